//! Fixed-point arithmetic for the tick: multiplication and square root on 64-bit fractions.
//!
//! A fraction is a `u64` in Q64: the value is the integer times 2^-64. Everything is built from
//! 32 x 32 -> 64 bit products, which a Cortex-M4 does in one instruction, and from f32 additions
//! and multiplications, which IEEE 754 fixes to the bit; so every machine gets the same results.

/// 1 - 2^-64: as near to one as a Q64 fraction gets.
pub(crate) const ALMOST_ONE: u64 = u64::MAX;

/// `a * b` of two Q64 fractions; at most 3 units of 2^-64 below the exact product, never above.
///
/// The product of the low halves is left out: it can only change the last place.
#[inline(always)]
pub(crate) const fn multiply(a: u64, b: u64) -> u64 {
    let (a_high, a_low) = (a >> 32, a & 0xFFFF_FFFF);
    let (b_high, b_low) = (b >> 32, b & 0xFFFF_FFFF);
    a_high * b_high + ((a_high * b_low) >> 32) + ((a_low * b_high) >> 32)
}

/// `value * fraction` for a signed value; at most 3 below the exact product, never above.
#[inline(always)]
pub(crate) const fn scale(value: i64, fraction: u64) -> i64 {
    let (value_high, value_low) = (value >> 32, value & 0xFFFF_FFFF);
    let (high, low) = ((fraction >> 32) as i64, (fraction & 0xFFFF_FFFF) as i64);
    // |value_high| <= 2^31 and the others are below 2^32: no product leaves an i64, but the last
    // one can pass its sign bit, so it is taken without a sign.
    value_high * high
        + ((value_high * low) >> 32)
        + ((value_low as u64).wrapping_mul(high as u64) >> 32) as i64
}

/// The square root of a Q64 fraction from 2^-22 to one half; the error is below 2^-44 of the root
/// from 2^-8 up, and below 2^-32 for less. Less than 2^-22 gives something small.
///
/// The f32 of its upper half needs no shift to bring it into range, and gives 24 bits from 2^-8 up;
/// one step of Newton's doubles that.
#[inline(always)]
pub(crate) fn square_root(value: u64) -> u64 {
    // The upper half is the value in units of 2^-32, so its root is in units of 2^-16.
    let upper = (value >> 32) as u32 as f32;
    let reciprocal = reciprocal_root(upper);
    let root = (upper * reciprocal * (1u32 << 16) as f32) as u32;
    // The remainder is below 2^42 in magnitude: 11 bits fewer and it fits an i32.
    let square = u64::from(root) * u64::from(root);
    let remainder = ((value.wrapping_sub(square) as i64) >> 11) as i32;
    // Over twice the root, as a Q52: below 2^-22, for the smallest values.
    let correction = (remainder as f32 * reciprocal * (1u32 << 14) as f32) as i32;
    (u64::from(root) << 32).wrapping_add_signed(i64::from(correction) << 12)
}

/// 2^127 / `value` for a value from 2^63 up: at most 2^-58 of it too small, never too large.
///
/// An f32 gives 23 bits, and each Newton step doubles them.
#[inline(always)]
pub(crate) fn reciprocal(value: u64) -> u64 {
    let approximate = (value >> 40) as u32 as f32 * (1.0 / (1u32 << 24) as f32);
    // Q31 in (1, 2]; two saturates to a little less.
    let guess = (1.0 / approximate * (1u32 << 31) as f32) as u32;
    let mut reciprocal = u64::from(guess) << 32;
    for _ in 0..2 {
        let error = (1i64 << 62) - (multiply(value, reciprocal) >> 1) as i64;
        reciprocal = reciprocal.saturating_add_signed(scale(error, reciprocal) << 2);
    }
    // The products err by a few places of 2^-64 each.
    reciprocal - 32
}

/// The square root of a positive normal f32, with a relative error below 2^-21.
#[inline(always)]
pub(crate) fn square_root_f32(value: f32) -> f32 {
    value * reciprocal_root(value)
}

/// The reciprocal root of a positive normal f32 to about 24 bits: from its bits, and three Newton
/// steps.
#[inline(always)]
fn reciprocal_root(value: f32) -> f32 {
    let half = value * 0.5;
    // The exponent's half, negated, with the constant that spreads the error evenly.
    let mut reciprocal = f32::from_bits(0x5F37_59DF_u32.wrapping_sub(value.to_bits() >> 1));
    reciprocal = reciprocal * (1.5 - half * reciprocal * reciprocal);
    reciprocal = reciprocal * (1.5 - half * reciprocal * reciprocal);
    reciprocal * (1.5 - half * reciprocal * reciprocal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn products_are_within_three_units(a: u64, b: u64, value: i64) {
            let exact = ((u128::from(a) * u128::from(b)) >> 64) as u64;
            prop_assert!(exact - multiply(a, b) <= 3);
            let exact = ((i128::from(value) * i128::from(b)) >> 64) as i64;
            prop_assert!((0..=3).contains(&(exact - scale(value, b))));
        }

        #[test]
        fn root_is_within_its_error(value in 1u64 << 42..=1 << 63, shift in 0u32..22) {
            assert_root((value >> shift).max(1 << 42));
        }
    }

    proptest! {
        #[test]
        fn reciprocal_is_just_below(value in 1u64 << 63..) {
            let exact = (1u128 << 127) / u128::from(value);
            let got = u128::from(reciprocal(value));
            prop_assert!(got <= exact && exact - got <= 1 << 6, "{value}: {got} {exact}");
        }

        #[test]
        fn f32_root_is_within_its_relative_error(value in 1e-30..4.0f32) {
            let root = f64::from(square_root_f32(value));
            let exact = libm::sqrt(f64::from(value));
            prop_assert!((root - exact).abs() <= exact / f64::from(1 << 21), "{value}: {root}");
        }
    }

    #[track_caller]
    fn assert_root(value: u64) {
        const ONE: f64 = 18_446_744_073_709_551_616.0;
        let (value, root) = (value as f64 / ONE, square_root(value) as f64 / ONE);
        let exact = libm::sqrt(value);
        let error = (root - exact).abs();
        let allowed = if value >= 1.0 / 256.0 {
            exact / (1u64 << 44) as f64
        } else {
            1.0 / (1u64 << 32) as f64
        };
        assert!(error <= allowed, "{value}: {root} {exact} {error:e}");
    }

    #[test]
    fn edges() {
        for value in [
            1 << 42,
            (1 << 42) + 1,
            1 << 62,
            (1 << 62) - 1,
            1 << 63,
            (1 << 63) - 1,
        ] {
            assert_root(value);
        }
        for value in [0, 1, 2, (1 << 32) - 1, 1 << 32, (1 << 42) - 1] {
            assert!(square_root(value) < 1 << 54, "{value}");
        }
        for value in [1 << 63, (1 << 63) + 1, u64::MAX, u64::MAX - 1] {
            let exact = (1u128 << 127) / u128::from(value);
            let got = u128::from(reciprocal(value));
            assert!(
                got <= exact && exact - got <= 1 << 6,
                "{value}: {got} {exact}"
            );
        }
        assert_eq!(scale(i64::MIN, ALMOST_ONE), i64::MIN);
        assert_eq!(scale(i64::MIN, 0), 0);
    }
}
