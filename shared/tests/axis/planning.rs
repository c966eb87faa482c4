//! Planning that takes its time: what comes between a decision and its plan, and plans that come
//! too late. The bench holds every setpoint to the promise meanwhile.

use super::bench::{Answer, Bench, SESSION, beta, staged, stopping_ticks, turns};
use super::planner::Planner;
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::axis::{Axis, Outcome};
use canter_shared::limits::Limits;
use canter_shared::time::{Tick, Ticks};
use canter_shared::wire::command::{Action, Command};
use canter_shared::wire::id::Function;
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;

const STOP: Command = Command::Stop { sequence: 200 };

/// An enabled axis whose plans come back after `delay` frames and ticks.
fn slow(lead: u32, delay: u8) -> Bench {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    bench.planner = Planner::slow(lead, delay);
    bench.reports.clear();
    bench
}

/// At full speed towards 10 turns.
fn moving(lead: u32, delay: u8) -> Bench {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.go(10.0, 8_000), Outcome::Accepted);
    bench.run(4_000);
    bench.planner = Planner::slow(lead, delay);
    bench.reports.clear();
    bench
}

/// The answers so far to moves and triggers.
fn answers(bench: &Bench) -> Vec<(u8, Reason)> {
    let answer = |report: &Report| match *report {
        Report::Acknowledgement {
            sequence,
            reason,
            function,
            ..
        } => (function != Function::Stop).then_some((sequence, reason)),
        _ => None,
    };
    bench.reports.iter().filter_map(answer).collect()
}

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
    assert_eq!(answers(&bench), [(10, Reason::Moving)]);
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

/// The first move waits for its splice while the second is planned, for longer than that.
#[test]
fn a_move_is_planned_from_the_one_that_waits_for_its_splice() {
    let mut bench = moving(200, 0);
    bench.planner = Planner::erratic(200, vec![Some(0), Some(190), Some(0)]);
    assert_eq!(bench.send(beta(10, 0.0, 4_000)), Outcome::Accepted);
    bench.run(100);
    assert_eq!(bench.send(beta(11, 8.0, 4_000)), Outcome::Planning);
    // The bench sees whether anything jumps.
    bench.run(20_000);
    assert_eq!(bench.place(), 8.0);
    let (accepted, again) = (Outcome::Accepted, Outcome::Planning);
    assert_eq!(bench.planner.outcomes, [accepted, again, accepted]);
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
    let stale = Reason::StaleSequence;
    let accepted = Reason::Accepted;
    assert_eq!(
        answers(&bench),
        [
            (11, stale),
            (12, stale),
            (13, stale),
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
    assert_eq!(answers(&bench), [(10, Reason::Moving)]);
    bench.stays(1_000);
}

/// A planner that needs `delay` ticks for each plan, whatever it is given.
#[test]
fn a_plan_that_comes_too_late_is_made_again_and_nothing_jumps() {
    for delay in [2, 3, 5, 9, 17, 30, 60] {
        let mut bench = moving(1, delay);
        assert_eq!(bench.send(beta(10, 0.0, 8_000)), Outcome::Planning);
        // Leads of 1, 2, 4 ... up to the first that is enough, each tried for `delay` ticks.
        let mut lead = 1;
        let mut ticks = u64::from(delay);
        while lead < u64::from(delay) {
            lead *= 2;
            ticks += u64::from(delay);
        }
        bench.run(ticks - 1);
        assert_eq!(answers(&bench), [], "{delay}");
        bench.run(1);
        assert_eq!(answers(&bench), [(10, Reason::Accepted)], "{delay}");
        bench.run(20_000);
        assert_eq!(bench.place(), 0.0);
    }
}

#[test]
fn a_stop_that_comes_too_late_is_made_again_until_it_does_not() {
    for delay in [2, 5, 17, 60] {
        let mut bench = moving(1, delay);
        let most = stopping_ticks(bench.velocity(), bench.axis.limits());
        assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
        // The sum of the leads that were too short is less than the plan's time, each try took
        // that time, and there are at most 7.
        bench.ticks_to_rest(most + 7 * u64::from(delay) + 64);
        bench.run(1);
        assert_eq!(bench.axis.state(), State::Fault);
        assert!(bench.place() < 9.9, "{}", bench.place());
    }
}

/// Slower than any lead: a move is refused in the end, and a stop is not.
#[test]
fn a_planner_that_is_always_too_late_refuses_moves_and_tells_of_stops() {
    let mut bench = slow(1, 70);
    assert_eq!(bench.send(beta(10, 1.0, 1_000)), Outcome::Planning);
    bench.run(7 * 70 - 1);
    assert_eq!(answers(&bench), []);
    bench.run(1);
    assert_eq!(answers(&bench), [(10, Reason::TooLate)]);
    assert_eq!(bench.answer().detail, 7 * 70);
    bench.stays(1_000);
    let mut bench = moving(1, 70);
    assert_eq!(bench.axis.stop_overdue(), Ticks(0));
    assert_eq!(bench.send(STOP), Outcome::Accepted);
    bench.run(700);
    assert_eq!(bench.axis.stop_overdue(), Ticks(700));
    // The move ends where it was to: it was checked to stay inside.
    bench.run(4_000);
    assert!(!bench.axis.is_moving() || bench.axis.stop_overdue() > Ticks(4_000));
    assert_eq!(bench.place(), 10.0);
}

/// Whoever took the plan was lost with it.
#[test]
fn a_plan_that_never_comes_back_is_given_again() {
    let mut bench = moving(1, 0);
    bench.planner = Planner::erratic(1, vec![None, None, Some(0)]);
    let most = stopping_ticks(bench.velocity(), bench.axis.limits());
    assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
    bench.ticks_to_rest(most + 2 + 3 + 4);
    assert!(bench.place() < 9.0);
}

#[test]
fn stops_in_a_flood_while_planning_is_slow_do_not_put_off_the_rest() {
    for (lead, delay) in [(1, 1), (2, 3), (4, 9)] {
        let mut bench = moving(lead, delay);
        let most = stopping_ticks(bench.velocity(), bench.axis.limits());
        let begin = bench.tick;
        while bench.axis.is_moving() {
            for _ in 0..4 {
                assert_eq!(bench.send(STOP), Outcome::Accepted);
            }
            bench.step();
            assert!(bench.tick - begin < most + 20, "{}", bench.velocity());
        }
        assert!(bench.place() < 9.0);
    }
}

/// Moves in a flood, all between taking a plan and committing it: each is answered once, some are
/// planned, and a stop still gets through at once.
#[test]
fn moves_in_a_flood_are_answered_and_do_not_hold_off_a_stop() {
    let mut bench = moving(1, 6);
    let mut sequence = bench.sequence;
    let mut sent = 0;
    for round in 0..200 {
        for _ in 0..7 {
            sequence = sequence.wrapping_add(1);
            let target = f64::from(round % 9);
            assert!(matches!(
                bench.send(beta(sequence, target, 4_000)),
                Outcome::Planning | Outcome::Accepted
            ));
            sent += 1;
        }
        bench.step();
    }
    let accepted = answers(&bench);
    let accepted = accepted.iter().filter(|(_, r)| *r == Reason::Accepted);
    assert!(accepted.count() > 100);
    let most = stopping_ticks(bench.velocity(), bench.axis.limits());
    assert_eq!(bench.send(STOP), Outcome::Accepted);
    assert_eq!(answers(&bench).len(), sent);
    bench.ticks_to_rest(most + 20);
}

#[test]
fn a_trigger_that_is_planned_too_late_is_refused() {
    let mut bench = slow(4, 3);
    let group = bench.next();
    assert_eq!(bench.send(staged(group, 1.0, 1_000)), Outcome::Planning);
    // It counts when it has been checked.
    assert_eq!(bench.trigger(group, 50), Outcome::Ignored);
    bench.run(5);
    assert_eq!(answers(&bench), [(group, Reason::Accepted)]);
    let start = Tick(bench.tick + 3);
    let trigger = Command::Trigger {
        group,
        session: SESSION,
        start,
    };
    assert_eq!(bench.send(trigger), Outcome::Planning);
    assert_eq!(bench.send(trigger), Outcome::Repeated);
    bench.run(5);
    assert_eq!(bench.answer().reason, Reason::TooLate);
    assert_eq!(bench.answer().detail, 1);
    assert_eq!(answers(&bench).len(), 2);
    bench.stays(2_000);
}

#[test]
fn a_trigger_that_is_planned_in_time_leaves_at_its_tick() {
    for delay in 0..4 {
        let mut bench = slow(4, 0);
        let group = bench.stage(1.0, 1_000);
        bench.planner = Planner::slow(4, delay);
        let begin = bench.tick;
        let _: Outcome = bench.trigger(group, 4);
        bench.run(1_003);
        assert!(bench.place() < 1.0);
        bench.run(1);
        assert_eq!(bench.place(), 1.0);
        let started = Report::Started {
            sequence: group,
            time: Tick(begin + 4).time(),
        };
        assert!(bench.reports.contains(&started), "{delay}");
    }
}

#[test]
fn what_is_still_being_checked_is_forgotten_with_what_is_staged() {
    type Case = (fn(&mut Bench) -> Outcome, Reason);
    let cases: [Case; 4] = [
        (|bench| bench.send(STOP), Reason::Moving),
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
