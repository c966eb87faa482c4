//! Numbers and answers: what comes twice is answered twice and done once.

use super::bench::{Answer, Bench, beta, control};
use canter_shared::axis::Outcome;
use canter_shared::axis::state::State;
use canter_shared::drive::{Condition, Trouble};
use canter_shared::limits::Limits;
use canter_shared::wire::command::{Action, Command};
use canter_shared::wire::id::Function;
use canter_shared::wire::reason::Reason;

const STALE: Outcome = Outcome::Rejected(Reason::StaleSequence);

#[test]
fn a_repeated_command_gets_the_same_answer_and_is_done_once() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.send(beta(3, 1.0, 1_000)), Outcome::Accepted);
    let first = bench.answer();
    assert_eq!(
        first,
        Answer {
            sequence: 3,
            function: Function::MoveBeta,
            reason: Reason::Accepted,
            detail: 1_000,
        }
    );
    bench.run(300);
    // Done anew it would last a second from here.
    for _ in 0..3 {
        bench.reports.clear();
        assert_eq!(bench.send(beta(3, 1.0, 1_000)), Outcome::Repeated);
        assert_eq!(bench.answer(), first);
    }
    assert_eq!(bench.ticks_to_rest(701), 700);
}

#[test]
fn a_number_that_is_not_ahead_is_refused_with_the_last_one() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.send(beta(100, 1.0, 1_000)), Outcome::Accepted);
    // 228 is 128 ahead, which is as far behind.
    for stale in [100, 99, 3, 228, 255] {
        let command = beta(stale, -1.0, 1_000);
        let wanted = Outcome::Rejected(Reason::StaleSequence);
        assert_eq!(bench.send(command), wanted, "{stale}");
        assert_eq!(bench.answer().detail, 100);
    }
    assert_eq!(bench.send(beta(227, 1.0, 2_000)), Outcome::Accepted);
    assert_eq!(bench.send(beta(50, 1.0, 2_000)), Outcome::Accepted);
}

#[test]
fn a_refused_move_is_refused_again_though_the_axis_is_enabled_meanwhile() {
    let mut bench = Bench::new(Limits::default(), 0.0);
    bench.run(5);
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    assert_eq!(
        bench.send(beta(3, 1.0, 1_000)),
        Outcome::Rejected(Reason::NotEnabled)
    );
    let first = bench.answer();
    bench.run(10);
    assert_eq!(bench.axis.state(), State::OperationEnabled);
    bench.reports.clear();
    assert_eq!(bench.send(beta(3, 1.0, 1_000)), Outcome::Repeated);
    assert_eq!(bench.answer(), first);
    // And when it is no longer the last command, its number is used up.
    assert_eq!(bench.send(beta(4, 0.0, 1_000)), Outcome::Accepted);
    assert_eq!(bench.send(beta(3, 1.0, 1_000)), STALE);
    bench.run(2_000);
    assert_eq!(bench.place(), 0.0);
}

#[test]
fn a_refused_enable_is_refused_again_though_the_drive_is_well_meanwhile() {
    let mut bench = Bench::new(Limits::default(), 0.0);
    bench.condition = Some(Condition::Faulted(Trouble::Other));
    bench.run(5);
    assert_eq!(bench.send(control(1, Action::Hold)), Outcome::Accepted);
    assert_eq!(
        bench.send(control(2, Action::Enable)),
        Outcome::Rejected(Reason::DriveNotReady)
    );
    let first = bench.answer();
    bench.condition = None;
    bench.run(5);
    bench.reports.clear();
    assert_eq!(bench.send(control(2, Action::Enable)), Outcome::Repeated);
    assert_eq!(bench.answer(), first);
    bench.run(100);
    assert_eq!(bench.axis.state(), State::SwitchOnDisabled);
}

#[test]
fn a_refused_release_is_refused_again_though_the_axis_rests_meanwhile() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.send(beta(3, 1.0, 1_000)), Outcome::Accepted);
    let release = control(4, Action::Release);
    assert_eq!(bench.send(release), Outcome::Rejected(Reason::Moving));
    bench.run(1_100);
    assert_eq!(bench.send(release), Outcome::Repeated);
    assert_eq!(bench.answer().reason, Reason::Moving);
    assert!(bench.axis.session().is_some());
}

#[test]
fn a_move_that_was_too_fast_is_too_fast_again() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(
        bench.send(beta(3, 1.0, 1)),
        Outcome::Rejected(Reason::TooFast)
    );
    let first = bench.answer();
    assert!(first.detail > 100, "{first:?}");
    bench.reports.clear();
    assert_eq!(bench.send(beta(3, 1.0, 1)), Outcome::Repeated);
    assert_eq!(bench.answer(), first);
    bench.stays(100);
}

#[test]
fn an_old_hold_enable_and_move_after_a_stop_do_not_move() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.send(beta(3, 1.0, 1_000)), Outcome::Accepted);
    bench.run(200);
    assert_eq!(bench.send(Command::Stop { sequence: 1 }), Outcome::Accepted);
    bench.ticks_to_rest(100);
    let before = bench.setpoint.position;
    let old = [
        control(1, Action::Hold),
        control(2, Action::Enable),
        beta(3, 1.0, 1_000),
    ];
    for _ in 0..2 {
        for command in old {
            let _: Outcome = bench.send(command);
            bench.stays(20);
        }
    }
    bench.stays(2_000);
    assert_eq!(bench.setpoint.position, before);
    // A new number moves it.
    assert_eq!(bench.send(beta(4, 1.0, 1_000)), Outcome::Accepted);
}

#[test]
fn a_hold_that_comes_twice_makes_no_old_number_new() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.send(beta(3, 1.0, 1_000)), Outcome::Accepted);
    bench.run(2_000);
    assert_eq!(bench.send(beta(4, 0.0, 1_000)), Outcome::Accepted);
    bench.run(2_000);
    assert_eq!(bench.send(control(1, Action::Hold)), Outcome::Accepted);
    assert_eq!(bench.send(beta(3, 1.0, 1_000)), STALE);
    assert_eq!(bench.send(beta(4, 0.0, 1_000)), STALE);
    bench.stays(2_000);
}

/// The same session held the axis twice, and the frames of the first time come again.
#[test]
fn an_old_hold_after_a_newer_one_makes_no_old_number_new() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.send(beta(3, 1.0, 1_000)), Outcome::Accepted);
    bench.run(2_000);
    assert_eq!(bench.send(control(4, Action::Hold)), Outcome::Accepted);
    assert_eq!(bench.send(beta(5, 0.0, 1_000)), Outcome::Accepted);
    bench.run(2_000);
    let _: Outcome = bench.send(control(1, Action::Hold));
    let _: Outcome = bench.send(beta(3, 1.0, 1_000));
    bench.stays(2_000);
}

#[test]
fn a_new_hold_begins_the_numbers_anew_and_forgets_what_was_staged() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let group = bench.stage(1.0, 1_000);
    bench.sequence = 100;
    assert_eq!(bench.send(control(100, Action::Hold)), Outcome::Accepted);
    assert_eq!(bench.trigger(group, 5), Outcome::Ignored);
    bench.stays(1_100);
    assert_eq!(bench.go(1.0, 1_000), Outcome::Accepted);
    assert_eq!(bench.answer().sequence, 101);
}

#[test]
fn a_stop_is_done_each_time_whatever_its_number() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    for place in [1.0, 2.0, 3.0] {
        assert_eq!(bench.go(place, 3_000), Outcome::Accepted);
        bench.run(1_000);
        assert_eq!(bench.send(Command::Stop { sequence: 5 }), Outcome::Accepted);
        bench.ticks_to_rest(150);
        bench.stays(100);
    }
}
