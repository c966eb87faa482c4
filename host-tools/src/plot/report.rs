//! A page of what was measured: one HTML file that needs nothing else, neither fonts nor network.

use std::fmt::Write as _;

use super::draw::{ROLES, hex};
use super::{Chart, PlotError};

const STYLE: &str = include_str!("report.css");

/// Points in all charts of a page together, of at most 10 bytes each: the file stays below 3 MB.
const MOST_POINTS: usize = 240_000;

/// A series keeps at least this many points, however many series there are.
const FEWEST_POINTS: usize = 60;

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

/// A report.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// The page's title.
    pub title: String,
    /// A sentence under the title; may be empty.
    pub lead: String,
    /// What was measured, in the order of importance.
    pub summary: Vec<SummaryRow>,
    /// The charts, in order.
    pub charts: Vec<Chart>,
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
            "<title>{title}</title>\n<style>\n{STYLE}{}</style>",
            roles()
        );
        let _ = writeln!(page, "<h1>{title}</h1>");
        if !self.lead.is_empty() {
            let _ = writeln!(page, "<p class=\"lead\">{}</p>", escaped(&self.lead));
        }
        self.put_summary(&mut page);
        let series: usize = self.charts.iter().map(|chart| chart.series.len()).sum();
        let most_points = (MOST_POINTS / series.max(1)).max(FEWEST_POINTS);
        page.push_str("<div class=\"charts\">\n");
        for chart in &self.charts {
            let caption = escaped(&chart.title);
            let _ = writeln!(page, "<figure>\n<figcaption>{caption}</figcaption>");
            page.push_str(&chart.element(most_points)?);
            page.push_str("</figure>\n");
        }
        page.push_str("</div>\n</html>\n");
        Ok(page)
    }

    fn put_summary(&self, page: &mut String) {
        if self.summary.is_empty() {
            return;
        }
        page.push_str("<table>\n<thead><tr><th>measured<th>value<th>to compare</thead>\n<tbody>\n");
        for SummaryRow { what, value, note } in &self.summary {
            let _ = writeln!(
                page,
                "<tr><th scope=\"row\">{}<td class=\"value\">{}<td class=\"note\">{}",
                escaped(what),
                escaped(value),
                escaped(note)
            );
        }
        page.push_str("</tbody>\n</table>\n");
    }
}

/// The rules by which a chart's fixed colours become those of the page.
fn roles() -> String {
    let mut rules = String::new();
    for (name, colour) in ROLES {
        let value = hex(colour);
        for property in ["stroke", "fill"] {
            let _ = writeln!(
                rules,
                "svg [{property}=\"{value}\"] {{ {property}: var(--{name}); }}"
            );
        }
    }
    rules
}

fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            control if control.is_control() => safe.push(' '),
            other => safe.push(other),
        }
    }
    safe
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

    #[test]
    fn the_page_asks_for_nothing_and_escapes_everything() {
        let mut report = Report {
            title: "<b>title</b>".to_owned(),
            lead: "x & y".to_owned(),
            charts: vec![chart(2, 10)],
            ..Report::default()
        };
        report.add("<i>", "1 < 2", "it's");
        let page = report.html().expect("finite");
        for text in [
            "&lt;b&gt;title",
            "x &amp; y",
            "&lt;i&gt;",
            "1 &lt; 2",
            "it&#39;s",
        ] {
            assert!(page.contains(text), "{text}");
        }
        for text in [
            "http", "//", "url(", "<b>", "<i>", "src=", "href=", "@import",
        ] {
            assert!(!page.contains(text), "{text}");
        }
        assert_eq!(page.matches("<svg").count(), 1);
        assert_eq!(page, report.html().expect("finite"));
    }

    #[test]
    fn long_recordings_stay_below_three_megabytes() {
        let report = Report {
            charts: vec![chart(12, 60_000); 16],
            ..Report::default()
        };
        let page = report.html().expect("finite");
        assert!(page.len() < 3_000_000, "{} bytes", page.len());
        assert!(page.len() > 1_000_000, "{} bytes", page.len());
    }

    #[test]
    fn a_number_that_is_none_is_an_error() {
        let mut bad = chart(1, 3);
        bad.series[0].points[2].0 = f64::INFINITY;
        let report = Report {
            charts: vec![bad],
            ..Report::default()
        };
        assert!(matches!(
            report.html(),
            Err(PlotError::NotFinite { index: 2, .. })
        ));
    }
}
