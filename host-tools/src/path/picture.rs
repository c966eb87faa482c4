//! A path as SVG: positions over time, and rates as shares of each axis's limits.

use super::bounds::AxisBounds;
use super::error::PathError;
use super::timed::{TimedPath, Timing};
use crate::plot::{Axis, Chart, Series, stack};
use canter_shared::motion::trajectory::Sample;
use canter_shared::wire::id::AxisId;

/// Points of a curve in a picture: more than one for each pixel.
const POINTS: u32 = 1000;

/// Draws a path.
///
/// # Errors
/// A number that has no place in a picture.
pub fn svg(
    path: &TimedPath,
    axes: &[AxisId],
    bounds: &[AxisBounds],
    timing: Timing,
) -> Result<String, PathError> {
    let duration = path.duration();
    let rows: Vec<(f64, Vec<Sample>)> = (0..=POINTS)
        .map(|point| {
            let time = duration * f64::from(point) / f64::from(POINTS);
            (time, path.at(time))
        })
        .collect();
    let chart = |name: &str, unit: &str, value: fn(&Sample, &AxisBounds) -> f64| {
        let title = format!("path: {name}");
        let mut chart = Chart::new(title, Axis::new("time", "s"), Axis::new(name, unit));
        for (index, (axis, bounds)) in axes.iter().zip(bounds).enumerate() {
            let points = rows
                .iter()
                .map(|(time, row)| (*time, value(&row[index], bounds)));
            let name = format!("axis {axis}");
            chart.series.push(Series::line(name, points.collect()));
        }
        chart
    };
    let share = |name: &str, value: fn(&Sample, &AxisBounds) -> f64| {
        let mut chart = chart(name, "share of its limit", value);
        chart.add_limit("limit", 1.0);
        chart
    };
    let mut charts = vec![
        chart("position", "rad", |sample, _| sample.position),
        share("velocity", |sample, bounds| {
            sample.velocity / bounds.velocity
        }),
        share("acceleration", |sample, bounds| {
            sample.acceleration / bounds.acceleration
        }),
    ];
    if timing == Timing::SCurve {
        charts.push(share("jerk", |sample, bounds| sample.jerk / bounds.jerk));
    }
    Ok(stack(&charts)?)
}
