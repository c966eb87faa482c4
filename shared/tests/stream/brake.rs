//! A stream that runs dry or is cut brakes by itself: with the deceleration limit, inside the
//! travel, to rest exactly where the closed form says.

use super::hermite::pieces;
use super::{START, knot, limits, period, setpoint, sines, watch};
use canter_shared::limits::Limits;
use canter_shared::motion::Setpoint;
use canter_shared::motion::stream::{KnotError, Stream};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::Acceleration;
use proptest::prelude::*;

/// How far from `state` rest is, in counts: v^2 / 2 d.
fn way(state: Setpoint, limits: &Limits) -> f64 {
    let speed = state.velocity.counts() as f64;
    speed * speed / (2.0 * limits.deceleration().counts() as f64)
}

/// Follows a stream from `now` to rest, holds every tick to the limits, gives the first at rest.
fn follow(stream: &Stream, now: Tick, limits: &Limits) -> Result<Setpoint, TestCaseError> {
    let begin = stream.at(stream.ends());
    let (mut now, mut before) = (now, stream.at(now));
    while stream.is_moving(now) {
        prop_assert!(now < stream.rests());
        now = now.after(Ticks(1));
        let setpoint = stream.at(now);
        watch(before, setpoint, limits, false)?;
        if now > stream.ends() && stream.is_moving(now) {
            prop_assert!(stream.has_run_dry(now));
            let deceleration = limits.deceleration();
            let sign = -begin.velocity.counts().signum();
            prop_assert_eq!(setpoint.acceleration.counts(), sign * deceleration.counts());
        }
        before = setpoint;
    }
    prop_assert_eq!(now, stream.rests());
    let moved = (before.position - begin.position).counts().abs() as f64;
    prop_assert!(moved <= way(begin, limits) && way(begin, limits) - moved <= 1.0);
    for later in [1, 1_000, u64::from(u32::MAX) + 7] {
        let rest = stream.at(Tick(now.0 + later));
        prop_assert_eq!(rest, before);
        prop_assert_eq!(rest, setpoint(rest.position.counts(), 0, 0));
    }
    Ok(before)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_500))]

    /// A piece between any two states, then nothing.
    #[test]
    fn a_stream_that_runs_dry_brakes_inside_the_travel(
        (limits, from, to, ticks, periods) in pieces(),
    ) {
        let mut stream = Stream::new(START, 0, from, period(ticks));
        let pushed = stream.push(START, periods, &to, &limits);
        // A third of them is taken on. What lasts for minutes has been seen after a part of it.
        if pushed.is_ok() && stream.rests().since(stream.ends()).0 < 20_000 {
            follow(&stream, START, &limits)?;
        }
    }

    /// Cut at any tick: it rests no farther than the stream itself would have gone.
    #[test]
    fn a_stream_can_be_cut_at_any_tick(
        ticks in 5u8..=25,
        quintic: bool,
        begin in 0u32..4_000,
        scale in 0.1..1.0f64,
        cut in 0u64..130,
    ) {
        let limits = limits();
        let at = |number: u32| {
            sines(f64::from(begin) * 1e-3 + f64::from(number) * f64::from(ticks) / 1e3, scale)
        };
        let mut stream = Stream::new(START, 0, at(0), period(ticks));
        for number in 1..=5 {
            let knot = knot(at(u32::from(number)), quintic);
            prop_assert!(stream.push(START, number, &knot, &limits).is_ok());
        }
        let twin = stream.clone();
        let tick = Tick(START.0 + cut);
        stream.cut(tick, &limits);
        prop_assert!(stream.is_closed());
        prop_assert_eq!(stream.ends(), tick.min(twin.ends()));
        for before in START.0..=stream.ends().0 {
            prop_assert_eq!(stream.at(Tick(before)), twin.at(Tick(before)));
        }
        prop_assert!(stream.rests() <= twin.rests());
        follow(&stream, START, &limits)?;
        let ended = stream.ends();
        let error = stream.push(tick, 6, &knot(at(6), quintic), &limits);
        prop_assert_eq!(error, Err(KnotError::TooLate { ended }));
    }
}

/// At the strongest and at the gentlest limits the arithmetic does not leave its bits.
#[test]
fn the_extremes_brake_exactly() {
    use canter_shared::limits::{FARTHEST_POSITION, LimitValues};
    for (velocity, deceleration) in [(1e4, 1e6), (1e4, 1e4), (1.0, 1e-4), (1e-4, 1e-4)] {
        let limits = Limits::new(&LimitValues {
            velocity,
            acceleration: 1e6,
            deceleration,
            jerk: 1e9,
            position_minimum: -FARTHEST_POSITION,
            position_maximum: FARTHEST_POSITION,
        })
        .expect("in range");
        for sign in [-1, 1] {
            let speed = sign * limits.velocity().counts();
            // It goes evenly from one end of the travel.
            let from = setpoint(-sign * limits.position_maximum().counts(), speed, 0);
            let mut stream = Stream::new(START, 0, from, period(100));
            let to = setpoint(from.position.counts() + speed / 10, speed, 0);
            let pushed = stream.push(START, 1, &knot(to, true), &limits);
            assert!(pushed.is_ok(), "{pushed:?}");
            let (ends, rests) = (stream.ends(), stream.rests());
            let rest = stream.at(rests);
            let moved = (rest.position - to.position).counts() * sign;
            assert!((moved as f64 - way(to, &limits)).abs() <= 1.0);
            let counts = limits.deceleration().counts() as f64;
            let ticks = limits.velocity().counts() as f64 / counts * 1e3;
            assert!((f64::from(rests.since(ends).0) - ticks).abs() <= 1.0);
            let before = stream.at(Tick(rests.0 - 1));
            assert!(before.velocity.counts() * sign >= 0);
            assert!((rest.position - before.position).counts() * sign >= 0);
            // Half the speed is left half way in time, three quarters of the way behind it.
            let half = stream.at(Tick(ends.0 + u64::from(rests.since(ends).0) / 2));
            let part = half.velocity.counts() as f64 / speed as f64;
            assert!((part - 0.5).abs() < 0.05, "{part}");
            let part = (half.position - to.position).counts() as f64 / way(to, &limits);
            assert!((part * sign as f64 - 0.75).abs() < 0.05, "{part}");
        }
    }
}

/// Nothing is decelerated where another knot may still come.
#[test]
fn the_last_knot_keeps_its_acceleration_until_its_tick_has_passed() {
    let limits = limits();
    let at = |number: u64| sines(number as f64 * 0.02, 0.5);
    let mut stream = Stream::new(START, 0, at(0), period(20));
    let pushed = stream.push(START, 1, &knot(at(1), true), &limits);
    assert!(pushed.is_ok());
    let end = stream.ends();
    assert_eq!(stream.at(end), at(1));
    assert!(!stream.has_run_dry(end) && stream.is_moving(end));
    let dry = stream.at(end.after(Ticks(1)));
    assert_eq!(dry.acceleration, Acceleration::ZERO - limits.deceleration());
    assert!(stream.has_run_dry(end.after(Ticks(1))));
}
