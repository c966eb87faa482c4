//! A change of velocity with limited jerk, in three pieces: the acceleration goes to a peak, stays
//! there, and comes back to zero just as the velocity is reached.
//!
//! Seen so that the velocity falls by v from where it begins with an acceleration a, and with a
//! jerk j, the middle piece vanishes for a peak p = sqrt(j v + a^2 / 2), the triangle; where that
//! is over the limit d, p = d. A ramp that lasts t from velocity v to w while the acceleration
//! changes by c leads t (v + w) / 2 - c t^2 / 12 far.
//!
//! [`super::s_curve::change_velocity`] is the same in general. A device must do with less: f32 is
//! cheap there, and finds what f64 then makes exact.

use super::chain::Piece;
use super::fixed::square_root_f32;
use super::phase::{Moment, Rates};
use core::ops::{Add, Div, Mul, Neg, Sub};

/// What the arithmetic here needs of f32 and f64.
pub(crate) trait Number:
    Copy
    + Default
    + PartialOrd
    + From<f32>
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    fn root(self) -> Self;
    fn absolute(self) -> Self;
    fn with_sign_of(self, other: Self) -> Self;
}

impl Number for f64 {
    fn root(self) -> Self {
        libm::sqrt(self)
    }

    fn absolute(self) -> Self {
        self.abs()
    }

    fn with_sign_of(self, other: Self) -> Self {
        self.copysign(other)
    }
}

impl Number for f32 {
    fn root(self) -> Self {
        if self > f32::MIN_POSITIVE {
            square_root_f32(self)
        } else {
            0.0
        }
    }

    fn absolute(self) -> Self {
        self.abs()
    }

    fn with_sign_of(self, other: Self) -> Self {
        self.copysign(other)
    }
}

/// How strongly a velocity may rise and fall, each positive, and how fast that may change.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Strength<F> {
    pub rise: F,
    pub fall: F,
    pub jerk: F,
}

/// A change of velocity.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Change<F> {
    /// One where the velocity falls, else minus one.
    sign: F,
    /// The velocity that is reached.
    to: F,
    /// What is lost until then, and the acceleration at the start, both times the sign.
    velocity: F,
    acceleration: F,
    /// The greatest deceleration.
    peak: F,
    /// What is still to be lost after the first and the second piece.
    after_ramp: F,
    after_hold: F,
    /// Seconds of the three pieces.
    ramp: F,
    hold: F,
    release: F,
}

impl<F: Number> Change<F> {
    /// From a velocity and an acceleration to a velocity.
    pub(crate) fn new(velocity: F, acceleration: F, to: F, strength: &Strength<F>) -> Self {
        let half = F::from(0.5);
        let jerk = strength.jerk;
        let slow = F::from(1.0) / jerk;
        let lost = velocity - to;
        let half_square = half * acceleration * acceleration;
        // What is left to lose once the acceleration has been taken back.
        let carried = jerk * lost + half_square.with_sign_of(acceleration);
        let sign = F::from(1.0).with_sign_of(carried);
        let (velocity, acceleration) = (sign * lost, sign * acceleration);
        let square = jerk * velocity + half_square;
        let limit = if carried > F::default() {
            strength.fall
        } else {
            strength.rise
        };
        let triangle = square <= limit * limit;
        let peak = if triangle { square.root() } else { limit };
        let ramp = (peak + acceleration).absolute() * slow;
        let release = peak * slow;
        let after_hold = half * peak * release;
        let mut after_ramp = after_hold;
        let mut hold = F::default();
        if !triangle {
            after_ramp = velocity + half * (acceleration - peak) * ramp;
            if after_ramp > after_hold {
                hold = (after_ramp - after_hold) / peak;
            }
        }
        Self {
            sign,
            to,
            velocity,
            acceleration,
            peak,
            after_ramp,
            after_hold,
            ramp,
            hold,
            release,
        }
    }

    /// Takes back a deceleration for so many seconds, and ends with what is left of it.
    pub(crate) fn releasing(velocity: F, acceleration: F, seconds: F, jerk: F) -> Self {
        let half = F::from(0.5);
        let zero = F::default();
        let gained = seconds * (acceleration + half * jerk * seconds);
        Self {
            sign: F::from(1.0),
            to: velocity + gained,
            velocity: -gained,
            acceleration,
            peak: -(acceleration + jerk * seconds),
            after_ramp: zero,
            after_hold: zero,
            ramp: seconds,
            hold: zero,
            release: zero,
        }
    }

    /// Seconds until the velocity is reached.
    pub(crate) fn duration(&self) -> F {
        self.ramp + self.hold + self.release
    }

    /// The velocity that is reached.
    pub(crate) fn to(&self) -> F {
        self.to
    }

    /// The acceleration that is reached where that is done by [`Self::releasing`].
    pub(crate) fn exit(&self) -> F {
        -self.peak
    }

    /// How far it goes until then.
    pub(crate) fn distance(&self) -> F {
        let half = F::from(0.5);
        let double = self.ramp * (self.velocity + self.after_ramp)
            + self.hold * (self.after_ramp + self.after_hold)
            + self.release * self.after_hold;
        let bend = (self.peak + self.acceleration) * self.ramp * self.ramp
            - self.peak * self.release * self.release;
        let lost = half * double + bend / F::from(12.0);
        self.to * self.duration() + self.sign * lost
    }
}

impl Change<f64> {
    /// To rest with this deceleration from the first instant to the last, whatever the jerk.
    pub(crate) fn braking(velocity: f64, deceleration: f64) -> Self {
        let speed = velocity.abs();
        Self {
            sign: 1.0f64.copysign(velocity),
            to: 0.0,
            velocity: speed,
            acceleration: -deceleration,
            peak: deceleration,
            after_ramp: speed,
            after_hold: 0.0,
            ramp: 0.0,
            hold: speed / deceleration,
            release: 0.0,
        }
    }

    /// The same seen from the other side.
    pub(crate) fn mirrored(self) -> Self {
        Self {
            sign: -self.sign,
            to: -self.to,
            ..self
        }
    }

    /// The pieces of the change, which begins so many seconds after the start of a motion.
    #[inline(never)]
    pub(crate) fn pieces(self, begins: f64) -> [Piece; 3] {
        let Self { sign, to, .. } = self;
        // Times the sign, for next to nothing.
        let turned = |value: f64| {
            if sign.is_sign_negative() {
                -value
            } else {
                value
            }
        };
        let rates =
            |lost: f64, deceleration: f64| Rates::new(to + turned(lost), turned(deceleration));
        let after_ramp = rates(self.after_ramp, -self.peak);
        let after_hold = rates(self.after_hold, -self.peak);
        let entry = rates(self.velocity, self.acceleration);
        let ramped = begins + self.ramp;
        let held = ramped + self.hold;
        [
            (ramped, entry, after_ramp),
            (held, after_ramp, after_hold),
            (held + self.release, after_hold, rates(0.0, 0.0)),
        ]
        .map(|(ends, entry, exit)| Piece {
            ends: Moment::from_seconds(ends),
            entry,
            exit,
        })
    }
}
