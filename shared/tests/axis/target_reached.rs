//! Whether the setpoint rests where a host sent it, as feedback tells it: however the drive follows.

use super::bench::{Bench, beta, control};
use super::planner::STOP;
use canter_shared::axis::Outcome;
use canter_shared::limits::Limits;
use canter_shared::wire::command::{Action, Command};
use canter_shared::wire::report::Report;

/// What each feedback from now on says, until the axis rests and has said so.
fn told(bench: &mut Bench) -> Vec<(bool, bool)> {
    // What was due before is from before.
    bench.run(20);
    bench.reports.clear();
    bench.ticks_to_rest(5_000);
    bench.run(40);
    let feedback = |report: &Report| match *report {
        Report::Feedback {
            moving,
            target_reached,
            ..
        } => Some((moving, target_reached)),
        _ => None,
    };
    bench.reports.iter().filter_map(feedback).collect()
}

/// Not on the way, and this at its end.
#[track_caller]
fn ends(bench: &mut Bench, reached: bool) {
    let told = told(bench);
    let (way, end) = told.split_at(told.iter().take_while(|told| told.0).count());
    assert!(way.iter().all(|told| !told.1), "{told:?}");
    assert!(!end.is_empty(), "{told:?}");
    assert!(end.iter().all(|told| *told == (false, reached)), "{told:?}");
}

fn enabled() -> Bench {
    Bench::enabled(Limits::default(), 0.0)
}

#[test]
fn nothing_is_reached_before_the_first_move() {
    ends(&mut enabled(), false);
}

#[test]
fn a_move_a_retarget_and_a_move_of_no_length_reach_their_targets() {
    let mut bench = enabled();
    assert_eq!(bench.go(1.0, 1_000), Outcome::Accepted);
    ends(&mut bench, true);
    assert_eq!(bench.go(0.0, 1_000), Outcome::Accepted);
    bench.run(300);
    assert_eq!(bench.go(2.0, 2_000), Outcome::Accepted);
    ends(&mut bench, true);
    assert_eq!(bench.go(2.0, 500), Outcome::Accepted);
    ends(&mut bench, true);
}

#[test]
fn what_is_stopped_on_the_way_is_not_there_until_the_next_move_is() {
    for command in [STOP, control(90, Action::Disable), Command::EmergencyStop] {
        let mut bench = enabled();
        assert_eq!(bench.go(1.0, 1_000), Outcome::Accepted);
        bench.run(500);
        assert_eq!(bench.send(command), Outcome::Accepted, "{command:?}");
        ends(&mut bench, false);
    }
    let mut bench = enabled();
    assert_eq!(bench.go(1.0, 1_000), Outcome::Accepted);
    bench.run(500);
    assert_eq!(bench.send(STOP), Outcome::Accepted);
    bench.run(1_000);
    let sequence = bench.next();
    assert_eq!(bench.send(beta(sequence, 1.0, 1_000)), Outcome::Accepted);
    ends(&mut bench, true);
}

#[test]
fn a_stream_reaches_its_last_knot_unless_it_is_stopped_or_runs_dry() {
    let mut bench = enabled();
    // All knots are there by then.
    bench.stream_on(1.5, 1.0, 920);
    ends(&mut bench, true);
    let (mut bench, _) = Bench::streaming(Limits::default(), 1.5, 2.0, 900);
    assert_eq!(bench.send(STOP), Outcome::Accepted);
    ends(&mut bench, false);
    // Nothing comes any more.
    let (mut bench, _) = Bench::streaming(Limits::default(), 1.5, 2.0, 900);
    ends(&mut bench, false);
}
