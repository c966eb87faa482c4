(() => {
  const findings = [];
  const box = (element) => element.getBoundingClientRect();
  const width = document.documentElement.clientWidth;
  if (document.documentElement.scrollWidth > width || document.body.scrollWidth > width) {
    findings.push("the page is wider than the page that is seen: " + document.documentElement.scrollWidth);
  }
  for (const element of document.querySelectorAll("body *:not(svg *)")) {
    const { left, right } = box(element);
    if (left < -0.5 || right > width + 0.5) {
      findings.push(element.outerHTML.slice(0, 80) + " is wider than the page: " + left + " to " + right);
    }
  }
  const resources = performance.getEntriesByType("resource").map((entry) => entry.name);
  findings.push(...resources.map((name) => name + " was asked for"));
  for (const figure of document.querySelectorAll("figure")) {
    const title = figure.querySelector("figcaption").textContent;
    const svg = figure.querySelector("svg");
    if (!svg || box(svg).width < 200 || box(svg).height < 60) {
      findings.push(title + ": there is no picture");
      continue;
    }
    const outer = box(svg);
    // What shows the numbers, from edge to edge.
    const shown = [...svg.querySelectorAll(".series, .leg")].map(box);
    const span = (low, high) =>
      Math.max(...shown.map((part) => part[high])) - Math.min(...shown.map((part) => part[low]));
    if (shown.length === 0 || !(span("left", "right") > 0.3 * outer.width) || !(span("top", "bottom") > 4)) {
      findings.push(title + ": the picture shows nothing");
    }
    const texts = [...svg.querySelectorAll("text")].filter((text) => text.textContent.trim() !== "");
    const boxes = texts.map(box);
    for (const [index, text] of texts.entries()) {
      const size = parseFloat(getComputedStyle(text).fontSize) * outer.width / svg.viewBox.baseVal.width;
      if (size < 11) findings.push(title + ": " + text.textContent.trim() + " is too small: " + size + " px");
      const own = boxes[index];
      if (own.left < outer.left - 1 || own.right > outer.right + 1 || own.bottom > outer.bottom + 1) {
        findings.push(title + ": " + text.textContent.trim() + " is cut off");
      }
      for (let other = 0; other < index; other++) {
        const across = Math.min(own.right, boxes[other].right) - Math.max(own.left, boxes[other].left);
        const down = Math.min(own.bottom, boxes[other].bottom) - Math.max(own.top, boxes[other].top);
        // Lines of text are higher than their letters.
        if (across > 1 && down > 4) {
          findings.push(title + ": " + text.textContent.trim() + " overlaps " + texts[other].textContent.trim());
        }
      }
    }
  }
  return findings;
})()
