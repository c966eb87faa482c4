//! A walk as charts: the feet from the side, the axes over time, and stick figures.

use super::course::Course;
use super::error::GaitError;
use super::pattern::LEG_NAMES;
use super::planner::State;
use crate::plot::{Axis, Chart, Series, stack};

/// Points of a curve at most.
const POINTS: usize = 1_000;

/// Figures in the strip.
const FIGURES: usize = 6;

/// From figure to figure: so many times the length of the body.
const SPACING: f64 = 1.8;

/// What is drawn of the joint of a leg.
type ValueOf = fn(&State, usize, usize) -> f64;

/// The picture of a walk, as an SVG document.
///
/// # Errors
/// A foot that its leg does not reach; a number that has no place in a picture.
pub fn svg(course: &Course, title: &str) -> Result<String, GaitError> {
    let rows = course.rows()?.count();
    let every = rows.div_ceil(POINTS).max(1);
    let mut states = Vec::new();
    for (index, state) in course.rows()?.enumerate() {
        let state = state?;
        if index.is_multiple_of(every) || index + 1 == rows {
            states.push(state);
        }
    }
    let chart = |what: &str, x: Axis, y: Axis| Chart::new(format!("{title}: {what}"), x, y);
    let time = || Axis::new("time", "s");
    let mut paths = chart(
        "feet as the hips see them",
        Axis::new("forward", "mm"),
        Axis::new("up", "mm"),
    );
    let mut heights = chart("feet above the ground", time(), Axis::new("height", "mm"));
    for (leg, name) in LEG_NAMES.into_iter().enumerate() {
        let path = states.iter().map(|state| {
            let [x, _, z] = state.feet[leg].position;
            (1e3 * x, 1e3 * z)
        });
        paths.series.push(Series::line(name, path.collect()));
        let height = states
            .iter()
            .map(|state| (state.time, 1e3 * state.places[leg][2]));
        heights.series.push(Series::line(name, height.collect()));
    }
    let mut charts = vec![paths, heights];
    let orders: [(&str, &str, ValueOf); 3] = [
        ("position", "rad", |state, leg, joint| {
            state.joints[leg].position[joint]
        }),
        ("velocity", "rad/s", |state, leg, joint| {
            state.joints[leg].velocity[joint]
        }),
        ("acceleration", "rad/s²", |state, leg, joint| {
            state.joints[leg].acceleration[joint]
        }),
    ];
    for (name, unit, value) in orders {
        let mut axes = chart(&format!("axes' {name}"), time(), Axis::new(name, unit));
        for (leg, mount) in course.quadruped().mounts.iter().enumerate() {
            for (joint, axis) in mount.leg.axes.iter().enumerate() {
                let points = states
                    .iter()
                    .map(|state| (state.time, value(state, leg, joint)));
                axes.series.push(Series::line(
                    format!("axis {}", axis.get()),
                    points.collect(),
                ));
            }
        }
        charts.push(axes);
    }
    charts.push(strip(course, &states, title)?);
    Ok(stack(&charts)?)
}

/// The legs from the side at even times. One line goes through a leg down to its foot and back up,
/// and on to the same leg of the next figure.
fn strip(course: &Course, states: &[State], title: &str) -> Result<Chart, GaitError> {
    let words =
        format!("{title}: {FIGURES} moments of the walk, one beside the other, not to scale");
    let mut chart = Chart::new(words, Axis::new("forward", "mm"), Axis::new("up", "mm"));
    let mounts = &course.quadruped().mounts;
    let places = mounts.each_ref().map(|mount| mount.leg.place[0]);
    let length = places.into_iter().fold(0.0, f64::max) - places.into_iter().fold(0.0, f64::min);
    for (leg, (mount, name)) in mounts.iter().zip(LEG_NAMES).enumerate() {
        let mut points = Vec::new();
        for figure in 0..FIGURES {
            let last = states.len().saturating_sub(1);
            let Some(state) = states.get(last * figure / (FIGURES - 1)) else {
                continue;
            };
            let limb = mount
                .limb(state.joints[leg].position)
                .map_err(|cause| GaitError::Leg {
                    leg: name,
                    time: state.time,
                    cause,
                })?;
            let ahead = SPACING * length * figure as f64;
            let down = limb.iter().map(|[x, _, z]| (1e3 * (x + ahead), 1e3 * z));
            points.extend(down.clone());
            points.extend(down.rev());
        }
        chart.series.push(Series::line(name, points));
    }
    Ok(chart)
}
