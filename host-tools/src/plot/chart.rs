//! What a chart shows.

use super::PlotError;

/// An axis of a chart.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    /// What is along it, such as `velocity`.
    pub name: String,
    /// Its unit, such as `rad/s`; empty for plain numbers.
    pub unit: String,
}

impl Axis {
    /// An axis from its name and unit.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
        }
    }

    pub(super) fn label(&self) -> String {
        if self.unit.is_empty() {
            self.name.clone()
        } else {
            format!("{} ({})", self.name, self.unit)
        }
    }
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mark {
    /// A line from point to point.
    #[default]
    Line,
    /// A dot at each point.
    Dots,
    /// A bar from 0 to each point, around whole x.
    Bar,
}

/// Points that belong together. Series of one name look alike and stand in the legend once.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// x and y in the units of the axes, in the order in which a line joins them.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub mark: Mark,
}

impl Series {
    /// A line.
    pub fn line(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.into(),
            points,
            mark: Mark::Line,
        }
    }

    /// Dots.
    pub fn dots(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.into(),
            points,
            mark: Mark::Dots,
        }
    }

    /// Bars.
    pub fn bars(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.into(),
            points,
            mark: Mark::Bar,
        }
    }
}

/// A dashed line across the chart at some y, such as a limit. One that would squeeze the series
/// is left out of the picture, and the legend says so.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Its name in the legend, where levels of one name stand once.
    pub name: String,
    /// Where it is, in the unit of y.
    pub value: f64,
}

/// A picture of series over a common x.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// What it shows.
    pub title: String,
    /// The axis to the right.
    pub x: Axis,
    /// The axis upwards.
    pub y: Axis,
    /// What is drawn, the first below the others.
    pub series: Vec<Series>,
    /// Levels to compare with.
    pub levels: Vec<Level>,
    /// Whether a unit is as long to the right as it is upwards: a picture of things in space.
    pub to_scale: bool,
}

/// Levels may stretch the picture to this many times what the series need.
const LARGEST_STRETCH: f64 = 4.0;

/// Free space above and below the series, as a share of the whole.
const MARGIN: f64 = 0.05;

/// Half the width of a bar, where bars are 1 apart.
pub(super) const HALF_BAR: f64 = 0.35;

/// What part of the plane a chart shows.
pub(super) struct View {
    pub(super) x: (f64, f64),
    pub(super) y: (f64, f64),
    /// For each level, whether it is in the picture.
    pub(super) levels: Vec<bool>,
}

impl Chart {
    /// A chart without series.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self {
            title: title.into(),
            x,
            y,
            series: Vec::new(),
            levels: Vec::new(),
            to_scale: false,
        }
    }

    /// Which look a series has: that of the first one of its name.
    pub(super) fn look_of(&self, series: &Series) -> usize {
        let mut names: Vec<&str> = Vec::new();
        for other in &self.series {
            if other.name == series.name {
                break;
            }
            if !names.contains(&other.name.as_str()) {
                names.push(&other.name);
            }
        }
        names.len()
    }

    /// Adds a dashed line at `value`.
    pub fn add_level(&mut self, name: impl Into<String>, value: f64) {
        let name = name.into();
        self.levels.push(Level { name, value });
    }

    /// Adds dashed lines at `value` and at its negative.
    pub fn add_limit(&mut self, name: impl Into<String>, value: f64) {
        let name = name.into();
        for value in [value, -value] {
            self.add_level(name.clone(), value);
        }
    }

    pub(super) fn check(&self) -> Result<(), PlotError> {
        let bad = |name: &str, index| PlotError::NotFinite {
            chart: self.title.clone(),
            name: name.to_owned(),
            index,
        };
        for series in &self.series {
            let finite = |(x, y): &(f64, f64)| x.is_finite() && y.is_finite();
            if let Some(index) = series.points.iter().position(|point| !finite(point)) {
                return Err(bad(&series.name, index));
            }
        }
        match self.levels.iter().find(|level| !level.value.is_finite()) {
            Some(level) => Err(bad(&level.name, 0)),
            None => Ok(()),
        }
    }

    /// What the series and the levels need.
    pub(super) fn view(&self) -> View {
        let (mut x, mut y) = (None, None);
        for series in &self.series {
            let half = match series.mark {
                Mark::Line | Mark::Dots => 0.0,
                Mark::Bar => 2.0 * HALF_BAR,
            };
            if series.mark == Mark::Bar {
                include(&mut y, 0.0);
            }
            for point in &series.points {
                include(&mut x, point.0 - half);
                include(&mut x, point.0 + half);
                include(&mut y, point.1);
            }
        }
        let room = y.map_or(0.0, |(least, most)| (most - least) * LARGEST_STRETCH);
        let mut levels = Vec::new();
        for level in &self.levels {
            let mut with = y;
            include(&mut with, level.value);
            let fits = with.is_some_and(|(least, most)| most - least <= room);
            if fits {
                y = with;
            }
            levels.push(fits);
        }
        let (least, most) = opened(y);
        let margin = (most - least) * MARGIN;
        View {
            x: opened(x),
            y: (least - margin, most + margin),
            levels,
        }
    }
}

impl View {
    /// The same, or more of the plane, so that a unit is as long to the right as it is upwards in a
    /// picture that is `aspect` times as wide as it is high.
    pub(super) fn scaled(self, aspect: f64) -> Self {
        let (width, height) = (self.x.1 - self.x.0, self.y.1 - self.y.0);
        Self {
            x: widened(self.x, height * aspect),
            y: widened(self.y, width / aspect),
            levels: self.levels,
        }
    }
}

fn include(range: &mut Option<(f64, f64)>, value: f64) {
    let (least, most) = range.unwrap_or((value, value));
    *range = Some((least.min(value), most.max(value)));
}

/// A range of at least this extent around the same middle.
fn widened((least, most): (f64, f64), extent: f64) -> (f64, f64) {
    let more = (0.5 * (extent - (most - least))).max(0.0);
    (least - more, most + more)
}

/// A range that is wide enough to draw: a single value gets some room on both sides.
fn opened(range: Option<(f64, f64)>) -> (f64, f64) {
    let (least, most) = range.unwrap_or((0.0, 1.0));
    // Far less than what the labels could tell apart.
    let narrow = least.abs().max(most.abs()) * 1e-9;
    if most - least > narrow {
        (least, most)
    } else {
        let room = if least == 0.0 { 1.0 } else { least.abs() * 0.1 };
        (least - room, most + room)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(points: &[(f64, f64)]) -> Chart {
        let mut chart = Chart::new("c", Axis::new("t", "s"), Axis::new("y", ""));
        chart.series.push(Series::line("one", points.to_vec()));
        chart
    }

    #[test]
    fn far_levels_do_not_squeeze_the_series() {
        let mut near = chart(&[(0.0, -5.0), (1.0, 5.0)]);
        near.add_limit("limit", 20.0);
        assert_eq!(near.view().levels, [true, true]);
        assert_eq!(near.view().y, (-22.0, 22.0));
        let mut far = chart(&[(0.0, -5.0), (1.0, 5.0)]);
        far.add_limit("limit", 2_000.0);
        assert_eq!(far.view().levels, [false, false]);
        assert_eq!(far.view().y, (-5.5, 5.5));
    }

    #[test]
    fn a_picture_of_things_in_space_is_to_scale() {
        let wide = chart(&[(0.0, 0.0), (8.0, 1.0)]);
        for aspect in [0.5, 2.0, 20.0] {
            let View { x, y, .. } = wide.view().scaled(aspect);
            assert!(x.0 <= 0.0 && 8.0 <= x.1 && y.0 <= 0.0 && 1.0 <= y.1);
            assert!(((x.1 - x.0) / (y.1 - y.0) / aspect - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn series_of_one_name_look_alike() {
        let mut legs = chart(&[(0.0, 0.0)]);
        for name in ["two", "one", "three", "two"] {
            legs.series.push(Series::line(name, vec![(0.0, 1.0)]));
        }
        let looks = legs.series.iter().map(|series| legs.look_of(series));
        assert_eq!(looks.collect::<Vec<_>>(), [0, 1, 0, 2, 1]);
    }

    #[test]
    fn every_view_has_an_extent() {
        for points in [
            &[][..],
            &[(0.0, 0.0)],
            &[(1e9, -3.0)],
            &[(2.0, 7.0), (2.0, 7.0)],
        ] {
            let view = chart(points).view();
            assert!(view.x.0 < view.x.1 && view.y.0 < view.y.1, "{points:?}");
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_named() {
        let error = chart(&[(0.0, 0.0), (1.0, f64::NAN)]).check();
        let message = error.expect_err("a number that is none").to_string();
        assert!(
            message.starts_with("chart `c`, `one`: number 1 "),
            "{message}"
        );
    }
}
