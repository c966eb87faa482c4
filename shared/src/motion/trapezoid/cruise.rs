//! A trapezoid from the velocity that an axis has, to rest: as quickly as the limits allow, or
//! later with a slower cruise.
//!
//! Seen in the direction of travel with start velocity v, distance R and duration T, the cruise
//! velocity c follows from R = ramp to c + cruise + ramp to rest. Slowing to it, both ramps have
//! the deceleration d: R = v^2 / (2 d) + c (T - v / d). Speeding up to it with a and with
//! k = 1 / (2 a) + 1 / (2 d): k c^2 - (T + v / a) c + R + v^2 / (2 a) = 0, the lesser root. The
//! greatest c, without a cruise, has k c^2 = R + v^2 / (2 a).
//!
//! [`super::exact::to_rest`] has the same ramps for a host; this is the least arithmetic for a
//! device.

use crate::motion::bounds::Bounds;
use crate::motion::chain::Piece;
use crate::motion::phase::{Moment, Rates};

/// The pieces from `velocity` at place zero to rest at `target`: in `duration` seconds, or as
/// quickly as the limits allow where that is longer. In turns.
///
/// Slowing down takes the deceleration limit and speeding up the acceleration limit. Whoever comes
/// too fast overshoots and comes back.
pub(crate) fn to_rest(velocity: f64, target: f64, duration: f64, bounds: &Bounds) -> [Piece; 4] {
    // 1 / a and 1 / d
    let up = 1.0 / bounds.acceleration();
    let down = 1.0 / bounds.deceleration();
    let braking = 0.5 * velocity * velocity.abs() * down;
    let sign = 1.0f64.copysign(target - braking);
    let (mut start, mut distance, mut left) = (sign * velocity, sign * target, duration);
    let mut stop = 0.0;
    if start < 0.0 {
        // The wrong way: it stops first, and goes on from there.
        stop = -start * down;
        distance = sign * (target - braking);
        left -= stop;
        start = 0.0;
    }
    let slowing = start * down;
    let after = distance - 0.5 * start * slowing;
    let level = after / (left - slowing);
    let limit = bounds.velocity();
    let cruise = if left > slowing && level <= start {
        level.min(limit)
    } else if start >= limit {
        limit
    } else {
        let k = 0.5 * (up + down);
        let constant = distance + 0.5 * start * start * up;
        let linear = left + start * up;
        let square = linear * linear - 4.0 * k * constant;
        let cruise = if left > 0.0 && square >= 0.0 {
            2.0 * constant / (linear + libm::sqrt(square))
        } else {
            libm::sqrt(constant / k)
        };
        cruise.min(limit)
    };
    let (rise, rate) = if cruise < start {
        ((start - cruise) * down, -bounds.deceleration())
    } else {
        ((cruise - start) * up, bounds.acceleration())
    };
    let fall = cruise * down;
    let way = distance - 0.5 * (start + cruise) * rise - 0.5 * cruise * fall;
    let level = if cruise > 0.0 {
        (way / cruise).max(0.0)
    } else {
        0.0
    };
    let coasts =
        |velocity: f64, acceleration: f64| Rates::new(sign * velocity, sign * acceleration);
    let against = bounds.deceleration();
    let mut ends = 0.0;
    [
        (stop, -stop * against, 0.0, against),
        (rise, start, cruise, rate),
        (level, cruise, cruise, 0.0),
        (fall, cruise, 0.0, -against),
    ]
    .map(|(duration, from, to, acceleration)| {
        ends += duration;
        Piece {
            ends: Moment::from_seconds(ends),
            entry: coasts(from, acceleration),
            exit: coasts(to, acceleration),
        }
    })
}
