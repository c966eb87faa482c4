//! Quantities of motion as integers: position in counts of 2^-32 turn, and its rates.
//!
//! An f32 errs 1.3 mrad over 1000 turns; an i64 with 2^-32 turn per count (1.46 nrad) carries
//! +-2^31 turns exactly, so nothing accumulates and host and device hold the same bits.

use core::f64::consts::TAU;
use core::fmt;
use core::ops::{Add, Neg, Sub};

/// Counts in one turn: the least significant bit of every quantity here is 2^-32 turn.
pub const COUNTS_PER_TURN: i64 = 1 << 32;

/// Counts in one radian, 2^32 / (2 pi).
pub const COUNTS_PER_RADIAN: f64 = COUNTS_PER_TURN as f64 / TAU;

/// The farthest position that a command can name, in turns: 2^33 wire steps of 2^-23 turn.
pub const POSITION_RANGE_TURNS: i64 = 1024;

/// A value that its quantity cannot hold, with the range that it can.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitError {
    /// What was being set, with its unit, such as `position in rad`.
    pub quantity: &'static str,
    /// The value that was refused.
    pub value: f64,
    /// The smallest value that is accepted.
    pub minimum: f64,
    /// The largest value that is accepted.
    pub maximum: f64,
}

impl fmt::Display for UnitError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "{} must be a number from {} to {}, but it is {}",
            self.quantity, self.minimum, self.maximum, self.value
        )
    }
}

impl core::error::Error for UnitError {}

/// Rounds `radians` to counts where its magnitude is at most `limit` counts.
fn to_counts(quantity: &'static str, radians: f64, limit: i64) -> Result<i64, UnitError> {
    let counts = libm::round(radians * COUNTS_PER_RADIAN);
    // A NaN fails this comparison, and so is refused like any other value out of range.
    if counts.abs() <= limit as f64 {
        Ok(counts as i64)
    } else {
        let edge = limit as f64 / COUNTS_PER_RADIAN;
        Err(UnitError {
            quantity,
            value: radians,
            minimum: -edge,
            maximum: edge,
        })
    }
}

macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident, $unit:literal, $limit:expr, $per:literal) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
        pub struct $name(i64);

        impl $name {
            /// Nothing of it.
            pub const ZERO: Self = Self(0);
            /// The largest magnitude that [`Self::from_radians`] accepts, in counts.
            pub const LIMIT: i64 = $limit;

            #[doc = concat!("From counts of 2^-32 turn", $per, ".")]
            pub const fn from_counts(counts: i64) -> Self {
                Self(counts)
            }

            #[doc = concat!("In counts of 2^-32 turn", $per, ".")]
            pub const fn counts(self) -> i64 {
                self.0
            }

            #[doc = concat!("From rad", $per, ", rounded to the nearest count.")]
            ///
            /// # Errors
            /// A value that is not a number or whose magnitude is over [`Self::LIMIT`].
            pub fn from_radians(radians: f64) -> Result<Self, UnitError> {
                to_counts(concat!($unit), radians, Self::LIMIT).map(Self)
            }

            #[doc = concat!("In rad", $per, ".")]
            pub fn radians(self) -> f64 {
                self.0 as f64 / COUNTS_PER_RADIAN
            }

            /// The magnitude; `i64::MIN` gives `i64::MAX`.
            #[inline(never)]
            pub const fn abs(self) -> Self {
                let magnitude = self.0.unsigned_abs();
                Self((magnitude - (magnitude >> 63)) as i64)
            }
        }

        impl Add for $name {
            type Output = Self;
            /// Saturates: a sum that does not fit stays at the edge.
            fn add(self, other: Self) -> Self {
                Self(sum(self.0, other.0))
            }
        }

        impl Sub for $name {
            type Output = Self;
            /// Saturates: a difference that does not fit stays at the edge.
            fn sub(self, other: Self) -> Self {
                Self(difference(self.0, other.0))
            }
        }

        impl Neg for $name {
            type Output = Self;
            fn neg(self) -> Self {
                Self(self.0.saturating_neg())
            }
        }
    };
}

quantity!(
    /// A position, or a difference of positions, in counts of 2^-32 turn.
    Position,
    "position in rad",
    POSITION_RANGE_TURNS * COUNTS_PER_TURN,
    ""
);
quantity!(
    /// A velocity in counts of 2^-32 turn per second.
    ///
    /// Up to 2048 turn/s (about 12 868 rad/s), beyond any servo drive of this class.
    Velocity,
    "velocity in rad/s",
    2048 * COUNTS_PER_TURN,
    "/s"
);
quantity!(
    /// An acceleration in counts of 2^-32 turn per second squared.
    ///
    /// Up to 2^18 turn/s^2 (about 1.6e6 rad/s^2).
    Acceleration,
    "acceleration in rad/s^2",
    (1 << 18) * COUNTS_PER_TURN,
    "/s^2"
);
quantity!(
    /// A jerk in counts of 2^-32 turn per second cubed.
    ///
    /// Up to 2^28 turn/s^3 (about 1.7e9 rad/s^3).
    Jerk,
    "jerk in rad/s^3",
    (1 << 28) * COUNTS_PER_TURN,
    "/s^3"
);

/// The sum, which stays at the nearer end where it does not fit: one function for all of them.
#[inline(never)]
pub(crate) const fn sum(value: i64, other: i64) -> i64 {
    value.saturating_add(other)
}

/// The difference, as [`sum`].
#[inline(never)]
pub(crate) const fn difference(value: i64, other: i64) -> i64 {
    value.saturating_sub(other)
}

/// The product, and what does not fit cut to the nearer end, `i64::MAX` or its negative.
/// On a processor of 32 bits that is long, and a third of what two factors of 64 bits would take.
#[inline(never)]
pub(crate) const fn product(value: i64, factor: u32) -> i64 {
    let magnitude = value.unsigned_abs();
    let lower = (magnitude & 0xFFFF_FFFF) * factor as u64;
    let upper = (magnitude >> 32) * factor as u64 + (lower >> 32);
    let size = if upper >> 31 == 0 {
        (upper << 32 | lower & 0xFFFF_FFFF) as i64
    } else {
        i64::MAX
    };
    if value < 0 { -size } else { size }
}

/// The whole part of `value`: at an end where it does not fit, and 0 for what is no number. A processor without
/// f64 does this with a hundred bytes of code wherever it stands.
#[inline(never)]
pub(crate) fn whole(value: f64) -> i64 {
    value as i64
}

/// The greatest whole number that is not above `value`: at an end where it does not fit, and 0 for what is no
/// number. As the library's, in a third of its code.
#[inline(never)]
pub(crate) fn floor(value: f64) -> i64 {
    let whole = whole(value);
    whole.saturating_sub(i64::from(whole as f64 > value))
}

/// `value / 2^bits`, towards zero: where code is to be short, a compiler calls a division of 64 bits for it.
#[inline(always)]
pub(crate) const fn over_power_of_two(value: i64, bits: u32) -> i64 {
    let below = (1 << bits) - 1;
    (value + ((value >> 63) & below)) >> bits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floor_is_the_librarys() {
        let whole = [
            0.0,
            1.0,
            2.0,
            1e9,
            9_007_199_254_740_992.0,
            9.3e18,
            f64::INFINITY,
            f64::NAN,
        ];
        for value in whole
            .iter()
            .flat_map(|whole| [-0.5, -1e-300, 0.0, 0.5].map(|part| whole + part))
        {
            for value in [value, -value] {
                assert_eq!(floor(value), libm::floor(value) as i64, "{value}");
            }
        }
    }

    #[test]
    fn a_product_is_that_or_the_nearer_end() {
        for value in [
            0,
            1,
            -1,
            1 << 31,
            -(1 << 31),
            1 << 40,
            i64::MAX,
            -i64::MAX,
            i64::MIN,
        ] {
            for factor in [0, 1, 2, 1_000, 1 << 16, u32::MAX] {
                let exact = value.saturating_mul(factor.into()).max(-i64::MAX);
                assert_eq!(product(value, factor), exact, "{value} {factor}");
            }
        }
    }

    #[test]
    fn powers_of_two_divide_towards_zero() {
        for value in [
            0,
            1,
            -1,
            2,
            -2,
            3,
            -3,
            63,
            -63,
            64,
            -64,
            65,
            -65,
            i64::MIN,
            i64::MAX - 63,
        ] {
            for bits in [0, 1, 6] {
                assert_eq!(
                    over_power_of_two(value, bits),
                    value / (1 << bits),
                    "{value} {bits}"
                );
            }
        }
    }

    #[test]
    fn one_turn_is_two_pi() {
        assert_eq!(
            Position::from_radians(TAU).map(Position::counts),
            Ok(1 << 32)
        );
        assert_eq!(Position::from_counts(1 << 31).radians(), TAU / 2.0);
    }

    #[test]
    fn bad_values_name_the_quantity_and_its_range() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 6500.0, -6500.0] {
            let error = Position::from_radians(bad).expect_err("out of range");
            assert_eq!(error.quantity, "position in rad");
            assert_eq!(error.maximum, 1024.0 * TAU);
        }
    }

    #[test]
    fn arithmetic_saturates() {
        let most = Position::from_counts(i64::MAX);
        assert_eq!(most + most, most);
        assert_eq!(Position::from_counts(i64::MIN).abs(), most);
    }
}
