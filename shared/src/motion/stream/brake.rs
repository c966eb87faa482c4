//! How a stream that has run dry comes to rest: with the deceleration limit, and nothing to plan.
//!
//! Whoever waited for a plan here would have to go on without knots meanwhile. So the way to rest
//! is a function of the tick that needs nothing but the last knot: v - d t, and v t - d t^2 / 2.

use crate::limits::Limits;
use crate::motion::fixed::{ALMOST_ONE, scale};
use crate::time::{TICKS_PER_SECOND, Ticks};
use crate::units::{Position, product, whole};

/// Bits behind the point of a speed. A velocity limit is below 2^43 counts/s, so what was lost of
/// it, d n, is below 1000 * 2^43 < 2^53. The way is at most the longest travel, 2000 turns or 2^43
/// counts, so a mean speed times ticks is below 2^53 as well: 8 bits more are 2^61.
const BITS: u32 = 8;

/// What one tick is of a second, as a Q64 fraction.
const TICK: u64 = ALMOST_ONE / TICKS_PER_SECOND;

/// The deceleration, and how far it may lead.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Brake {
    /// Counts/s^2, not 0.
    deceleration: i64,
    /// Counts to the end of the travel.
    room: i64,
}

impl Brake {
    /// Stands still where it begins: for a stream that nobody has told any limit yet.
    pub(super) const AT_ONCE: Self = Self {
        deceleration: i64::MAX,
        room: 0,
    };

    /// From a knot inside the limits.
    pub(super) fn new(position: i64, velocity: i64, limits: &Limits) -> Self {
        let edge = if velocity < 0 {
            limits.position_minimum()
        } else {
            limits.position_maximum()
        };
        Self {
            deceleration: limits.deceleration().counts().max(1),
            room: (edge - Position::from_counts(position))
                .counts()
                .saturating_abs(),
        }
    }

    /// Whether it rests so many ticks after it began with `velocity`.
    pub(super) fn has_ended(&self, velocity: i64, elapsed: u32) -> bool {
        let lost = product(self.deceleration, elapsed);
        lost >= thousandfold(velocity)
    }

    /// The first whole number of ticks after which it rests.
    pub(super) fn ticks(&self, velocity: i64) -> Ticks {
        let whole = thousandfold(velocity) / self.deceleration;
        let ticks = u32::try_from(whole).unwrap_or(u32::MAX - 1);
        Ticks(ticks + u32::from(!self.has_ended(velocity, ticks)))
    }

    /// Position, velocity and acceleration so many ticks after it began at `position` with
    /// `velocity`.
    pub(super) fn at(&self, position: i64, velocity: i64, elapsed: u32) -> (i64, i64, i64) {
        let speed = velocity.saturating_abs();
        let sign = velocity.signum();
        if self.has_ended(velocity, elapsed) {
            return (position.saturating_add(sign * self.way(speed)), 0, 0);
        }
        // It has not ended: d n is below 1000 v, less than 2^53.
        let lost = scale((self.deceleration * i64::from(elapsed)) << BITS, TICK);
        let now = (speed << BITS) - lost;
        // What was lost may be 4 units more than that. So the way passed is never too long, and the
        // last step leads forward as well.
        let mean = (speed << BITS) - (lost >> 1) - 3;
        let passed = scale(product(mean, elapsed), TICK) >> BITS;
        (
            position.saturating_add(sign * passed.min(self.room)),
            sign * (now >> BITS),
            -sign * self.deceleration,
        )
    }

    /// How far it leads: v^2 / 2 d, and never past the end of the travel.
    ///
    /// The products and the quotient of f64 are rounded in the same way everywhere. The way is below
    /// 2^43 counts, so what is rounded is less than a hundredth of a count.
    fn way(&self, speed: i64) -> i64 {
        let speed = speed as f64;
        let way = speed * speed / (2.0 * self.deceleration as f64);
        whole(way).min(self.room)
    }
}

/// A speed in counts per thousand seconds, as decelerations times ticks are.
fn thousandfold(velocity: i64) -> i64 {
    product(velocity.saturating_abs(), TICKS_PER_SECOND as u32)
}
