//! Other limits in mid-move.

use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::beta::Beta;
use canter_shared::motion::trapezoid::Trapezoid;
use canter_shared::motion::{Motion, Move, PlanError, Profile, shortest_s_curve};
use canter_shared::time::Tick;
use proptest::prelude::*;

use super::watch::{Watch, position};

fn with_velocity(velocity: f64) -> Limits {
    Limits::new(&LimitValues {
        velocity,
        ..DEFAULT_VALUES
    })
    .expect("in range")
}

fn profile() -> impl Strategy<Value = Profile> {
    prop::sample::select(&[Profile::Beta, Profile::SCurve, Profile::Trapezoid][..])
}

/// A move as quick as the limits allow.
fn quick(profile: Profile, target: f64, limits: &Limits) -> Move {
    let target = position(target);
    let duration = match profile {
        Profile::Beta => Beta::shortest(target, limits),
        Profile::SCurve => shortest_s_curve(target, limits),
        _ => Trapezoid::shortest(target, limits).map(|shortest| shortest.duration()),
    };
    Move {
        target,
        duration: duration.expect("short enough"),
        profile,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    /// The speed comes down to the new limit, never dips below it, and nothing goes back.
    #[test]
    fn a_lowered_speed_limit_brings_the_speed_down_without_a_dip(
        profile in profile(),
        part in 0.02..0.98f64,
        lowered in 0.05..1.0f64,
        backward: bool,
    ) {
        let limits = Limits::default();
        let target = if backward { -60.0 } else { 60.0 };
        let mut motion = Motion::at_rest(position(0.0));
        let asked = quick(profile, target, &limits);
        motion.start(Tick(0), Tick(0), asked, &limits).expect("quick");
        let now = (f64::from(asked.duration.0) * part) as u64;
        let mut watch = Watch::new(limits);
        watch.steps = profile == Profile::Trapezoid;
        watch.run(&mut motion, 0, now)?;
        let lower = with_velocity(20.0 * lowered);
        let end = motion.change_limits(Tick(now), &lower).expect("the target is inside");
        watch.change_limits(lower);
        prop_assert!(end >= Tick(asked.duration.0.into()));
        let sign = target.signum() as i64;
        let speed = |tick: u64| sign * motion.at(Tick(tick)).velocity.counts();
        let limit = lower.velocity().counts();
        let (mut fell, mut most) = (false, 0);
        for tick in now..end.0 {
            let change = speed(tick + 1) - speed(tick);
            prop_assert!(speed(tick) >= -8, "it goes back at {tick}: {} {:?} {:?}", speed(tick), motion.at(Tick(tick)), motion.at(Tick(now)));
            // Whatever is above the limit never speeds up again once it has slowed down, and what
            // has come down to it stays there until the end.
            prop_assert!(!fell || change <= 8, "it dips at {tick}");
            fell |= change < -8;
            most = most.max(speed(tick));
        }
        // What is above the limit does not gain more than its acceleration carries.
        let state = motion.at(Tick(now));
        let carried = ((sign * state.acceleration.counts()).max(0) as f64).powi(2)
            / (2.0 * lower.jerk().counts() as f64);
        prop_assert!(most <= limit.max(speed(now) + carried as i64 + 16));
        watch.run(&mut motion, now, end.0 + 2)?;
        prop_assert_eq!(motion.at(end).position, asked.target);
    }

    #[test]
    fn raised_limits_leave_a_motion_as_it_is(profile in profile(), part in 0.0..1.0f64) {
        let limits = with_velocity(5.0);
        let mut motion = Motion::at_rest(position(0.0));
        let asked = quick(profile, 3.0, &limits);
        motion.start(Tick(0), Tick(0), asked, &limits).expect("quick");
        let now = (f64::from(asked.duration.0) * part) as u64;
        let mut same = motion.clone();
        prop_assert_eq!(same.change_limits(Tick(now), &with_velocity(20.0)).ok(), motion.end());
        for tick in now..u64::from(asked.duration.0) + 2 {
            prop_assert_eq!(same.at(Tick(tick)), motion.at(Tick(tick)));
        }
    }
}

#[test]
fn a_travel_without_the_target_is_refused_and_changes_nothing() {
    let limits = Limits::default();
    let mut motion = Motion::at_rest(position(0.0));
    let asked = quick(Profile::SCurve, 10.0, &limits);
    motion
        .start(Tick(0), Tick(0), asked, &limits)
        .expect("quick");
    let narrow = Limits::new(&LimitValues {
        position_maximum: 5.0,
        ..DEFAULT_VALUES
    })
    .expect("in range");
    let before = motion.clone();
    let nearest = narrow.position_maximum();
    assert_eq!(
        motion.change_limits(Tick(100), &narrow),
        Err(PlanError::OutsideTravel {
            target: position(10.0),
            nearest
        })
    );
    for tick in 100..1_500 {
        assert_eq!(motion.at(Tick(tick)), before.at(Tick(tick)));
    }
}

/// What has not left yet is planned anew, and leaves when it was to.
#[test]
fn a_move_that_waits_takes_the_new_limits() {
    for profile in [Profile::Beta, Profile::SCurve, Profile::Trapezoid] {
        let limits = Limits::default();
        let mut motion = Motion::at_rest(position(0.0));
        let asked = quick(profile, 10.0, &limits);
        motion
            .start(Tick(0), Tick(500), asked, &limits)
            .expect("quick");
        let lower = with_velocity(5.0);
        let end = motion.change_limits(Tick(100), &lower).expect("inside");
        let slower = quick(profile, 10.0, &lower);
        assert_eq!(end, Tick(500).after(slower.duration));
        assert_eq!(motion.at(Tick(500)).position, position(0.0));
        assert_eq!(motion.at(end).position, asked.target);
        let fastest = (500..end.0).map(|tick| motion.at(Tick(tick)).velocity.abs());
        let fastest = fastest.max().expect("it moves");
        assert!(fastest <= lower.velocity() && fastest.radians() > 4.5);
    }
}

/// Faster than a limit that was lowered, an axis stops as from any other speed.
#[test]
fn a_stop_above_a_lowered_speed_limit_does_not_wait_for_the_motion() {
    for profile in [Profile::Beta, Profile::SCurve] {
        let limits = Limits::default();
        let asked = quick(profile, 200.0, &limits);
        let lower = with_velocity(5.0);
        let middle = u64::from(asked.duration.0) / 3;
        for now in middle..middle + 60 {
            let mut motion = Motion::at_rest(position(0.0));
            motion
                .start(Tick(0), Tick(0), asked, &limits)
                .expect("quick");
            let end = motion.change_limits(Tick(middle), &lower);
            assert!(end.expect("inside") > Tick(middle + 10_000));
            let mut watch = Watch::new(limits);
            watch.last = motion.at(Tick(now));
            watch.change_limits(lower);
            assert!(watch.last.velocity > lower.velocity(), "{now}");
            let mut quick = motion.clone();
            let rest = motion.stop(Tick(now), &lower);
            assert!(rest.0 <= now + watch.longest_stop(), "{now} {rest:?}");
            let hard = quick.quick_stop(Tick(now), &lower);
            assert!(hard <= rest, "{now} {hard:?} {rest:?}");
            watch
                .run(&mut motion, now, rest.0 + 2)
                .expect("every limit is kept");
        }
    }
}

/// A limit that rises and falls while nothing moves is of no concern.
#[test]
fn at_rest_any_limits_are_taken() {
    let mut motion = Motion::at_rest(position(50.0));
    let narrow = Limits::new(&LimitValues {
        position_maximum: 5.0,
        ..DEFAULT_VALUES
    })
    .expect("in range");
    assert_eq!(motion.change_limits(Tick(7), &narrow), Ok(Tick(7)));
}
