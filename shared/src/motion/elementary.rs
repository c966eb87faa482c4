//! Cube root, sine and exponential in f64, for the few places of a device that need them.
//!
//! `libm` has them to the last digit and for any argument, which takes 10 KiB of flash on
//! a processor without f64. Here they are right to some units of 2^-52 and for the arguments that
//! come up, in the same bits on every machine.

/// 1/1!, -1/3!, 1/5! ...: for a right angle the next term would be below 2^-51.
const SINE: [f64; 10] = {
    let mut coefficients = [1.0; 10];
    let mut place = 1;
    while place < coefficients.len() {
        let odd = 2.0 * place as f64 + 1.0;
        coefficients[place] = -coefficients[place - 1] / (odd * (odd - 1.0));
        place += 1;
    }
    coefficients
};

/// 1/0!, 1/1!, 1/2! ...: for one quarter the next term would be below 2^-52.
const EXPONENTIAL: [f64; 12] = {
    let mut coefficients = [1.0; 12];
    let mut place = 1;
    while place < coefficients.len() {
        coefficients[place] = coefficients[place - 1] / place as f64;
        place += 1;
    }
    coefficients
};

/// The polynomial with these coefficients, from the constant one up.
#[inline(never)]
fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    let highest_first = coefficients.iter().rev();
    highest_first.fold(0.0, |sum, coefficient| sum * x + coefficient)
}

/// The sine of an angle from zero to a right one, in rad.
pub(super) fn sine(angle: f64) -> f64 {
    angle * polynomial(&SINE, angle * angle)
}

/// e^x, for x from -2 to 2.
pub(super) fn exponential(x: f64) -> f64 {
    let eighth = polynomial(&EXPONENTIAL, x * 0.125);
    let quarter = eighth * eighth;
    let half = quarter * quarter;
    half * half
}

/// The cube root of zero, or of a number from 1e-300 to 1e300.
#[inline(never)]
pub(super) fn cube_root(value: f64) -> f64 {
    /// A third of the exponent's bias is to stay, and what spreads the error evenly (W. Kahan): it is
    /// then below 4 %.
    const BIAS: u32 = 715_094_163;
    if value <= 0.0 {
        return 0.0;
    }
    let upper = (value.to_bits() >> 32) as u32;
    let mut root = f64::from_bits(u64::from(upper / 3 + BIAS) << 32);
    // Each of Halley's steps leaves two thirds of the error's third power.
    for _ in 0..3 {
        let cube = root * root * root;
        root *= (cube + value + value) / (cube + cube + value);
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::FRAC_PI_2;
    use proptest::prelude::*;

    #[track_caller]
    fn near(got: f64, exact: f64) {
        let error = (got - exact).abs();
        assert!(error <= 16.0 * f64::EPSILON * exact, "{got} {exact}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn all_are_right_to_some_units(angle in 0.0..=FRAC_PI_2, x in -2.0..=2.0f64, power in -300.0..300.0f64) {
            near(sine(angle), libm::sin(angle));
            near(exponential(x), libm::exp(x));
            let value = libm::exp10(power);
            near(cube_root(value), libm::cbrt(value));
        }
    }

    #[test]
    fn edges() {
        assert_eq!(sine(0.0), 0.0);
        near(sine(FRAC_PI_2), 1.0);
        assert_eq!(exponential(0.0), 1.0);
        near(exponential(-2.0), libm::exp(-2.0));
        assert_eq!(cube_root(0.0), 0.0);
        near(cube_root(1e-300), 1e-100);
        near(cube_root(1e300), 1e100);
    }
}
