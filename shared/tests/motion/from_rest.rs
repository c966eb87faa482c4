//! Moves from rest: as asked, or an error that says what could be.

use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::trapezoid::Trapezoid;
use canter_shared::motion::{Motion, Move, Profile};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::Position;
use proptest::prelude::*;

use super::watch::{limits_strategy, position};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

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
