//! Time-optimal motions: exact, inside the limits, and nothing else is quicker.

use super::random::{
    any_case, bounds, hangs_together, inside, inside_case, keeps, scale, velocity,
};
use canter_shared::motion::s_curve::{SignedBounds, change_velocity, time_optimal};
use canter_shared::motion::trajectory::{Sample, Trajectory};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    #[test]
    fn keep_their_limits_and_end_exactly((bounds, from, to) in inside_case()) {
        let curve = time_optimal(from, to, &bounds).expect("a valid case");
        hangs_together(&curve, from, to)?;
        keeps(&curve, &bounds)?;
    }

    #[test]
    fn come_back_inside_the_limits_and_stay((bounds, from, to) in any_case()) {
        let curve = time_optimal(from, to, &bounds).expect("a valid case");
        hangs_together(&curve, from, to)?;
        // Where the velocity limit has been kept once, with what its release still adds, it is
        // kept from there on.
        let jerk = bounds.jerk();
        let inside = |at: &Sample| {
            let release = at.acceleration * at.acceleration.abs() / (2.0 * jerk);
            let (low, high) = (bounds.velocity_min(), bounds.velocity_max());
            let range = low * (1.0 + 1e-6)..=high * (1.0 + 1e-6);
            range.contains(&at.velocity) && range.contains(&(at.velocity + release))
                && at.acceleration <= bounds.acceleration_max() * (1.0 + 1e-6)
                && at.acceleration >= bounds.acceleration_min() * (1.0 + 1e-6)
        };
        let mut kept = false;
        for piece in curve.segments() {
            let now = inside(&piece.entry);
            prop_assert!(now || !kept, "{piece:?} {curve:?}");
            kept = now;
        }
    }

    /// Bellman's principle: what is left of the quickest way is the quickest way from there.
    ///
    /// To rest: a state on the way to a target with a velocity may by its last digit be too near
    /// to it, which asks for a whole loop.
    #[test]
    fn are_the_same_when_planned_again_under_way(
        (bounds, from, to) in inside_case(), part in 0.0..1.0f64,
    ) {
        let to = Sample::at_rest(to.position);
        let curve = time_optimal(from, to, &bounds).expect("a valid case");
        let passed = curve.duration() * part;
        let again = time_optimal(curve.at(passed), to, &bounds).expect("still valid");
        let left = curve.duration() - passed;
        // While the acceleration is released at the end, the way that is left is the cube of the time
        // that is left: what rounds off a position, 1e-16 of it, is worth 5e-6 of the time.
        let slack = 2e-5 * curve.duration();
        prop_assert!(again.duration() <= left + slack, "{} {left} {curve:?} {again:?}", again.duration());
        prop_assert!(again.duration() >= left - slack, "{} {left} {curve:?} {again:?}", again.duration());
    }

    /// Any other way that keeps the limits, made of changes of velocity and cruises, takes longer.
    #[test]
    fn are_never_longer_than_another_way(
        (bounds, from, legs) in bounds().prop_flat_map(|bounds| {
            let legs = prop::collection::vec((velocity(&bounds), 0.0..2.0f64), 1..4);
            (Just(bounds), inside(&bounds), legs)
        })
    ) {
        let mut now = from;
        let mut duration = 0.0;
        let mut cruised = 0.0;
        for (velocity, share) in legs {
            let change = change_velocity(now, velocity, &bounds).expect("a valid velocity");
            keeps(&change, &bounds)?;
            cruised = share * scale(&bounds);
            duration += change.duration() + cruised;
            now = change.end().after(cruised);
        }
        let curve = time_optimal(from, now, &bounds).expect("it can be reached");
        let slack = 1e-9 * (duration + cruised);
        prop_assert!(curve.duration() <= duration + slack, "{} {duration} {curve:?}", curve.duration());
    }

    /// Wider limits are never slower.
    #[test]
    fn are_never_longer_with_wider_limits(
        (bounds, from, to) in inside_case(), factors in [(); 5].map(|()| 1.0..4.0f64),
    ) {
        let [up, down, rise, fall, jerk] = factors;
        let wider = SignedBounds::new(
            bounds.velocity_max() * up,
            bounds.velocity_min() * down,
            bounds.acceleration_max() * rise,
            bounds.acceleration_min() * fall,
            bounds.jerk() * jerk,
        ).expect("in range");
        let narrow = time_optimal(from, to, &bounds).expect("a valid case").duration();
        let wide = time_optimal(from, to, &wider).expect("a valid case").duration();
        prop_assert!(wide <= narrow * (1.0 + 1e-9), "{wide} {narrow}");
    }

    #[test]
    fn changes_of_velocity_are_quick_and_exact(
        (bounds, from, to) in any_case(),
    ) {
        let curve = change_velocity(from, to.velocity, &bounds).expect("a valid case");
        hangs_together(&curve, from, Sample { position: curve.end().position, ..to })?;
        // The velocity turns once at most, so what it must change by at the largest rate is less.
        let change = to.velocity - from.velocity;
        let rate = if change > 0.0 { bounds.acceleration_max() } else { bounds.acceleration_min() };
        let strongest = rate.abs().max(from.acceleration.abs());
        prop_assert!(curve.duration() >= change.abs() / strongest * (1.0 - 1e-9));
        let limits = bounds.acceleration_min()..=bounds.acceleration_max();
        let most = if limits.contains(&from.acceleration) { 3 } else { 4 };
        prop_assert!(curve.segments().len() <= most, "{curve:?}");
    }
}
