//! Whatever bits the numbers have: an error or a motion that ends as asked, and never a panic.

use super::random::signed;
use canter_shared::motion::bounds::{Bounds, LARGEST, SMALLEST};
use canter_shared::motion::error::ProfileError;
use canter_shared::motion::s_curve::{
    SignedBounds, change_velocity, lasting, plan, time_optimal, to_rest,
};
use canter_shared::motion::segments::Segments;
use canter_shared::motion::trajectory::{Sample, Trajectory};
use proptest::prelude::*;

/// Any of the 2^64.
fn bits() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        any::<f64>(),
        any_number()
    ]
}

/// A number that may be accepted.
fn any_number() -> impl Strategy<Value = f64> {
    signed(-18.0, 15.0)
}

fn limit() -> impl Strategy<Value = f64> {
    (-15.0..15.0f64).prop_map(|power| 10f64.powf(power).clamp(SMALLEST, LARGEST))
}

fn sample<S: Strategy<Value = f64>>(number: impl Fn() -> S) -> impl Strategy<Value = Sample> {
    [(); 4]
        .map(|()| number())
        .prop_map(|[position, velocity, acceleration, jerk]| Sample {
            position,
            velocity,
            acceleration,
            jerk,
        })
}

fn sound(
    curve: Result<Segments, ProfileError>,
    to: Sample,
    time: f64,
) -> Result<(), TestCaseError> {
    let Ok(curve) = curve else {
        return Ok(());
    };
    prop_assert!(
        curve.duration() >= 0.0 && curve.duration().is_finite(),
        "{curve:?}"
    );
    let end = curve.at(curve.duration());
    prop_assert_eq!((end.position, end.velocity), (to.position, to.velocity));
    let _at_any_time = curve.at(time);
    for part in [0.0, 0.1, 0.5, 0.9] {
        let at = curve.at(part * curve.duration());
        prop_assert!(
            at.position.is_finite() && at.velocity.is_finite(),
            "{at:?} {curve:?}"
        );
    }
    Ok(())
}

fn all(bounds: &SignedBounds, from: Sample, to: Sample, time: f64) -> Result<(), TestCaseError> {
    let rest = Sample::at_rest(to.position);
    sound(time_optimal(from, to, bounds), to, time)?;
    sound(to_rest(from, to.position, bounds), rest, time)?;
    sound(lasting(from, to.position, time, bounds), rest, time)?;
    if let Ok(curve) = change_velocity(from, to.velocity, bounds) {
        sound(
            Ok(curve.clone()),
            Sample::coasting(curve.end().position, to.velocity),
            time,
        )?;
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    #[test]
    fn any_bits_are_an_error_or_a_motion(
        limits in [(); 5].map(|()| bits()), from in sample(bits), to in sample(bits), time in bits(),
    ) {
        let [a, b, c, d, e] = limits;
        if let Ok(bounds) = SignedBounds::new(a, b, c, d, e) {
            all(&bounds, from, to, time)?;
        }
        if let Ok(bounds) = Bounds::new(a, b, c, d) {
            sound(plan(from, to, &bounds), to, time)?;
        }
    }

    #[test]
    fn any_state_is_an_error_or_a_motion(
        limits in [(); 5].map(|()| limit()), from in sample(bits), to in sample(bits), time in bits(),
    ) {
        let [a, b, c, d, e] = limits;
        let bounds = SignedBounds::new(a, -b, c, -d, e).expect("in range");
        all(&bounds, from, to, time)?;
    }

    /// Numbers of all sizes that are accepted.
    #[test]
    fn any_valid_state_is_a_motion(
        limits in [(); 5].map(|()| limit()), from in sample(any_number), to in sample(any_number), time in limit(),
    ) {
        let [a, b, c, d, e] = limits;
        let bounds = SignedBounds::new(a, -b, c, -d, e).expect("in range");
        let to = Sample { velocity: to.velocity.clamp(-b, a), ..to };
        prop_assert!(time_optimal(from, to, &bounds).is_ok());
        prop_assert!(to_rest(from, to.position, &bounds).is_ok());
        prop_assert!(change_velocity(from, to.velocity, &bounds).is_ok());
        all(&bounds, from, to, time)?;
    }
}

#[test]
fn an_error_names_what_is_wrong() {
    let bounds = SignedBounds::new(1.0, -2.0, 1.0, -1.0, 1.0).expect("valid");
    let fields = |from: Sample, to: Sample| match time_optimal(from, to, &bounds) {
        Err(ProfileError::Value {
            field,
            minimum,
            maximum,
            ..
        }) => (field, minimum, maximum),
        other => panic!("{other:?}"),
    };
    let rest = Sample::at_rest(0.0);
    let nan = f64::NAN;
    assert_eq!(fields(Sample::at_rest(nan), rest).0, "start");
    assert_eq!(
        fields(rest, Sample::at_rest(1e16)),
        ("target", -LARGEST, LARGEST)
    );
    assert_eq!(fields(Sample::coasting(0.0, nan), rest).0, "start velocity");
    let pushed = Sample {
        acceleration: f64::INFINITY,
        ..rest
    };
    assert_eq!(fields(pushed, rest).0, "start acceleration");
    assert_eq!(
        fields(rest, Sample::coasting(0.0, 1.5)),
        ("stop velocity", -2.0, 1.0)
    );

    let endless = Bounds::new(1.0, 1.0, 1.0, f64::INFINITY).expect("a trapezoid's");
    for refused in [
        SignedBounds::forward(&endless),
        SignedBounds::backward(&endless),
    ] {
        let Err(ProfileError::Value {
            field,
            minimum,
            maximum,
            ..
        }) = refused
        else {
            panic!("{refused:?}");
        };
        assert_eq!((field, minimum, maximum), ("jerk limit", SMALLEST, LARGEST));
    }
    for limits in [
        [-1.0, -1.0, 1.0, -1.0, 1.0],
        [1.0, 1.0, 1.0, -1.0, 1.0],
        [1.0, -1.0, nan, -1.0, 1.0],
        [1.0, -1.0, 1.0, 0.0, 1.0],
        [1.0, -1.0, 1.0, -1.0, f64::INFINITY],
    ] {
        let [a, b, c, d, e] = limits;
        assert!(SignedBounds::new(a, b, c, d, e).is_err(), "{limits:?}");
    }
}
