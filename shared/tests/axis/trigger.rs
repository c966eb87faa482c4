//! Moves that wait for their trigger.

use super::bench::{Answer, Bench, OTHER, SESSION, staged, turns};
use canter_shared::axis::Outcome;
use canter_shared::axis::state::State;
use canter_shared::limits::Limits;
use canter_shared::time::{BusTime, Tick, Ticks};
use canter_shared::wire::command::{Action, Command, ProfileKind};
use canter_shared::wire::id::Function;
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;

fn trigger(group: u8, start: u64) -> Command {
    Command::Trigger {
        group,
        session: SESSION,
        start: Tick(start),
    }
}

/// Whatever is still to come, the trigger of `group` moves nothing.
#[track_caller]
fn is_forgotten(bench: &mut Bench, group: u8) {
    assert_eq!(bench.trigger(group, 5), Outcome::Ignored);
    bench.stays(2_000);
}

#[test]
fn a_staged_move_leaves_at_its_tick() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let group = bench.stage(1.0, 1_000);
    assert_eq!(bench.answer().detail, 1_000);
    bench.stays(500);
    let start = bench.tick + 100;
    bench.reports.clear();
    assert_eq!(bench.send(trigger(group, start)), Outcome::Accepted);
    assert_eq!(
        bench.answer(),
        Answer {
            sequence: group,
            function: Function::Trigger,
            reason: Reason::Accepted,
            detail: 1_100,
        }
    );
    bench.run(100);
    assert_eq!(bench.place(), 0.0);
    let started = Report::Started {
        sequence: group,
        time: BusTime(start * 1_000),
    };
    assert!(bench.reports.contains(&started), "{:?}", bench.reports);
    bench.run(999);
    assert!(bench.place() < 1.0);
    bench.run(1);
    assert_eq!(bench.setpoint.position, turns(1.0));
}

#[test]
fn a_trigger_of_another_group_or_session_is_not_meant() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let group = bench.stage(1.0, 1_000);
    assert_eq!(bench.trigger(group + 1, 5), Outcome::Ignored);
    let start = Tick(bench.tick + 5);
    let other = Command::Trigger {
        group,
        session: OTHER,
        start,
    };
    assert_eq!(bench.send(other), Outcome::Ignored);
    bench.stays(100);
    assert_eq!(bench.trigger(group, 5), Outcome::Accepted);
}

#[test]
fn a_repeated_trigger_gets_the_same_answer_and_starts_once() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let group = bench.stage(1.0, 1_000);
    let command = trigger(group, bench.tick + 10);
    assert_eq!(bench.send(command), Outcome::Accepted);
    let first = bench.answer();
    for _ in 0..3 {
        bench.reports.clear();
        assert_eq!(bench.send(command), Outcome::Repeated);
        assert_eq!(bench.answer(), first);
        bench.run(100);
    }
    bench.run(710);
    assert_eq!(bench.setpoint.position, turns(1.0));
    bench.reports.clear();
    assert_eq!(bench.send(command), Outcome::Repeated);
    bench.stays(2_000);
}

#[test]
fn a_late_trigger_is_refused_with_how_late_it_is() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let group = bench.stage(1.0, 1_000);
    let late = trigger(group, bench.tick - 3);
    let refused = Outcome::Rejected(Reason::TooLate);
    assert_eq!(bench.send(late), refused);
    let first = bench.answer();
    assert_eq!(first.detail, 3);
    // As often as it is asked, the answer is the same.
    bench.run(10);
    bench.reports.clear();
    assert_eq!(bench.send(late), Outcome::Repeated);
    assert_eq!(bench.answer(), first);
    // The others of the group have left or not: this one must be staged again.
    is_forgotten(&mut bench, group);
}

#[test]
fn a_trigger_far_ahead_is_refused() {
    for ahead in [10_001, 1 << 30, (1 << 40) - 1_000] {
        let mut bench = Bench::enabled(Limits::default(), 0.0);
        let group = bench.stage(1.0, 1_000);
        assert_eq!(
            bench.trigger(group, ahead),
            Outcome::Rejected(Reason::BadValue)
        );
        assert!(!bench.axis.is_moving());
        is_forgotten(&mut bench, group);
    }
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let group = bench.stage(1.0, 1_000);
    assert_eq!(bench.trigger(group, 10_000), Outcome::Accepted);
    bench.run(11_000);
    assert_eq!(bench.setpoint.position, turns(1.0));
}

#[test]
fn a_stop_forgets_what_is_staged() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let group = bench.stage(1.0, 1_000);
    assert_eq!(bench.send(Command::Stop { sequence: 0 }), Outcome::Accepted);
    is_forgotten(&mut bench, group);
}

#[test]
fn disabling_forgets_what_is_staged() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let group = bench.stage(1.0, 1_000);
    assert_eq!(bench.control(Action::Disable), Outcome::Accepted);
    bench.run(10);
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    bench.run(10);
    assert_eq!(bench.axis.state(), State::OperationEnabled);
    is_forgotten(&mut bench, group);
}

#[test]
fn a_fault_forgets_what_is_staged() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let group = bench.stage(1.0, 1_000);
    assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
    bench.run(5);
    assert_eq!(bench.control(Action::Clear), Outcome::Accepted);
    bench.run(5);
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    bench.run(10);
    assert_eq!(bench.axis.state(), State::OperationEnabled);
    is_forgotten(&mut bench, group);
}

#[test]
fn a_move_that_leaves_now_replaces_what_is_staged() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let group = bench.stage(1.0, 1_000);
    assert_eq!(bench.go(0.5, 500), Outcome::Accepted);
    bench.run(600);
    is_forgotten(&mut bench, group);
}

#[test]
fn of_two_stages_the_last_one_counts() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let first = bench.stage(1.0, 1_000);
    let last = bench.stage(-1.0, 1_000);
    assert_eq!(bench.trigger(first, 5), Outcome::Ignored);
    assert_eq!(bench.trigger(last, 5), Outcome::Accepted);
    bench.run(1_100);
    assert_eq!(bench.setpoint.position, turns(-1.0));
}

#[test]
fn a_start_ahead_is_called_off_by_a_stop_and_by_whatever_stops() {
    let stops: [fn(&mut Bench) -> Outcome; 3] = [
        |bench| bench.send(Command::Stop { sequence: 0 }),
        |bench| bench.send(Command::EmergencyStop),
        |bench| bench.control(Action::Disable),
    ];
    for stop in stops {
        let mut bench = Bench::enabled(Limits::default(), 0.0);
        let group = bench.stage(1.0, 1_000);
        let command = trigger(group, bench.tick + 50);
        assert_eq!(bench.send(command), Outcome::Accepted);
        bench.run(10);
        assert_eq!(stop(&mut bench), Outcome::Accepted);
        assert_eq!(bench.send(command), Outcome::Repeated);
        bench.stays(2_000);
        let any = |report: &Report| matches!(report, Report::Started { .. });
        assert!(!bench.reports.iter().any(any));
    }
}

#[test]
fn what_cannot_be_done_is_refused_when_it_is_staged() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(
        bench.send(staged(3, 1.0, 1)),
        Outcome::Rejected(Reason::TooFast)
    );
    assert_eq!(
        bench.send(staged(4, 1_001.0, 1_000_000)),
        Outcome::Rejected(Reason::OutsideTravel)
    );
    is_forgotten(&mut bench, 3);
    is_forgotten(&mut bench, 4);
}

/// Found by `canter soak`: such an axis said that it rested, so its clock could be set in mid-move,
/// and a stop was not planned.
#[test]
fn a_move_with_nowhere_to_go_does_not_hide_the_one_under_way() {
    for profile in [
        ProfileKind::Beta,
        ProfileKind::Trapezoid,
        ProfileKind::SCurve,
    ] {
        let mut bench = Bench::enabled(Limits::default(), 0.0);
        assert_eq!(bench.go(1.0, 1_000), Outcome::Accepted);
        bench.run(300);
        // The same again, later: it lies over the first one, and has nowhere to go either.
        assert_eq!(bench.go(1.0, 1_200), Outcome::Accepted);
        bench.run(10);
        let group = bench.next();
        let there = Command::Move {
            profile,
            staged: true,
            target: turns(1.0),
            duration: Ticks(100),
            sequence: group,
        };
        assert_eq!(bench.send(there), Outcome::Accepted);
        assert_eq!(bench.trigger(group, 1_500), Outcome::Accepted);
        bench.run(10);
        assert!(bench.axis.is_moving(), "{profile:?}");
        let command = Command::Stop { sequence: 0 };
        assert_eq!(bench.send(command), Outcome::Accepted);
        bench.run(300);
        assert!(!bench.axis.is_moving(), "{profile:?}");
        assert!(bench.place() < 0.9, "{profile:?}: {}", bench.place());
    }
}
