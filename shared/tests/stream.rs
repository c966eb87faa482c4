//! Streamed motion: the curve is the Hermite polynomial, knots and limits are kept, losses noticed.

#[path = "stream/advance.rs"]
mod advance;
#[path = "stream/brake.rs"]
mod brake;
#[path = "stream/hermite.rs"]
mod hermite;
#[path = "stream/leaving.rs"]
mod leaving;

use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::Setpoint;
use canter_shared::motion::stream::{Knot, KnotError, LONGEST_GAP, LOOK_AHEAD, Pushed, Stream};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::{Acceleration, Position, Velocity};
use core::num::NonZeroU8;
use hermite::{Hermite, pieces, used};
use proptest::prelude::*;

const START: Tick = Tick(1_000_000_007);

fn period(ticks: u8) -> NonZeroU8 {
    NonZeroU8::new(ticks).expect("not zero")
}

fn setpoint(position: i64, velocity: i64, acceleration: i64) -> Setpoint {
    Setpoint {
        position: Position::from_counts(position),
        velocity: Velocity::from_counts(velocity),
        acceleration: Acceleration::from_counts(acceleration),
    }
}

fn knot(state: Setpoint, quintic: bool) -> Knot {
    Knot {
        position: state.position,
        velocity: state.velocity,
        acceleration: quintic.then_some(state.acceleration),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    #[test]
    fn a_piece_is_the_hermite_polynomial_and_is_taken_on_where_it_keeps_the_limits(
        (limits, from, to, ticks, periods) in pieces(),
    ) {
        let mut stream = Stream::new(START, 250, from, period(ticks));
        let length = u32::from(ticks) * u32::from(periods);
        let curve = Hermite::new(from, &to, length);
        let number = 250u8.wrapping_add(periods);
        let pushed = stream.push(START, number, &to, &limits);
        match pushed {
            Ok(pushed) => {
                prop_assert_eq!(pushed, Pushed::Accepted { missing: periods - 1 });
                prop_assert!(used(&curve, &limits) <= 1.0 + 1e-6, "{}", used(&curve, &limits));
            }
            Err(KnotError::TooFast { velocity, limit }) => {
                prop_assert!(velocity.abs() > limit);
                prop_assert!(used(&curve, &limits) > 0.98, "{} {pushed:?}", used(&curve, &limits));
            }
            Err(KnotError::TooStrong { acceleration, limit }) => {
                prop_assert!(acceleration.abs() > limit);
                // The sense of a lobe across a standstill is looked at in parts.
                prop_assert!(used(&curve, &limits) > 0.6, "{} {pushed:?}", used(&curve, &limits));
            }
            // Braking may take the whole travel.
            Err(KnotError::CannotStop { .. }) => {}
            // From near the end of the travel the curve swings out, or nearly, as it is looked at in parts.
            Err(KnotError::OutsideTravel { position, .. }) => {
                prop_assert!(!limits.allow(position));
                let way = |part: u32| curve.at(f64::from(part) / 1e3)[0];
                let swing = (0..=1_000).map(way).fold(0.0, |most: f64, way| most.max(way.abs()));
                let nearly = Position::from_counts((swing / 100.0) as i64);
                let leaves = |part: u32| {
                    let place = from.position + Position::from_counts(way(part) as i64);
                    !limits.allow(place - nearly) || !limits.allow(place + nearly)
                };
                prop_assert!((0..=1_000).any(leaves), "{position:?}");
            }
            Err(other) => prop_assert!(false, "{other}"),
        }
        if pushed.is_err() {
            prop_assert_eq!(stream.ends(), START);
            return Ok(());
        }
        prop_assert_eq!(stream.ends(), START.after(Ticks(length)));
        for elapsed in (0..length).step_by(1 + length as usize / 64) {
            let got = stream.at(START.after(Ticks(elapsed)));
            let [position, velocity, acceleration] =
                curve.at(f64::from(elapsed) / f64::from(length));
            let position = position - (got.position - from.position).counts() as f64;
            // The twin's own error is some 2^-50 of its numbers.
            let slack = 1.0 + 1e-14 * limits.velocity().counts() as f64;
            prop_assert!(position.abs() <= slack, "position {position}");
            let velocity = velocity - got.velocity.counts() as f64;
            prop_assert!(velocity.abs() <= 1.0 + slack, "velocity {velocity} {slack}");
            // A velocity is good for 2^-8 counts/s, over the duration.
            let acceleration = acceleration - got.acceleration.counts() as f64;
            let slack = 2.0 + 16e3 * slack / f64::from(length);
            prop_assert!(acceleration.abs() <= slack, "acceleration {acceleration} {slack}");
        }
        let end = stream.at(stream.ends());
        prop_assert_eq!((end.position, end.velocity), (to.position, to.velocity));
        if let Some(acceleration) = to.acceleration {
            prop_assert_eq!(end.acceleration, acceleration);
        }
        prop_assert_eq!(stream.at(START), Setpoint {
            acceleration: if to.acceleration.is_some() {
                from.acceleration
            } else {
                stream.at(START).acceleration
            },
            ..from
        });
    }
}

/// A machine's limits with a short travel.
fn limits() -> Limits {
    Limits::new(&LimitValues {
        position_minimum: -10.0,
        position_maximum: 10.0,
        ..DEFAULT_VALUES
    })
    .expect("in range")
}

/// A smooth motion: two sines, in rad and seconds.
fn sines(seconds: f64, scale: f64) -> Setpoint {
    let mut sums = [0.0; 3];
    for (amplitude, rate) in [(4.0, 2.0f64), (0.05, 30.0)] {
        let amplitude = amplitude * scale;
        let (sine, cosine) = (rate * seconds).sin_cos();
        sums[0] += amplitude * sine;
        sums[1] += amplitude * rate * cosine;
        sums[2] -= amplitude * rate * rate * sine;
    }
    Setpoint {
        position: Position::from_radians(sums[0]).expect("in range"),
        velocity: Velocity::from_radians(sums[1]).expect("in range"),
        acceleration: Acceleration::from_radians(sums[2]).expect("in range"),
    }
}

/// Checks one tick against the one before it: limits kept, nothing jumps.
fn watch(
    before: Setpoint,
    now: Setpoint,
    limits: &Limits,
    smooth: bool,
) -> Result<(), TestCaseError> {
    prop_assert!(limits.allow(now.position), "{now:?}");
    prop_assert!(now.velocity.abs() <= limits.velocity(), "{now:?}");
    let slowing = now.velocity.counts().signum() == -now.acceleration.counts().signum();
    let limit = if slowing {
        limits.deceleration()
    } else {
        limits.acceleration()
    };
    prop_assert!(now.acceleration.abs() <= limit, "{now:?}");
    let strongest = limits.acceleration().max(limits.deceleration()).radians();
    let moved = (now.position - before.position).radians();
    let mean = (now.velocity.radians() + before.velocity.radians()) / 2.0;
    let slack = 2e-9 + strongest * 1e-6 / 4.0;
    prop_assert!((moved - mean * 1e-3).abs() <= slack, "{moved} {mean}");
    let change = (now.velocity - before.velocity).radians();
    prop_assert!(
        change.abs() <= strongest * 1e-3 + 2e-9,
        "{before:?} {now:?}"
    );
    if smooth {
        let mean = (now.acceleration.radians() + before.acceleration.radians()) / 2.0;
        // The quintics of this test have a jerk far below 1e5 rad/s^3.
        prop_assert!(
            (change - mean * 1e-3).abs() <= 1e-8 + 1e5 * 1e-6 / 4.0,
            "{before:?} {now:?}"
        );
        let step = (now.acceleration - before.acceleration).radians();
        prop_assert!(step.abs() <= 1e5 * 1e-3, "{before:?} {now:?}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// A host that streams a motion inside the limits, over a bus that loses and doubles knots.
    #[test]
    fn a_stream_follows_its_motion_through_losses(
        ticks in 5u8..=25,
        quintic: bool,
        lost in prop::collection::vec(prop::bool::weighted(0.15), 60),
        doubled in prop::collection::vec(prop::bool::weighted(0.2), 60),
    ) {
        let limits = limits();
        let at = |number: usize| sines(number as f64 * f64::from(ticks) / 1e3, 1.0);
        let mut stream = Stream::new(START, 200, at(0), period(ticks));
        let (mut last, mut longest_gap) = (0, 0);
        let mut before = stream.at(START);
        let mut now = START;
        for (number, (lost, doubled)) in lost.iter().zip(&doubled).enumerate().skip(1) {
            if !lost {
                let said = 200u8.wrapping_add(number as u8);
                let pushed = stream.push(now, said, &knot(at(number), quintic), &limits);
                let missing = (number - last - 1) as u8;
                longest_gap = longest_gap.max(missing);
                if missing > 3 {
                    // A cubic over so long a gap may well swing too far.
                    prop_assume!(pushed.is_ok());
                }
                prop_assert_eq!(pushed, Ok(Pushed::Accepted { missing }));
                last = number;
                if *doubled {
                    let again = stream.push(now, said, &knot(at(0), quintic), &limits);
                    prop_assert_eq!(again, Ok(Pushed::Repeated));
                }
            }
            // Three knots ahead, as a host would be.
            while now.0 + 3 * u64::from(ticks) < START.0 + number as u64 * u64::from(ticks)
                && now < stream.ends()
            {
                now = Tick(now.0 + 1);
                let setpoint = stream.at(now);
                watch(before, setpoint, &limits, quintic)?;
                before = setpoint;
                let elapsed = now.since(START).0;
                let truth = sines(f64::from(elapsed) / 1e3, 1.0);
                let error = (setpoint.position - truth.position).radians();
                // The error grows with the gap, by its fourth power or more.
                let bound = match longest_gap {
                    0 => 1e-4,
                    1..=3 => 0.03,
                    _ => 0.3,
                };
                prop_assert!(error.abs() <= bound, "{error} after {longest_gap}");
            }
        }
    }

    /// Whatever is pushed whenever: setpoints stay inside the limits and never jump.
    #[test]
    fn no_sequence_of_knots_leaves_the_limits(
        ticks in 1u8..=40,
        said in prop::collection::vec(
            (0u8..4, -1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64, any::<bool>(), 0u64..60, 0u8..3),
            80,
        ),
    ) {
        let limits = Limits::new(&LimitValues {
            acceleration: 150.0,
            deceleration: 300.0,
            position_minimum: -2.0,
            position_maximum: 1.0,
            ..DEFAULT_VALUES
        })
        .expect("in range");
        let mut stream = Stream::new(START, 0, setpoint(0, 0, 0), period(ticks));
        let mut now = START;
        let mut before = stream.at(now);
        for (skip, place, rate, bend, quintic, pause, kind) in said {
            let from = stream.at(stream.ends());
            let number = stream.number().wrapping_add(1 + skip);
            let seconds = f64::from(ticks) * f64::from(skip + 1) / 1e3;
            // Near where it could go, or anywhere.
            let velocity = match kind {
                0 => from.velocity.radians() * 0.5,
                1 => (from.velocity.radians() + rate * 100.0 * seconds).clamp(-20.0, 20.0),
                _ => rate * 20.0,
            };
            let mean = (velocity + from.velocity.radians()) / 2.0;
            let position = match kind {
                0 | 1 => from.position.radians() + mean * seconds + place * seconds * seconds * 10.0,
                _ => place * 2.5,
            };
            let knot = Knot {
                position: Position::from_radians(position).expect("in range"),
                velocity: Velocity::from_radians(velocity).expect("in range"),
                acceleration: quintic
                    .then(|| Acceleration::from_radians(bend * 250.0).expect("in range")),
            };
            let ends = stream.ends();
            match stream.push(now, number, &knot, &limits) {
                Ok(Pushed::Accepted { missing }) => {
                    prop_assert_eq!(missing, skip);
                    prop_assert_eq!(stream.ends().0, ends.0 + (f64::round(seconds * 1e3)) as u64);
                    let end = stream.at(stream.ends());
                    prop_assert_eq!((end.position, end.velocity), (knot.position, knot.velocity));
                }
                Ok(Pushed::Repeated) => prop_assert!(false),
                Err(_) => prop_assert_eq!(stream.ends(), ends),
            }
            for _ in 0..pause {
                if now == stream.ends() {
                    break;
                }
                now = Tick(now.0 + 1);
                let setpoint = stream.at(now);
                watch(before, setpoint, &limits, false)?;
                before = setpoint;
            }
        }
    }

    #[test]
    fn no_input_panics(
        start: u64,
        state: (i64, i64, i64),
        ticks in 1u8..=255,
        knots in prop::collection::vec(
            (any::<u64>(), any::<u8>(), any::<(i64, i64, i64)>(), any::<bool>(), 0u32..64),
            20,
        ),
    ) {
        for limits in [limits(), Limits::default()] {
            let from = setpoint(state.0, state.1, state.2);
            let mut stream = Stream::new(Tick(start), 0, from, period(ticks));
            let mut rest = Stream::new(Tick(start), 0, setpoint(0, 0, 0), period(ticks));
            for (now, number, (position, velocity, acceleration), quintic, shift) in &knots {
                let shifted = |value: &i64| value >> shift;
                let state = setpoint(shifted(position), shifted(velocity), shifted(acceleration));
                let knot = knot(state, *quintic);
                for stream in [&mut stream, &mut rest] {
                    let (ended, next) = (stream.ends(), stream.number().wrapping_add(1));
                    for (now, number) in [(*now, *number), (*now, next), (ended.0, next)] {
                        if let Err(error) = stream.push(Tick(now), number, &knot, &limits) {
                            prop_assert!(error.to_string().starts_with("knot") || error.to_string().starts_with("curve"));
                        }
                        stream.at(Tick(now));
                        stream.at(Tick(now / 2 + start / 2));
                        stream.advance(Tick(now / 2 + start / 2));
                        stream.at(Tick(now));
                    }
                }
            }
        }
    }
}

#[test]
fn knots_are_counted_and_their_places_are_whole_periods() {
    let limits = limits();
    let at = |number: u64| sines(number as f64 * 0.02, 0.5);
    let mut stream = Stream::new(START, 253, at(0), period(20));
    let push = |stream: &mut Stream, now: u64, number: u64| {
        let said = 253u8.wrapping_add(number as u8);
        stream.push(Tick(START.0 + now), said, &knot(at(number), true), &limits)
    };
    for number in 1..=LOOK_AHEAD as u64 {
        assert_eq!(
            push(&mut stream, 0, number),
            Ok(Pushed::Accepted { missing: 0 })
        );
        assert_eq!(stream.ends().0, START.0 + 20 * number);
    }
    let ahead = LOOK_AHEAD as u64;
    // Over the wrap of the number: the last, an old one, one that the room is missing for.
    assert_eq!(stream.number(), 253u8.wrapping_add(LOOK_AHEAD as u8));
    assert_eq!(push(&mut stream, 0, ahead), Ok(Pushed::Repeated));
    assert_eq!(push(&mut stream, 0, 1), Ok(Pushed::Repeated));
    let room = Tick(START.0 + 20);
    assert_eq!(
        push(&mut stream, 0, ahead + 1),
        Err(KnotError::Full { room })
    );
    assert_eq!(
        push(&mut stream, 19, ahead + 1),
        Err(KnotError::Full { room })
    );
    assert_eq!(
        push(&mut stream, 20, ahead + 1),
        Ok(Pushed::Accepted { missing: 0 })
    );
    for number in 1..=ahead + 1 {
        assert_eq!(stream.at(Tick(START.0 + 20 * number)), at(number));
    }
    // Two are lost; the next one is in time until the last tick.
    let last = 20 * (ahead + 1);
    let missing = LONGEST_GAP;
    assert_eq!(
        push(&mut stream, 30, ahead + 2 + u64::from(missing)),
        Err(KnotError::TooManyMissing { missing })
    );
    assert_eq!(
        push(&mut stream, last, ahead + 4),
        Ok(Pushed::Accepted { missing: 2 })
    );
    assert_eq!(stream.at(Tick(START.0 + last)), at(ahead + 1));
    assert_eq!(stream.at(Tick(START.0 + last + 60)), at(ahead + 4));
    let ended = stream.ends();
    assert_eq!(
        push(&mut stream, last + 61, ahead + 5),
        Err(KnotError::TooLate { ended })
    );
}

/// What stops a stream that has run dry goes on from the acceleration that its curve ended with.
#[test]
fn a_late_refusal_does_not_change_the_acceleration_at_the_end() {
    let limits = limits();
    let at = |number: u64| sines(number as f64 * 0.02, 0.5);
    let mut stream = Stream::new(START, 0, at(0), period(20));
    let pushed = stream.push(START, 1, &knot(at(1), false), &limits);
    assert_eq!(pushed, Ok(Pushed::Accepted { missing: 0 }));
    let ends = stream.ends();
    let end = stream.at(ends);
    assert!(end.acceleration != Acceleration::ZERO);
    let error = stream.push(ends, 2, &knot(at(40), false), &limits);
    assert!(error.is_err());
    assert_eq!((stream.ends(), stream.at(ends)), (ends, end));
}

#[test]
fn refusals_name_the_limit_and_change_nothing() {
    let limits = limits();
    let refused = |from: (f64, f64), to: (f64, f64)| {
        let state = |(position, velocity)| Setpoint {
            position: Position::from_radians(position).expect("in range"),
            velocity: Velocity::from_radians(velocity).expect("in range"),
            acceleration: Acceleration::ZERO,
        };
        let mut stream = Stream::new(START, 0, state(from), period(20));
        let error = stream
            .push(START, 1, &knot(state(to), true), &limits)
            .expect_err("refused");
        assert_eq!(stream.ends(), START);
        error.to_string()
    };
    let says = |text: String, part: &str| assert!(text.contains(part), "{text}");
    says(
        refused((9.99, 0.0), (10.01, 0.0)),
        "outside the travel, which ends at 9.99",
    );
    says(refused((0.0, 0.0), (0.5, 25.0)), "reach 24.99");
    says(refused((0.0, 0.0), (0.41, 0.0)), "at most 19.9999");
    says(refused((0.0, 0.0), (0.1, 10.0)), "rad/s^2");
    says(
        refused((9.6, 19.5), (9.99, 19.5)),
        "too high to stop before the travel ends at 9.99",
    );
    says(
        refused((-9.6, -19.5), (-9.99, -19.5)),
        "stop before the travel ends at -9.99",
    );
    // At both ends inside the travel, in between not.
    says(refused((9.996, 1.2), (9.996, -1.2)), "outside the travel");
}

#[test]
fn a_stream_that_ends_at_rest_rests_there() {
    let limits = limits();
    for quintic in [false, true] {
        let mut stream = Stream::new(START, 0, setpoint(0, 0, 0), period(100));
        let target = Setpoint {
            position: Position::from_radians(0.1).expect("in range"),
            ..Setpoint::default()
        };
        let moving = Setpoint {
            position: Position::from_radians(0.05).expect("in range"),
            velocity: Velocity::from_radians(1.0).expect("in range"),
            ..Setpoint::default()
        };
        stream
            .push(START, 1, &knot(moving, quintic), &limits)
            .expect("gentle");
        assert!(!stream.ends_at_rest());
        stream
            .push(START, 2, &knot(target, quintic), &limits)
            .expect("gentle");
        assert!(stream.ends_at_rest());
        for later in [0, 1, 1_000_000] {
            assert_eq!(stream.at(Tick(stream.ends().0 + later)), target);
        }
    }
}
