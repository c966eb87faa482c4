//! From the axis's shaft to the drive's and back: gear ratio, direction and offset, in integers.
//!
//! ```text
//! drive = direction * gear_ratio * (axis - offset)
//! axis  = direction * drive / gear_ratio + offset
//! ```

use crate::units::{Acceleration, COUNTS_PER_TURN, Position, Velocity};
use core::f64::consts::TAU;

/// A gear ratio of one, in steps of 10^-9.
pub const UNIT_GEAR: u64 = 1_000_000_000;

/// A positive number as `mantissa * 2^-shift`, with 63 bits: whole ratios and their halves are exact, any
/// other errs by 2^-63 of itself, so that no position inside of 2^60 errs by more than its rounding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Ratio {
    mantissa: u64,
    shift: u32,
}

impl Ratio {
    /// Bits of the mantissa.
    const BITS: u32 = 63;

    /// `numerator / denominator`, to the nearest; both are from 1 to 2^96.
    fn new(numerator: u128, denominator: u128) -> Self {
        let (mut rest, mut divisor) = (numerator.max(1), denominator.max(1));
        // Until their quotient is from one to two, then bit by bit: a processor has no division this wide.
        let mut exponent = 0;
        while rest < divisor {
            rest <<= 1;
            exponent -= 1;
        }
        while divisor << 1 <= rest {
            divisor <<= 1;
            exponent += 1;
        }
        let mut mantissa = 0u64;
        for _ in 0..Self::BITS {
            mantissa <<= 1;
            if rest >= divisor {
                rest -= divisor;
                mantissa |= 1;
            }
            rest <<= 1;
        }
        if rest >= divisor {
            mantissa += 1;
        }
        let shift = Self::BITS as i32 - 1 - exponent;
        Self {
            mantissa,
            shift: shift.clamp(0, 126) as u32,
        }
    }

    /// `value` times the ratio, rounded to the nearest; what does not fit is cut to the nearer end.
    #[inline(never)]
    fn of(self, value: i64) -> i64 {
        let product = u128::from(value.unsigned_abs()) * u128::from(self.mantissa);
        let (upper, lower) = ((product >> 64) as u64, product as u64);
        // In halves, since shifts of 128 bits are long on a processor of 32. Half of a unit is the bit
        // below the last that stays.
        let (size, beyond, half) = match self.shift {
            0 => (lower, upper, 0),
            shift @ 1..64 => {
                let size = upper << 1 << (63 - shift) | lower >> shift;
                (size, upper >> shift, lower >> (shift - 1))
            }
            64 => (upper, 0, lower >> 63),
            shift => (upper >> (shift - 64), 0, upper >> (shift - 65)),
        };
        let size = size.saturating_add(half & 1);
        let size = match i64::try_from(size) {
            Ok(size) if beyond == 0 => size,
            _ => i64::MAX,
        };
        if value < 0 { -size } else { size }
    }
}

/// Bits that a rate gives away so that an i32 holds all there are: then a processor with an f32 unit is done
/// with it in a few instructions. The f32 keeps 24 of them, and no drive is told as many.
const VELOCITY_BITS: u32 = 13;
const ACCELERATION_BITS: u32 = 20;

const _: () = assert!(Velocity::LIMIT >> VELOCITY_BITS < i32::MAX as i64);
const _: () = assert!(Acceleration::LIMIT >> ACCELERATION_BITS < i32::MAX as i64);

/// A rate's upper bits; what is beyond every limit is cut.
fn upper(counts: i64, bits: u32) -> f32 {
    let upper = (counts >> bits).clamp(i32::MIN.into(), i32::MAX.into());
    upper as i32 as f32
}

/// How the drive's shaft goes with the axis's. Places are exact, rates are good to 2^-19 turn/s or 2^-24 of
/// themselves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    to_drive: Ratio,
    to_axis: Ratio,
    reversed: bool,
    offset: Position,
    /// Turns/s of the drive for the upper bits of a velocity of the axis.
    velocity: f32,
    /// Counts/s of the axis for a turn/s of the drive.
    axis_velocity: f32,
    /// Nm at the drive's shaft for the upper bits of an acceleration of the axis.
    torque: f32,
}

impl Scale {
    /// A scale between the axis's counts and the drive's units.
    ///
    /// `gear` is the turns of the drive's shaft in one of the axis, in steps of 10^-9; `units` how many
    /// of the drive's units make a turn of its shaft; `offset` where the axis is when the drive reads
    /// zero; `inertia` what the drive accelerates, in kg m^2 at the axis's shaft. All but the last two
    /// are at least 1.
    pub fn new(gear: u64, units: u64, reversed: bool, offset: Position, inertia: f32) -> Self {
        let drive = u128::from(gear) * u128::from(units);
        let axis = u128::from(UNIT_GEAR) * COUNTS_PER_TURN as u128;
        let direction = if reversed { -1.0 } else { 1.0 };
        let gear = direction * gear as i64 as f64 / UNIT_GEAR as f64;
        let turn = COUNTS_PER_TURN as f64;
        let velocity = gear * f64::from(1 << VELOCITY_BITS) / turn;
        let radians = f64::from(1 << ACCELERATION_BITS) * TAU / turn;
        Self {
            to_drive: Ratio::new(drive, axis),
            to_axis: Ratio::new(axis, drive),
            reversed,
            offset,
            velocity: velocity as f32,
            axis_velocity: (turn / gear) as f32,
            torque: (f64::from(inertia) * radians / gear) as f32,
        }
    }

    /// A place of the axis in the drive's units; at most half a unit off, and cut where it does not fit.
    pub fn position(&self, axis: Position) -> i64 {
        self.directed(self.to_drive.of((axis - self.offset).counts()))
    }

    /// A place of the drive on the axis.
    pub fn axis_position(&self, drive: i64) -> Position {
        Position::from_counts(self.directed(self.to_axis.of(drive))) + self.offset
    }

    /// A velocity of the axis in turns/s of the drive's shaft.
    pub fn velocity(&self, axis: Velocity) -> f32 {
        self.velocity * upper(axis.counts(), VELOCITY_BITS)
    }

    /// A velocity of the drive's shaft, in turns/s, on the axis.
    pub fn axis_velocity(&self, drive: f32) -> Velocity {
        Velocity::from_counts(whole(self.axis_velocity * drive))
    }

    /// What an acceleration of the axis takes at the drive's shaft, in Nm.
    pub fn torque(&self, axis: Acceleration) -> f32 {
        self.torque * upper(axis.counts(), ACCELERATION_BITS)
    }

    fn directed(&self, value: i64) -> i64 {
        if self.reversed {
            value.saturating_neg()
        } else {
            value
        }
    }
}

/// The whole part of a number: at the ends where it does not fit, and at the greater one where it is none, so
/// that nobody takes it for a place.
pub(super) fn whole(number: f32) -> i64 {
    // By its bits: a processor with an f32 unit has no instruction for 64 bits, and its library is slow.
    let bits = number.to_bits();
    let mantissa = i64::from(bits & 0x7F_FFFF | 0x80_0000);
    let shift = (bits >> 23 & 0xFF) as i32 - 127 - 23;
    let size = match shift {
        40.. => i64::MAX,
        0.. => mantissa << shift,
        -23.. => mantissa >> -shift,
        _ => 0,
    };
    if number < 0.0 { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TURN: i64 = COUNTS_PER_TURN;

    fn scale(gear: u64, units: u64) -> Scale {
        Scale::new(gear, units, false, Position::ZERO, 0.0)
    }

    #[test]
    fn whole_ratios_are_exact_both_ways() {
        for ratio in [1, 2, 6, 9, 64, 1000] {
            let scale = scale(ratio * UNIT_GEAR, TURN as u64);
            for counts in [0, 1, -1, 12_345_678_901, 1024 * TURN, -1024 * TURN] {
                let drive = scale.position(Position::from_counts(counts));
                assert_eq!(drive, counts * ratio as i64);
                assert_eq!(scale.axis_position(drive).counts(), counts);
            }
        }
    }

    #[test]
    fn direction_and_offset_are_at_the_axis() {
        let offset = Position::from_counts(TURN / 4);
        let scale = Scale::new(2 * UNIT_GEAR, 65_536, true, offset, 0.0);
        // A turn of the axis beyond the offset is two turns of the drive, the other way.
        let there = offset + Position::from_counts(TURN);
        assert_eq!(scale.position(there), -2 * 65_536);
        assert_eq!(scale.axis_position(-2 * 65_536), there);
        assert_eq!(scale.axis_position(0), offset);
        assert_eq!(scale.velocity(Velocity::from_counts(TURN)), -2.0);
        assert_eq!(scale.axis_velocity(-2.0).counts(), TURN);
    }

    #[test]
    fn torque_is_inertia_times_acceleration_behind_the_gear() {
        let scale = Scale::new(5 * UNIT_GEAR, 1 << 32, false, Position::ZERO, 0.02);
        let acceleration = Acceleration::from_radians(100.0).expect("in range");
        // 0.02 kg m^2 * 100 rad/s^2 / 5.
        assert!((scale.torque(acceleration) - 0.4).abs() < 1e-5);
        let reversed = Scale::new(5 * UNIT_GEAR, 1 << 32, true, Position::ZERO, 0.02);
        assert!((reversed.torque(acceleration) + 0.4).abs() < 1e-5);
    }

    #[test]
    fn nothing_overflows() {
        let scale = scale(1000 * UNIT_GEAR, 1 << 32);
        for counts in [i64::MAX, i64::MIN] {
            let cut = scale.position(Position::from_counts(counts));
            assert_eq!(cut, if counts < 0 { -i64::MAX } else { i64::MAX });
        }
        let small = Scale::new(1, 1, true, Position::from_counts(i64::MIN), 0.0);
        assert_eq!(
            small.position(Position::from_counts(i64::MAX)),
            0 - (i64::MAX as i128 / (1_000_000_000i128 << 32)) as i64
        );
        assert_eq!(small.axis_position(i64::MIN).counts(), -1);
    }

    #[test]
    fn rates_reach_from_the_least_to_the_limit() {
        let scale = scale(UNIT_GEAR, 1 << 32);
        for turns in [2.0f32.powi(-19), 1.0, 3.5, 2_048.0, -2_048.0] {
            let velocity = Velocity::from_counts((f64::from(turns) * TURN as f64) as i64);
            assert_eq!(scale.velocity(velocity), turns);
            assert_eq!(scale.axis_velocity(turns), velocity);
        }
        assert!(scale.velocity(Velocity::from_counts(i64::MIN)) < -2_048.0);
    }

    proptest! {
        #[test]
        fn the_whole_part_is_the_language_s_own(bits: u32) {
            let number = f32::from_bits(bits);
            let wanted = if number.is_nan() { i64::MAX } else { number as i64 };
            // The least number of 64 bits is one farther than the greatest.
            prop_assert_eq!(whole(number).abs(), wanted.saturating_abs());
            prop_assert!(number.is_nan() || whole(number).signum() == wanted.signum());
        }

        /// Against the same in 128 bits with a real division.
        #[test]
        fn a_place_is_the_nearest_of_the_exact_one(
            gear in 1_000_000..=1000 * UNIT_GEAR,
            units in 1u64..=1 << 26,
            turns in -1024.0..1024.0f64,
        ) {
            let counts = (turns * TURN as f64) as i64;
            let exact = i128::from(counts) * i128::from(gear) * i128::from(units);
            let one = i128::from(UNIT_GEAR) << 32;
            let got = i128::from(scale(gear, units).position(Position::from_counts(counts)));
            // Half a unit, and what 63 bits leave of up to 2^56 units.
            prop_assert!((got * one - exact).abs() <= one / 2 + one / 64, "{got}");
        }

        #[test]
        fn a_place_comes_back(
            gear in UNIT_GEAR..=1000 * UNIT_GEAR,
            counts in -1024 * TURN..1024 * TURN,
            offset in -1024 * TURN..1024 * TURN,
            reversed: bool,
        ) {
            let scale = Scale::new(gear, 1 << 32, reversed, Position::from_counts(offset), 0.0);
            let there = Position::from_counts(counts);
            let back = scale.axis_position(scale.position(there));
            prop_assert!((back - there).abs().counts() <= 1);
        }
    }
}
