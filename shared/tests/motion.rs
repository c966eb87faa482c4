//! The promise of `motion`: limits kept, nothing jumps, ends exact; over random moves.

use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::beta::{Beta, exact};
use canter_shared::motion::trajectory::Trajectory;
use canter_shared::motion::trapezoid::Trapezoid;
use canter_shared::motion::{Motion, Move, Profile, Setpoint};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::{COUNTS_PER_RADIAN, Position};
use proptest::prelude::*;

fn position(radians: f64) -> Position {
    Position::from_radians(radians).expect("in range")
}

fn limits_strategy() -> impl Strategy<Value = Limits> {
    (0.1..200.0f64, 0.5..3.0f64, 0.5..3.0f64, 1.5..4.5f64).prop_map(
        |(velocity, acceleration, deceleration, jerk)| {
            Limits::new(&LimitValues {
                velocity,
                acceleration: 10f64.powf(acceleration),
                deceleration: 10f64.powf(deceleration),
                jerk: 10f64.powf(acceleration.max(deceleration)) * 10f64.powf(jerk - 1.0),
                ..DEFAULT_VALUES
            })
            .expect("in range")
        },
    )
}

/// Checks one tick against the one before it.
struct Watch {
    limits: Limits,
    last: Setpoint,
    /// Whether the acceleration may step, as a trapezoid's does.
    steps: bool,
}

impl Watch {
    fn check(&mut self, now: Setpoint) -> Result<(), TestCaseError> {
        let (limits, last) = (&self.limits, self.last);
        let radians = |counts: i64| counts as f64 / COUNTS_PER_RADIAN;
        let fastest = limits.velocity().radians();
        let strongest = limits.acceleration().max(limits.deceleration()).radians();
        prop_assert!(now.velocity.abs() <= limits.velocity(), "{now:?}");
        let slowing = now.velocity.counts().signum() == -now.acceleration.counts().signum();
        let limit = if slowing {
            limits.deceleration()
        } else {
            limits.acceleration()
        };
        prop_assert!(now.acceleration.abs() <= limit, "{now:?}");
        prop_assert!(limits.allow(now.position), "{now:?}");
        let moved = (now.position - last.position).radians();
        prop_assert!(moved.abs() <= fastest * 1e-3 + 1e-8, "moved {moved}");
        let mean = (now.velocity.radians() + last.velocity.radians()) / 2.0;
        // Position and velocity belong together: the trapezium rule's error is a T^2 / 12 per s.
        let slack = 1e-8 + strongest * 2e-6 / 6.0;
        prop_assert!((moved - mean * 1e-3).abs() <= slack, "{moved} {mean}");
        let change = (now.velocity - last.velocity).radians();
        prop_assert!(change.abs() <= strongest * 1e-3 + 1e-6, "velocity {change}");
        if !self.steps {
            // Jerk: a few times the limit where moves are laid over each other or a stop's ramp
            // is one tick long.
            let change = radians((now.acceleration - last.acceleration).counts());
            let jerk = limits.jerk().radians() * 1e-3;
            prop_assert!(
                change.abs() <= (2.5 * jerk).max(strongest * 1.001),
                "acceleration {change}"
            );
        }
        self.last = now;
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn device_beta_is_within_1e_12_of_the_exact_curve(
        range in -6000.0..6000.0f64,
        duration in 1u32..400_000,
        part in 0.0..1.0f64,
    ) {
        let range = position(range);
        let beta = Beta::new(Tick(7), range, Ticks(duration));
        let tick = (f64::from(duration) * part) as u32;
        let got = beta.position(Tick(7 + u64::from(tick))).counts() as f64;
        let x = 2.0 * f64::from(tick) / f64::from(duration) - 1.0;
        let want = exact::shape(x).value * range.counts() as f64;
        let bound = 1e-12 * (range.counts().abs() as f64) + 0.51;
        prop_assert!((got - want).abs() <= bound, "{got} {want} at {tick}/{duration}");
    }

    #[test]
    fn device_beta_velocity_and_acceleration(
        range in -600.0..600.0f64,
        duration in 10u32..100_000,
        part in 0.0..1.0f64,
    ) {
        let range = position(range);
        let beta = Beta::new(Tick(0), range, Ticks(duration));
        let tick = (f64::from(duration) * part) as u32;
        let got = beta.at(Tick(u64::from(tick)));
        let seconds = f64::from(duration) / 1e3;
        let want = exact::Profile::lasting(0.0, range.radians(), seconds)
            .expect("valid")
            .at(f64::from(tick) / 1e3);
        let peak_velocity = beta.peak_velocity().radians();
        let peak_acceleration = beta.peak_acceleration().radians();
        prop_assert!((got.velocity.radians() - want.velocity).abs() <= 1e-9 * peak_velocity + 1e-8);
        prop_assert!(
            (got.acceleration.radians() - want.acceleration).abs() <= 1e-9 * peak_acceleration + 1e-8
        );
        prop_assert!(got.velocity.abs() <= beta.peak_velocity());
        prop_assert!(got.acceleration.abs() <= beta.peak_acceleration());
    }

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

    #[test]
    fn moves_retargets_and_stops_keep_every_limit(
        limits in limits_strategy(),
        steps in prop::collection::vec((0u8..4, -50.0..50.0f64, 0u32..400, 1.0..3.0f64), 1..12),
    ) {
        let mut motion = Motion::at_rest(Position::ZERO);
        let mut watch = Watch { limits, last: Setpoint::default(), steps: false };
        let mut now = 1_000u64;
        let mut target = None;
        for (kind, goal, ticks, slower) in steps {
            let goal = position(goal);
            let from = motion.target();
            let profile = if kind == 1 { Profile::Trapezoid } else { Profile::Beta };
            let shortest = match profile {
                Profile::Beta => Beta::shortest(goal - from, &limits),
                _ => Trapezoid::shortest(goal - from, &limits).map(|shortest| shortest.duration()),
            };
            let duration = shortest.map(|shortest| Ticks((f64::from(shortest.0) * slower) as u32));
            if kind == 3 {
                let rest = motion.stop(Tick(now), &limits);
                prop_assert!(motion.end().is_none_or(|end| end <= rest));
                target = None;
            } else if let Some(duration) = duration {
                let asked = Move { target: goal, duration, profile };
                let start = Tick(now + u64::from(kind) * 5);
                let planned = motion.start(Tick(now), start, asked, &limits);
                if let Ok(planned) = planned {
                    prop_assert_eq!(motion.target(), goal);
                    prop_assert!(planned.start >= start && motion.end().is_some_and(|end| end >= planned.start));
                    target = Some(goal);
                    watch.steps |= kind == 1;
                }
            }
            for _ in 0..ticks {
                now += 1;
                watch.check(motion.at(Tick(now)))?;
                motion.fold(Tick(now));
            }
        }
        while motion.is_moving(Tick(now)) && now < 3_000_000 {
            now += 1;
            watch.check(motion.at(Tick(now)))?;
            motion.fold(Tick(now));
        }
        if now < 3_000_000 {
            let rest = motion.at(Tick(now + 1));
            prop_assert_eq!(rest.velocity.counts(), 0);
            prop_assert_eq!(rest.acceleration.counts(), 0);
            if let Some(target) = target {
                prop_assert_eq!(rest.position, target);
            }
        }
    }
}

#[test]
fn a_beta_move_is_symmetric_monotone_and_ends_exactly() {
    let range = Position::from_counts(0x1234_5678_9ABC);
    for duration in [1u32, 2, 3, 4, 5, 7, 8, 64, 1_000, 4_096, 65_537] {
        let beta = Beta::new(Tick(0), range, Ticks(duration));
        let at = |tick: u32| beta.position(Tick(u64::from(tick))).counts();
        assert_eq!(at(0), 0);
        assert_eq!(at(duration), range.counts());
        for tick in 0..duration {
            assert!(at(tick) <= at(tick + 1), "{tick} of {duration}");
            // The middle is its own mirror image and carries the polynomial's 1e-13.
            if 2 * tick != duration {
                assert_eq!(at(tick) + at(duration - tick), range.counts());
            }
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

#[test]
fn a_quick_retarget_is_laid_over_and_does_not_wait_for_a_stop() {
    let limits = Limits::default();
    let mut motion = Motion::at_rest(Position::ZERO);
    let asked = |radians: f64, ticks| Move {
        target: position(radians),
        duration: Ticks(ticks),
        profile: Profile::Beta,
    };
    motion
        .start(Tick(0), Tick(0), asked(1.0, 1_000), &limits)
        .expect("well inside the limits");
    let planned = motion
        .start(Tick(400), Tick(400), asked(-1.0, 1_000), &limits)
        .expect("well inside the limits");
    assert_eq!((planned.start, planned.end), (Tick(400), Tick(1_400)));
}

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
