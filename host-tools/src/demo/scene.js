"use strict";
(() => {
  const scene = document.getElementById("scene");
  const source = document.getElementById("scene-data");
  if (!scene || !source) return;
  const data = JSON.parse(source.textContent);
  const frames = data.frames;
  const last = frames.length - 1;
  const trailLength = Math.round(0.4 / data.step);
  const svg = scene.querySelector("svg");
  const marks = svg.querySelector(".marks");
  const trunk = svg.querySelector(".trunk");
  const legs = data.legs.map((name, index) => {
    const group = svg.querySelector("g.leg-" + index);
    return {
      name,
      line: group.querySelector("polyline"),
      joints: [...group.querySelectorAll(".joint")],
      foot: group.querySelector(".foot"),
      trail: svg.querySelector(".trail.leg-" + index),
      near: data.near.includes(index),
    };
  });
  // Where each leg's numbers begin in a frame: phase, height, way and feet are before them.
  let begin = 4;
  for (let index = 0; index < legs.length; index++) {
    legs[index].begin = begin;
    legs[index].count = data.joints[index];
    begin += 2 * (data.joints[index] + 1);
  }

  // A place of a frame in the picture's mm; joint number `count` is the foot.
  const place = (frame, leg, joint) => {
    const at = leg.begin + 2 * joint;
    return [frame[at] / 10, -(frame[1] + frame[at + 1]) / 10];
  };
  const text = (points) => points.map(([x, y]) => x.toFixed(1) + "," + y.toFixed(1)).join(" ");

  const play = document.getElementById("scene-play");
  const time = document.getElementById("scene-time");
  const speed = document.getElementById("scene-speed");
  const readout = document.getElementById("scene-readout");
  let at = 0;
  let playing = false;
  let before = null;

  const draw = () => {
    const index = Math.min(last, Math.floor(at));
    const frame = frames[index];
    const [phase, height, way, feet] = frame;
    marks.setAttribute("transform", "translate(" + (-((way / 10) % data.marks)).toFixed(1) + " 0)");
    trunk.setAttribute("transform", "translate(0 " + (-height / 10).toFixed(1) + ")");
    const down = [];
    for (const [number, leg] of legs.entries()) {
      const joints = [];
      for (let joint = 0; joint < leg.count; joint++) joints.push(place(frame, leg, joint));
      leg.line.setAttribute("points", text(joints));
      for (const [joint, circle] of leg.joints.entries()) {
        circle.setAttribute("cx", joints[joint][0]);
        circle.setAttribute("cy", joints[joint][1]);
      }
      const foot = place(frame, leg, leg.count);
      leg.foot.setAttribute("cx", foot[0]);
      leg.foot.setAttribute("cy", foot[1]);
      const on = (feet >> number) & 1;
      leg.foot.classList.toggle("on", Boolean(on));
      if (on) down.push(leg.name);
      if (leg.near) {
        // Where the foot has been over the ground, which has moved on since.
        const trail = [];
        for (let past = Math.max(0, index - trailLength); past <= index; past++) {
          const [x, y] = place(frames[past], leg, leg.count);
          trail.push([x + (frames[past][2] - way) / 10, y]);
        }
        leg.trail.setAttribute("points", text(trail));
      }
    }
    time.value = index;
    const seconds = (index * data.step).toFixed(2) + " s";
    time.setAttribute("aria-valuetext", seconds);
    readout.textContent = seconds + ": " + data.phases[phase] + ", " + (way / 1e4).toFixed(2) +
      " m forward. On the ground: " + (down.length === legs.length ? "all feet" : down.join(", ") || "no foot") + ".";
  };

  const step = (now) => {
    if (!playing) return;
    // A page that was hidden goes on where it was.
    if (before !== null) at += Math.min(now - before, 100) / 1e3 * Number(speed.value) / data.step;
    before = now;
    if (at > last) at = 0;
    draw();
    requestAnimationFrame(step);
  };
  const set = (on) => {
    playing = on;
    before = null;
    play.textContent = on ? "Pause" : "Play";
    if (on) requestAnimationFrame(step);
  };

  play.addEventListener("click", () => set(!playing));
  time.addEventListener("input", () => {
    set(false);
    at = Number(time.value);
    draw();
  });
  time.max = last;
  scene.querySelector(".controls").hidden = false;
  // Who asked for less motion sees one moment of it and starts it by hand.
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (still) at = data.still;
  draw();
  set(!still);
})();
