//! Several charts under each other, as one SVG document.

use super::draw::{NAME_SPACE, WIDTH_IN_PIXELS, in_pixels};
use super::{Chart, PlotError};
use std::fmt::Write as _;

/// The charts in one document on white, each with its title, with their left edges above each
/// other: charts over the same x can be read along one vertical line.
///
/// # Errors
/// A number that is not finite.
pub fn stack(charts: &[Chart]) -> Result<String, PlotError> {
    let mut body = String::new();
    let mut top = 0.0;
    for chart in charts {
        let (svg, height) = chart.nested(top)?;
        body.push_str(&svg);
        top += height;
    }
    let width = WIDTH_IN_PIXELS;
    let mut document = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(
        document,
        "<svg xmlns=\"{NAME_SPACE}\" width=\"{width}\" height=\"{top}\" \
         viewBox=\"0 0 {width} {top}\">\n\
         <rect width=\"{width}\" height=\"{top}\" fill=\"#FFFFFF\"/>\n{body}</svg>"
    );
    Ok(document)
}

impl Chart {
    /// The chart as an element of a larger picture, `top` pixels from its top, and its height.
    fn nested(&self, top: f64) -> Result<(String, f64), PlotError> {
        let (svg, height) = in_pixels(&self.svg()?);
        let place = format!("<svg y=\"{top}\" height=\"{height}\" ");
        Ok((svg.replacen("<svg ", &place, 1), height))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{Axis, Series};

    #[test]
    fn charts_stand_under_each_other() {
        let chart = |name: &str| {
            let mut chart = Chart::new(name, Axis::new("t", "s"), Axis::new("y", ""));
            let points = vec![(0.0, 0.0), (1.0, 2.0)];
            chart.series.push(Series::line(name, points));
            chart
        };
        let svg = stack(&[chart("one"), chart("two"), chart("three")]).expect("finite");
        assert_eq!(svg.matches("<svg ").count(), 4);
        assert_eq!(svg.matches("</svg>").count(), 4);
        assert!(svg.contains(" y=\"330\" height=\"330\""), "{svg}");
        assert!(svg.contains("height=\"990\""), "{svg}");
        // One name space, that of the document, and nothing from elsewhere.
        assert_eq!(svg.matches("http").count(), 1);
    }
}
