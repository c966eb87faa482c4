//! The limits of a profile in f64, in the caller's own unit; only valid values can be held.

use super::error::{ProfileError, checked};

/// The least limit, and the least duration in seconds, that is accepted. The cube of a range over
/// a rate, and what is made of it, then stays far from the ends of an f64.
pub const SMALLEST: f64 = 1e-15;
/// The greatest limit, duration in seconds and magnitude of a position that is accepted.
pub const LARGEST: f64 = 1e15;

/// How fast a profile may be: each limit positive and in range, the jerk possibly infinite.
///
/// Acceleration is what the first ramp of a move may have, in the direction of the move, and
/// deceleration what the last one may have against it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    velocity: f64,
    acceleration: f64,
    deceleration: f64,
    jerk: f64,
}

impl Bounds {
    /// Limits of velocity, acceleration, deceleration and jerk; an infinite jerk is no limit.
    ///
    /// # Errors
    /// The first value that is not a number from [`SMALLEST`] to [`LARGEST`], by name.
    pub fn new(
        velocity: f64,
        acceleration: f64,
        deceleration: f64,
        jerk: f64,
    ) -> Result<Self, ProfileError> {
        let rate = |field, value| checked(field, value, SMALLEST, LARGEST);
        Ok(Self {
            velocity: rate("velocity limit", velocity)?,
            acceleration: rate("acceleration limit", acceleration)?,
            deceleration: rate("deceleration limit", deceleration)?,
            jerk: if jerk == f64::INFINITY {
                jerk
            } else {
                rate("jerk limit", jerk)?
            },
        })
    }

    /// The bounds of an axis, whose [`Limits`](crate::limits::Limits) are far inside the ranges of [`Self::new`],
    /// as are these times what a stop takes. A device looks at them once, when it is given the limits.
    pub(crate) const fn of_axis(
        velocity: f64,
        acceleration: f64,
        deceleration: f64,
        jerk: f64,
    ) -> Self {
        Self {
            velocity,
            acceleration,
            deceleration,
            jerk,
        }
    }

    /// The largest velocity.
    pub const fn velocity(&self) -> f64 {
        self.velocity
    }

    /// The largest acceleration.
    pub const fn acceleration(&self) -> f64 {
        self.acceleration
    }

    /// The largest deceleration.
    pub const fn deceleration(&self) -> f64 {
        self.deceleration
    }

    /// The lesser of acceleration and deceleration, for curves that are symmetric.
    pub const fn slower_acceleration(&self) -> f64 {
        self.acceleration.min(self.deceleration)
    }

    /// The same limits without one of jerk.
    pub const fn without_jerk(&self) -> Self {
        Self {
            jerk: f64::INFINITY,
            ..*self
        }
    }

    /// The largest jerk; infinite where there is no limit.
    pub const fn jerk(&self) -> f64 {
        self.jerk
    }
}

/// A position, or the time of a start, that arithmetic can carry.
///
/// # Errors
/// A value that is not a number or whose magnitude is over [`LARGEST`].
pub fn checked_position(field: &'static str, value: f64) -> Result<f64, ProfileError> {
    checked(field, value, -LARGEST, LARGEST)
}

/// A duration that arithmetic can carry, as can its reciprocal; zero only where nothing is to happen.
///
/// # Errors
/// One that is not from [`SMALLEST`] to [`LARGEST`] seconds, nor zero for a profile that `stands`.
pub fn checked_duration(duration: f64, stands: bool) -> Result<f64, ProfileError> {
    if stands && duration == 0.0 {
        return Ok(duration);
    }
    checked("duration", duration, SMALLEST, LARGEST)
}

/// A velocity, acceleration or jerk at an end of a profile.
///
/// # Errors
/// A value that is not a number or whose magnitude is over [`LARGEST`].
pub fn checked_rate(field: &'static str, value: f64) -> Result<f64, ProfileError> {
    checked(field, value, -LARGEST, LARGEST)
}
