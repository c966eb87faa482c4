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

/// The square root of a Q64 fraction, with a relative error below 2^-43.
///
/// A first guess of the reciprocal root comes from the f32's bits and three Newton steps in f32
/// (24 bits); one more step in integers doubles that.
#[inline(always)]
pub(crate) fn square_root(value: u64) -> u64 {
    if value == 0 {
        return 0;
    }
    // An even shift brings the value into [1/4, 1) and comes out of the root halved.
    let shift = value.leading_zeros() & !1;
    let normal = value << shift;
    let approximate = (normal >> 40) as u32 as f32 * (1.0 / (1u32 << 24) as f32);
    let reciprocal = reciprocal_root(approximate);
    // Q30; it lies in (1, 2], so it fits 32 bits.
    let reciprocal = (reciprocal * (1u32 << 30) as f32) as u32;
    let root = (((normal >> 32) * reciprocal as u64) >> 30).min(0xFFFF_FFFF);
    // The remainder is below 2^43 in magnitude: 12 bits fewer and it fits an i32.
    let remainder = (normal as i64).wrapping_sub((root * root) as i64) >> 12;
    let correction = (remainder * reciprocal as i64) >> (30 + 1 - 12);
    ((root << 32).saturating_add_signed(correction)) >> (shift / 2)
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
        fn root_is_within_its_relative_error(value: u64, shift in 0u32..64) {
            let value = value >> shift;
            let root = square_root(value) as f64;
            let exact = libm::sqrt(value as f64) * 4_294_967_296.0;
            // The last bit of the shifted result counts as well where the value is small.
            prop_assert!((root - exact).abs() <= exact * 1.14e-13 + 1.0, "{value}: {root} {exact}");
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

    #[test]
    fn edges() {
        for value in [
            0,
            1,
            2,
            3,
            u64::MAX,
            u64::MAX - 1,
            1 << 63,
            1 << 62,
            (1 << 63) - 1,
        ] {
            let root = square_root(value) as f64;
            let exact = libm::sqrt(value as f64) * 4_294_967_296.0;
            assert!(
                (root - exact).abs() <= exact * 1.14e-13 + 1.0,
                "{value}: {root} {exact}"
            );
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
