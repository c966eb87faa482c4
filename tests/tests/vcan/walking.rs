//! Twelve axes walk on real CAN, and what becomes of all of them when one thing goes wrong.

use super::robot::{Robot, axis, now_in_ticks};
use canter::gait::{Body, Kind, Quadruped};
use canter::robot::Robot as Model;
use canter::walk::joints::{axes, positions};
use canter::walk::{Order, Replay, Settings};
use canter_shared::axis::state::State;
use canter_shared::limits::Limits;
use canter_shared::wire::report::Report;
use canter_tests::measurement;
use canter_tests::process::Process;
use canter_tests::trace::Trace;
use serde_json::Value;

const BUS: &str = "vcan10";

/// Cubics between knots are continuous in velocity, and their accelerations step by less than that of 0.1 s
/// of the default jerk limit in a tick.
const JERK: f64 = 5.0 * 20_000.0;

/// A stream that runs dry brakes at once: its acceleration steps by the limits up and down in a tick.
const DRY_JERK: f64 = 2.0 * 200.0 / 1e-3;

/// A walk that only its end ends.
const WALK: &str = "gait run trot --vx 0.3 --yaw-rate 20deg --duration 60 --enable";

/// Starts a walk, and waits until it has gone some steps.
#[track_caller]
fn walking(robot: &Robot) -> Process {
    let mut host = Process::spawn(&mut robot.command(WALK));
    host.wait_for("walk", |line| line.text.ends_with(" s: walks"));
    let moves = |report: &Report| match report {
        Report::Feedback { velocity, .. } => velocity.radians().abs() > 3.0,
        _ => false,
    };
    robot.wait_for("swing", axis(2), moves);
    host
}

/// For how many ms after `since` an axis moved on.
#[track_caller]
fn moved_on(trace: &Trace, id: u8, since: u64) -> u64 {
    let rows = trace.axis(id);
    let moving = rows.iter().rev().find(|row| row.velocity != 0.0);
    let last = moving.expect("it moved").tick;
    assert!(
        last < rows.last().expect("rows").tick,
        "axis {id} moves still"
    );
    (last + 1).saturating_sub(since)
}

#[track_caller]
fn status(robot: &Robot) -> Vec<Value> {
    let status = robot.run("status --json").success().json();
    status["axes"].as_array().expect("a list").clone()
}

/// When an axis first has a fault.
fn faulted_at(trace: &Trace, id: u8) -> u64 {
    let mut rows = trace.axis(id).iter();
    let faulted = rows.find(|row| row.state.starts_with("fault"));
    faulted.expect("a fault").tick
}

#[test]
fn twelve_axes_walk_and_each_tick_is_what_it_was_to_be() {
    let robot = Robot::of_axes(BUS, "1-12");
    let refused = robot.run("gait run trot --vx 0.3");
    assert_eq!(refused.status.code(), Some(1), "{refused:#?}");
    assert!(refused.stderr.contains("canter enable 1"), "{refused:#?}");
    let words = "gait run trot --vx 0.3 --cycles 6 --enable --json";
    let walked = robot.run(words).success().json();
    let trace = robot.finish();
    trace.keeps(&Limits::default(), JERK);

    let number = |value: &Value| value.as_f64().expect("a number");
    let quadruped = Quadruped::of(&Model::default()).expect("four legs");
    let body = Body {
        vx: 0.3,
        ..Body::standing(Quadruped::HEIGHT)
    };
    assert_eq!(walked["orders"][0]["order"], "stop");
    let replay = Replay {
        settings: Settings::new(Kind::Trot.gait(), body),
        orders: vec![(number(&walked["orders"][0]["time"]), Order::Stop)],
        duration: number(&walked["duration"]),
        quadruped,
    };
    let starts = walked["axes"].as_array().expect("a list").iter();
    let starts: Vec<u64> = starts
        .filter_map(|axis| axis["start_us"].as_u64())
        .collect();
    let (first, last) = (starts.iter().min(), starts.iter().max());
    let (first, last) = first.zip(last).expect("twelve axes");
    let leaves = walked["axes"][0]["leaves_us"].as_u64();
    let start = leaves.expect("a time") / 1_000;
    let states = replay.states(1e-3).expect("as it was");
    let ideal: Vec<_> = states
        .map(|state| positions(&state.expect("as it was").1))
        .collect();
    let mut worst = 0.0f64;
    for (joint, id) in axes(&replay.quadruped).into_iter().enumerate() {
        let mut seen = 0;
        for row in trace.axis(id.get()) {
            let index = row.tick.wrapping_sub(start) as usize;
            if let Some(ideal) = ideal.get(index) {
                worst = worst.max((row.position - ideal[joint]).abs());
                seen += 1;
            }
        }
        assert_eq!(seen, ideal.len(), "axis {id}");
    }
    assert!(worst <= 50e-6, "{worst} rad off the motion");
    let worst = format!("{:.1} microrad", 1e6 * worst);
    measurement(
        "vcan",
        "12 axes trot: off the motion",
        &worst,
        "<= 50 microrad",
    );
    let skew = format!("{} us", last - first);
    measurement("vcan", "12 axes trot: start skew", &skew, "-");
}

#[test]
fn an_interrupt_settles_and_sits_and_a_second_one_stops_at_once() {
    let robot = Robot::of_axes(BUS, "1-12");
    let host = walking(&robot);
    host.signal("INT");
    let finished = host.finish().success();
    assert!(
        finished.stdout.starts_with("gait done: trot"),
        "{finished:#?}"
    );
    for words in ["s: settles", "s: sits down", "s: sits\n"] {
        assert!(finished.stderr.contains(words), "{words}: {finished:#?}");
    }
    for axis in status(&robot) {
        assert_eq!(axis["state"], "operation enabled", "{axis}");
        assert_eq!(axis["session"], Value::Null, "{axis}");
    }
    // From its seat it goes on where it is.
    let mut host = walking(&robot);
    host.signal("INT");
    host.wait_for("settling", |line| line.text.ends_with(" s: settles"));
    host.signal("INT");
    let finished = host.finish();
    assert_eq!(finished.status.code(), Some(1), "{finished:#?}");
    assert!(finished.stderr.contains("pose: it sits"), "{finished:#?}");
    assert!(finished.stderr.contains("interrupted"), "{finished:#?}");
    assert!(!finished.stderr.contains("sits down"), "{finished:#?}");
    for axis in status(&robot) {
        assert_eq!(axis["moving"], false, "{axis}");
        assert_eq!(axis["fault"], Value::Null, "{axis}");
    }
    robot.finish().keeps(&Limits::default(), JERK);
}

#[test]
fn a_node_that_dies_stops_all_the_others() {
    let robot = Robot::of_axes(BUS, "1-9");
    let leg = Robot::of_axes(BUS, "10-12");
    let host = walking(&robot);
    let killed = now_in_ticks();
    leg.kill();
    let finished = host.finish();
    assert_eq!(finished.status.code(), Some(1), "{finished:#?}");
    // Whichever of the leg was heard last: all three fell silent at once.
    let names_one = |id: u8| {
        let words = format!("axis {id} does not answer");
        finished.stderr.contains(&words)
    };
    assert!((10..=12).any(names_one), "{finished:#?}");
    for axis in status(&robot) {
        assert_eq!(axis["fault"], Value::Null, "stopped by its host: {axis}");
        assert_eq!(axis["moving"], false, "{axis}");
    }
    let trace = robot.finish();
    trace.keeps(&Limits::default(), JERK);
    let rests = (1..=9).map(|id| moved_on(&trace, id, killed));
    let slowest = rests.max().expect("nine axes");
    // The time-out after which the axes miss their host.
    assert!(slowest <= 250, "{slowest} ms");
    let slowest = format!("{slowest} ms");
    measurement(
        "vcan",
        "leg dies: all others rest after",
        &slowest,
        "<= 250 ms",
    );
}

#[test]
fn a_host_that_is_killed_leaves_all_axes_at_rest_with_faults() {
    let robot = Robot::of_axes(BUS, "1-12");
    let host = walking(&robot);
    let killed = now_in_ticks();
    host.signal("KILL");
    for id in 1..=12 {
        robot.wait_for("fault", axis(id), is_faulted);
    }
    for axis in status(&robot) {
        // One that just rests at a knot needs no more of them, and misses its host instead.
        let fault = axis["fault"].as_str();
        assert!(
            matches!(fault, Some("stream_underrun" | "host_timeout")),
            "{axis}"
        );
    }
    let trace = robot.finish();
    trace.keeps(&Limits::default(), DRY_JERK);
    let rests = (1..=12).map(|id| moved_on(&trace, id, killed));
    let slowest = rests.max().expect("twelve axes");
    // A time-out of 250 ms, and 125 ms to stop from full speed.
    assert!(slowest <= 375, "{slowest} ms");
    let slowest = format!("{slowest} ms");
    measurement(
        "vcan",
        "host killed in a trot: all rest after",
        &slowest,
        "<= 375 ms",
    );
}

fn is_faulted(report: &Report) -> bool {
    matches!(report, Report::Heartbeat { state, .. } if *state == u8::from(State::Fault))
}

#[test]
fn a_host_that_is_held_up_for_a_second_finds_its_axes_stopped_together() {
    let robot = Robot::of_axes(BUS, "1-12");
    let host = walking(&robot);
    let held = now_in_ticks();
    host.signal("STOP");
    robot.wait_for("a second", axis(1), |_| now_in_ticks() >= held + 1_000);
    host.signal("CONT");
    let finished = host.finish();
    assert_eq!(finished.status.code(), Some(1), "{finished:#?}");
    assert!(finished.stderr.contains(" has the fault "), "{finished:#?}");
    let trace = robot.finish();
    trace.keeps(&Limits::default(), DRY_JERK);
    let stops: Vec<u64> = (1..=12).map(|id| faulted_at(&trace, id)).collect();
    let (first, last) = stops.iter().min().zip(stops.iter().max()).expect("twelve");
    assert!(last - first <= 200, "{stops:?}");
    let rests = (1..=12).map(|id| moved_on(&trace, id, held));
    let slowest = rests.max().expect("twelve axes");
    assert!(slowest <= 375, "{slowest} ms");
    let apart = format!("{} ms", last - first);
    measurement(
        "vcan",
        "host held up in a trot: stops apart",
        &apart,
        "<= 200 ms",
    );
}

/// As an ordinary process, without any priority: knots leave 100 ms before they are due.
#[test]
fn a_minute_of_trot_never_runs_dry() {
    let robot = Robot::of_axes(BUS, "1-12");
    let words = "gait run trot --vx 0.5 --duration 60 --enable --json";
    let mut host = Process::spawn(&mut robot.command(words));
    host.wait_for("walk", |line| line.text.ends_with(" s: walks"));
    let begun = now_in_ticks();
    for seconds in [20, 40, 60] {
        let is_over = |_: &Report| now_in_ticks() >= begun + seconds * 1_000;
        robot.wait_for("time to pass", axis(1), is_over);
    }
    let walked = host.finish().success().json();
    assert!(walked["duration"].as_f64().expect("seconds") > 60.0);
    let axes = walked["axes"].as_array().expect("a list");
    let missing = axes.iter().map(|axis| axis["missing_knots"].as_u64());
    let missing: u64 = missing.map(|knots| knots.expect("a number")).sum();
    let status = status(&robot);
    assert!(status.iter().all(|axis| axis["fault"] == Value::Null));
    assert_eq!(missing, 0, "{walked}");
    let (knots, bound) = (format!("{missing} of 12 x 6000"), "0");
    measurement("vcan", "60 s of trot: knots missing", &knots, bound);
}
