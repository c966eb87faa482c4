//! A page of what was measured: one HTML file that needs nothing else, neither fonts nor network.

use std::fmt::Write as _;

use super::draw::escaped;
use super::style::rules;
use super::{Chart, PlotError, Timeline};

const STYLE: &str = include_str!("report.css");

/// Points in all charts of a page together, of at most 10 bytes each: the file stays below 3 MB.
const MOST_POINTS: usize = 180_000;

/// A series keeps at least this many points, however many series there are.
const FEWEST_POINTS: usize = 60;

/// A figure that a reader should not miss.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Headline {
    /// What was measured.
    pub what: String,
    /// The value with its unit.
    pub value: String,
    /// What was asked for.
    pub asked: String,
    /// Whether the value is as was asked.
    pub kept: bool,
}

/// One line of the summary.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SummaryRow {
    /// What was measured.
    pub what: String,
    /// The value with its unit.
    pub value: String,
    /// What to compare it with, or why it matters; may be empty.
    pub note: String,
}

/// What a figure shows.
#[derive(Debug, Clone, PartialEq)]
pub enum Picture {
    /// Series over a common x.
    Chart(Chart),
    /// What is on when.
    Timeline(Timeline),
    /// HTML of the caller's own, under a title. It must ask for nothing from elsewhere.
    Markup {
        /// What it shows.
        title: String,
        /// It is put into the page as it is.
        html: String,
    },
}

/// A picture with a sentence.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// What it shows.
    pub picture: Picture,
    /// What to look at; may be empty.
    pub note: String,
    /// Whether it is as wide as the page.
    pub wide: bool,
}

impl Figure {
    /// A figure of usual width.
    pub fn new(picture: Picture, note: impl Into<String>) -> Self {
        Self {
            picture,
            note: note.into(),
            wide: false,
        }
    }

    /// A chart of usual width.
    pub fn chart(chart: Chart, note: impl Into<String>) -> Self {
        Self::new(Picture::Chart(chart), note)
    }
}

/// A part of a report under a title of its own.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// Its title.
    pub title: String,
    /// A paragraph under it; may be empty.
    pub text: String,
    /// What it shows.
    pub figures: Vec<Figure>,
    /// What it shows to those who ask: the words to click on, and more figures.
    pub folded: Vec<(String, Vec<Figure>)>,
}

impl Section {
    fn all_figures(&self) -> impl Iterator<Item = &Figure> {
        let folded = self.folded.iter().flat_map(|(_, figures)| figures);
        self.figures.iter().chain(folded)
    }
}

/// A program that runs in the page. Others do not: its policy names the digest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Script {
    /// JavaScript.
    pub source: &'static str,
    /// The SHA-256 of the source in base 64. A browser that finds another one runs nothing and says
    /// which it has found.
    pub sha256: &'static str,
}

/// A report.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// The page's title.
    pub title: String,
    /// A sentence under the title; may be empty.
    pub lead: String,
    /// What a reader should not miss.
    pub headlines: Vec<Headline>,
    /// The parts, in order.
    pub sections: Vec<Section>,
    /// All that was measured, in the order of importance.
    pub summary: Vec<SummaryRow>,
    /// The last words, such as how to get the page again; may be empty.
    pub footer: String,
    /// More CSS, for markup of the caller's own.
    pub style: &'static str,
    /// What moves the page; none for a page that stands still.
    pub script: Option<Script>,
}

impl Report {
    /// Adds a line to the summary.
    pub fn add(
        &mut self,
        what: impl Into<String>,
        value: impl Into<String>,
        note: impl Into<String>,
    ) {
        self.summary.push(SummaryRow {
            what: what.into(),
            value: value.into(),
            note: note.into(),
        });
    }

    /// The page.
    ///
    /// # Errors
    /// A number in a chart that is not finite.
    pub fn html(&self) -> Result<String, PlotError> {
        let mut page =
            String::from("<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n");
        page.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
        let title = escaped(&self.title);
        // Writing to a string cannot fail.
        let _ = writeln!(
            page,
            "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n<title>{title}</title>\n\
             <style>\n{STYLE}{}{}</style>",
            self.policy(),
            rules(),
            self.style
        );
        let _ = writeln!(page, "<header>\n<h1>{title}</h1>");
        if !self.lead.is_empty() {
            let _ = writeln!(page, "<p class=\"lead\">{}</p>", escaped(&self.lead));
        }
        page.push_str("</header>\n<main>\n");
        self.put_headlines(&mut page);
        for section in &self.sections {
            self.put_section(&mut page, section)?;
        }
        self.put_summary(&mut page);
        page.push_str("</main>\n");
        if !self.footer.is_empty() {
            let _ = writeln!(page, "<footer>{}</footer>", escaped(&self.footer));
        }
        if let Some(script) = &self.script {
            let _ = writeln!(page, "<script>{}</script>", script.source);
        }
        page.push_str("</html>\n");
        Ok(page)
    }

    /// Nothing from elsewhere, and no program but ours.
    fn policy(&self) -> String {
        let script = self.script.as_ref().map_or_else(
            || "'none'".to_owned(),
            |script| format!("'sha256-{}'", script.sha256),
        );
        format!(
            "default-src 'none'; style-src 'unsafe-inline'; script-src {script}; \
             base-uri 'none'; form-action 'none'"
        )
    }

    fn put_headlines(&self, page: &mut String) {
        if self.headlines.is_empty() {
            return;
        }
        page.push_str("<ul class=\"headlines\">\n");
        for headline in &self.headlines {
            let Headline {
                what,
                value,
                asked,
                kept,
            } = headline;
            // A sign and a word, so that it does not take colour to see it.
            let (class, sign) = if *kept {
                ("kept", "\u{2713} as asked")
            } else {
                ("broken", "\u{2717} not as asked")
            };
            let _ = writeln!(
                page,
                "<li class=\"{class}\"><span class=\"what\">{}</span> \
                 <strong>{}</strong> <span class=\"asked\">{}</span> \
                 <span class=\"sign\">{sign}</span></li>",
                escaped(what),
                escaped(value),
                escaped(asked)
            );
        }
        page.push_str("</ul>\n");
    }

    fn put_section(&self, page: &mut String, section: &Section) -> Result<(), PlotError> {
        let _ = writeln!(page, "<section>\n<h2>{}</h2>", escaped(&section.title));
        if !section.text.is_empty() {
            let _ = writeln!(page, "<p class=\"text\">{}</p>", escaped(&section.text));
        }
        self.put_figures(page, &section.figures)?;
        for (words, figures) in &section.folded {
            let words = escaped(words);
            let _ = writeln!(page, "<details>\n<summary>{words}</summary>");
            self.put_figures(page, figures)?;
            page.push_str("</details>\n");
        }
        page.push_str("</section>\n");
        Ok(())
    }

    fn put_figures(&self, page: &mut String, figures: &[Figure]) -> Result<(), PlotError> {
        let most_points = self.most_points();
        page.push_str("<div class=\"figures\">\n");
        for figure in figures {
            let (title, body) = match &figure.picture {
                Picture::Chart(chart) => (&chart.title, chart.element(most_points)?),
                Picture::Timeline(timeline) => (&timeline.title, timeline.element()?),
                Picture::Markup { title, html } => (title, html.clone()),
            };
            let class = if figure.wide { " class=\"wide\"" } else { "" };
            let _ = writeln!(
                page,
                "<figure{class}>\n<figcaption>{}</figcaption>\n{body}",
                escaped(title)
            );
            if !figure.note.is_empty() {
                let _ = writeln!(page, "<p class=\"note\">{}</p>", escaped(&figure.note));
            }
            page.push_str("</figure>\n");
        }
        page.push_str("</div>\n");
        Ok(())
    }

    /// What each series may have.
    fn most_points(&self) -> usize {
        let figures = self.sections.iter().flat_map(Section::all_figures);
        let series: usize = figures
            .map(|figure| match &figure.picture {
                Picture::Chart(chart) => chart.series.len(),
                _ => 0,
            })
            .sum();
        (MOST_POINTS / series.max(1)).max(FEWEST_POINTS)
    }

    fn put_summary(&self, page: &mut String) {
        if self.summary.is_empty() {
            return;
        }
        page.push_str(
            "<section>\n<h2>All that was measured</h2>\n<table>\n\
             <thead><tr><th>measured<th>value<th>to compare</thead>\n<tbody>\n",
        );
        for SummaryRow { what, value, note } in &self.summary {
            let _ = writeln!(
                page,
                "<tr><th scope=\"row\">{}<td class=\"value\">{}<td class=\"note\">{}",
                escaped(what),
                escaped(value),
                escaped(note)
            );
        }
        page.push_str("</tbody>\n</table>\n</section>\n");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{Axis, Series};

    fn chart(series: usize, points: usize) -> Chart {
        let mut chart = Chart::new("a <chart>", Axis::new("t", "s"), Axis::new("y", "rad"));
        for index in 0..series {
            let wave = |at: usize| {
                let t = at as f64 * 1e-3;
                (t, (t * (1.0 + index as f64) * 40.0).sin() * 100.0)
            };
            let points = (0..points).map(wave).collect();
            chart
                .series
                .push(Series::line(format!("axis {index}"), points));
        }
        chart
    }

    fn report(charts: Vec<Chart>) -> Report {
        let figures = charts.into_iter().map(|chart| Figure::chart(chart, ""));
        Report {
            sections: vec![Section {
                figures: figures.collect(),
                ..Section::default()
            }],
            ..Report::default()
        }
    }

    #[test]
    fn the_page_asks_for_nothing_and_escapes_everything() {
        let mut report = Report {
            title: "<b>title</b>".to_owned(),
            lead: "x & y".to_owned(),
            headlines: vec![Headline {
                what: "<u>".to_owned(),
                ..Headline::default()
            }],
            ..report(vec![chart(2, 10)])
        };
        report.sections[0].text = "<em>".to_owned();
        report.add("<i>", "1 < 2", "it's");
        let page = report.html().expect("finite");
        for text in [
            "&lt;b&gt;title",
            "x &amp; y",
            "&lt;u&gt;",
            "&lt;em&gt;",
            "&lt;i&gt;",
            "1 &lt; 2",
            "it&#39;s",
            "default-src 'none'; ",
            "script-src 'none';",
        ] {
            assert!(page.contains(text), "{text}");
        }
        for text in [
            "http:", "https", "//", "url(", "<b>", "<i>", "<u>", "<em>", "src=", "href=",
            "@import", "<script",
        ] {
            assert!(!page.contains(text), "{text}");
        }
        assert_eq!(page.matches("<svg").count(), 1);
        assert_eq!(page, report.html().expect("finite"));
    }

    #[test]
    fn long_recordings_stay_below_three_megabytes() {
        let page = report(vec![chart(12, 60_000); 16]);
        let page = page.html().expect("finite");
        assert!(page.len() < 3_000_000, "{} bytes", page.len());
        assert!(page.len() > 1_000_000, "{} bytes", page.len());
    }

    #[test]
    fn a_number_that_is_none_is_an_error() {
        let mut bad = chart(1, 3);
        bad.series[0].points[2].0 = f64::INFINITY;
        assert!(matches!(
            report(vec![bad]).html(),
            Err(PlotError::NotFinite { index: 2, .. })
        ));
    }
}
