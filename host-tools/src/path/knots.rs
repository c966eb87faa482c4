//! A path as knots for a stream: positions and velocities at whole periods.
//!
//! An axis joins knots by cubics and refuses one whose cubic breaks a limit. A cubic between two
//! places of a path is not the path: where the acceleration steps, it has more at its ends. So the
//! cubics are looked at here first, with room for what the wire rounds off, and the whole path is
//! slowed down until they fit.

use super::bounds::AxisBounds;
use super::error::PathError;
use super::timed::TimedPath;
use crate::client::StreamKnot;
use crate::profile::table::MOST_ROWS;
use canter_shared::units::Position;
use canter_shared::wire::id::AxisId;
use canter_shared::wire::layout::POSITION_STEP;

/// Knots that a path may be sent as: ten hours at a knot every 20 ms.
const MOST_KNOTS: usize = MOST_ROWS / 5;
/// How often it is slowed down.
const ROUNDS: usize = 60;
/// The share of a limit that may be used at most.
const USABLE: f64 = 0.999;

/// The knots of a path that rests at both ends, a period after the start and so on, and how long
/// the path then lasts: a whole number of periods.
///
/// # Errors
/// More knots than anybody sends; limits that no cubics keep.
pub fn knots(
    path: &TimedPath,
    axes: &[AxisId],
    bounds: &[AxisBounds],
    period: f64,
) -> Result<(Vec<Vec<StreamKnot>>, f64), PathError> {
    let mut duration = path.duration();
    let mut worst = 0;
    for _ in 0..ROUNDS {
        let count = (duration / period - 1e-9).ceil().max(1.0);
        if count > MOST_KNOTS as f64 {
            return Err(PathError::TooManyRows {
                step: period,
                duration,
                rows: count,
                most: MOST_KNOTS,
            });
        }
        duration = count * period;
        let slower = path.clone().stretched(duration);
        let count = count as usize;
        let all: Vec<Vec<StreamKnot>> = (0..=count)
            .map(|index| at(&slower, index, count, period))
            .collect();
        let (over, axis) = over(&all, bounds, period);
        if over <= 1.0 {
            return Ok((all.into_iter().skip(1).collect(), duration));
        }
        worst = axis;
        duration = (duration * over.min(2.0)).max(duration + period);
    }
    let axis = axes.get(worst).map_or(0, |axis| axis.get());
    Err(PathError::NoKnots { axis, period })
}

fn at(path: &TimedPath, index: usize, count: usize, period: f64) -> Vec<StreamKnot> {
    let is_end = index == 0 || index == count;
    let samples = path.at(if index == count {
        path.duration()
    } else {
        index as f64 * period
    });
    let knots = samples.iter().map(|sample| StreamKnot {
        position: sample.position,
        velocity: if is_end { 0.0 } else { sample.velocity },
    });
    knots.collect()
}

/// The greatest velocity and acceleration of something, in rad/s and rad/s^2.
pub(crate) struct Rates {
    pub(crate) velocity: f64,
    pub(crate) acceleration: f64,
}

/// What the cubic between two knots comes to.
pub(crate) fn cubic_peaks(from: &StreamKnot, to: &StreamKnot, period: f64) -> Rates {
    let mean = (to.position - from.position) / period;
    let start = (6.0 * mean - 4.0 * from.velocity - 2.0 * to.velocity) / period;
    let end = (-6.0 * mean + 2.0 * from.velocity + 4.0 * to.velocity) / period;
    let mut velocity = from.velocity.abs().max(to.velocity.abs());
    if start * end < 0.0 {
        let turn = start / (start - end);
        let there = from.velocity + period * turn * (start + turn * (end - start) / 2.0);
        velocity = velocity.max(there.abs());
    }
    let acceleration = start.abs().max(end.abs());
    Rates {
        velocity,
        acceleration,
    }
}

/// What cubics may come to, with room for what the wire rounds off.
pub(crate) fn usable(bounds: &AxisBounds, period: f64) -> Rates {
    // Two positions, each off by a step, as the stream's own documentation counts it.
    let step = 2.0 * Position::from_counts(POSITION_STEP.counts()).radians();
    let velocity_room = step * 15.0 / 8.0 / period;
    let acceleration_room = step * 10.0 / 3.0_f64.sqrt() / period.powi(2);
    let usable = |limit: f64, room: f64| (limit * USABLE - room).max(limit / 2.0);
    Rates {
        velocity: usable(bounds.velocity, velocity_room),
        acceleration: usable(bounds.acceleration, acceleration_room),
    }
}

/// By how much the cubics break limits at most, as a factor of time, and which axis's.
fn over(knots: &[Vec<StreamKnot>], bounds: &[AxisBounds], period: f64) -> (f64, usize) {
    let usable: Vec<Rates> = bounds.iter().map(|one| usable(one, period)).collect();
    let mut worst = (0.0, 0);
    for pair in knots.windows(2) {
        for (axis, ((from, to), usable)) in pair[0].iter().zip(&pair[1]).zip(&usable).enumerate() {
            let peaks = cubic_peaks(from, to, period);
            let over = (peaks.velocity / usable.velocity)
                .max((peaks.acceleration / usable.acceleration).sqrt());
            if over > worst.0 {
                worst = (over, axis);
            }
        }
    }
    worst
}
