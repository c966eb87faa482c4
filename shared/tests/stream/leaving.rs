//! A stream that is left in mid-motion: stopped, or for a move.

use super::period;
use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::stream::{Knot, Stream};
use canter_shared::motion::{Motion, Move, Profile, Setpoint};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::{Acceleration, COUNTS_PER_RADIAN, Position, Velocity};
use proptest::prelude::*;
use std::f64::consts::TAU;

const START: Tick = Tick(5_000);
const PERIOD: u32 = 20;

/// A sine of this amplitude in rad and frequency in Hz, streamed for some knots from its rest.
fn sine(amplitude: f64, frequency: f64, knots: u8, limits: &Limits) -> Stream {
    let knot = |index: u8| {
        let phase = TAU * frequency * f64::from(index) * f64::from(PERIOD) * 1e-3;
        let rate = TAU * frequency;
        Knot {
            position: Position::from_radians(amplitude * (1.0 - phase.cos())).expect("in range"),
            velocity: Velocity::from_radians(amplitude * rate * phase.sin()).expect("in range"),
            acceleration: Some(
                Acceleration::from_radians(amplitude * rate * rate * phase.cos())
                    .expect("in range"),
            ),
        }
    };
    let first = knot(0);
    let state = Setpoint {
        position: first.position,
        velocity: first.velocity,
        acceleration: first.acceleration.unwrap_or_default(),
    };
    let mut stream = Stream::new(START, 0, state, period(PERIOD as u8));
    for index in 1..=knots {
        let now = START.after(Ticks(u32::from(index - 1) * PERIOD));
        stream
            .push(now, index, &knot(index), limits)
            .expect("inside");
    }
    stream
}

/// Goes along the motion from `now` to its end, and sees that it keeps the limits without a jump.
fn watch(motion: &Motion, now: Tick, from: Setpoint, limits: &Limits) -> Result<(), TestCaseError> {
    let jerk = limits.jerk().radians() * 1e-3 * (1.0 + 1e-6) + 1e-5;
    let strongest = limits.acceleration().max(limits.deceleration());
    let mut last = motion.at(now);
    let off = |a: i64, b: i64| (a - b).abs() as f64 / COUNTS_PER_RADIAN;
    prop_assert!(off(last.position.counts(), from.position.counts()) < 1e-8);
    prop_assert!(off(last.velocity.counts(), from.velocity.counts()) < 1e-7);
    prop_assert!(off(last.acceleration.counts(), from.acceleration.counts()) < 1e-5);
    let end = motion.end().unwrap_or(now);
    for tick in now.0 + 1..=end.0 {
        let next = motion.at(Tick(tick));
        prop_assert!(limits.allow(next.position));
        prop_assert!(next.velocity.abs() <= limits.velocity());
        prop_assert!(next.acceleration.abs() <= strongest);
        let change = off(next.acceleration.counts(), last.acceleration.counts());
        prop_assert!(change <= jerk, "{change} at {tick}");
        let moved = off(next.position.counts(), last.position.counts());
        prop_assert!(moved <= limits.velocity().radians() * 1e-3 + 1e-8);
        last = next;
    }
    prop_assert_eq!(last.velocity, Velocity::ZERO);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn a_stream_is_stopped_and_left_for_a_target_from_any_instant(
        amplitude in 0.05..0.5f64,
        frequency in 0.2..2.0f64,
        ticks in 0u32..=100,
        target in -20.0..20.0f64,
        duration in 1u32..3_000,
    ) {
        let limits = Limits::new(&LimitValues { jerk: 40_000.0, ..DEFAULT_VALUES }).expect("in range");
        let stream = sine(amplitude, frequency, 5, &limits);
        let now = START.after(Ticks(ticks.max(81)));
        let state = stream.at(now);
        let stop = Motion::stop_from(now, state, &limits).expect("there is room");
        watch(&stop, now, state, &limits)?;
        let target = Position::from_radians(target).expect("in range");
        let asked = Move { target, duration: Ticks(duration), profile: Profile::SCurve };
        let (motion, planned) = Motion::start_from(now, state, asked, &limits).expect("inside");
        watch(&motion, now, state, &limits)?;
        prop_assert_eq!(motion.at(planned.end).position, target);
        prop_assert_eq!(motion.target(), target);
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let limits = Limits::default();
    let at = |velocity: i64| Setpoint {
        velocity: Velocity::from_counts(velocity),
        ..Setpoint::default()
    };
    for velocity in [i64::MIN, i64::MAX] {
        assert!(Motion::stop_from(START, at(velocity), &limits).is_none());
    }
    let asked = Move {
        target: Position::from_counts(i64::MAX),
        duration: Ticks(100),
        profile: Profile::Beta,
    };
    assert!(Motion::start_from(START, at(0), asked, &limits).is_err());
}

/// A stop that is harder than the jerk limit, for the sake of the velocity limit, is under way: no
/// s-curve can lead on from its accelerations, so the axis rests first.
#[test]
fn an_s_curve_in_the_middle_of_a_hard_stop_passes_no_velocity_limit() {
    let limits = Limits::new(&LimitValues {
        jerk: 100.0,
        ..DEFAULT_VALUES
    })
    .expect("in range");
    let state = Setpoint {
        position: Position::ZERO,
        velocity: Velocity::from_radians(10.0).expect("in range"),
        acceleration: Acceleration::from_radians(100.0).expect("in range"),
    };
    let stop = Motion::stop_from(START, state, &limits).expect("there is room");
    let end = stop.end().expect("it moves");
    let asked = Move {
        target: Position::from_radians(100.0).expect("in range"),
        duration: Ticks(10),
        profile: Profile::SCurve,
    };
    for tick in START.0..end.0 {
        let mut motion = stop.clone();
        let now = Tick(tick);
        let planned = motion.start(now, now, asked, &limits).expect("in reach");
        let fastest = (tick..=planned.end.0).map(|tick| motion.at(Tick(tick)).velocity.abs());
        assert!(fastest.max() <= Some(limits.velocity()), "{tick}");
        assert_eq!(motion.at(planned.end).position, asked.target);
    }
}
