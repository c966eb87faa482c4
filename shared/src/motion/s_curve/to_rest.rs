//! To rest at a target, and down to the velocity limit without passing it.

use super::brake::brake;
use super::lobes::{Lobes, Triangle, change_peak, change_time};
use super::root::{CORNERED, Curve, root};
use super::unit::{Piece, Pieces, Range, State};
use super::upward::Upward;
use super::{Side, SignedBounds, change, checked_start, quickest, release, side};
use crate::motion::error::ProfileError;
use crate::motion::segments::Segments;
use crate::motion::trajectory::Sample;

/// To rest at `target`, without a dip of the velocity.
///
/// A start that is above the velocity limit, or would be once its acceleration is released, comes
/// down to the limit in one change of velocity and stays there until it must stop for the target.
/// [`super::time_optimal`] passes the limit with all its deceleration, goes below it and comes up
/// again, as Ruckig does, and is a little slower. Where the target is too near to get to the
/// limit, the velocity comes down in two steps or in one, and never rises. From all other starts,
/// and where the target has been missed already, the motion is that of `time_optimal`.
///
/// # Errors
/// A value that is not a number or too large.
pub fn to_rest(from: Sample, target: f64, bounds: &SignedBounds) -> Result<Segments, ProfileError> {
    let pieces = solved(from, target, bounds)?;
    Ok(pieces.join(from, Sample::at_rest(target), bounds.jerk()))
}

/// The pieces of [`to_rest`].
pub(super) fn solved(
    from: Sample,
    target: f64,
    bounds: &SignedBounds,
) -> Result<Pieces, ProfileError> {
    let start = checked_start(from, target, bounds)?;
    let range = Range::new(bounds, from.position, target);
    Ok(without_dip(start, 1.0, &range)
        .or_else(|| without_dip(start.mirrored(), -1.0, &range.mirrored()))
        .unwrap_or_else(|| quickest(start, 0.0, &range)))
}

/// The way down to the limit, for a start that is above it and where `brake` would make a dip.
fn without_dip(start: State, sign: f64, range: &Range) -> Option<Pieces> {
    let State {
        velocity,
        acceleration,
        ..
    } = start;
    let rising = acceleration.max(0.0);
    if velocity <= range.highest && velocity + rising * rising / 2.0 <= range.highest {
        return None;
    }
    let mut pieces = Pieces::default();
    let limited = change(start, range.highest, range, &mut pieces);
    let stop_time = change_time(range.highest, range.fall);
    let spare = -limited.position - range.highest / 2.0 * stop_time;
    if spare >= 0.0 {
        let cruise = spare / range.highest;
        pieces.push(Piece::cruise(cruise, range.highest));
        stop(range.highest, range, &mut pieces);
        return Some(pieces.signed(sign));
    }
    // Too near for that. A brake that has no dip is the quickest.
    let mut braked = Pieces::default();
    let inside = brake(start, range, &mut braked);
    match side(inside, 0.0, range) {
        Side::Above(up, side) if side > 0.0 && up.quickest().peak > 0.0 => {}
        _ => return None,
    }
    let mut pieces = Pieces::default();
    let inside = release(start, range, &mut pieces);
    let up = Upward::new(inside, 0.0, -inside.position, range);
    let velocity = two_steps(&up)?;
    change(inside, velocity, range, &mut pieces);
    stop(velocity, range, &mut pieces);
    Some(pieces.signed(sign))
}

/// The velocity between two steps down, the second of them to rest at the target.
fn two_steps(up: &Upward) -> Option<f64> {
    let range = up.range;
    let curve = |velocity: f64| {
        let first = up.towards(velocity).direct_reach();
        let stop = Triangle::new(velocity, range.fall);
        Curve {
            value: first.reach + stop.area - up.reach,
            slope: first.slope + stop.slope,
            curvature: 0.0,
        }
    };
    (curve(0.0).value <= 0.0 && curve(range.highest).value >= 0.0)
        .then(|| root(0.0, range.highest, range.highest / 2.0, CORNERED, curve))
}

/// Lays a stop from `velocity`, without acceleration.
fn stop(velocity: f64, range: &Range, pieces: &mut Pieces) {
    let (trough, trough_hold) = change_peak(velocity, range.fall);
    let stop = Lobes {
        trough,
        trough_hold,
        ..Lobes::default()
    };
    stop.lay(0.0, 1.0, pieces);
}
