//! A walk as charts: the feet from the side, the axes over time, and stick figures.

use super::course::Course;
use super::error::GaitError;
use super::pattern::LEG_NAMES;
use super::planner::State;
use crate::plot::{Axis, Chart, Series, stack};

/// Points of a curve at most.
const POINTS: usize = 1_000;

/// Figures in the strip, and how many of them side by side.
const FIGURES: usize = 8;
const IN_A_ROW: usize = 4;

/// From figure to figure: so many times the length of the body.
const SPACING: f64 = 1.8;

/// From row to row: so many times the height of the hips.
const ROW_SPACING: f64 = 1.4;

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

/// Legs, bodies and ground from the side, at even parts of a cycle in the middle of the walk, as one
/// reads: to the right, then the next row.
fn strip(course: &Course, states: &[State], title: &str) -> Result<Chart, GaitError> {
    let words = format!("{title}: {FIGURES} moments of a cycle from the right, to scale");
    let mut chart = Chart::new(words, Axis::new("forward", "mm"), Axis::new("up", "mm"));
    chart.to_scale = true;
    let mounts = &course.quadruped().mounts;
    let hips = mounts.each_ref().map(|mount| mount.leg.place);
    let farthest = hips.iter().map(|hip| hip[0].abs()).fold(0.0, f64::max);
    let moments = moments(course, states);
    let highest = moments.iter().flat_map(|state| &state.feet);
    let highest = highest.map(|foot| -foot.position[2]).fold(0.0, f64::max);
    for (figure, state) in moments.into_iter().enumerate() {
        let right = SPACING * 2.0 * farthest * (figure % IN_A_ROW) as f64;
        let down = ROW_SPACING * highest * (figure / IN_A_ROW) as f64;
        let line = |points: &mut dyn Iterator<Item = [f64; 3]>| {
            let points = points.map(|[x, _, z]| (1e3 * (x + right), 1e3 * (z - down)));
            points.collect::<Vec<_>>()
        };
        for (leg, (mount, name)) in mounts.iter().zip(LEG_NAMES).enumerate() {
            let limb = mount
                .limb(state.joints[leg].position)
                .map_err(|cause| GaitError::Leg {
                    leg: name,
                    time: state.time,
                    cause,
                })?;
            let points = line(&mut limb.into_iter());
            chart.series.push(Series::line(name, points));
        }
        let body = line(&mut hips.into_iter());
        chart.series.push(Series::line("body", body));
        // The lowest foot is where the ground is.
        let lowest = mounts.iter().zip(&state.feet);
        let lowest = lowest.map(|(mount, foot)| mount.leg.place[2] + foot.position[2]);
        let lowest = lowest.fold(f64::INFINITY, f64::min);
        let side = 0.5 * SPACING * 2.0 * farthest;
        let ground = line(&mut [[-side, 0.0, lowest], [side, 0.0, lowest]].into_iter());
        chart.series.push(Series::line("ground", ground));
    }
    Ok(chart)
}

/// A cycle in the middle of the walk, at even parts of it; of a robot that stands, its first moment.
fn moments<'a>(course: &Course, states: &'a [State]) -> Vec<&'a State> {
    let Some(period) = course.period() else {
        return states.first().into_iter().collect();
    };
    let last = states.last().map_or(0.0, |state| state.time);
    let begin = 0.5 * (last - period).max(0.0);
    (0..FIGURES)
        .filter_map(|figure| {
            let time = begin + period * figure as f64 / FIGURES as f64;
            let after = states.partition_point(|state| state.time < time);
            states.get(after).or(states.last())
        })
        .collect()
}
