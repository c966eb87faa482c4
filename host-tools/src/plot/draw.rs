//! A chart as SVG.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::chart::HALF_BAR;
use super::legend::Legend;
use super::thin::thin;
use super::{Chart, Mark, PlotError};

pub(super) type Surface<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type Failure = DrawingAreaErrorKind<std::io::Error>;

/// The library draws on whole points only, so there are 4 to each pixel.
pub(super) const SCALE: i32 = 4;

/// Narrow enough that the text can be read on a phone, which shrinks it to 360 pixels.
const WIDTH: i32 = 560 * SCALE;
const HEIGHT: i32 = 300 * SCALE;
const TITLE_HEIGHT: i32 = 30 * SCALE;
const LEFT: i32 = 84 * SCALE;
const BOTTOM: i32 = 38 * SCALE;
const MARGIN: i32 = 8 * SCALE;
pub(super) const TEXT_SIZE: i32 = 13 * SCALE;
/// Thin enough for twelve series in one chart.
pub(super) const LINE_WIDTH: u32 = 6;

/// Points of one series in a chart of its own: two for each pixel.
const MOST_POINTS: usize = 1_100;

// The colours of roles. A report's style sheet finds them by their values and so can change them
// for a dark page; each is used for nothing else.
pub(super) const INK: RGBColor = RGBColor(0x22, 0x22, 0x23);
const GRID: RGBColor = RGBColor(0xDD, 0xDD, 0xDE);
const FRAME: RGBColor = RGBColor(0x99, 0x99, 0x9A);
pub(super) const LEVEL: RGBColor = RGBColor(0xC0, 0x20, 0x21);

/// Colours of series that can be told apart on white and on black.
const COLOURS: [RGBColor; 12] = [
    RGBColor(0x1F, 0x77, 0xD4),
    RGBColor(0xF2, 0x7F, 0x0E),
    RGBColor(0x2C, 0xA0, 0x3C),
    RGBColor(0xA8, 0x6A, 0xD0),
    RGBColor(0x17, 0xA9, 0xBB),
    RGBColor(0xE3, 0x5F, 0x9A),
    RGBColor(0x9A, 0x8A, 0x1C),
    RGBColor(0x8C, 0x5A, 0x4A),
    RGBColor(0x6B, 0x7A, 0x8C),
    RGBColor(0x5B, 0x5F, 0xE0),
    RGBColor(0x58, 0xA8, 0x8A),
    RGBColor(0xC8, 0x85, 0x6E),
];

pub(super) fn colour(index: usize) -> RGBColor {
    COLOURS[index % COLOURS.len()]
}

pub(super) fn text_style() -> TextStyle<'static> {
    // The library asks for 1.24 times the size of the letters.
    let size = f64::from(TEXT_SIZE) * 1.24;
    TextStyle::from(("sans-serif", size).into_font()).color(&INK)
}

impl Chart {
    /// The chart as an SVG document of its own, on white.
    ///
    /// # Errors
    /// A number that is not finite.
    pub fn svg(&self) -> Result<String, PlotError> {
        self.draw(true, MOST_POINTS)
    }

    /// The chart as an element of a page, whose style sheet gives the colours of ink and ground.
    pub(super) fn element(&self, most_points: usize) -> Result<String, PlotError> {
        let svg = self.draw(false, most_points.min(MOST_POINTS))?;
        // Part of HTML it needs no name space; its size is the page's affair.
        Ok(rewrite_root(&svg, "<svg role=\"img\" "))
    }

    fn draw(&self, alone: bool, most_points: usize) -> Result<String, PlotError> {
        self.check()?;
        let chart = self.printable();
        let mut svg = String::new();
        chart
            .draw_into(&mut svg, alone, most_points)
            .map_err(|cause| PlotError::Draw {
                chart: self.title.clone(),
                cause: cause.to_string(),
            })?;
        let plain = format!("stroke=\"{}\"", hex(LEVEL));
        let svg = svg.replace(&plain, &format!("{plain} stroke-dasharray=\"24 16\""));
        Ok(if alone {
            rewrite_root(
                &svg,
                &format!("<svg xmlns=\"{NAME_SPACE}\" width=\"{}\" ", WIDTH / SCALE),
            )
        } else {
            svg
        })
    }

    fn draw_into(&self, svg: &mut String, alone: bool, most_points: usize) -> Result<(), Failure> {
        let view = self.view();
        let legend = Legend::new(self, &view.levels, LEFT, WIDTH - MARGIN);
        let title_height = if alone { TITLE_HEIGHT } else { 0 };
        let height = (title_height + HEIGHT).unsigned_abs() + legend.height();
        let root = SVGBackend::with_string(svg, (WIDTH.unsigned_abs(), height)).into_drawing_area();
        if alone {
            root.fill(&WHITE)?;
            let middle = text_style().pos(Pos::new(HPos::Center, VPos::Center));
            let at = (WIDTH / 2, TITLE_HEIGHT / 2);
            root.draw(&Text::new(self.title.clone(), at, middle))?;
        }
        let (_, below) = root.split_vertically(title_height);
        let (picture, names) = below.split_vertically(HEIGHT);
        // Bars stand for things that are counted: each of a robot's twelve axes gets its number.
        let bars = self.series.iter().any(|series| series.mark == Mark::Bar);
        let mut context = ChartBuilder::on(&picture)
            .margin(MARGIN)
            .x_label_area_size(BOTTOM)
            .y_label_area_size(LEFT - MARGIN)
            .build_cartesian_2d(view.x.0..view.x.1, view.y.0..view.y.1)?;
        context
            .configure_mesh()
            .x_desc(self.x.label())
            .y_desc(self.y.label())
            .x_labels(if bars { 15 } else { 9 })
            .y_labels(7)
            .x_label_formatter(&|value| label(*value, view.x.1 - view.x.0))
            .y_label_formatter(&|value| label(*value, view.y.1 - view.y.0))
            .label_style(text_style())
            .axis_desc_style(text_style())
            .axis_style(FRAME.stroke_width(SCALE.unsigned_abs()))
            .bold_line_style(GRID.stroke_width(SCALE.unsigned_abs()))
            .light_line_style(TRANSPARENT)
            .set_all_tick_mark_size(4 * SCALE)
            .draw()?;
        for (level, _) in self
            .levels
            .iter()
            .zip(&view.levels)
            .filter(|(_, shown)| **shown)
        {
            let ends = [(view.x.0, level.value), (view.x.1, level.value)];
            context.draw_series(LineSeries::new(ends, LEVEL.stroke_width(LINE_WIDTH)))?;
        }
        for (index, series) in self.series.iter().enumerate() {
            let colour = colour(index);
            match series.mark {
                Mark::Line => {
                    let points = thin(&series.points, most_points);
                    context
                        .draw_series(LineSeries::new(points, colour.stroke_width(LINE_WIDTH)))?;
                }
                Mark::Bar => {
                    let bars = series.points.iter().map(|(x, y)| {
                        Rectangle::new([(x - HALF_BAR, 0.0), (x + HALF_BAR, *y)], colour.filled())
                    });
                    context.draw_series(bars)?;
                }
            }
        }
        legend.draw(&names)?;
        root.present()
    }

    /// The same with texts that XML can carry.
    fn printable(&self) -> Self {
        let mut chart = self.clone();
        let series = chart.series.iter_mut().map(|series| &mut series.name);
        let levels = chart.levels.iter_mut().map(|level| &mut level.name);
        let own = [
            &mut chart.title,
            &mut chart.x.name,
            &mut chart.x.unit,
            &mut chart.y.name,
            &mut chart.y.unit,
        ];
        for text in own.into_iter().chain(series).chain(levels) {
            text.retain(|character| !character.is_control());
        }
        chart
    }
}

pub(super) const NAME_SPACE: &str = "http://www.w3.org/2000/svg";

/// How wide every chart is shown.
pub(super) const WIDTH_IN_PIXELS: i32 = WIDTH / SCALE;

/// A chart of its own without its name space, and how high it is shown.
pub(super) fn in_pixels(svg: &str) -> (String, f64) {
    let name_space = format!(" xmlns=\"{NAME_SPACE}\"");
    let height = svg
        .split_once("viewBox=\"")
        .and_then(|(_, rest)| rest.split('"').next())
        .and_then(|numbers| numbers.split_whitespace().last())
        .and_then(|number| number.parse::<f64>().ok())
        .unwrap_or_default();
    (svg.replacen(&name_space, "", 1), height / f64::from(SCALE))
}

/// Puts `start` in the place of the root's size in points and name space, and keeps its view box.
fn rewrite_root(svg: &str, start: &str) -> String {
    match svg.find("viewBox=") {
        Some(at) => {
            let joined = " stroke-linejoin=\"round\" ";
            let name_space = format!(" xmlns=\"{NAME_SPACE}\"");
            let rest = svg[at..].replacen(&name_space, joined, 1);
            format!("{start}{rest}")
        }
        None => svg.to_owned(),
    }
}

/// The colour as it is written in SVG.
pub(super) fn hex(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

pub(super) const ROLES: [(&str, RGBColor); 4] = [
    ("ink", INK),
    ("grid", GRID),
    ("frame", FRAME),
    ("level", LEVEL),
];

/// A number at an axis that shows a range of `extent`: as many digits as tell it from its
/// neighbours, and zero where rounding has left next to nothing of it.
fn label(value: f64, extent: f64) -> String {
    let size = value.abs();
    if size < extent.abs() * 1e-9 {
        return "0".to_owned();
    }
    let text = if size != 0.0 && !(1e-4..1e6).contains(&size) {
        format!("{value:.1e}").replace(".0e", "e")
    } else {
        let text = format!("{value:.6}");
        let short = text.trim_end_matches('0').trim_end_matches('.');
        (if short == "-0" { "0" } else { short }).to_owned()
    };
    text.replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{Axis, Series};

    #[test]
    fn labels_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (0.30000000000000004, "0.3"),
            (-20.0, "\u{2212}20"),
            (1200.5, "1200.5"),
            (2e6, "2e6"),
            (1.27e-5, "1.3e\u{2212}5"),
            (-1e-17, "\u{2212}1e\u{2212}17"),
        ] {
            assert_eq!(label(value, 0.0), text);
        }
        assert_eq!(label(-1.3e-23, 1e-7), "0");
    }

    #[test]
    fn texts_are_escaped() {
        let mut chart = Chart::new("a<b>&\"\u{1}", Axis::new("<t>", "s"), Axis::new("y&", ""));
        chart
            .series
            .push(Series::line("<script>", vec![(0.0, 0.0), (1.0, 1.0)]));
        chart.series.push(Series::line("'two'", vec![(0.0, 1.0)]));
        chart.add_limit("lim<it", 1.0);
        let svg = chart.svg().expect("finite");
        for text in [
            "a&lt;b&gt;&amp;&quot;\n",
            "&lt;t&gt; (s)",
            "&lt;script&gt;",
            "lim&lt;it",
        ] {
            assert!(svg.contains(text), "{text} in {svg}");
        }
        assert!(!svg.contains("<script") && !svg.contains('\u{1}'));
        assert!(svg.contains("stroke-dasharray"));
    }

    #[test]
    fn an_empty_chart_and_bars_can_be_drawn() {
        let mut chart = Chart::new("bars", Axis::new("axis", ""), Axis::new("skew", "us"));
        let empty = chart.svg().expect("nothing to go wrong");
        assert!(empty.starts_with("<svg ") && empty.trim_end().ends_with("</svg>"));
        chart
            .series
            .push(Series::bars("skew", vec![(1.0, 3.0), (2.0, -4.0)]));
        assert!(chart.svg().expect("finite").matches("<rect").count() >= 3);
    }
}
