//! Plans that come too late or never, and floods that are faster than planning. The bench holds
//! every setpoint to the promise meanwhile.

use super::bench::{SESSION, beta, staged, stopping_ticks};
use super::planner::{Planner, STOP, answers, moving, slow};
use canter_shared::axis::Outcome;
use canter_shared::axis::state::State;
use canter_shared::time::{Tick, Ticks};
use canter_shared::wire::command::Command;
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;

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
    // It may still speed up until its stop is planned.
    let limits = *bench.axis.limits();
    let most = stopping_ticks(limits.velocity().radians(), &limits);
    assert_eq!(bench.send(STOP), Outcome::Accepted);
    assert_eq!(answers(&bench).len(), sent);
    // The plan that is no longer wanted comes back after 6 ticks, and the stop's own is late three
    // times in 6 ticks each, before 8 ticks ahead are enough.
    bench.ticks_to_rest(most + 6 + 3 * 6 + 8);
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
