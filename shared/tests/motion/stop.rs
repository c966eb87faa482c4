//! Stops.

use super::watch::{limits_strategy, position};
use canter_shared::limits::{LimitValues, Limits};
use canter_shared::motion::beta::Beta;
use canter_shared::motion::{Motion, Move, Profile};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::Position;
use proptest::prelude::*;

/// Several hosts may say stop at once: what was begun is not begun again, only harder.
#[test]
fn a_repeated_stop_is_no_harder() {
    let limits = Limits::default();
    let mut motion = Motion::at_rest(Position::ZERO);
    let asked = Move {
        target: Position::from_counts(8 << 32),
        duration: Ticks(6_000),
        profile: Profile::Beta,
    };
    motion
        .start(Tick(0), Tick(0), asked, &limits)
        .expect("inside the limits");
    for begin in (100..5_900).step_by(100) {
        let mut once = motion.clone();
        let rest = once.stop(Tick(begin), &limits);
        for again in begin..rest.0 {
            let mut twice = once.clone();
            // Planned anew it may save the ticks that were lost to rounding, no more.
            let sooner = twice.stop(Tick(again), &limits);
            assert!(
                sooner <= rest && rest.0 - sooner.0 <= 2,
                "{sooner:?} {rest:?}"
            );
            for tick in again..rest.0 {
                let (now, next) = (twice.at(Tick(tick)), twice.at(Tick(tick + 1)));
                let change = (next.acceleration - now.acceleration).abs().radians();
                let jerk = limits.jerk().radians() * 1e-3;
                assert!(change <= 1.2 * jerk, "{begin}, {again}: {change} at {tick}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    /// From any tick of any move over the whole of a travel: the acceleration is the limit's from
    /// the first tick to rest, and the way and the time are no more than that asks for.
    #[test]
    fn a_quick_stop_has_the_deceleration_limit_from_its_first_tick_on(
        limits in limits_strategy(),
        travel in 0.01..50.0f64,
        profile in prop::sample::select(vec![Profile::Beta, Profile::SCurve, Profile::Trapezoid]),
        slower in 1.0..2.0f64,
        part in 0.0..1.0f64,
    ) {
        let limits = Limits::new(&LimitValues {
            velocity: limits.velocity().radians(),
            acceleration: limits.acceleration().radians(),
            deceleration: limits.deceleration().radians(),
            jerk: limits.jerk().radians(),
            position_minimum: 0.0,
            position_maximum: travel,
        })
        .expect("in range");
        let mut motion = Motion::at_rest(Position::ZERO);
        let target = limits.position_maximum();
        let least = Beta::shortest(target, &limits).expect("not too long");
        let asked = Move {
            target,
            duration: Ticks((f64::from(least.0) * slower) as u32 + 2),
            profile,
        };
        prop_assume!(motion.start(Tick(0), Tick(0), asked, &limits).is_ok());
        let end = motion.end().expect("it moves").0;
        let now = (end as f64 * part) as u64;
        let before = motion.at(Tick(now));
        let rest = motion.quick_stop(Tick(now), &limits).0;
        let deceleration = limits.deceleration().radians();
        let speed = before.velocity.radians();
        prop_assert_eq!(motion.at(Tick(now)).velocity, before.velocity);
        prop_assert_eq!(motion.at(Tick(now)).position, before.position);
        prop_assert!(rest - now <= (speed / deceleration * 1e3).ceil() as u64, "{rest} {now}");
        let way = (motion.target() - before.position).radians();
        prop_assert!(way <= speed * speed / (2.0 * deceleration) + 1e-8, "{way} {speed}");
        prop_assert!(motion.target() <= target);
        for tick in now..rest {
            let state = motion.at(Tick(tick));
            prop_assert_eq!(-state.acceleration, limits.deceleration(), "{}", tick - now);
            prop_assert!(state.velocity.counts() >= 0);
        }
        let after = motion.at(Tick(rest));
        prop_assert_eq!((after.velocity.counts(), after.acceleration.counts()), (0, 0));
        // Again it is the same, but for velocities in whole counts; nor does a controlled stop soften it.
        let mut again = motion.clone();
        prop_assert_eq!(again.quick_stop(Tick(now + 1), &limits).0, rest.max(now + 1));
        let mut softer = motion.clone();
        prop_assert_eq!(softer.stop(Tick(now + 1), &limits).0, rest.max(now + 1));
        prop_assert!((again.target() - motion.target()).abs() <= position(1e-7));
        prop_assert_eq!(softer.target(), motion.target());
    }
}

#[test]
fn a_quick_stop_at_the_turn_of_a_move_is_rest_at_once() {
    let limits = Limits::default();
    let mut motion = Motion::at_rest(Position::ZERO);
    let there = |target: f64| Move {
        target: position(target),
        duration: Ticks(1_500),
        profile: Profile::SCurve,
    };
    motion
        .start(Tick(0), Tick(0), there(5.0), &limits)
        .expect("inside the limits");
    motion
        .start(Tick(700), Tick(700), there(-5.0), &limits)
        .expect("inside the limits");
    let turn = (700..2_000).min_by_key(|tick| motion.at(Tick(*tick)).velocity.abs());
    let turn = Tick(turn.expect("ticks"));
    let before = motion.at(turn);
    assert!(before.acceleration.radians() < -10.0, "{before:?}");
    let rest = motion.quick_stop(turn, &limits);
    assert!(rest.since(turn) <= Ticks(1));
    assert!((motion.target() - before.position).abs() < position(1e-3));
}
