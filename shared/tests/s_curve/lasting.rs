//! Motions that last as long as asked.

use super::random::{any_case, hangs_together, inside_case, keeps};
use canter_shared::motion::error::ProfileError;
use canter_shared::motion::s_curve::{lasting, time_optimal};
use canter_shared::motion::trajectory::{Sample, Trajectory};
use proptest::prelude::*;

/// How much longer than the shortest.
fn longer() -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(0.0),
        (-12.0..-1.0f64).prop_map(|power| 10f64.powf(power)),
        0.0..3.0f64,
        3.0..100.0f64,
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    #[test]
    fn keep_their_limits_and_end_exactly((bounds, from, to) in inside_case(), longer in longer()) {
        let rest = Sample::at_rest(to.position);
        let shortest = time_optimal(from, rest, &bounds).expect("a valid case").duration();
        let duration = shortest * (1.0 + longer);
        let curve = lasting(from, to.position, duration, &bounds).expect("long enough");
        prop_assert!((curve.duration() - duration).abs() <= 1e-11 * duration, "{} {duration}", curve.duration());
        hangs_together(&curve, from, rest)?;
        keeps(&curve, &bounds)?;
    }

    #[test]
    fn come_from_anywhere((bounds, from, to) in any_case(), longer in longer()) {
        let rest = Sample::at_rest(to.position);
        let shortest = time_optimal(from, rest, &bounds).expect("a valid case").duration();
        let duration = shortest * (1.0 + longer);
        let curve = lasting(from, to.position, duration, &bounds).expect("long enough");
        prop_assert!((curve.duration() - duration).abs() <= 1e-11 * duration, "{} {duration}", curve.duration());
        hangs_together(&curve, from, rest)?;
    }

    #[test]
    fn say_the_shortest((bounds, from, to) in any_case(), part in 0.0..0.999f64) {
        let rest = Sample::at_rest(to.position);
        let shortest = time_optimal(from, rest, &bounds).expect("a valid case").duration();
        prop_assume!(shortest > 0.0);
        let refused = lasting(from, to.position, part * shortest, &bounds);
        let Err(ProfileError::TooShort { shortest: told, .. }) = refused else {
            return Err(TestCaseError::fail(format!("{refused:?}")));
        };
        prop_assert!((told - shortest).abs() <= 1e-11 * shortest, "{told} {shortest}");
        prop_assert!(lasting(from, to.position, told, &bounds).is_ok());
    }

    /// From rest they cruise slower, and otherwise use what the limits allow.
    #[test]
    fn from_rest_only_the_velocity_is_lower((bounds, _from, to) in inside_case(), longer in longer()) {
        let (from, rest) = (Sample::at_rest(0.0), Sample::at_rest(to.position));
        let shortest = time_optimal(from, rest, &bounds).expect("a valid case").duration();
        let curve = lasting(from, to.position, shortest * (1.0 + longer), &bounds).expect("long enough");
        for piece in curve.segments() {
            let jerk = piece.entry.jerk.abs();
            prop_assert!(jerk == 0.0 || (jerk - bounds.jerk()).abs() <= 1e-12 * jerk, "{piece:?}");
        }
        prop_assert!(curve.segments().len() <= 7);
    }
}
