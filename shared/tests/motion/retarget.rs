//! Another target in mid-move.

use canter_shared::limits::Limits;
use canter_shared::motion::beta::Beta;
use canter_shared::motion::{Motion, Move, Profile};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::Position;

use proptest::prelude::*;

use super::watch::{Watch, position};

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

/// A beta move at the velocity limit has no room over it before its middle. A target farther on is
/// taken over from there, at full speed; one behind finds room at once.
#[test]
fn a_retarget_of_a_beta_move_at_its_limits_neither_stops_nor_breaks_them() {
    let limits = Limits::default();
    let asked = |radians: f64, ticks| Move {
        target: position(radians),
        duration: Ticks(ticks),
        profile: Profile::Beta,
    };
    let least = Beta::shortest(position(10.0), &limits).expect("a short way");
    for (target, leaves_in_the_middle) in [(20.0, true), (-5.0, false)] {
        let mut motion = Motion::at_rest(Position::ZERO);
        motion
            .start(Tick(0), Tick(0), asked(10.0, least.0), &limits)
            .expect("long enough");
        let now = Tick(u64::from(least.0) / 5);
        let mut watch = Watch::new(limits);
        watch.run(&mut motion, 0, now.0).expect("inside the limits");
        let planned = motion
            .start(now, now, asked(target, 1), &limits)
            .expect("long enough in the end");
        let middle = u64::from(least.0) / 2;
        assert_eq!(planned.start > now, leaves_in_the_middle, "{target}");
        assert!(planned.start.0.abs_diff(middle) <= 1 || planned.start == now);
        assert!(motion.at(planned.start).velocity.radians() > 6.0);
        watch
            .run(&mut motion, now.0, planned.end.0 + 2)
            .expect("inside the limits");
        assert_eq!(motion.at(planned.end).position, position(target));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    /// With time enough a retarget arrives in the tick that was asked for, along s-curves and
    /// trapezoids from whatever is under way.
    #[test]
    fn a_retarget_with_time_arrives_when_it_is_asked_to(
        first in prop::sample::select(&[Profile::Beta, Profile::SCurve, Profile::Trapezoid][..]),
        second in prop::sample::select(&[Profile::SCurve, Profile::Trapezoid][..]),
        from in -20.0..20.0f64,
        to in -20.0..20.0f64,
        part in 0.01..0.99f64,
        later in 0u64..40,
        longer in 5_000u32..20_000,
    ) {
        let limits = Limits::default();
        let mut motion = Motion::at_rest(position(0.0));
        let asked = |target, ticks, profile| Move {
            target: position(target),
            duration: Ticks(ticks),
            profile,
        };
        motion.start(Tick(0), Tick(0), asked(from, 3_000, first), &limits).expect("long enough");
        let mut watch = Watch::new(limits);
        watch.steps = first == Profile::Trapezoid || second == Profile::Trapezoid;
        let now = (3_000.0 * part) as u64;
        watch.run(&mut motion, 0, now)?;
        let start = Tick(now + later);
        let planned = motion
            .start(Tick(now), start, asked(to, longer, second), &limits)
            .expect("long enough");
        if start < Tick(3_000) {
            prop_assert_eq!(planned.start, start);
            // A tick that is met but for rounding is met.
            prop_assert_eq!(planned.end, start.after(Ticks(longer)));
        }
        prop_assert_eq!(motion.end(), Some(planned.end));
        watch.run(&mut motion, now, planned.end.0 + 2)?;
        prop_assert_eq!(motion.at(planned.end).position, position(to));
        prop_assert_eq!(motion.at(planned.end).velocity.counts(), 0);
    }
}

/// Seven phases that have all but ended leave room for the seven that come after them.
#[test]
fn what_has_ended_makes_room_for_what_comes() {
    let limits = Limits::default();
    let asked = |radians: f64, ticks| Move {
        target: position(radians),
        duration: Ticks(ticks),
        profile: Profile::SCurve,
    };
    let mut motion = Motion::at_rest(position(0.0));
    let first = motion.start(Tick(0), Tick(0), asked(6.0, 3_000), &limits);
    let end = first.expect("long enough").end;
    for now in [2_968, 2_999] {
        let planned = motion
            .clone()
            .start(Tick(now), end, asked(-12.0, 5_000), &limits);
        assert_eq!(planned.map(|planned| planned.start), Ok(end));
    }
}

/// Until it leaves, a retarget lets the motion under way go on, also when it is replaced then.
#[test]
fn what_is_under_way_goes_on_until_the_retarget_leaves() {
    let limits = Limits::default();
    let asked = |radians: f64, ticks, profile| Move {
        target: position(radians),
        duration: Ticks(ticks),
        profile,
    };
    for profile in [Profile::Beta, Profile::SCurve, Profile::Trapezoid] {
        let mut motion = Motion::at_rest(position(0.0));
        motion
            .start(Tick(0), Tick(0), asked(10.0, 2_000, profile), &limits)
            .expect("inside the limits");
        let before = motion.clone();
        for target in [-10.0, 5.0, -3.0] {
            let next = asked(target, 5_000, Profile::SCurve);
            let planned = motion.start(Tick(700), Tick(720), next, &limits);
            assert_eq!(planned.map(|planned| planned.start), Ok(Tick(720)));
            for tick in 700..=720 {
                assert_eq!(motion.at(Tick(tick)), before.at(Tick(tick)), "{tick}");
            }
            assert_eq!(motion.target(), position(target));
        }
        assert!(motion.at(Tick(740)).velocity < before.at(Tick(740)).velocity);
    }
}
