//! Moves from rest: as asked, or an error that says what could be.

use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::s_curve::{self, SignedBounds};
use canter_shared::motion::trajectory::{Sample, Trajectory};
use canter_shared::motion::trapezoid::Trapezoid;
use canter_shared::motion::{Motion, Move, PlanError, Profile, shortest_s_curve};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::{COUNTS_PER_TURN, Position};
use proptest::prelude::*;

use super::watch::{limits_strategy, position};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    #[test]
    fn shortest_trapezoid_keeps_limits_and_is_shortest(
        limits in limits_strategy(),
        range in -100.0..100.0f64,
    ) {
        let range = position(range);
        if let Some(trapezoid) = Trapezoid::shortest(range, &limits) {
            prop_assert!(trapezoid.allowed(range, &limits));
            let ideal = {
                let r = range.abs().radians();
                let k = 0.5 / limits.acceleration().radians() + 0.5 / limits.deceleration().radians();
                let v = limits.velocity().radians().min((r / k).sqrt());
                if v > 0.0 { r / v + k * v } else { 0.0 }
            };
            // Whole ticks for each of three phases.
            prop_assert!(trapezoid.duration().seconds() <= ideal + 4e-3);
        }
    }
}

/// Counts in the limits that plans stay below.
const MARGIN: f64 = 8.0;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    /// The device's s-curve is the exact one, to a few counts.
    #[test]
    fn s_curves_are_the_exact_ones(
        limits in limits_strategy(),
        range in -30.0..30.0f64,
        longer in 0u32..3_000,
    ) {
        let range = position(range);
        let counts = range.counts() as f64;
        let shortest = shortest_s_curve(range, &limits).filter(|shortest| shortest.0 > 1);
        let Some(shortest) = shortest else {
            return Ok(());
        };
        let duration = Ticks(shortest.0 + longer);
        let asked = Move { target: range, duration, profile: Profile::SCurve };
        let mut motion = Motion::at_rest(position(0.0));
        let quicker = Move { duration: Ticks(shortest.0 - 1), ..asked };
        prop_assert_eq!(
            motion.start(Tick(0), Tick(0), quicker, &limits),
            Err(PlanError::TooFast { shortest })
        );
        motion.start(Tick(0), Tick(0), asked, &limits).expect("long enough");
        let limit = |counts: i64| (counts as f64 - MARGIN) / counts_per_unit();
        let bounds = Bounds::new(
            limit(limits.velocity().counts()),
            limit(limits.acceleration().counts()),
            limit(limits.deceleration().counts()),
            limit(limits.jerk().counts()),
        )
        .expect("in range");
        let signed = if counts < 0.0 {
            SignedBounds::backward(&bounds)
        } else {
            SignedBounds::forward(&bounds)
        }
        .expect("in range");
        let (from, target) = (Sample::at_rest(0.0), counts / counts_per_unit());
        let exact = s_curve::lasting(from, target, duration.seconds(), &signed)
            .or_else(|_| s_curve::time_optimal(from, Sample::at_rest(target), &signed))
            .expect("long enough");
        for tick in (0..=duration.0).step_by(1 + duration.0 as usize / 200) {
            let got = motion.at(Tick(tick.into()));
            let want = exact.at(Ticks(tick).seconds());
            let away = got.position.counts() as f64 - want.position * counts_per_unit();
            let slack = 2.0 + 1e-9 * counts.abs();
            prop_assert!(away.abs() <= slack, "{away} at {tick} of {duration:?}");
        }
        prop_assert_eq!(motion.at(Tick(duration.0.into())).position, range);
    }
}

/// A unit in which any limits are accepted.
fn counts_per_unit() -> f64 {
    COUNTS_PER_TURN as f64
}

#[test]
fn a_target_outside_the_travel_changes_nothing() {
    let limits = Limits::new(&LimitValues {
        position_minimum: -1.0,
        position_maximum: 1.0,
        ..DEFAULT_VALUES
    })
    .expect("valid");
    let mut motion = Motion::at_rest(Position::ZERO);
    let asked = Move {
        target: position(1.5),
        duration: Ticks(1_000),
        profile: Profile::Beta,
    };
    assert!(motion.start(Tick(5), Tick(5), asked, &limits).is_err());
    assert_eq!(motion.end(), None);
}
