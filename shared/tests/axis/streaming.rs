//! Streams of knots as the host sees them: begun, followed, ended; refused; stopped; run dry.

use super::bench::{Bench, beta, control, staged, travel};
use super::planner::{Planner, STOP};
use super::streams::{PERIOD, knot, quintic};
use canter_shared::axis::Outcome;
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::drive::{Condition, DriveReport};
use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::shaping::{ShaperKind, Shaping};
use canter_shared::motion::stream::LOOK_AHEAD;
use canter_shared::time::Tick;
use canter_shared::wire::command::{Action, Command};
use canter_shared::wire::id::Function;
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;

const REFUSED: fn(Reason) -> Outcome = Outcome::Rejected;

#[test]
fn a_stream_follows_its_knots_and_ends_at_rest_without_a_fault() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    // Over the end of the numbers, 63.
    let first = 60;
    assert_eq!(bench.begin(50, PERIOD, first), Outcome::Accepted);
    assert_eq!(bench.answer().function, Function::StreamBegin);
    assert!(bench.axis.is_moving());
    let start = bench.tick + 50;
    let sequence = bench.sequence;
    let mut number = 0;
    let mut farthest = 0.0f64;
    while bench.tick < start + 2_000 {
        while number < 100 && start + number * u64::from(PERIOD) < bench.tick + 100 {
            number += 1;
            let (position, velocity) = quintic(1.5, 2.0, number as f64 * 0.02);
            let said = first.wrapping_add(number as u8);
            assert_eq!(
                bench.send(knot(said, position, velocity)),
                Outcome::Accepted
            );
        }
        bench.step_evenly();
        let (ideal, _) = quintic(1.5, 2.0, bench.tick.saturating_sub(start) as f64 / 1e3);
        farthest = farthest.max((bench.place() - ideal).abs());
    }
    // A cubic over 20 ms is off by T^4 / 384 of the fourth derivative, 360 * 1.5 / 2^4 turns/s^4 at
    // the most, and the wire's velocity by half a step of 2^-14 turn/s for a quarter of 20 ms.
    assert!(farthest < 4e-7, "{farthest}");
    assert!(!bench.axis.is_moving());
    assert_eq!(bench.place(), 1.5);
    bench.stays(300);
    assert_eq!(bench.axis.state(), State::OperationEnabled);
    assert_eq!(bench.axis.fault(), None);
    assert_eq!(bench.knot_answers(), []);
    let time = Tick(start).time();
    assert!(bench.reports.contains(&Report::Started { sequence, time }));
    // It is over: another knot has nothing to follow, and moves are taken again.
    assert_eq!(
        bench.send(knot(33, 1.6, 0.0)),
        REFUSED(Reason::NotStreaming)
    );
    assert_eq!(bench.go(0.0, 2_000), Outcome::Accepted);
    bench.run(2_001);
    assert_eq!(bench.place(), 0.0);
}

#[test]
fn lost_knots_are_told_and_old_ones_are_passed_over() {
    let (mut bench, last) = Bench::streaming(Limits::default(), 1.5, 2.0, 700);
    let at = |number: u8| {
        let (position, velocity) = quintic(1.5, 2.0, f64::from(number) * 0.02);
        knot(number, position, velocity)
    };
    // The last ones again, and an old one: each a repetition, whatever it says.
    for number in [last, last - 1, last - 4, last.wrapping_sub(32)] {
        assert_eq!(bench.send(knot(number, 900.0, 7.0)), Outcome::Repeated);
    }
    assert_eq!(bench.knot_answers(), []);
    let rejected = bench.axis.counters_mut().rejected;
    // One is lost on its way: the next says so, and the lost one comes too late.
    bench.run(20);
    assert_eq!(bench.send(at(last + 2)), Outcome::Accepted);
    assert_eq!(bench.send(at(last + 1)), Outcome::Repeated);
    bench.run(80);
    assert_eq!(bench.send(at(last + 6)), Outcome::Accepted);
    let told = [
        ((last + 2) % 64, Reason::Accepted, 1),
        ((last + 6) % 64, Reason::Accepted, 3),
    ];
    assert_eq!(bench.knot_answers(), told);
    // Too many: the stream is as it was, and those in between may still come.
    assert_eq!(bench.send(at(last + 15)), REFUSED(Reason::KnotsMissing));
    assert_eq!(bench.answer().detail, 8);
    assert_eq!(bench.axis.counters_mut().rejected, rejected + 1);
    assert_eq!(bench.send(at(last + 7)), Outcome::Accepted);
    let ideal = |bench: &Bench| quintic(1.5, 2.0, (bench.tick - 16) as f64 / 1e3).0;
    for _ in 0..60 {
        bench.step_evenly();
        assert!(
            (bench.place() - ideal(&bench)).abs() < 1e-4,
            "{}",
            bench.place()
        );
    }
}

#[test]
fn knots_are_refused_with_a_reason_and_change_nothing() {
    let (mut bench, last) = Bench::streaming(travel(2.0), 1.5, 2.0, 900);
    let mut twin = bench.axis.clone();
    let (place, speed) = quintic(1.5, 2.0, f64::from(last) * 0.02);
    for (position, velocity, reason) in [
        (2.5, speed, Reason::OutsideTravel),
        (place + 0.1, 3.3, Reason::TooFast),
        (place + 0.06, 3.0, Reason::TooStrong),
        (place, -speed, Reason::TooStrong),
    ] {
        assert_eq!(
            bench.send(knot(last + 1, position, velocity)),
            REFUSED(reason)
        );
        let answer = bench.answer();
        assert_eq!(
            (answer.sequence, answer.function),
            ((last + 1) % 64, Function::Knot)
        );
        assert_eq!(answer.detail, 0);
    }
    for tick in bench.tick + 1..bench.tick + 90 {
        bench.step();
        assert_eq!(bench.setpoint, twin.tick(Tick(tick), Tick(tick).time()));
    }
    // As many as it holds, and how long to wait for one more.
    let (mut bench, _) = Bench::streaming(Limits::default(), 1.5, 2.0, 1);
    let mut full = None;
    let held = LOOK_AHEAD as u8;
    for number in 6..held + 3 {
        let (position, velocity) = quintic(1.5, 2.0, f64::from(number) * 0.02);
        match bench.send(knot(number, position, velocity)) {
            Outcome::Accepted => {}
            refused => full = full.or(Some((number, refused, bench.answer().detail))),
        }
    }
    assert_eq!(full, Some((held + 1, REFUSED(Reason::StreamFull), 20)));
    // Towards the end of the travel, too fast to stop.
    let mut bench = Bench::enabled(travel(0.3), 0.0);
    assert_eq!(bench.begin(1, 100, 0), Outcome::Accepted);
    assert_eq!(bench.send(knot(1, 0.1, 2.0)), Outcome::Accepted);
    assert_eq!(bench.send(knot(2, 0.29, 1.9)), REFUSED(Reason::CannotStop));
    assert_eq!(bench.send(knot(2, 0.2, 0.0)), Outcome::Accepted);
}

#[test]
fn a_stream_is_refused_where_it_cannot_begin() {
    let mut bench = Bench::new(Limits::default(), 0.0);
    bench.run(5);
    assert_eq!(bench.begin(10, PERIOD, 0), REFUSED(Reason::NotHeld));
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    assert_eq!(bench.begin(10, PERIOD, 0), REFUSED(Reason::NotEnabled));
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    bench.run(10);
    assert_eq!(bench.begin(0, PERIOD, 0), REFUSED(Reason::TooLate));
    assert_eq!(bench.answer().detail, 1);
    for (ahead, period, number) in [(10_001, PERIOD, 0), (10, 0, 0)] {
        assert_eq!(
            bench.begin(ahead, period, number),
            REFUSED(Reason::BadValue)
        );
    }
    assert_eq!(bench.send(knot(1, 0.0, 0.0)), REFUSED(Reason::NotStreaming));
    assert_eq!(bench.go(1.0, 1_000), Outcome::Accepted);
    assert_eq!(bench.begin(10, PERIOD, 0), REFUSED(Reason::Moving));
    bench.run(1_001);
    assert_eq!(bench.begin(10_000, PERIOD, 63), Outcome::Accepted);
    assert_eq!(bench.begin(10_000, PERIOD, 63), REFUSED(Reason::Moving));
}

/// The same bytes again, whether the first answer was lost or not.
#[test]
fn a_begin_that_comes_twice_begins_one_stream() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let begin = Command::StreamBegin {
        start: Tick(bench.tick + 5),
        period: PERIOD,
        number: 0,
        sequence: bench.next(),
    };
    assert_eq!(bench.send(begin), Outcome::Accepted);
    assert_eq!(bench.send(knot(1, 0.001, 0.0)), Outcome::Accepted);
    bench.run(10);
    assert_eq!(bench.send(begin), Outcome::Repeated);
    assert_eq!(bench.answer().reason, Reason::Accepted);
    bench.run(20);
    assert!(bench.place() > 0.0009 && !bench.axis.is_moving());
}

#[test]
fn nothing_else_is_taken_while_a_stream_is_there() {
    for ticks in [0, 600] {
        let mut bench = Bench::enabled(Limits::default(), 0.0);
        let group = bench.stage(0.5, 1_000);
        if ticks == 0 {
            assert_eq!(bench.begin(500, PERIOD, 0), Outcome::Accepted);
        } else {
            bench.stream_on(1.5, 2.0, ticks);
        }
        assert_eq!(bench.trigger(group, 10), REFUSED(Reason::Moving));
        let sequence = bench.next();
        assert_eq!(
            bench.send(beta(sequence, 0.5, 900)),
            REFUSED(Reason::Moving)
        );
        let sequence = bench.next();
        assert_eq!(
            bench.send(staged(sequence, 0.5, 900)),
            REFUSED(Reason::Moving)
        );
        assert_eq!(bench.control(Action::Release), REFUSED(Reason::Moving));
        assert_eq!(bench.begin(10, PERIOD, 0), REFUSED(Reason::Moving));
    }
}

/// Whatever calls off a move that has not begun calls off a stream that has not.
#[test]
fn a_stream_that_has_not_begun_is_called_off() {
    let rejected = REFUSED(Reason::NotStreaming);
    for what in 0..5 {
        let mut bench = Bench::enabled(Limits::default(), 0.0);
        assert_eq!(bench.begin(20, PERIOD, 0), Outcome::Accepted);
        assert_eq!(bench.send(knot(1, 0.001, 0.0)), Outcome::Accepted);
        let outcome = match what {
            0 => bench.send(STOP),
            1 => bench.control(Action::Hold),
            2 => bench.control(Action::Disable),
            3 => bench.send(Command::EmergencyStop),
            _ => {
                // The clock of the node is set.
                bench.axis.rebase(Tick(bench.tick));
                Outcome::Accepted
            }
        };
        assert_eq!(outcome, Outcome::Accepted, "{what}");
        assert_eq!(bench.send(knot(2, 0.002, 0.0)), rejected, "{what}");
        bench.stays(100);
        let faulted = bench.axis.fault() == Some(Fault::EmergencyStop);
        assert_eq!(faulted, what == 3);
        let started = |report: &Report| matches!(report, Report::Started { .. });
        assert!(!bench.reports.iter().any(started), "{what}");
    }
    // A silent host, 0.25 s after its last heartbeat.
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    bench.beats = false;
    assert_eq!(bench.begin(1_000, PERIOD, 0), Outcome::Accepted);
    bench.run(1_100);
    assert_eq!(bench.axis.fault(), Some(Fault::HostTimeout));
    assert_eq!(bench.send(knot(1, 0.001, 0.0)), rejected);
}

#[test]
fn a_later_hold_of_the_same_session_leaves_a_stream_under_way() {
    let (mut bench, last) = Bench::streaming(Limits::default(), 1.5, 2.0, 700);
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    bench.run(20);
    let (position, velocity) = quintic(1.5, 2.0, f64::from(last + 1) * 0.02);
    let next = knot(last + 1, position, velocity);
    assert_eq!(bench.send(next), Outcome::Accepted);
}

/// Without any knot there is nothing to follow: the axis rests, and a host that goes on is told.
#[test]
fn a_stream_without_knots_is_over_at_its_start() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.begin(5, PERIOD, 0), Outcome::Accepted);
    bench.run(5);
    assert!(!bench.axis.is_moving());
    assert_eq!(
        bench.send(knot(1, 0.001, 0.0)),
        REFUSED(Reason::NotStreaming)
    );
    bench.stays(100);
    assert_eq!(bench.axis.fault(), None);
}

/// Nobody plans: the brake needs nobody.
#[test]
fn a_stream_that_runs_dry_brakes_by_itself_and_latches_its_fault() {
    for planner in [Planner::default(), Planner::erratic(1, vec![None])] {
        let (mut bench, last) = Bench::streaming(Limits::default(), 1.5, 2.0, 900);
        bench.planner = planner;
        let start = bench.tick - 899;
        let ends = start + u64::from(last) * u64::from(PERIOD);
        while bench.tick < ends {
            bench.step_evenly();
        }
        assert_eq!(bench.axis.fault(), None);
        let (from, speed) = (bench.place(), bench.velocity());
        assert!(speed > 8.0, "{speed}");
        bench.step_evenly();
        assert_eq!(bench.axis.fault(), Some(Fault::StreamUnderrun));
        assert_eq!(bench.axis.state(), State::FaultReactionActive);
        let sent = bench.send(knot(last + 1, 1.0, 0.0));
        assert_eq!(sent, REFUSED(Reason::NotStreaming));
        while bench.axis.state() == State::FaultReactionActive {
            bench.step_evenly();
        }
        let ticks = (speed / 200.0 * 1e3).ceil() as u64;
        assert!(bench.tick <= ends + ticks + 1, "{}", bench.tick - ends);
        let way = (bench.place() - from) * std::f64::consts::TAU;
        assert!((way - speed * speed / 400.0).abs() < 1e-8, "{way}");
        assert_eq!(bench.axis.state(), State::Fault);
        bench.stays(100);
    }
}

#[test]
fn a_stop_ends_a_stream_under_way_wherever_it_comes() {
    for ticks in (10..1_990).step_by(37) {
        for (lead, delay) in [(0, 0), (1, 0), (3, 2), (1, 60)] {
            let (mut bench, last) = Bench::streaming(Limits::default(), 1.5, 2.0, ticks);
            bench.planner = Planner::slow(lead, delay);
            // Where its knots alone would have led it.
            let mut twin = bench.axis.clone();
            let mut rests = bench.tick;
            while twin.is_moving() {
                rests += 1;
                let setpoint = twin.tick(Tick(rests), Tick(rests).time());
                twin.handle_drive(DriveReport {
                    condition: Condition::Enabled,
                    position: setpoint.position,
                    velocity: setpoint.velocity,
                });
                let _: Option<Outcome> = twin.plan();
            }
            assert_eq!(bench.send(STOP), Outcome::Accepted);
            let sent = bench.send(knot(last + 1, 0.0, 0.0));
            assert_eq!(sent, REFUSED(Reason::NotStreaming));
            // Seven plans that come too late, at the most.
            let mut left = 7 * u64::from(delay) + 300;
            while bench.axis.is_moving() {
                bench.step_evenly();
                left -= 1;
                assert!(left > 0, "{ticks} {delay}");
                if bench.velocity() != 0.0 {
                    assert!(bench.tick < rests, "{ticks} {delay}");
                }
            }
            assert_eq!(bench.axis.state(), State::OperationEnabled);
            assert_eq!(bench.axis.fault(), None);
            bench.stays(30);
            bench.planner = Planner::default();
            assert_eq!(bench.go(0.2, 4_000), Outcome::Accepted);
        }
    }
}

#[test]
fn a_stop_keeps_the_jerk_limit_where_there_is_room() {
    let (mut bench, _) = Bench::streaming(Limits::default(), 1.5, 2.0, 900);
    assert_eq!(bench.send(STOP), Outcome::Accepted);
    let most = bench.axis.limits().jerk().radians() * 1e-3 + 1e-6;
    while bench.axis.is_moving() {
        let last = bench.setpoint.acceleration;
        bench.step_evenly();
        let step = (bench.setpoint.acceleration - last).radians();
        assert!(step.abs() <= most, "{step}");
    }
}

/// A knot that is reached at full speed just where it must be braked, and a jerk limit that is too
/// low to stop before: the stream itself brakes from the splice on.
#[test]
fn a_stop_without_room_brakes_at_once() {
    const TURN: f64 = std::f64::consts::TAU;
    // From 8 rad/s it brakes over 0.16 rad, and loses 0.016 rad to two ticks.
    let limits = Limits::new(&LimitValues {
        jerk: 0.1,
        position_maximum: 0.4 + 0.18,
        ..DEFAULT_VALUES
    })
    .expect("in range");
    for ticks in 88..100 {
        let mut bench = Bench::enabled(limits, 0.0);
        assert_eq!(bench.begin(1, 100, 0), Outcome::Accepted);
        let sent = bench.send(knot(1, 0.4 / TURN, 8.0 / TURN));
        assert_eq!(sent, Outcome::Accepted);
        bench.run(ticks);
        let speed = bench.velocity();
        assert!(speed > 6.5, "{speed}");
        assert_eq!(bench.send(STOP), Outcome::Accepted);
        let begin = bench.tick;
        while bench.axis.is_moving() {
            bench.step_evenly();
        }
        // Along its knots it would take until the knot and 40 ms more.
        let most = (speed / 200.0 * 1e3).ceil() as u64;
        assert_eq!(bench.tick - begin, most, "{ticks}");
        assert_eq!(bench.axis.state(), State::OperationEnabled);
        bench.stays(20);
    }
}

#[test]
fn disable_faults_and_silence_stop_a_stream() {
    for what in 0..3 {
        let (mut bench, _) = Bench::streaming(Limits::default(), 1.5, 2.0, 900);
        let most = match what {
            0 => {
                let sequence = bench.next();
                assert_eq!(
                    bench.send(control(sequence, Action::Disable)),
                    Outcome::Accepted
                );
                150
            }
            1 => {
                assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
                150
            }
            _ => {
                // The host is silent, and its knots end before the time-out.
                bench.beats = false;
                300
            }
        };
        let end = bench.tick + most;
        while bench.axis.state().drives() {
            bench.step_evenly();
            assert!(bench.tick < end, "{what}");
        }
        let expected = match what {
            0 => (State::SwitchOnDisabled, None),
            1 => (State::Fault, Some(Fault::EmergencyStop)),
            _ => (State::Fault, Some(Fault::StreamUnderrun)),
        };
        assert_eq!((bench.axis.state(), bench.axis.fault()), expected);
    }
}

#[test]
fn a_shaped_stream_arrives_later_and_exactly() {
    let shaping = Shaping::new(ShaperKind::Zvd, 12.0, 0.02).expect("in range");
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.axis.shape(Some(&shaping)), Ok(()));
    bench.stream_on(1.5, 2.0, 2_000 + 1);
    assert!(bench.axis.is_moving());
    for _ in 0..shaping.delay().0 {
        bench.step_evenly();
    }
    assert!(!bench.axis.is_moving());
    assert_eq!(bench.place(), 1.5);
    assert_eq!(bench.axis.fault(), None);
}

/// Found by `canter soak`: a stop that came while a stream stood for a moment let it go on.
#[test]
fn a_stop_holds_a_stream_that_stands_for_a_moment() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.begin(1, PERIOD, 0), Outcome::Accepted);
    // It waits where it is for three periods, then goes.
    for (number, place) in [(1, 0.0), (2, 0.0), (3, 0.0), (4, 0.001), (5, 0.001)] {
        assert_eq!(bench.send(knot(number, place, 0.0)), Outcome::Accepted);
    }
    bench.run(10);
    let command = Command::Stop { sequence: 0 };
    assert_eq!(bench.send(command), Outcome::Accepted);
    bench.run(2);
    assert!(!bench.axis.is_moving());
    bench.stays(300);
    assert_eq!(bench.place(), 0.0);
}
