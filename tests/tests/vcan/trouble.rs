//! Stops, vanished hosts, second hosts: what must hold when things go wrong in mid-move.

use super::robot::{Robot, axis, now_in_ticks};
use canter_shared::axis::state::State;
use canter_shared::limits::Limits;
use canter_shared::wire::report::Report;
use canter_tests::measurement;
use canter_tests::process::Process;
use canter_tests::trace::{Row, Trace};
use std::process::Stdio;

/// The default jerk limit, twice: a stop may begin while a move's own jerk is at its peak.
const JERK: f64 = 2.0 * 20_000.0;

/// A move long enough to be met in its middle, by a busy machine too.
const LONG_MOVE: &str = "move 1=8turn 2=-8turn 3=1turn --duration 6";

/// Waits until axis 1 is well on its way.
#[track_caller]
fn wait_for_motion(robot: &Robot) {
    robot.wait_for("motion", axis(1), |report| match report {
        Report::Feedback { velocity, .. } => velocity.radians() > 10.0,
        _ => false,
    });
}

fn first_in(rows: &[Row], state: &str) -> u64 {
    rows.iter()
        .find(|row| row.state == state)
        .unwrap_or_else(|| panic!("never in {state}"))
        .tick
}

fn last_moving(trace: &Trace, axis: u8) -> u64 {
    let moving = trace
        .axis(axis)
        .iter()
        .rev()
        .find(|row| row.velocity != 0.0);
    moving.expect("it moved").tick
}

#[test]
fn a_stop_from_another_process_brings_all_to_rest_and_ends_the_move() {
    let robot = Robot::start("vcan3");
    robot.enable();
    let moving = Process::spawn(&mut robot.command(LONG_MOVE));
    wait_for_motion(&robot);
    robot.run("stop all").success();
    let moved = moving.finish();
    assert_eq!(moved.status.code(), Some(1), "{moved:#?}");
    assert!(moved.stderr.contains("stopped on the way"), "{moved:#?}");
    let trace = robot.finish();
    trace.keeps(&Limits::default(), JERK);
    let last = trace.axis(1).last().expect("rows");
    assert_eq!(last.state, "operation enabled");
    assert!(last.position < 50.0, "it was not stopped: {last:?}");
}

#[test]
fn a_killed_host_ends_in_a_stop_and_a_latched_fault() {
    let robot = Robot::start("vcan4");
    robot.enable();
    let mut host = robot
        .command(LONG_MOVE)
        .stderr(Stdio::null())
        .spawn()
        .expect("canter starts");
    wait_for_motion(&robot);
    host.kill().expect("it still runs");
    let at_kill = now_in_ticks();
    host.wait().expect("it ends");
    robot.wait_for("fault at rest", axis(1), |report| match report {
        Report::Heartbeat { state, .. } => *state == u8::from(State::Fault),
        _ => false,
    });
    let status = robot.run("status --json").success().json();
    for axis in status["axes"].as_array().expect("a list") {
        assert_eq!(axis["fault"], "host_timeout", "{axis}");
        assert_eq!(axis["state"], "fault", "{axis}");
    }
    // Latched: nothing moves until it is cleared and enabled.
    let refused = robot.run("move 1=0 --enable");
    assert_eq!(refused.status.code(), Some(1));
    assert!(refused.stderr.contains("host_timeout"), "{refused:#?}");
    robot.run("clear all").success();
    robot.run("enable all").success();
    robot.run("move 1=0").success();

    let trace = robot.finish();
    trace.keeps(&Limits::default(), JERK);
    for id in 1..=3 {
        let rows = trace.axis(id);
        let reaction = first_in(rows, "fault reaction active");
        let fault = first_in(rows, "fault");
        let rest = fault - reaction;
        // 20 rad/s at 200 rad/s^2 take 100 ms, and 10 ms each for the two ramps of the jerk.
        assert!(rest <= 125, "axis {id} took {rest} ms to stop");
        assert!(
            reaction - at_kill <= 251,
            "axis {id}: {} ms",
            reaction - at_kill
        );
        if id == 1 {
            measurement(
                "vcan",
                "host killed: fault after",
                &format!("{} ms", reaction - at_kill),
                "<= 251 ms",
            );
            measurement(
                "vcan",
                "host killed: stopping time",
                &format!("{rest} ms"),
                "<= 125 ms",
            );
        }
    }
}

#[test]
fn an_emergency_stop_latches_and_a_second_host_is_refused() {
    let robot = Robot::start("vcan5");
    robot.enable();
    let moving = Process::spawn(&mut robot.command(LONG_MOVE));
    wait_for_motion(&robot);
    let second = robot.run("move 2=0");
    assert_eq!(second.status.code(), Some(1));
    assert!(second.stderr.contains("holds the axis"), "{second:#?}");
    assert!(
        robot
            .trace()
            .axis(1)
            .last()
            .is_some_and(|row| row.velocity > 1.0)
    );
    robot.run("estop all").success();
    let moved = moving.finish();
    assert_eq!(moved.status.code(), Some(1));
    assert!(moved.stderr.contains("emergency_stop"), "{moved:#?}");
    let status = robot.run("status --json").success().json();
    for axis in status["axes"].as_array().expect("a list") {
        assert_eq!(axis["fault"], "emergency_stop", "{axis}");
    }
    let trace = robot.finish();
    trace.keeps(&Limits::default(), JERK);
    assert!(last_moving(&trace, 1) < trace.axis(1).last().expect("rows").tick);
}

#[test]
fn an_interrupted_move_stops_its_axes() {
    let robot = Robot::start("vcan6");
    robot.enable();
    let moving = Process::spawn(&mut robot.command(LONG_MOVE));
    wait_for_motion(&robot);
    moving.signal("INT");
    let moved = moving.finish();
    assert_eq!(moved.status.code(), Some(1));
    assert!(moved.stderr.contains("interrupted"), "{moved:#?}");
    let status = robot.run("status --json").success().json();
    for axis in status["axes"].as_array().expect("a list") {
        assert_eq!(axis["state"], "operation enabled", "{axis}");
        assert_eq!(axis["session"], serde_json::Value::Null, "{axis}");
        assert_eq!(axis["moving"], false, "{axis}");
    }
    robot.finish().keeps(&Limits::default(), JERK);
}
