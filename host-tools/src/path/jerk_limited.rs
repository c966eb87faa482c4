//! A timing that keeps jerks too: one S-curve of seven pieces along the whole path.
//!
//! The S-curve's own limits are those of the parameter. With each choice of them, how much the axes
//! break their limits is measured, and from rest to rest the curve is slowed down by just as much: a
//! motion that takes k times as long has velocities of 1/k, accelerations of 1/k^2 and jerks of
//! 1/k^3. Of some choices the quickest is taken. It is sound and simple; it does not brake for one
//! corner alone.

use super::error::PathError;
use super::peak::Peak;
use super::shape::{Point, pace};
use super::two_pass::{NOISE, Task};
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::s_curve;
use canter_shared::motion::segments::Segments;
use canter_shared::motion::trajectory::{Sample, Trajectory};

/// Points of a curve while choices are compared.
const ROUGH: usize = 300;
/// Points of the curve that is taken.
const FINE: usize = 8000;
/// The fewest points between two places where it is not smooth.
const EACH: usize = 4;
/// Shares of the parameter's velocity and acceleration that are tried, relative to what suits the
/// path where it is hardest.
const SHARES: [f64; 5] = [4.0, 2.0, 1.0, 0.5, 0.25];
/// What rounding may add.
const ROUNDING: f64 = 1e-9;

/// The quickest S-curve of the parameter that was found.
pub fn solve(task: &Task<'_>) -> Result<Segments, PathError> {
    let hardest = hardest(task);
    let mut best: Option<(f64, [f64; 3])> = None;
    for velocity in SHARES {
        for acceleration in SHARES {
            let [v, a, j] = hardest;
            let choice = [v * velocity, a * acceleration, j];
            let Some((curve, limits)) = slowed(task, choice, ROUGH) else {
                continue;
            };
            if best.is_none_or(|(duration, _)| curve.duration() < duration) {
                best = Some((curve.duration(), limits));
            }
        }
    }
    let (_, limits) = best.ok_or(PathError::NoTiming)?;
    // More where there are many waypoints.
    let points = FINE.max(20 * task.shape.knots().len());
    let (curve, _) = slowed(task, limits, points).ok_or(PathError::NoTiming)?;
    Ok(curve)
}

/// Velocity, acceleration and jerk of the parameter that suit the path where each is hardest.
fn hardest(task: &Task<'_>) -> [f64; 3] {
    let mut least = [f64::INFINITY; 3];
    for index in 0..=ROUGH {
        let parameter = task.shape.length() * index as f64 / ROUGH as f64;
        for (point, bounds) in task.shape.at(parameter).iter().zip(task.axes) {
            let limits = [bounds.velocity, bounds.acceleration, bounds.jerk];
            for (least, limit) in least.iter_mut().zip(limits) {
                if point.first != 0.0 {
                    *least = least.min(limit / point.first.abs());
                }
            }
        }
    }
    least
}

/// The S-curve with these limits, slowed down until the axes keep theirs; and the limits it has then.
fn slowed(task: &Task<'_>, limits: [f64; 3], points: usize) -> Option<(Segments, [f64; 3])> {
    let mut slower = 1.0;
    for _ in 0..60 {
        let [v, a, j] = limits;
        let limits = [v / slower, a / slower.powi(2), j / slower.powi(3)];
        let curve = curve(task, limits)?;
        let needed = needed(task, &curve, points);
        if needed <= 1.0 + NOISE {
            return Some((curve, limits));
        }
        // With an end in motion a slower curve is not the same one, stretched.
        slower *= needed * (1.0 + ROUNDING);
    }
    None
}

fn curve(task: &Task<'_>, [v, a, j]: [f64; 3]) -> Option<Segments> {
    let length = task.shape.length();
    let rate = |speed: f64, parameter: f64| match speed {
        0.0 => 0.0,
        speed => speed / pace(&task.shape.at(parameter)),
    };
    let bounds = Bounds::new(v, a, a, j).ok()?;
    let from = Sample::coasting(0.0, rate(task.start_speed, 0.0));
    let to = Sample::coasting(length, rate(task.end_speed, length));
    // What is faster than the limit at the start would first have to slow down.
    if from.velocity > v * (1.0 + ROUNDING) {
        return None;
    }
    s_curve::plan(from, to, &bounds).ok()
}

/// How many times as long a curve must last.
fn needed(task: &Task<'_>, curve: &Segments, points: usize) -> f64 {
    let knots = passing(task, curve);
    // Between these all is smooth.
    let mut breaks: Vec<f64> = curve.segments().iter().map(|piece| piece.start).collect();
    breaks.extend(&knots);
    breaks.push(curve.duration());
    breaks.sort_by(f64::total_cmp);
    let each = (points / breaks.len()).max(EACH);
    let mut peaks = vec![[Peak::default(); 3]; task.axes.len() + 1];
    for pair in breaks.windows(2) {
        let (from, length) = (pair[0], pair[1] - pair[0]);
        if length <= 0.0 {
            continue;
        }
        let middle = curve.at(from + length / 2.0);
        let segment = task.shape.segment(middle.position);
        peaks.iter_mut().flatten().for_each(Peak::restart);
        for place in 0..=each {
            // A little inside: at the very ends the jerk may be that of the neighbour.
            let share = (place as f64 / each as f64).clamp(1e-9, 1.0 - 1e-9);
            let sample = curve.at(from + length * share);
            let seen = task.shape.within(segment, sample.position);
            measure(task, &seen, &sample, &mut peaks);
        }
    }
    let mut over = 0.0_f64;
    for (waypoint, speed) in task.speeds.iter().enumerate() {
        if let Some(speed) = speed {
            let sample = curve.at(knots[waypoint]);
            over = over.max(pace(&task.shape.at(sample.position)) * sample.velocity / speed);
        }
    }
    for [v, a, j] in &peaks {
        let needed = v.most().max(a.most().sqrt()).max(j.most().cbrt());
        over = over.max(needed);
    }
    over
}

/// When the curve passes each waypoint.
fn passing(task: &Task<'_>, curve: &Segments) -> Vec<f64> {
    let mut since = 0.0;
    let times = task.shape.knots().iter().map(|knot| {
        let (mut early, mut late) = (since, curve.duration());
        for _ in 0..60 {
            let middle = (early + late) / 2.0;
            if curve.at(middle).position < *knot {
                early = middle;
            } else {
                late = middle;
            }
        }
        since = early;
        early
    });
    times.collect()
}

/// By how much velocity, acceleration and jerk exceed their limits at one place.
fn measure(task: &Task<'_>, seen: &[Point], sample: &Sample, peaks: &mut [[Peak; 3]]) {
    let (mut speed, mut change, mut turn) = (0.0, 0.0, 0.0);
    for ((point, bounds), peaks) in seen.iter().zip(task.axes).zip(&mut *peaks) {
        let [v, a, j] = point.rates(sample);
        speed += v * v;
        change += v * a;
        turn += j * j;
        peaks[0].push(v.abs() / bounds.velocity);
        peaks[1].push(a.abs() / bounds.acceleration);
        peaks[2].push(j.abs() / bounds.jerk);
    }
    let speed = f64::sqrt(speed);
    let along = &mut peaks[seen.len()];
    if let Some(limit) = task.path.velocity {
        along[0].push(speed / limit);
    }
    let limit = if change >= 0.0 {
        task.path.acceleration
    } else {
        task.path.meant_deceleration()
    };
    if let Some(limit) = limit.filter(|_| speed > 0.0) {
        along[1].push(f64::abs(change) / speed / limit);
    }
    if let Some(limit) = task.path.jerk {
        along[2].push(f64::sqrt(turn) / limit);
    }
}
