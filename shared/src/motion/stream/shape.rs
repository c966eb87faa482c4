//! The derivatives of one Hermite piece in Bernstein form, from the knots at its ends, in integers.

use super::stretch::Place;
use super::{Breach, LONGEST_PIECE};
use crate::motion::fixed::{ALMOST_ONE, multiply, scale};
use crate::time::TICKS_PER_SECOND;
use crate::units::{over_power_of_two, product};
use core::num::NonZeroU32;

/// Bits behind the point of a velocity. Over a curve of degree four that stays below 2^43 counts/s,
/// as every velocity limit does, control values stay below 12 * 2^43 and the polynomial's
/// coefficients below 256 * 2^43 = 2^51: 8 bits more are 2^59.
pub(super) const VELOCITY_BITS: u32 = 8;

/// Bits behind the point of an acceleration: of degree three and below 2^50 counts/s^2, the
/// coefficients stay below 48 * 2^50, and 6 bits more are below 2^62.
pub(super) const ACCELERATION_BITS: u32 = 6;

// The way of a whole piece, raised, fits: 2^43 counts/s over 2.04 s.
const _: () = assert!((LONGEST_PIECE as i64) < i64::MAX >> (43 + VELOCITY_BITS));

/// What one tick is of a second, as a Q64 fraction.
pub(super) const TICK: u64 = ALMOST_ONE / TICKS_PER_SECOND;

/// Divides by 3.
const THIRD: Divisor = Divisor::new(3);

/// Divides by 6.
const SIXTH: Divisor = Divisor::new(6);

/// Divides by 5.
pub(super) const FIFTH: Divisor = Divisor::new(5);

/// A piece's velocity and acceleration as control values, raised.
pub(super) struct Shape {
    pub(super) velocity: [i64; 5],
    pub(super) acceleration: [i64; 4],
}

/// The same where an end leaves its acceleration to the curve.
pub(super) struct Cubic {
    pub(super) velocity: [i64; 3],
    pub(super) acceleration: [i64; 2],
}

/// Velocities at the start, in the mean and at the end, raised: below 2^43 counts/s each.
fn velocities(from: &Place, to: &Place, ticks: &Divisor) -> [i64; 3] {
    let difference = to.position.saturating_sub(from.position);
    // The thousandfold is below 2^43 * 2040 < 2^54.
    let thousandfold = product(difference, TICKS_PER_SECOND as u32);
    [
        from.velocity << VELOCITY_BITS,
        ticks.divide(thousandfold << VELOCITY_BITS),
        to.velocity << VELOCITY_BITS,
    ]
}

impl Shape {
    /// From one knot to the next, `ticks` later: a quintic where both know their acceleration, a cubic
    /// otherwise.
    ///
    /// # Errors
    /// [`Breach::Acceleration`] where a control value is far above any limit. Velocities, the mean one
    /// among them, are to be below 2^43 counts/s, accelerations below 2^50 counts/s^2.
    pub(super) fn between<const QUINTIC: bool>(
        from: &Place,
        to: &Place,
        ticks: &Divisor,
    ) -> Result<Self, Breach> {
        match (from.acceleration, to.acceleration) {
            (Some(first), Some(last)) if QUINTIC => Self::quintic(from, first, to, last, ticks),
            _ => Ok(Cubic::between(from, to, ticks)?.raised()),
        }
    }

    /// From one knot with the acceleration `first` to the next with `last`.
    ///
    /// # Errors
    /// As [`Self::between`].
    pub(super) fn quintic(
        from: &Place,
        first: i64,
        to: &Place,
        last: i64,
        ticks: &Divisor,
    ) -> Result<Self, Breach> {
        let [v0, mean, v4] = velocities(from, to, ticks);
        // a T / 4 with T = ticks / 1000: a * ticks is below 2^61.
        let quarter = |acceleration: i64| {
            let raised = TICK << (VELOCITY_BITS - 2);
            scale(acceleration * i64::from(ticks.get()), raised)
        };
        let v1 = v0 + quarter(first);
        let v3 = v4 - quarter(last);
        // The mean of the control values is that of the velocity.
        let v2 = 5 * mean - v0 - v1 - v3 - v4;
        Ok(Self {
            velocity: [v0, v1, v2, v3, v4],
            acceleration: [
                first << ACCELERATION_BITS,
                per_second(v2 - v1, 4, ticks)?,
                per_second(v3 - v2, 4, ticks)?,
                last << ACCELERATION_BITS,
            ],
        })
    }
}

impl Cubic {
    /// From one knot to the next, whatever they know of their acceleration.
    ///
    /// # Errors
    /// As [`Shape::between`].
    pub(super) fn between(from: &Place, to: &Place, ticks: &Divisor) -> Result<Self, Breach> {
        let [v0, mean, v4] = velocities(from, to, ticks);
        let middle = 3 * mean - v0 - v4;
        Ok(Self {
            velocity: [v0, middle, v4],
            acceleration: [
                per_second(middle - v0, 2, ticks)?,
                per_second(v4 - middle, 2, ticks)?,
            ],
        })
    }

    /// The same curve, with control values as a quintic has them.
    #[inline(always)] // The tick that enters a stretch asks it.
    pub(super) fn raised(&self) -> Shape {
        let [v0, middle, v4] = self.velocity;
        let [first, last] = self.acceleration;
        let third = THIRD.divide(first - last);
        Shape {
            velocity: [
                v0,
                over_power_of_two(v0 + middle, 1),
                SIXTH.divide(v0 + 4 * middle + v4),
                over_power_of_two(middle + v4, 1),
                v4,
            ],
            acceleration: [first, first - third, last + third, last],
        }
    }
}

/// `factor` times a raised difference of velocities over `ticks`, as a raised acceleration.
#[inline(always)]
fn per_second(difference: i64, factor: i64, ticks: &Divisor) -> Result<i64, Breach> {
    const RATE: i64 = TICKS_PER_SECOND as i64 >> (VELOCITY_BITS - ACCELERATION_BITS);
    let product = difference.checked_mul(factor * RATE);
    let beyond = Breach::Acceleration(if difference < 0 { i64::MIN } else { i64::MAX });
    let value = ticks.divide(product.ok_or(beyond)?);
    // No limit is above 2^50, and a curve of degree three below that has no control value above
    // 5 * 2^50; beyond this the sums of the halving might not fit.
    let fits = value.saturating_abs() < 1 << (53 + ACCELERATION_BITS);
    fits.then_some(value).ok_or(beyond)
}

/// A number below 2^16 to divide by, more than once: the device has no instruction for 64 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Divisor {
    by: NonZeroU32,
    /// What it is of one, as a Q64 fraction.
    part: u64,
}

impl Divisor {
    /// For a number that is not 0.
    pub(super) const fn new(by: u16) -> Self {
        let by = match NonZeroU32::new(by as u32) {
            Some(by) => by,
            None => NonZeroU32::MIN,
        };
        let wide = by.get();
        // In four digits of 16 bits, since the device has an instruction for those.
        let (mut part, mut rest, mut digits) = (0, 0, 0);
        while digits < 4 {
            // The rest is below 2^16.
            let digit = rest << 16 | 0xFFFF;
            part = part << 16 | (digit / wide) as u64;
            rest = digit % wide;
            digits += 1;
        }
        Self { by, part }
    }

    /// For another number, where it is one: mostly all pieces of a stream last equally long.
    #[inline(never)]
    pub(super) const fn or_new(self, by: u16) -> Self {
        if self.get() == by as u32 {
            self
        } else {
            Self::new(by)
        }
    }

    /// One over it, as a Q64 fraction, rounded down; of one [`ALMOST_ONE`].
    pub(super) fn part(&self) -> u64 {
        self.part
    }

    pub(super) const fn get(&self) -> u32 {
        self.by.get()
    }

    /// `value` over it, towards zero.
    #[inline(never)] // Where this number is known, what it becomes is longer.
    pub(super) fn divide(&self, value: i64) -> i64 {
        let whole = value.unsigned_abs();
        // At most 4 too small: 1 for the part and 3 for the product. So the rest is below 5 times
        // this number, 2^19.
        let quotient = multiply(whole, self.part);
        let rest = whole.wrapping_sub(quotient.wrapping_mul(self.get().into())) as u32;
        let quotient = quotient.wrapping_add((rest / self.by).into()) as i64;
        if value < 0 {
            quotient.wrapping_neg()
        } else {
            quotient
        }
    }
}

/// The nearest integer to a raised value; a half goes up.
pub(super) const fn round(raised: i64, bits: u32) -> i64 {
    (raised + (1 << (bits - 1))) >> bits
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn quotients_are_exact(value: i64, shift in 0u32..64, by in 1u16..) {
            let divisor = Divisor::new(by);
            prop_assert_eq!(divisor.part(), ALMOST_ONE / u64::from(by));
            let value = value >> shift;
            let last = value - value % i64::from(by);
            for value in [value, last, last.saturating_sub(1), last.saturating_add(1)] {
                prop_assert_eq!(divisor.divide(value), value.wrapping_div(by.into()));
            }
        }
    }

    #[test]
    fn extremes_are_divided_too() {
        for by in [1, 2, 3, 5, 1_000, 1 << 15, u16::MAX] {
            for value in [i64::MIN, i64::MIN + 1, -1, 0, 1, i64::MAX - 1, i64::MAX] {
                assert_eq!(
                    Divisor::new(by).divide(value),
                    value.wrapping_div(by.into())
                );
            }
        }
    }
}
