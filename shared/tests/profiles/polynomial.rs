//! Polynomials between boundary values.

use super::check::{derivatives, limits, positive, signed, times};
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::error::ProfileError;
use canter_shared::motion::polynomial::{Cubic, Polynomial, Quintic, Septic};
use canter_shared::motion::trajectory::{Sample, Trajectory};
use proptest::prelude::*;

fn state() -> impl Strategy<Value = Sample> {
    let rate = || prop_oneof![signed(-3.0..3.0), Just(0.0)];
    (signed(-6.0..6.0), rate(), rate(), rate()).prop_map(
        |(position, velocity, acceleration, jerk)| Sample {
            position,
            velocity,
            acceleration,
            jerk,
        },
    )
}

fn bounds() -> impl Strategy<Value = Bounds> {
    (
        positive(-1.0..3.0),
        positive(-1.0..3.0),
        positive(-1.0..3.0),
        positive(-1.0..4.0),
    )
        .prop_map(|(velocity, acceleration, deceleration, jerk)| {
            Bounds::new(velocity, acceleration, deceleration, jerk).expect("valid")
        })
}

/// Positions that a polynomial passes are of this size.
fn scale(from: &Sample, to: &Sample, duration: f64) -> f64 {
    let of = |sample: &Sample| {
        sample.position.abs()
            + (sample.velocity * duration).abs()
            + (sample.acceleration * duration.powi(2)).abs()
            + (sample.jerk * duration.powi(3)).abs()
    };
    of(from) + of(to)
}

/// Boundary values, peaks, derivatives, and coefficients that tell the same.
fn check<const N: usize>(
    polynomial: &Polynomial<N>,
    from: Sample,
    to: Sample,
) -> Result<(), TestCaseError> {
    let duration = polynomial.duration();
    let scale = scale(&from, &to, duration);
    for (time, want) in [(0.0, from), (duration, to)] {
        let got = polynomial.at(time);
        prop_assert_eq!((got.position, got.velocity), (want.position, want.velocity));
        let near = |got: f64, want: f64| (got - want).abs() <= 1e-14 * want.abs();
        prop_assert!(
            N < 6 || near(got.acceleration, want.acceleration),
            "{got:?} {want:?}"
        );
        prop_assert!(N < 8 || near(got.jerk, want.jerk), "{got:?} {want:?}");
    }
    limits(polynomial, f64::MAX, f64::MAX, f64::INFINITY)?;
    derivatives(polynomial, 30.0 * scale, 100.0 * scale)?;
    for time in times(polynomial) {
        let got = polynomial.at(time).position;
        let coefficients = polynomial.coefficients();
        let want = coefficients
            .iter()
            .rev()
            .fold(0.0, |sum, coefficient| sum * time + coefficient);
        prop_assert!(
            (got - want).abs() <= 1e-12 * scale,
            "{got} {want} at {time}"
        );
    }
    // Peaks are reached: some sample is near each.
    let peaks = polynomial.peaks();
    let seen = (0..=2_000).map(|place| polynomial.at(duration * f64::from(place) / 2_000.0));
    let fastest = seen.map(|at| at.velocity.abs()).fold(0.0, f64::max);
    prop_assert!(fastest >= 0.999 * peaks.velocity, "{fastest}: {peaks:?}");
    Ok(())
}

fn reversed(sample: Sample) -> Sample {
    Sample {
        velocity: -sample.velocity,
        jerk: -sample.jerk,
        ..sample
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn through_boundary_values(from in state(), to in state(), duration in positive(-3.0..3.0)) {
        check(&Cubic::new(from, to, duration).expect("valid"), from, to)?;
        check(&Quintic::new(from, to, duration).expect("valid"), from, to)?;
        check(&Septic::new(from, to, duration).expect("valid"), from, to)?;
    }

    /// Run backwards every bit is the same, because each half is seen from its own end.
    #[test]
    fn backwards(from in state(), to in state(), duration in positive(-3.0..3.0)) {
        let one = Septic::new(from, to, duration).expect("valid");
        let two = Septic::new(reversed(to), reversed(from), duration).expect("valid");
        let rounding = 1e-13 * scale(&from, &to, duration);
        for time in times(&one) {
            let (one, two) = (one.at(time), two.at(duration - time));
            prop_assert!((one.position - two.position).abs() <= rounding);
            prop_assert!((one.velocity + two.velocity).abs() * duration <= 10.0 * rounding);
        }
    }

    #[test]
    fn from_rest_within_limits(from in signed(-3.0..3.0), range in signed(-9.0..9.0), bounds in bounds()) {
        let (from, to) = (Sample::at_rest(from), Sample::at_rest(from + range));
        let (velocity, acceleration) = (bounds.velocity(), bounds.slower_acceleration());
        let full = |peaks: canter_shared::motion::trajectory::Peaks| {
            (peaks.velocity / velocity).max(peaks.acceleration / acceleration)
        };
        let cubic = Cubic::within(from, to, &bounds).expect("valid");
        limits(&cubic, velocity, acceleration, f64::INFINITY)?;
        prop_assert!(full(cubic.peaks()) >= 1.0 - 1e-9);
        for (peaks, checked) in [
            {
                let quintic = Quintic::within(from, to, &bounds).expect("valid");
                (quintic.peaks(), limits(&quintic, velocity, acceleration, bounds.jerk()))
            },
            {
                let septic = Septic::within(from, to, &bounds).expect("valid");
                (septic.peaks(), limits(&septic, velocity, acceleration, bounds.jerk()))
            },
        ] {
            checked?;
            // The closed forms are the peaks that the roots find, and leave nothing.
            prop_assert!(full(peaks).max(peaks.jerk / bounds.jerk()) >= 1.0 - 1e-9);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    /// The search finds a duration that keeps the limits, of which a little less does not.
    #[test]
    fn from_a_state_within_limits(
        range in signed(-3.0..3.0),
        v0 in -1.0..1.0f64,
        v1 in -1.0..1.0f64,
        a0 in -1.0..1.0f64,
        bounds in bounds(),
    ) {
        let (velocity, acceleration) = (bounds.velocity(), bounds.slower_acceleration());
        let from = Sample { acceleration: a0 * acceleration, ..Sample::coasting(1.0, v0 * velocity) };
        let to = Sample::coasting(1.0 + range, v1 * velocity);
        match Quintic::within(from, to, &bounds) {
            Ok(quintic) => {
                limits(&quintic, velocity, acceleration, bounds.jerk())?;
                let shorter = Quintic::new(from, to, 0.999_999 * quintic.duration()).expect("valid");
                let peaks = shorter.peaks();
                let full = (peaks.velocity / velocity)
                    .max(peaks.acceleration / acceleration)
                    .max(peaks.jerk / bounds.jerk());
                prop_assert!(full > 1.0, "{peaks:?} within {bounds:?}");
            }
            Err(ProfileError::Value { field, value, minimum, .. }) => {
                prop_assert!(field.ends_with("limit") && minimum > value);
                // No duration of a fine grid does.
                for step in 0..400 {
                    let duration = 10f64.powf(-4.0 + f64::from(step) * 0.02);
                    let peaks = Quintic::new(from, to, duration).expect("valid").peaks();
                    prop_assert!(
                        peaks.velocity > velocity
                            || peaks.acceleration > acceleration
                            || peaks.jerk > bounds.jerk(),
                        "{duration} does"
                    );
                }
            }
            Err(other) => return Err(TestCaseError::fail(format!("{other}"))),
        }
    }
}

/// A straight line is the one way to move at the limit all the time.
#[test]
fn a_cruise_at_the_limit() {
    let bounds = Bounds::new(2.0, 1.0, 1.0, 1.0).expect("valid");
    let (from, to) = (Sample::coasting(0.0, 2.0), Sample::coasting(5.0, 2.0));
    let cruise = Quintic::within(from, to, &bounds).expect("valid");
    assert_eq!(cruise.duration(), 2.5);
    // Too fast for the limits, and the error says which.
    let error = Quintic::within(Sample::coasting(0.0, 3.0), to, &bounds).expect_err("too fast");
    let want = ProfileError::Value {
        field: "velocity limit",
        value: 2.0,
        minimum: 3.0,
        maximum: 1e15,
    };
    assert_eq!(error, want);
}

/// The peaks of the table: 3/2 and 6; 15/8, 10/sqrt(3) and 60; 35/16, 84/(5 sqrt(5)) and 105/2.
#[test]
fn peaks_from_rest_to_rest() {
    let (from, to) = (Sample::at_rest(0.0), Sample::at_rest(1.0));
    let near = |got: f64, want: f64| assert!((got - want).abs() <= 1e-14 * want, "{got} {want}");
    let cubic = Cubic::new(from, to, 1.0).expect("valid").peaks();
    near(cubic.velocity, 1.5);
    near(cubic.acceleration, 6.0);
    assert_eq!(cubic.jerk, f64::INFINITY);
    let quintic = Quintic::new(from, to, 1.0).expect("valid").peaks();
    near(quintic.velocity, 1.875);
    near(quintic.acceleration, 10.0 / 3f64.sqrt());
    near(quintic.jerk, 60.0);
    let septic = Septic::new(from, to, 1.0).expect("valid").peaks();
    near(septic.velocity, 2.1875);
    near(septic.acceleration, 84.0 / (5.0 * 5f64.sqrt()));
    near(septic.jerk, 52.5);
}
