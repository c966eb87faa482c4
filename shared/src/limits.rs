//! What an axis may do. A [`Limits`] can only hold values that make sense.

use crate::units::{
    Acceleration, COUNTS_PER_RADIAN, Jerk, POSITION_RANGE_TURNS, Position, Velocity, floor,
};
use core::f64::consts::TAU;
use core::fmt;

/// The limits of one axis, each positive and in range; the least position is below the greatest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    velocity: Velocity,
    acceleration: Acceleration,
    deceleration: Acceleration,
    jerk: Jerk,
    position_minimum: Position,
    position_maximum: Position,
}

/// Limits as a person writes them, in rad and seconds, not yet looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitValues {
    /// The largest velocity in rad/s.
    pub velocity: f64,
    /// The largest acceleration in rad/s^2.
    pub acceleration: f64,
    /// The largest deceleration in rad/s^2.
    pub deceleration: f64,
    /// The largest jerk in rad/s^3.
    pub jerk: f64,
    /// The least position in rad.
    pub position_minimum: f64,
    /// The greatest position in rad.
    pub position_maximum: f64,
}

/// A limit that cannot be: which, what it was, and what it may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitError {
    /// The parameter's name, such as `limits.velocity`.
    pub field: &'static str,
    /// The unit that the other numbers are in.
    pub unit: &'static str,
    /// The value that was refused.
    pub value: f64,
    /// The smallest value that is accepted.
    pub minimum: f64,
    /// The largest value that is accepted.
    pub maximum: f64,
}

impl fmt::Display for LimitError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "{} must be a number from {} to {} {}, but it is {}",
            self.field, self.minimum, self.maximum, self.unit, self.value
        )
    }
}

impl core::error::Error for LimitError {}

/// The least velocity, acceleration and jerk limit, in rad and seconds: slower than any machine
/// is meant to be, and large enough for every duration to stay a number.
pub const SMALLEST_RATE: f64 = 1e-4;
/// The greatest velocity limit in rad/s, about 95 000 turns per minute.
pub const LARGEST_VELOCITY: f64 = 1e4;
/// The greatest acceleration and deceleration limit in rad/s^2.
pub const LARGEST_ACCELERATION: f64 = 1e6;
/// The greatest jerk limit in rad/s^3.
pub const LARGEST_JERK: f64 = 1e9;
/// The farthest position limit in rad: 1000 turns, the travel over which a command keeps 1
/// microrad, with room to the wire's own end at 1024 turns.
pub const FARTHEST_POSITION: f64 = 1000.0 * TAU;

/// The values of [`Limits::default`].
pub const DEFAULT_VALUES: LimitValues = LimitValues {
    velocity: 20.0,
    acceleration: 200.0,
    deceleration: 200.0,
    jerk: 20_000.0,
    position_minimum: -FARTHEST_POSITION,
    position_maximum: FARTHEST_POSITION,
};

/// A call for each limit takes less flash than the comparisons in each place.
#[inline(never)]
fn checked(
    field: &'static str,
    unit: &'static str,
    value: f64,
    minimum: f64,
    maximum: f64,
) -> Result<f64, LimitError> {
    // A NaN is in no range.
    if (minimum..=maximum).contains(&value) {
        Ok(value)
    } else {
        Err(LimitError {
            field,
            unit,
            value,
            minimum,
            maximum,
        })
    }
}

/// Rounded down: a limit in counts is never above the one that was asked for.
#[inline(never)]
fn down(radians: f64) -> i64 {
    floor(radians * COUNTS_PER_RADIAN)
}

impl Limits {
    /// Limits from values in rad and seconds.
    ///
    /// # Errors
    /// The first value that is not a number or out of its range, by name.
    pub fn new(values: &LimitValues) -> Result<Self, LimitError> {
        let rate =
            |field, unit, value, maximum| checked(field, unit, value, SMALLEST_RATE, maximum);
        let velocity = rate(
            "limits.velocity",
            "rad/s",
            values.velocity,
            LARGEST_VELOCITY,
        )?;
        let acceleration = rate(
            "limits.acceleration",
            "rad/s^2",
            values.acceleration,
            LARGEST_ACCELERATION,
        )?;
        let deceleration = rate(
            "limits.deceleration",
            "rad/s^2",
            values.deceleration,
            LARGEST_ACCELERATION,
        )?;
        let jerk = rate("limits.jerk", "rad/s^3", values.jerk, LARGEST_JERK)?;
        let minimum = checked(
            "limits.position_min",
            "rad",
            values.position_minimum,
            -FARTHEST_POSITION,
            FARTHEST_POSITION,
        )?;
        let maximum = checked(
            "limits.position_max",
            "rad",
            values.position_maximum,
            minimum,
            FARTHEST_POSITION,
        )?;
        Ok(Self {
            velocity: Velocity::from_counts(down(velocity)),
            acceleration: Acceleration::from_counts(down(acceleration)),
            deceleration: Acceleration::from_counts(down(deceleration)),
            jerk: Jerk::from_counts(down(jerk)),
            position_minimum: Position::from_counts(-down(-minimum)),
            position_maximum: Position::from_counts(down(maximum)),
        })
    }

    /// The largest velocity.
    pub const fn velocity(&self) -> Velocity {
        self.velocity
    }

    /// The largest acceleration.
    pub const fn acceleration(&self) -> Acceleration {
        self.acceleration
    }

    /// The largest deceleration.
    pub const fn deceleration(&self) -> Acceleration {
        self.deceleration
    }

    /// The lesser of acceleration and deceleration, for curves that are symmetric.
    pub fn slower_acceleration(&self) -> Acceleration {
        self.acceleration.min(self.deceleration)
    }

    /// The largest jerk.
    pub const fn jerk(&self) -> Jerk {
        self.jerk
    }

    /// The least position.
    pub const fn position_minimum(&self) -> Position {
        self.position_minimum
    }

    /// The greatest position.
    pub const fn position_maximum(&self) -> Position {
        self.position_maximum
    }

    /// The same travel with rates that are at most these too; `None` where one is not positive.
    pub fn narrowed(
        &self,
        velocity: Velocity,
        acceleration: Acceleration,
        deceleration: Acceleration,
        jerk: Jerk,
    ) -> Option<Self> {
        let positive = velocity > Velocity::ZERO
            && acceleration > Acceleration::ZERO
            && deceleration > Acceleration::ZERO
            && jerk > Jerk::ZERO;
        positive.then_some(Self {
            velocity: self.velocity.min(velocity),
            acceleration: self.acceleration.min(acceleration),
            deceleration: self.deceleration.min(deceleration),
            jerk: self.jerk.min(jerk),
            ..*self
        })
    }

    /// The same with the lesser of acceleration and deceleration for both.
    pub fn symmetric(&self) -> Self {
        let slower = self.slower_acceleration();
        Self {
            acceleration: slower,
            deceleration: slower,
            ..*self
        }
    }

    /// The position inside the travel that is nearest to `position`, where it is less than
    /// `tolerance` away; otherwise `position` itself, which is then not allowed.
    ///
    /// A limit need not be a whole step of the wire nor of a person's unit: a target that misses
    /// it by rounding means the limit.
    pub fn snap(&self, position: Position, tolerance: Position) -> Position {
        let inside = position
            .max(self.position_minimum)
            .min(self.position_maximum);
        if (position - inside).abs() < tolerance {
            inside
        } else {
            position
        }
    }

    /// Whether `position` is inside the travel.
    pub fn allow(&self, position: Position) -> bool {
        (self.position_minimum..=self.position_maximum).contains(&position)
    }
}

impl Default for Limits {
    /// The values of [`DEFAULT_VALUES`].
    fn default() -> Self {
        // The default values are in range, which a test holds; the other arm is never taken.
        Self::new(&DEFAULT_VALUES).unwrap_or(Self {
            velocity: Velocity::ZERO,
            acceleration: Acceleration::ZERO,
            deceleration: Acceleration::ZERO,
            jerk: Jerk::ZERO,
            position_minimum: Position::ZERO,
            position_maximum: Position::ZERO,
        })
    }
}

const _: () = assert!(FARTHEST_POSITION < POSITION_RANGE_TURNS as f64 * TAU);

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::string::ToString;

    #[test]
    fn defaults_are_the_documented_ones() {
        assert_eq!(Limits::new(&DEFAULT_VALUES), Ok(Limits::default()));
        assert!((Limits::default().velocity().radians() - 20.0).abs() < 1e-9);
    }

    #[test]
    fn every_bad_value_is_named() {
        for bad in [f64::NAN, 0.0, -1.0, f64::INFINITY, 1e300] {
            let cases = [
                (
                    "limits.velocity",
                    LimitValues {
                        velocity: bad,
                        ..DEFAULT_VALUES
                    },
                ),
                (
                    "limits.acceleration",
                    LimitValues {
                        acceleration: bad,
                        ..DEFAULT_VALUES
                    },
                ),
                (
                    "limits.deceleration",
                    LimitValues {
                        deceleration: bad,
                        ..DEFAULT_VALUES
                    },
                ),
                (
                    "limits.jerk",
                    LimitValues {
                        jerk: bad,
                        ..DEFAULT_VALUES
                    },
                ),
            ];
            for (field, values) in cases {
                let error = Limits::new(&values).expect_err(field);
                assert_eq!(error.field, field);
                assert!(error.to_string().starts_with(field));
            }
        }
        let crossed = LimitValues {
            position_minimum: 2.0,
            position_maximum: 1.0,
            ..DEFAULT_VALUES
        };
        assert_eq!(
            Limits::new(&crossed).map_err(|error| error.field),
            Err("limits.position_max")
        );
    }
}
