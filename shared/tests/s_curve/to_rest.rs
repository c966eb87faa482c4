//! To rest without a dip.

use super::random::{any_case, hangs_together, inside_case, too_fast};
use canter_shared::motion::s_curve::{SignedBounds, change_velocity, time_optimal, to_rest};
use canter_shared::motion::segments::Segments;
use canter_shared::motion::trajectory::{Sample, Trajectory};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    #[test]
fn ends_exactly((bounds, from, to) in any_case()) {
        let curve = to_rest(from, to.position, &bounds).expect("a valid case");
        hangs_together(&curve, from, Sample::at_rest(to.position))?;
    }

    #[test]
    fn is_the_quickest_from_inside((bounds, from, to) in inside_case()) {
        let rest = Sample::at_rest(to.position);
        // A little inside, for the rounding at the limits themselves.
        let from = Sample {
            velocity: from.velocity * 0.999,
            acceleration: from.acceleration * 0.999,
            ..from
        };
        prop_assert_eq!(to_rest(from, to.position, &bounds), time_optimal(from, rest, &bounds));
    }

    /// A target far ahead: down to the limit, along it, and down to rest.
    #[test]
    fn never_comes_below_the_limit_before_it_must(
        (bounds, from) in too_fast(), far in 0.0..5.0f64,
    ) {
        let limit = bounds.velocity_max();
        let near = distance_over_the_limit(from, &bounds);
        let target = near * (1.0 + 1e-9 + far);
        let curve = to_rest(from, target, &bounds).expect("a valid case");
        never_rises_again(&curve, &bounds)?;
        // What passes the limit downwards is the last braking.
        let stop = change_velocity(Sample::coasting(0.0, limit), 0.0, &bounds).expect("valid");
        let braking = curve.duration() - stop.duration();
        for piece in curve.segments() {
            prop_assert!(
                piece.entry.velocity >= limit * (1.0 - 1e-9) || piece.start >= braking * (1.0 - 1e-9),
                "{piece:?} {curve:?}"
            );
        }
        let dips = time_optimal(from, Sample::at_rest(target), &bounds).expect("a valid case");
        prop_assert!(curve.duration() <= dips.duration() * (1.0 + 1e-9), "{curve:?} {dips:?}");
    }

    /// A target too near for that: the velocity still never rises again once it falls.
    #[test]
    fn never_speeds_up_again_on_the_way_down(
        (bounds, from) in too_fast(), part in 0.01..1.0f64,
    ) {
        let stop = change_velocity(from, 0.0, &bounds).expect("valid");
        let least = stop.end().position;
        let most = distance_over_the_limit(from, &bounds);
        prop_assume!(least < most);
        let target = least + (most - least) * part;
        let curve = to_rest(from, target, &bounds).expect("a valid case");
        never_rises_again(&curve, &bounds)?;
    }
}

/// Once the velocity falls it never rises.
fn never_rises_again(curve: &Segments, bounds: &SignedBounds) -> Result<(), TestCaseError> {
    let strongest = bounds.acceleration_max();
    let mut falls = false;
    for piece in curve.segments() {
        for at in [piece.entry, piece.entry.after(piece.duration)] {
            falls |= at.acceleration < -1e-9 * strongest;
            prop_assert!(
                !falls || at.acceleration <= 1e-9 * strongest,
                "{piece:?} {curve:?}"
            );
        }
    }
    Ok(())
}

/// From `from` down to the velocity limit and from there to rest.
fn distance_over_the_limit(from: Sample, bounds: &SignedBounds) -> f64 {
    let change = |from, velocity| change_velocity(from, velocity, bounds).expect("valid");
    let limited = change(from, bounds.velocity_max()).end();
    change(limited, 0.0).end().position
}
