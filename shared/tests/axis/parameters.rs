//! What is set about an axis: who may read it, who may change it and when, and that it counts.

use super::bench::{AXIS, Bench, turns};
use canter_shared::axis::Outcome;
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::limits::Limits;
use canter_shared::motion::beta::Beta;
use canter_shared::parameter::{Parameter, Values};
use canter_shared::wire::command::{Action, Command, Item};
use canter_shared::wire::id::Function;
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;

fn write(bench: &mut Bench, parameter: Parameter, value: i64) -> Outcome {
    let sequence = bench.next();
    bench.send(Command::ParameterWrite {
        parameter: parameter.into(),
        value,
        sequence,
    })
}

#[track_caller]
fn read(bench: &mut Bench, parameter: u8, item: Item) -> i64 {
    bench.reports.clear();
    let outcome = bench.send(Command::ParameterRead { parameter, item });
    assert_eq!(outcome, Outcome::Accepted);
    let value = bench.reports.iter().find_map(|report| match *report {
        Report::Parameter {
            parameter: of,
            item: what,
            value,
        } if (of, what) == (parameter, item) => Some(value),
        _ => None,
    });
    value.expect("a value")
}

#[track_caller]
fn refused(bench: &Bench, outcome: Outcome, reason: Reason, detail: u32) {
    assert_eq!(outcome, Outcome::Rejected(reason));
    let answer = bench.answer();
    assert_eq!((answer.reason, answer.detail), (reason, detail));
}

fn number(parameter: Parameter) -> u32 {
    u8::from(parameter).into()
}

#[test]
fn anybody_may_read_everything() {
    // Nobody holds the axis.
    let mut bench = Bench::new(Limits::default(), 0.0);
    bench.run(5);
    for parameter in Parameter::ALL {
        let entry = parameter.entry();
        let default = Values::defaults(AXIS.get()).get(parameter);
        for (item, value) in [
            (Item::Value, default),
            (Item::Saved, default),
            (Item::Minimum, entry.minimum),
            (Item::Maximum, entry.maximum),
            (Item::Default, default),
        ] {
            assert_eq!(read(&mut bench, parameter.into(), item), value, "{entry:?}");
        }
    }
    let unknown = Parameter::COUNT as u8;
    let outcome = bench.send(Command::ParameterRead {
        parameter: unknown,
        item: Item::Value,
    });
    refused(&bench, outcome, Reason::UnknownParameter, unknown.into());
    assert_eq!(bench.answer().function, Function::ParameterRead);
}

/// However many ask, there is room for the answers to commands.
#[test]
fn a_flood_of_questions_does_not_crowd_out_an_answer() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    bench.reports.clear();
    for parameter in 0..100 {
        let ask = super::bench::frame(Command::ParameterRead {
            parameter,
            item: Item::Value,
        });
        let _: Outcome = bench.axis.handle_frame(bench.now(), &ask);
    }
    let stop = super::bench::frame(Command::Stop { sequence: 77 });
    assert_eq!(
        bench.axis.handle_frame(bench.now(), &stop),
        Outcome::Accepted
    );
    bench.drain();
    assert_eq!(bench.answer().sequence, 77);
    let readings = bench.reports.iter();
    let readings = readings.filter(|report| matches!(report, Report::Parameter { .. }));
    assert_eq!(readings.count(), 4);
}

#[test]
fn only_the_session_that_holds_the_axis_writes() {
    let mut bench = Bench::new(Limits::default(), 0.0);
    bench.run(5);
    let outcome = write(&mut bench, Parameter::JerkLimit, 1_000_000);
    refused(&bench, outcome, Reason::NotHeld, 0);
    assert_eq!(bench.axis.values(), &Values::defaults(AXIS.get()));
}

#[test]
fn a_limit_counts_from_the_next_plan_on() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(
        write(&mut bench, Parameter::VelocityLimit, 1_000_000_000),
        Outcome::Accepted
    );
    assert!((bench.axis.limits().velocity().radians() - 1.0).abs() < 1e-8);
    // 1 turn at 1 rad/s takes 6.3 s at least; by the old limit half a second was enough.
    let shortest = Beta::shortest(turns(1.0), &Limits::default()).expect("a short way");
    let outcome = bench.go(1.0, shortest.0);
    let slow = Beta::shortest(turns(1.0), bench.axis.limits()).expect("a short way");
    assert!(slow.0 > 6_283, "{slow:?}");
    refused(&bench, outcome, Reason::TooFast, slow.0);
    assert_eq!(bench.go(1.0, slow.0), Outcome::Accepted);
    bench.ticks_to_rest(u64::from(slow.0) + 5);
    assert_eq!(bench.setpoint.position, turns(1.0));
}

#[test]
fn nothing_changes_while_the_axis_moves() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.go(1.0, 2_000), Outcome::Accepted);
    bench.run(500);
    let before = *bench.axis.values();
    let outcome = write(&mut bench, Parameter::VelocityLimit, 1_000_000_000);
    refused(&bench, outcome, Reason::Moving, 0);
    assert_eq!(bench.axis.values(), &before);
    bench.ticks_to_rest(2_000);
    assert_eq!(
        write(&mut bench, Parameter::VelocityLimit, 1_000_000_000),
        Outcome::Accepted
    );
}

#[test]
fn what_is_out_of_range_or_contradicts_changes_nothing() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let before = *bench.axis.values();
    let maximum = Parameter::PositionMinimum;
    let top = Parameter::PositionMaximum.entry().maximum;
    for (parameter, value) in [
        (Parameter::VelocityLimit, 0),
        (Parameter::VelocityLimit, -1),
        (Parameter::HostTimeout, 99),
        (Parameter::HostReaction, 3),
        (maximum, top + 1),
        // Half a second of memory would be needed.
        (Parameter::ShaperFrequency, 99_999),
    ] {
        let outcome = write(&mut bench, parameter, value);
        refused(&bench, outcome, Reason::OutOfRange, number(parameter));
        assert_eq!(bench.axis.values(), &before);
    }
    assert_eq!(
        write(&mut bench, Parameter::PositionMaximum, 1_000_000_000),
        Outcome::Accepted
    );
    let outcome = write(&mut bench, Parameter::PositionMinimum, 1_000_000_001);
    refused(&bench, outcome, Reason::OutOfRange, number(maximum));
}

#[test]
fn the_drives_id_changes_only_while_the_axis_is_disabled() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let outcome = write(&mut bench, Parameter::DriveNode, 9);
    let state = u8::from(State::OperationEnabled).into();
    refused(&bench, outcome, Reason::NotDisabled, state);
    assert_eq!(bench.control(Action::Disable), Outcome::Accepted);
    bench.run(5);
    assert_eq!(
        write(&mut bench, Parameter::DriveNode, 9),
        Outcome::Accepted
    );
    assert_eq!(
        read(&mut bench, Parameter::DriveNode.into(), Item::Value),
        9
    );
    assert_eq!(
        read(&mut bench, Parameter::DriveNode.into(), Item::Saved),
        AXIS.get().into()
    );
}

/// As when it is enabled there: it stands, and can be moved inside.
#[test]
fn an_axis_that_stands_outside_of_its_new_travel_stays_and_moves_inside() {
    let mut bench = Bench::enabled(Limits::default(), 1.0);
    assert_eq!(
        write(&mut bench, Parameter::PositionMaximum, 1_000_000_000),
        Outcome::Accepted
    );
    bench.stays(200);
    let outcome = bench.go(0.9, 2_000);
    refused(&bench, outcome, Reason::OutsideTravel, 0);
    assert_eq!(bench.go(0.125, 2_000), Outcome::Accepted);
    bench.ticks_to_rest(2_005);
    assert_eq!(bench.setpoint.position, turns(0.125));
}

#[test]
fn the_hosts_silence_is_measured_by_its_parameter() {
    for ticks in [100, 130, 400] {
        let mut bench = Bench::enabled(Limits::default(), 0.0);
        assert_eq!(
            write(&mut bench, Parameter::HostTimeout, ticks),
            Outcome::Accepted
        );
        // Until its next beat, which is the last.
        while !bench.tick.is_multiple_of(50) {
            bench.step();
        }
        bench.beats = false;
        let last = bench.tick;
        while bench.axis.fault().is_none() {
            bench.step();
            assert!(bench.tick < last + 1_000);
        }
        assert_eq!(bench.axis.fault(), Some(Fault::HostTimeout));
        assert_eq!(bench.tick - last, ticks as u64 + 1);
    }
}

#[test]
fn feedback_and_heartbeat_come_as_often_as_is_set() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    for (parameter, ticks) in [
        (Parameter::FeedbackPeriod, 5),
        (Parameter::HeartbeatPeriod, 125),
    ] {
        assert_eq!(write(&mut bench, parameter, ticks), Outcome::Accepted);
    }
    bench.run(2);
    bench.reports.clear();
    bench.run(1_000);
    let count = |wanted: fn(&Report) -> bool| bench.reports.iter().filter(|r| wanted(r)).count();
    assert_eq!(
        count(|report| matches!(report, Report::Feedback { .. })),
        200
    );
    assert_eq!(
        count(|report| matches!(report, Report::Heartbeat { .. })),
        8
    );
}

#[test]
fn a_shaper_that_is_set_delays_the_arrival() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    for (parameter, value) in [
        (Parameter::ShaperFrequency, 10_000_000),
        (Parameter::ShaperKind, 1),
    ] {
        assert_eq!(write(&mut bench, parameter, value), Outcome::Accepted);
    }
    bench.stays(50);
    assert_eq!(bench.go(0.25, 1_000), Outcome::Accepted);
    let ticks = bench.ticks_to_rest(2_000);
    // Half a period of 10 Hz.
    assert!((1_049..=1_053).contains(&ticks), "{ticks}");
    assert_eq!(bench.setpoint.position, turns(0.25));
}

#[test]
fn restoring_gives_the_defaults_but_not_while_enabled() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(
        write(&mut bench, Parameter::JerkLimit, 1_000_000),
        Outcome::Accepted
    );
    let outcome = bench.control(Action::Restore);
    let state = u8::from(State::OperationEnabled).into();
    refused(&bench, outcome, Reason::NotDisabled, state);
    assert_eq!(bench.control(Action::Disable), Outcome::Accepted);
    bench.run(5);
    assert_eq!(bench.control(Action::Restore), Outcome::Accepted);
    assert_eq!(bench.axis.values(), &Values::defaults(AXIS.get()));
    assert_eq!(
        bench.axis.limits(),
        &Values::defaults(AXIS.get()).settings().limits
    );
}

/// A write that is repeated is done once, and answered as the first time.
#[test]
fn a_repeated_write_gets_the_same_answer() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let sequence = bench.next();
    let word = Command::ParameterWrite {
        parameter: Parameter::JerkLimit.into(),
        value: 1_000_000,
        sequence,
    };
    assert_eq!(bench.send(word), Outcome::Accepted);
    let answer = bench.answer();
    bench.reports.clear();
    assert_eq!(bench.send(word), Outcome::Repeated);
    assert_eq!(bench.answer(), answer);
}

#[test]
fn lost_parameters_are_a_fault_that_can_be_cleared() {
    let mut bench = Bench::new(Limits::default(), 0.0);
    bench.axis.lose_parameters();
    bench.run(5);
    assert_eq!(bench.axis.fault(), Some(Fault::ParametersLost));
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    let outcome = bench.control(Action::Enable);
    let fault = u8::from(Fault::ParametersLost).into();
    refused(&bench, outcome, Reason::FaultLatched, fault);
    // Parameters are set and saved in this state: that is the cure.
    assert_eq!(
        write(&mut bench, Parameter::JerkLimit, 1_000_000),
        Outcome::Accepted
    );
    assert_eq!(bench.control(Action::Save), Outcome::Accepted);
    assert_eq!(bench.control(Action::Clear), Outcome::Accepted);
    bench.run(5);
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
}
