//! Trapezoids from any velocity to rest, with limits by speed.

use super::check::{continuous, derivatives, ends, rates, senses, signed, times};
use super::trapezoid::scale;
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::trajectory::{Sample, Trajectory};
use canter_shared::motion::trapezoid::exact::{plan, time_optimal, to_rest};
use proptest::prelude::*;

/// From up to five times the velocity limit, or rest, to a target that may be behind.
pub fn retargets() -> impl Strategy<Value = (Sample, f64, Bounds)> {
    let part = prop_oneof![3 => -1.0..=1.0f64, 1 => -5.0..5.0f64, 1 => Just(0.0), 1 => Just(1.0)];
    let range = prop_oneof![9 => signed(-9.0..6.0), 1 => Just(0.0)];
    (signed(-3.0..3.0), range, part, rates()).prop_map(|(from, range, part, bounds)| {
        let start = Sample::coasting(from, part * bounds.velocity());
        (start, from + range, bounds)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    #[test]
    fn limits_go_by_speed((from, target, bounds) in retargets()) {
        let planned = to_rest(from, target, &bounds).expect("valid");
        let to = Sample::at_rest(target);
        ends(&planned, from, to)?;
        let scale = scale(&from, &to, &bounds);
        derivatives(&planned, scale, 0.0)?;
        continuous(&planned, scale)?;
        senses(&planned, &bounds)?;
        // Whoever is above the limit slows down to it at once; nobody gets above.
        let excess = from.velocity.abs() - bounds.velocity();
        let back = excess.max(0.0) / bounds.deceleration();
        for time in times(&planned) {
            let over = planned.at(time).velocity.abs() - bounds.velocity();
            let allowed = (excess - bounds.deceleration() * time).max(0.0);
            let rounding = 1e-12 * from.velocity.abs().max(bounds.velocity());
            prop_assert!(over <= allowed + rounding, "{over} over at {time} of {back}");
        }
        // It passes the target at most once, and comes to rest there without passing it again.
        prop_assert!(planned.segments().len() <= 4);
    }

    /// Where no velocity is against the direction, and no limit is passed, all three agree.
    #[test]
    fn agrees_with_plan((from, target, bounds) in retargets()) {
        let to = Sample::at_rest(target);
        let quickest = to_rest(from, target, &bounds).expect("valid");
        // A range that is the rounding of the positions may be taken as just enough.
        let size = from.position.abs() + target.abs();
        let ahead = (target - from.position) * from.velocity >= 0.0
            && (target - from.position).abs() > 1e-12 * size;
        if let (true, Ok(planned)) = (ahead, plan(from, to, &bounds)) {
            let (one, two) = (quickest.duration(), planned.duration());
            prop_assert!((one - two).abs() <= 1e-9 * two, "{one} {two}");
        }
        let slower = bounds.slower_acceleration();
        let same = Bounds::new(bounds.velocity(), slower, slower, f64::INFINITY).expect("valid");
        let one = to_rest(from, target, &same).expect("valid").duration();
        let two = time_optimal(from, to, &same, &same).expect("valid").duration();
        prop_assert!((one - two).abs() <= 1e-9 * two, "{one} {two}");
    }

    #[test]
    fn mirrored((from, target, bounds) in retargets()) {
        let one = to_rest(from, target, &bounds).expect("valid");
        let mirror = Sample::coasting(-from.position, -from.velocity);
        let two = to_rest(mirror, -target, &bounds).expect("valid");
        prop_assert_eq!(one.duration(), two.duration());
        for time in times(&one) {
            prop_assert_eq!(-one.at(time).position, two.at(time).position);
        }
    }

    /// Planned anew from the middle of the way, what is left is the same.
    #[test]
    fn goes_on_as_planned((from, target, bounds) in retargets(), part in 0.0..1.0f64) {
        let whole = to_rest(from, target, &bounds).expect("valid");
        let time = part * whole.duration();
        let rest = to_rest(whole.at(time), target, &bounds).expect("valid");
        let (left, again) = (whole.duration() - time, rest.duration());
        // Near the braking distance the duration changes with the root of the position's rounding.
        let rounding = 1e-15 * scale(&from, &Sample::at_rest(target), &bounds);
        let bound = 1e-9 * whole.duration() + 4.0 * (rounding / bounds.slower_acceleration()).sqrt();
        prop_assert!((left - again).abs() <= bound, "{left} {again}");
    }
}
