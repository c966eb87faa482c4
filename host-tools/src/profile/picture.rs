//! Moves as SVG: position, velocity, acceleration and jerk under each other, with the limits.

use super::curve::Curve;
use super::error::PlanError;
use super::request::AskedLimits;
use crate::plot::{Axis, Chart, Level, Series, stack};
use canter_shared::motion::trajectory::{Sample, Trajectory};

/// Points of a curve in a picture: more than one for each pixel.
const POINTS: u32 = 800;

/// Units of position, velocity, acceleration and jerk.
pub type Units = [&'static str; 4];

/// Where the units are the caller's own.
pub const OWN_UNITS: Units = ["units", "units/s", "units/s²", "units/s³"];

/// Four charts over one time axis.
#[derive(Debug, Clone)]
pub struct Picture {
    position: Chart,
    velocity: Chart,
    acceleration: Chart,
    jerk: Chart,
    below: Vec<Chart>,
}

impl Picture {
    /// Charts of nothing yet, under a title.
    pub fn new(title: &str, units: Units) -> Self {
        let chart = |name: &str, unit| {
            let time = Axis::new("time", "s");
            Chart::new(format!("{title}: {name}"), time, Axis::new(name, unit))
        };
        let [position, velocity, acceleration, jerk] = units;
        Self {
            position: chart("position", position),
            velocity: chart("velocity", velocity),
            acceleration: chart("acceleration", acceleration),
            jerk: chart("jerk", jerk),
            below: Vec::new(),
        }
    }

    /// Adds a move, as samples at times.
    pub fn add(&mut self, name: &str, samples: &[(f64, Sample)]) {
        let put = |chart: &mut Chart, value: fn(&Sample) -> f64| {
            let points = samples.iter().map(|(time, sample)| (*time, value(sample)));
            chart.series.push(Series::line(name, points.collect()));
        };
        put(&mut self.position, |sample| sample.position);
        put(&mut self.velocity, |sample| sample.velocity);
        put(&mut self.acceleration, |sample| sample.acceleration);
        put(&mut self.jerk, |sample| sample.jerk);
    }

    /// Says that the acceleration steps, where no chart can show the jerk.
    pub fn say_that_it_steps(&mut self) {
        self.jerk
            .title
            .push_str(" (infinite where the acceleration steps)");
    }

    /// Draws the limits in; `forward` is the direction of the move, in which acceleration is what
    /// speeds it up.
    pub fn limit(&mut self, limits: &AskedLimits, forward: bool) {
        if let Some(velocity) = limits.velocity {
            self.velocity.add_limit("limit", velocity);
        }
        if let Some(jerk) = limits.jerk {
            self.jerk.add_limit("limit", jerk);
        }
        let sign = if forward { 1.0 } else { -1.0 };
        for value in [
            limits.acceleration.map(|limit| sign * limit),
            limits.meant_deceleration().map(|limit| -sign * limit),
        ]
        .into_iter()
        .flatten()
        {
            let name = "limit".to_owned();
            self.acceleration.levels.push(Level { name, value });
        }
    }

    /// Puts another chart below the four.
    pub fn put_below(&mut self, chart: Chart) {
        self.below.push(chart);
    }

    /// The document.
    ///
    /// # Errors
    /// A number that has no place in a picture.
    pub fn svg(self) -> Result<String, PlanError> {
        let mut charts = vec![self.position, self.velocity, self.acceleration, self.jerk];
        charts.extend(self.below);
        Ok(stack(&charts)?)
    }
}

/// A curve at times close enough to draw it, counted from `start`, with what is before and after it;
/// where it is made of pieces, both sides of each step are there.
pub fn samples(curve: &Curve, start: f64) -> Vec<(f64, Sample)> {
    let pieces = match curve {
        Curve::Pieces(segments) if !segments.segments().is_empty() => segments.segments(),
        _ => return evenly(curve, start),
    };
    let each = POINTS / 8;
    let mut samples = Vec::new();
    for piece in pieces {
        for point in 0..=each {
            let elapsed = piece.duration * f64::from(point) / f64::from(each);
            samples.push((start + piece.start + elapsed, piece.entry.after(elapsed)));
        }
    }
    between_coasts(samples)
}

/// Any trajectory at even times, counted from `start`, with what is before and after it.
pub fn evenly<T: Trajectory>(trajectory: &T, start: f64) -> Vec<(f64, Sample)> {
    let duration = trajectory.duration();
    let times = (0..=POINTS).map(|point| duration * f64::from(point) / f64::from(POINTS));
    let samples = times.map(|time| (start + time, trajectory.at(time)));
    between_coasts(samples.collect())
}

/// Samples between those of the constant velocity before and after them, so that a step at an end
/// is seen as one.
fn between_coasts(samples: Vec<(f64, Sample)>) -> Vec<(f64, Sample)> {
    let coasting = |(time, sample): &(f64, Sample)| {
        (*time, Sample::coasting(sample.position, sample.velocity))
    };
    let before = samples.first().map(coasting);
    let after = samples.last().map(coasting);
    before.into_iter().chain(samples).chain(after).collect()
}
