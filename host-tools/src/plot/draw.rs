//! A chart as SVG.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::chart::{HALF_BAR, View};
use super::legend::Legend;
use super::style::{
    FRAME, GRID, LETTER, LEVEL, LINE_WIDTH, RADIUS, SCALE, TEXT_SIZE, colour, dressed, text_style,
};
use super::thin::thin;
use super::{Axis, Chart, Mark, PlotError};

pub(super) type Surface<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Plane = Cartesian2d<RangedCoordf64, RangedCoordf64>;
pub(super) type Frame<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Plane>;
pub(super) type Failure = DrawingAreaErrorKind<std::io::Error>;

/// How large a picture is, in points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Size {
    pub(super) width: i32,
    pub(super) height: i32,
    /// To the left of the picture: numbers and what they mean.
    pub(super) left: i32,
    /// Numbers along the lower edge, at most.
    pub(super) numbers: usize,
}

impl Size {
    /// Of a picture alone.
    const ALONE: Self = Self {
        width: 560 * SCALE,
        height: 300 * SCALE,
        left: 84 * SCALE,
        numbers: 9,
    };

    /// On a page: narrow enough that the text can be read on a phone, which shrinks it to 350 pixels.
    pub(super) const ON_PAGE: Self = Self {
        width: 390 * SCALE,
        height: 250 * SCALE,
        left: 72 * SCALE,
        numbers: 6,
    };
}

impl Size {
    /// How wide and how high the picture is between its axes.
    fn inside(self) -> (i32, i32) {
        (
            self.width - self.left - MARGIN,
            self.height - BOTTOM - 2 * MARGIN,
        )
    }

    /// The same, or lower where a picture to scale would be empty above and below.
    fn no_higher_than_needed(self, view: &View) -> Self {
        let (width, height) = self.inside();
        let aspect = (view.y.1 - view.y.0) / (view.x.1 - view.x.0);
        let needed = (f64::from(width) * aspect) as i32;
        let height = needed.clamp(LOWEST.min(height), height);
        Self {
            height: height + BOTTOM + 2 * MARGIN,
            ..self
        }
    }

    /// The same, or with more room to the left where the numbers of this range need it.
    fn with_room_for(self, range: (f64, f64)) -> Self {
        let numbers = RangedCoordf64::from(range.0..range.1).key_points(NUMBERS_UP);
        let letters = numbers.into_iter().map(|number| {
            let text = label(number, range.1 - range.0);
            text.chars().count()
        });
        let widest = letters.max().unwrap_or(0) as f64 * LETTER * f64::from(TEXT_SIZE);
        // A line of text on its side, and gaps.
        let left = widest as i32 + TEXT_SIZE + 3 * MARGIN;
        Self {
            left: self.left.max(left),
            ..self
        }
    }
}

/// A picture to scale is at least so high.
const LOWEST: i32 = 90 * SCALE;

/// Numbers along the left edge, at most.
const NUMBERS_UP: usize = 7;

const TITLE_HEIGHT: i32 = 30 * SCALE;
const BOTTOM: i32 = 38 * SCALE;
pub(super) const MARGIN: i32 = 8 * SCALE;

/// Points of one series in a chart of its own: two for each pixel.
const MOST_POINTS: usize = 1_100;

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
        Ok(element(&svg, &self.title))
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
        let svg = dressed(&svg);
        Ok(if alone {
            rewrite_root(
                &svg,
                &format!("<svg xmlns=\"{NAME_SPACE}\" width=\"{WIDTH_IN_PIXELS}\" "),
            )
        } else {
            svg
        })
    }

    fn draw_into(&self, svg: &mut String, alone: bool, most_points: usize) -> Result<(), Failure> {
        let view = self.view();
        let mut size = if alone { Size::ALONE } else { Size::ON_PAGE };
        size = size.with_room_for(view.y);
        if self.to_scale {
            size = size.no_higher_than_needed(&view);
        }
        let (width, height) = (size.width, size.height);
        let inside = size.inside();
        let view = if self.to_scale {
            view.scaled(f64::from(inside.0) / f64::from(inside.1))
        } else {
            view
        };
        let legend = Legend::new(self, &view.levels, size.left, width - MARGIN);
        let title_height = if alone { TITLE_HEIGHT } else { 0 };
        let all = (title_height + height).unsigned_abs() + legend.height();
        let root = SVGBackend::with_string(svg, (width.unsigned_abs(), all)).into_drawing_area();
        if alone {
            root.fill(&WHITE)?;
            let middle = text_style().pos(Pos::new(HPos::Center, VPos::Center));
            let at = (width / 2, TITLE_HEIGHT / 2);
            root.draw(&Text::new(self.title.clone(), at, middle))?;
        }
        let (_, below) = root.split_vertically(title_height);
        let (picture, names) = below.split_vertically(height);
        // Bars stand for things that are counted: each of a robot's twelve axes gets its number.
        let bars = self.series.iter().any(|series| series.mark == Mark::Bar);
        let up = (inside.1 / (2 * TEXT_SIZE)).clamp(2, NUMBERS_UP as i32) as usize;
        let numbers = [if bars { 15 } else { size.numbers }, up];
        let mut context = frame(&picture, size, &view, numbers, [&self.x, &self.y])?;
        for (level, _) in self
            .levels
            .iter()
            .zip(&view.levels)
            .filter(|(_, shown)| **shown)
        {
            let ends = [(view.x.0, level.value), (view.x.1, level.value)];
            context.draw_series(LineSeries::new(ends, LEVEL.stroke_width(LINE_WIDTH)))?;
        }
        for series in &self.series {
            let colour = colour(self.look_of(series));
            match series.mark {
                Mark::Line => {
                    let points = thin(&series.points, most_points);
                    context
                        .draw_series(LineSeries::new(points, colour.stroke_width(LINE_WIDTH)))?;
                }
                Mark::Dots => {
                    let every = series.points.len().div_ceil(most_points).max(1);
                    let points = series.points.iter().step_by(every);
                    let dots = points.map(|point| Circle::new(*point, RADIUS, colour.filled()));
                    context.draw_series(dots)?;
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
pub(super) const WIDTH_IN_PIXELS: i32 = Size::ALONE.width / SCALE;

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

/// A picture as a part of a page: it needs no name space, and its size is the page's affair.
pub(super) fn element(svg: &str, title: &str) -> String {
    let title = escaped(title);
    rewrite_root(svg, &format!("<svg role=\"img\" aria-label=\"{title}\" "))
}

/// The text as HTML and SVG carry it.
pub(super) fn escaped(text: &str) -> String {
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

/// A picture's axes with their numbers, and a grid.
pub(super) fn frame<'a, 'b>(
    picture: &'a Surface<'b>,
    size: Size,
    view: &View,
    numbers: [usize; 2],
    axes: [&Axis; 2],
) -> Result<Frame<'a, 'b>, Failure> {
    let mut context = ChartBuilder::on(picture)
        .margin(MARGIN)
        .x_label_area_size(BOTTOM)
        .y_label_area_size(size.left - MARGIN)
        .build_cartesian_2d(view.x.0..view.x.1, view.y.0..view.y.1)?;
    context
        .configure_mesh()
        .x_desc(axes[0].label())
        .y_desc(axes[1].label())
        .x_labels(numbers[0])
        .y_labels(numbers[1])
        .x_label_formatter(&|value| label(*value, view.x.1 - view.x.0))
        .y_label_formatter(&|value| label(*value, view.y.1 - view.y.0))
        .label_style(text_style())
        .axis_desc_style(text_style())
        .axis_style(FRAME.stroke_width(SCALE.unsigned_abs()))
        .bold_line_style(GRID.stroke_width(SCALE.unsigned_abs()))
        .light_line_style(TRANSPARENT)
        .set_all_tick_mark_size(4 * SCALE)
        .draw()?;
    Ok(context)
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
