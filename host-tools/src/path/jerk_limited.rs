//! A timing that keeps jerks too: one S-curve of seven pieces along the whole path.
//!
//! The S-curve's own limits are those of the parameter. With each choice of them, how much the axes
//! break their limits is measured, and from rest to rest the curve is slowed down by just as much: a
//! motion that takes k times as long has velocities of 1/k, accelerations of 1/k^2 and jerks of
//! 1/k^3. Of some choices the quickest is taken. It is sound and simple; it does not brake for one
//! corner alone.

use super::error::PathError;
use super::shape::Point;
use super::two_pass::Task;
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::s_curve;
use canter_shared::motion::segments::Segments;
use canter_shared::motion::trajectory::{Sample, Trajectory};

/// Points of a curve while choices are compared.
const ROUGH: usize = 300;
/// Points of the curve that is taken.
const FINE: usize = 8000;
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
    let (curve, _) = slowed(task, limits, FINE).ok_or(PathError::NoTiming)?;
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
        if needed <= 1.0 {
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

fn pace(points: &[Point]) -> f64 {
    points.iter().map(|p| p.first * p.first).sum::<f64>().sqrt()
}

/// How many times as long a curve must last.
fn needed(task: &Task<'_>, curve: &Segments, points: usize) -> f64 {
    let mut over = [0.0_f64; 3];
    let duration = curve.duration();
    let mut waypoint = 0;
    let even = (0..=points).map(|index| (duration * index as f64 / points as f64, 0.0));
    // Jerk steps at the ends of the pieces, and so it is greatest there.
    let corners = curve.segments().iter().flat_map(|piece| {
        let inside = piece.duration * 1e-9;
        [piece.start + inside, piece.start + piece.duration - inside].map(|time| (time, 1.0))
    });
    for (time, corner) in even.chain(corners) {
        let sample = curve.at(time);
        let seen = task.shape.at(sample.position);
        let mut speed = 0.0;
        let (mut change, mut turn) = (0.0, 0.0);
        for (point, bounds) in seen.iter().zip(task.axes) {
            let [v, a, j] = rates(point, &sample);
            speed += v * v;
            change += v * a;
            turn += j * j;
            over[0] = over[0].max(v.abs() / bounds.velocity);
            over[1] = over[1].max(a.abs() / bounds.acceleration);
            over[2] = over[2].max(j.abs() / bounds.jerk);
        }
        let speed = f64::sqrt(speed);
        if let Some(limit) = task.path.velocity {
            over[0] = over[0].max(speed / limit);
        }
        let limit = if change >= 0.0 {
            task.path.acceleration
        } else {
            task.path.meant_deceleration()
        };
        if let Some(limit) = limit.filter(|_| speed > 0.0) {
            over[1] = over[1].max(change.abs() / speed / limit);
        }
        if let Some(limit) = task.path.jerk {
            over[2] = over[2].max(f64::sqrt(turn) / limit);
        }
        // In the order of time only: the speed over each waypoint that has been passed.
        while corner == 0.0
            && let Some(knot) = task.shape.knots().get(waypoint)
            && *knot <= sample.position
        {
            if let Some(Some(limit)) = task.speeds.get(waypoint) {
                let rate = pace(&task.shape.at(*knot)) * sample.velocity;
                over[0] = over[0].max(rate / limit);
            }
            waypoint += 1;
        }
    }
    let [v, a, j] = over;
    v.max(a.sqrt()).max(j.cbrt())
}

/// Velocity, acceleration and jerk of an axis.
pub fn rates(point: &Point, sample: &Sample) -> [f64; 3] {
    let Sample {
        velocity,
        acceleration,
        jerk,
        ..
    } = sample;
    [
        point.first * velocity,
        point.second * velocity * velocity + point.first * acceleration,
        point.third * velocity.powi(3)
            + 3.0 * point.second * velocity * acceleration
            + point.first * jerk,
    ]
}
