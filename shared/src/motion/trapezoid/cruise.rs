//! A trapezoid from the velocity that an axis has, to rest in a chosen time.
//!
//! Seen in the direction of travel with start velocity v, distance R and duration T, the cruise
//! velocity c follows from R = ramp to c + cruise + ramp to rest. Slowing to it, both ramps have
//! the deceleration d: R = v^2 / (2 d) + c (T - v / d). Speeding up to it with a and with
//! k = 1 / (2 a) + 1 / (2 d): k c^2 - (T + v / a) c + R + v^2 / (2 a) = 0, the lesser root.

use super::exact;
use crate::motion::bounds::Bounds;
use crate::motion::error::ProfileError;
use crate::motion::segments::{Builder, Segments};
use crate::motion::trajectory::{Sample, Trajectory};

/// From `velocity` at position zero to rest at `target`: in `duration` seconds, or as quickly as
/// the limits allow where that is longer.
///
/// Slowing down takes the deceleration limit and speeding up the acceleration limit, and nothing
/// goes back that need not.
///
/// # Errors
/// [`ProfileError::Value`] as [`exact::to_rest`].
pub(crate) fn to_rest(
    velocity: f64,
    target: f64,
    duration: f64,
    bounds: &Bounds,
) -> Result<Segments, ProfileError> {
    let from = Sample::coasting(0.0, velocity);
    let quickest = exact::to_rest(from, target, bounds)?;
    if duration <= quickest.duration() {
        return Ok(quickest);
    }
    let (up, down) = (bounds.acceleration(), bounds.deceleration());
    let braking = velocity * velocity.abs() / (2.0 * down);
    let sign = 1.0f64.copysign(target - braking);
    let mut builder = Builder::new(from);
    let (mut start, mut distance, mut left) = (sign * velocity, sign * target, duration);
    if start < 0.0 {
        // The wrong way: it stops first, and goes on from there.
        builder = builder.acceleration(-start / down, sign * down);
        distance = sign * (target - braking);
        left += start / down;
        start = 0.0;
    }
    let slowing = start / down;
    let after = distance - 0.5 * start * slowing;
    let level = after / (left - slowing);
    let (cruise, rise) = if level < start {
        (level, -(start - level) / down)
    } else {
        let k = 0.5 / up + 0.5 / down;
        let linear = left + start / up;
        let constant = distance + 0.5 * start * start / up;
        let root = libm::sqrt((linear * linear - 4.0 * k * constant).max(0.0));
        let cruise = (2.0 * constant / (linear + root)).min(bounds.velocity());
        (cruise, (cruise - start) / up)
    };
    let fall = cruise / down;
    let rate = if rise < 0.0 { -down } else { up };
    Ok(builder
        .acceleration(rise.abs(), sign * rate)
        .acceleration(left - rise.abs() - fall, 0.0)
        .acceleration(fall, -sign * down)
        .end(target, 0.0))
}
