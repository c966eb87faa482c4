//! The s-curve: from state to state in the least time, with a limit of jerk.
//!
//! Up to seven pieces of constant jerk, and up to two more before them where the start is outside
//! the limits. Positions are in any unit, times in seconds, and the rates in that unit per second,
//! per second squared and per second cubed. Positions and rates may be up to [`LARGEST`] in
//! magnitude, limits from [`SMALLEST`] to [`LARGEST`].
//!
//! The problem is that of Kröger's type IV online trajectories with a stop velocity, which Ruckig
//! (Berscheid and Kröger, "Jerk-limited Real-time Trajectory Generation with Arbitrary Target
//! States", RSS 2021) solves with an acceleration at the stop too; the durations here equal
//! Ruckig's. How it is solved here is told in `upward`.
//!
//! | file | what it holds |
//! |---|---|
//! | `bounds` | the limits by sign |
//! | `unit` | motions with the time counted so that the jerk is one |
//! | `brake` | back inside the limits |
//! | `upward` | the family of quickest motions, and which of them gets there |
//! | `cases`, `negative` | the members of that family |
//! | `lobes` | the shape that they have |
//! | `root` | the root of a smooth curve |
//! | `lasting` | a motion that lasts longer, for axes that arrive together |
//! | `to_rest` | a start above the velocity limit comes down to it and no further |
//!
//! [`LARGEST`]: super::bounds::LARGEST
//! [`SMALLEST`]: super::bounds::SMALLEST

mod bounds;
mod brake;
mod cases;
mod lasting;
mod lobes;
mod negative;
mod root;
mod to_rest;
mod unit;
mod upward;

pub use bounds::SignedBounds;
pub use lasting::lasting;
pub use to_rest::to_rest;

use super::bounds::{Bounds, checked_position, checked_rate};
use super::error::{ProfileError, checked};
use super::segments::Segments;
use super::trajectory::Sample;
use brake::brake;
use unit::{Piece, Pieces, Range, State};
use upward::Upward;

/// The quickest motion from a position, velocity and acceleration to a position and velocity,
/// without acceleration there.
///
/// A start outside the limits is first brought back inside: too much acceleration is released, and
/// too much velocity slowed down as hard as the limits allow until it passes its limit.
///
/// # Errors
/// A value that is not a number or too large; a stop velocity outside the limits.
pub fn time_optimal(
    from: Sample,
    to: Sample,
    bounds: &SignedBounds,
) -> Result<Segments, ProfileError> {
    Ok(solved(from, to, bounds)?.join(from, to, bounds.jerk()))
}

/// The pieces of [`time_optimal`].
fn solved(from: Sample, to: Sample, bounds: &SignedBounds) -> Result<Pieces, ProfileError> {
    let state = checked_start(from, to.position, bounds)?;
    let (lowest, highest) = (bounds.velocity_min(), bounds.velocity_max());
    checked("stop velocity", to.velocity, lowest, highest)?;
    let range = Range::new(bounds, from.position, to.position);
    Ok(quickest(state, bounds.jerk() * to.velocity, &range))
}

/// [`time_optimal`] with a person's limits: acceleration for the way towards the target as seen
/// from the start, deceleration against it.
///
/// # Errors
/// As [`time_optimal`], and an infinite jerk limit.
pub fn plan(from: Sample, to: Sample, bounds: &Bounds) -> Result<Segments, ProfileError> {
    time_optimal(from, to, &towards(from, to, bounds)?)
}

/// A person's limits by sign, for the way from one place to another.
fn towards(from: Sample, to: Sample, bounds: &Bounds) -> Result<SignedBounds, ProfileError> {
    if to.position >= from.position {
        SignedBounds::forward(bounds)
    } else {
        SignedBounds::backward(bounds)
    }
}

/// The quickest change of velocity, to no acceleration; where it ends is free, and no limit of
/// velocity counts. A stop is a change to zero.
///
/// # Errors
/// A value that is not a number or too large.
pub fn change_velocity(
    from: Sample,
    velocity: f64,
    bounds: &SignedBounds,
) -> Result<Segments, ProfileError> {
    let state = checked_start(from, from.position, bounds)?;
    checked_rate("stop velocity", velocity)?;
    let mut pieces = Pieces::default();
    let range = Range::new(bounds, from.position, from.position);
    change(state, bounds.jerk() * velocity, &range, &mut pieces);
    Ok(pieces.lead(from, velocity, bounds.jerk()))
}

/// The start in unit-jerk time and seen from the target.
fn checked_start(from: Sample, origin: f64, bounds: &SignedBounds) -> Result<State, ProfileError> {
    checked_position("start", from.position)?;
    checked_position("target", origin)?;
    checked_rate("start velocity", from.velocity)?;
    checked_rate("start acceleration", from.acceleration)?;
    Ok(State::new(from, origin, bounds.jerk()))
}

/// Lays the quickest change of velocity to `v1`, and gives the state after it.
fn change(state: State, v1: f64, range: &Range, pieces: &mut Pieces) -> State {
    let inside = release(state, range, pieces);
    let up = Upward::new(inside, v1, 0.0, range);
    let mut rest = Pieces::default();
    up.direct().lay(inside.acceleration, 1.0, &mut rest);
    for piece in rest.as_slice() {
        pieces.push(*piece);
    }
    State {
        velocity: v1,
        acceleration: 0.0,
        ..rest.carry(inside)
    }
}

/// Lays what brings the acceleration back inside its limits, and gives the state after it.
fn release(state: State, range: &Range, pieces: &mut Pieces) -> State {
    let limit = state.acceleration.min(range.rise).max(-range.fall);
    let over = state.acceleration - limit;
    let piece = Piece::new(over.abs(), -over.signum(), state.acceleration);
    pieces.push(piece);
    State {
        acceleration: limit,
        ..state.after(piece)
    }
}

/// Which way a target lies from where the quickest change of velocity ends.
enum Side {
    /// It is just there.
    There(Upward),
    /// Above, or below and seen upside down.
    Above(Upward, f64),
}

/// How much of a number may be rounding, in relation to what it was made of.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// `state`, which must be inside the limits, is to get to position zero with velocity `v1`.
///
/// A target that is where the direct change ends but for rounding counts as there: the smallest
/// distance less than that may ask for a whole loop.
fn side(state: State, v1: f64, range: &Range) -> Side {
    let up = Upward::new(state, v1, -state.position, range);
    let direct = up.direct_reach();
    let more = up.reach - direct.reach;
    if more.abs() <= direct.noise + ROUNDING * range.farthest {
        Side::There(up)
    } else if more > 0.0 {
        Side::Above(up, 1.0)
    } else {
        let state = state.mirrored();
        let up = Upward::new(state, -v1, -state.position, &range.mirrored());
        Side::Above(up, -1.0)
    }
}

/// The quickest motion from `state` to position zero with velocity `v1`.
fn quickest(state: State, v1: f64, range: &Range) -> Pieces {
    let mut pieces = Pieces::default();
    let inside = brake(state, range, &mut pieces);
    if !pieces.as_slice().is_empty() {
        // A direct change of velocity that happens to end there needs no way back inside.
        let mut direct = Pieces::default();
        let end = change(state, v1, range, &mut direct);
        if end.position.abs() <= ROUNDING * (state.position.abs() + range.farthest) {
            return direct;
        }
    }
    match side(inside, v1, range) {
        Side::There(up) => up.direct().lay(up.a0, 1.0, &mut pieces),
        Side::Above(up, sign) => up.quickest().lay(up.a0, sign, &mut pieces),
    }
    pieces
}
