//! Planning that takes its time: what comes between a decision and its plan. The bench holds every
//! setpoint to the promise meanwhile.

use super::bench::{Answer, Bench, beta, staged, stopping_ticks, turns};
use super::planner::{STOP, answers, moving, slow};
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::axis::{Axis, Outcome};
use canter_shared::time::{Tick, Ticks};
use canter_shared::wire::command::{Action, Command};
use canter_shared::wire::id::Function;
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;

/// The axis as it would be without the last command.
fn goes_on_as(bench: &mut Bench, other: &mut Axis, ticks: u64) {
    for _ in 0..ticks {
        bench.step();
        let tick = Tick(bench.tick);
        assert_eq!(bench.setpoint, other.tick(tick, tick.time()));
    }
}

#[test]
fn nothing_but_a_plan_moves_the_axis_and_its_answer_comes_then() {
    let mut bench = slow(1, 200);
    assert_eq!(bench.send(beta(10, 1.0, 1_000)), Outcome::Planning);
    // It will move, so the session must watch over it.
    assert!(bench.axis.is_moving());
    assert_eq!(
        bench.control(Action::Release),
        Outcome::Rejected(Reason::StaleSequence)
    );
    bench.sequence = 10;
    assert_eq!(
        bench.control(Action::Release),
        Outcome::Rejected(Reason::Moving)
    );
    bench.reports.clear();
    bench.run(100);
    assert_eq!(bench.place(), 0.0);
    assert_eq!(answers(&bench), []);
}

#[test]
fn a_move_leaves_at_its_splice_whenever_its_plan_comes_before() {
    let mut last = None;
    for delay in 0..=5 {
        let mut bench = slow(5, delay);
        let begin = bench.tick;
        assert!(matches!(
            bench.send(beta(10, 1.0, 1_000)),
            Outcome::Planning | Outcome::Accepted
        ));
        bench.run(100);
        let detail = bench.answer().detail;
        assert_eq!(answers(&bench), [(10, Reason::Accepted)]);
        // Ticks from the answer on: the splice is 5 ticks after the command.
        let at = begin + u64::from(delay);
        assert_eq!(u64::from(detail), begin + 5 + 1_000 - at, "{delay}");
        let place = bench.setpoint;
        assert!(bench.velocity() > 0.0);
        assert_eq!(*last.get_or_insert(place), place);
        bench.run(905);
        assert_eq!(bench.setpoint.position, turns(1.0));
    }
}

#[test]
fn the_motion_under_way_goes_on_until_the_splice() {
    let mut bench = moving(5, 2);
    let mut other = bench.axis.clone();
    assert_eq!(bench.send(beta(10, 0.0, 8_000)), Outcome::Planning);
    goes_on_as(&mut bench, &mut other, 5);
    bench.step();
    let tick = Tick(bench.tick);
    assert_ne!(bench.setpoint, other.tick(tick, tick.time()));
    bench.run(20_000);
    assert_eq!(bench.place(), 0.0);
}

#[test]
fn an_emergency_stop_overtakes_a_move_that_is_being_planned() {
    for (before, after) in [(0, 0), (1, 3), (2, 5), (4, 0)] {
        let mut bench = moving(5, 4);
        assert_eq!(bench.send(beta(10, 0.0, 8_000)), Outcome::Planning);
        bench.run(before);
        assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
        assert_eq!(bench.axis.state(), State::FaultReactionActive);
        if before < 4 {
            let refused = Answer {
                sequence: 10,
                function: Function::MoveBeta,
                reason: Reason::FaultLatched,
                detail: u8::from(Fault::EmergencyStop).into(),
            };
            assert_eq!(bench.answer(), refused);
        }
        bench.run(after);
        // The plan of the move comes back and is not wanted; the stop's own takes its time again.
        let most = stopping_ticks(bench.velocity(), bench.axis.limits());
        bench.ticks_to_rest(most + 5 + 5);
        bench.run(1);
        assert_eq!(bench.axis.state(), State::Fault);
        assert!(bench.place() > 4.0, "{}", bench.place());
        assert_eq!(answers(&bench).len(), 1);
        bench.stays(1_000);
    }
}

#[test]
fn a_stop_overtakes_a_move_and_refuses_the_next_until_it_is_planned() {
    let mut bench = moving(3, 2);
    assert_eq!(bench.send(beta(10, 0.0, 8_000)), Outcome::Planning);
    assert_eq!(bench.send(STOP), Outcome::Accepted);
    assert_eq!(answers(&bench), [(10, Reason::Stopped)]);
    let moving = Outcome::Rejected(Reason::Moving);
    assert_eq!(bench.send(beta(11, 0.0, 8_000)), moving);
    assert_eq!(bench.send(beta(11, 0.0, 8_000)), Outcome::Repeated);
    let most = stopping_ticks(bench.velocity(), bench.axis.limits());
    bench.ticks_to_rest(most + 6);
    bench.stays(100);
    assert_eq!(bench.axis.state(), State::OperationEnabled);
    assert!(bench.place() > 4.0);
    assert_eq!(bench.send(beta(12, 0.0, 8_000)), Outcome::Planning);
    bench.run(8_100);
    assert_eq!(bench.place(), 0.0);
}

/// A move that waits for its splice has not begun: a stop calls it off without a plan.
#[test]
fn a_stop_calls_off_a_move_that_waits_for_its_splice() {
    let mut bench = slow(10, 0);
    assert_eq!(bench.send(beta(10, 1.0, 1_000)), Outcome::Accepted);
    bench.run(5);
    assert_eq!(bench.send(STOP), Outcome::Accepted);
    bench.stays(2_000);
    let started = |report: &Report| matches!(report, Report::Started { .. });
    assert!(!bench.reports.iter().any(started));
}

/// The stop takes over from the motion under way, however far ahead the move was to.
#[test]
fn a_stop_does_not_wait_for_the_splice_of_a_move() {
    let mut bench = moving(500, 0);
    assert_eq!(bench.send(beta(10, 0.0, 8_000)), Outcome::Accepted);
    bench.planner.lead = Ticks(1);
    bench.run(100);
    let most = stopping_ticks(bench.velocity(), bench.axis.limits());
    assert_eq!(bench.send(STOP), Outcome::Accepted);
    bench.ticks_to_rest(most + 1);
    bench.stays(1_000);
}

#[test]
fn the_newer_of_two_moves_counts() {
    let mut bench = moving(2, 2);
    // The first is being worked on, so it is done; of the others only the last.
    for sequence in 10..15 {
        let target = f64::from(sequence - 7);
        assert_eq!(
            bench.axis.handle_frame(
                bench.now(),
                &super::bench::frame(beta(sequence, target, 8_000))
            ),
            Outcome::Planning
        );
        if sequence == 10 {
            bench.planner.act(&mut bench.axis);
        }
    }
    bench.run(10);
    let overtaken = Reason::Overtaken;
    let accepted = Reason::Accepted;
    assert_eq!(
        answers(&bench),
        [
            (11, overtaken),
            (12, overtaken),
            (13, overtaken),
            (10, accepted),
            (14, accepted)
        ]
    );
    bench.run(20_000);
    assert_eq!(bench.place(), 7.0);
}

#[test]
fn a_repetition_while_the_first_is_being_planned_gets_the_one_answer() {
    for (delay, repeats) in [(3, 3), (6, 2)] {
        let mut bench = slow(20, delay);
        assert_eq!(bench.send(beta(10, 1.0, 1_000)), Outcome::Planning);
        for _ in 1..repeats {
            assert_eq!(bench.send(beta(10, 1.0, 1_000)), Outcome::Repeated);
        }
        bench.run(30);
        assert_eq!(answers(&bench), [(10, Reason::Accepted)]);
        let first = bench.answer();
        bench.run(100);
        bench.reports.clear();
        assert_eq!(bench.send(beta(10, 1.0, 1_000)), Outcome::Repeated);
        assert_eq!(bench.answer(), first);
        bench.run(1_000);
        assert_eq!(bench.place(), 1.0);
    }
}

/// Of a move that was called off, too.
#[test]
fn the_repetition_of_a_move_that_was_called_off_is_refused_the_same() {
    let mut bench = moving(3, 2);
    assert_eq!(bench.send(beta(10, 0.0, 8_000)), Outcome::Planning);
    assert_eq!(bench.send(STOP), Outcome::Accepted);
    bench.run(1_000);
    bench.reports.clear();
    assert_eq!(bench.send(beta(10, 0.0, 8_000)), Outcome::Repeated);
    assert_eq!(answers(&bench), [(10, Reason::Stopped)]);
    bench.stays(1_000);
}

#[test]
fn what_is_still_being_checked_is_forgotten_with_what_is_staged() {
    type Case = (fn(&mut Bench) -> Outcome, Reason);
    let cases: [Case; 4] = [
        (|bench| bench.send(STOP), Reason::Stopped),
        (|bench| bench.control(Action::Hold), Reason::StaleSequence),
        (|bench| bench.control(Action::Release), Reason::NotHeld),
        (|bench| bench.control(Action::Disable), Reason::NotEnabled),
    ];
    for (forget, reason) in cases {
        let mut bench = slow(2, 9);
        let group = bench.next();
        assert_eq!(bench.send(staged(group, 1.0, 1_000)), Outcome::Planning);
        // It moves nothing yet.
        assert!(!bench.axis.is_moving());
        assert_eq!(forget(&mut bench), Outcome::Accepted);
        assert_eq!(answers(&bench).first(), Some(&(group, reason)));
        bench.run(20);
        assert_eq!(bench.trigger(group, 20), Outcome::Ignored);
        bench.stays(1_000);
    }
}

#[test]
fn disabling_waits_for_the_stop_that_is_being_planned() {
    let mut bench = moving(8, 6);
    assert_eq!(bench.control(Action::Disable), Outcome::Accepted);
    bench.run(7);
    assert_eq!(bench.axis.state(), State::QuickStopActive);
    let most = stopping_ticks(bench.velocity(), bench.axis.limits());
    bench.ticks_to_rest(most + 8);
    bench.run(1);
    assert_eq!(bench.axis.state(), State::SwitchOnDisabled);
    bench.stays(1_000);
}
