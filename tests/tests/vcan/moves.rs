//! The whole chain: moves from the command line, over real CAN, to a node.

use super::robot::{ByHand, Robot, axis};
use canter_shared::axis::state::State;
use canter_shared::limits::Limits;
use canter_shared::time::Ticks;
use canter_shared::wire::report::Report;
use canter_tests::candump::Candump;
use canter_tests::measurement;
use canter_tests::trace::Row;
use std::f64::consts::PI;
use std::io::Write;
use std::process::{Command, Stdio};

/// The default limit of jerk in rad/s^3, which two moves laid over each other keep as well.
const JERK: f64 = 20_000.0;

#[test]
fn three_axes_leave_together_follow_the_curve_and_arrive_in_one_tick() {
    let robot = Robot::start("vcan1");
    let mut candump = Candump::start(robot.bus);
    robot.enable();
    let moved = robot
        .run("move 1=90deg 2=-0.5turn 3=1rad --json")
        .success()
        .json();
    let trace = robot.finish();
    trace.keeps(&Limits::default(), JERK);

    let axes = moved["axes"].as_array().expect("a list of axes");
    let duration = (axes[0]["duration"].as_f64().expect("seconds") * 1e3).round() as u64;
    let mut starts = Vec::new();
    let mut worst = 0.0f64;
    for (id, want) in [(1, PI / 2.0), (2, -PI), (3, 1.0)] {
        let stretches = trace.stretches(id);
        let [stretch] = stretches[..] else {
            panic!("axis {id} moved {} times", stretches.len());
        };
        let (from, to) = stretch.ends();
        assert_eq!(from, 0.0);
        assert!((to - want).abs() <= 0.5e-6, "axis {id} ends at {to}");
        assert_eq!(
            axes[usize::from(id) - 1]["target"].as_f64(),
            Some(to),
            "axis {id}"
        );
        let fit = stretch.fit(duration);
        worst = worst.max(fit.error);
        starts.push((fit.start, fit.start_us));
    }
    assert!(worst <= 2e-6, "{worst} rad off the curve");
    assert!(
        starts.iter().all(|(tick, _)| *tick == starts[0].0),
        "{starts:?}"
    );
    let times = || starts.iter().map(|(_, time)| *time);
    let skew = times().fold(f64::MIN, f64::max) - times().fold(f64::MAX, f64::min);
    assert!(skew <= 50.0, "{skew} us apart");
    measurement(
        "vcan",
        "distance from F(x), 3 axes",
        &format!("{worst:.2e} rad"),
        "<= 2e-6 rad",
    );
    measurement(
        "vcan",
        "start skew, fitted",
        &format!("{skew:.3} us"),
        "<= 50 us",
    );

    decode_with_cantools(&mut candump);
}

/// What candump saw, in the words of other people's tools.
fn decode_with_cantools(candump: &mut Candump) {
    let stage = candump.wait_for("stage of axis 1", |logged| logged.id == (12 << 6 | 1));
    let python = std::env::var("CANTER_PYTHON").expect("tests/run names a Python with cantools");
    let mut decode = Command::new(python)
        .args(["-m", "cantools", "decode", "--single-line"])
        .arg(canter_tests::root().join("canter.dbc"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("cantools runs");
    let hex: String = stage
        .data
        .iter()
        .map(|byte| format!("{byte:02X} "))
        .collect();
    let line = format!(
        "  vcan1  {:03X}   [{}]  {hex}\n",
        stage.id,
        stage.data.len()
    );
    let mut input = decode.stdin.take().expect("a pipe");
    input.write_all(line.as_bytes()).expect("cantools reads");
    drop(input);
    let output = decode.wait_with_output().expect("cantools ends");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success() && text.contains("StageBeta"),
        "{text}"
    );
    assert!(text.contains("target: 0.25 turn"), "{text}");
}

#[test]
fn a_trapezoid_keeps_the_limits_that_were_asked_for() {
    let robot = Robot::start("vcan1");
    robot.enable();
    let request = "move 1=3 2=-1 --profile trapezoid --vmax 5 --amax 20 --dmax 40";
    robot.run(request).success();
    let trace = robot.finish();
    let fastest = |id| {
        trace
            .axis(id)
            .iter()
            .map(|row| row.velocity.abs())
            .fold(0.0, f64::max)
    };
    let strongest = |id, sign: f64| {
        trace
            .axis(id)
            .iter()
            .map(|row| sign * row.acceleration)
            .fold(0.0, f64::max)
    };
    assert!(fastest(1) <= 5.0 && fastest(1) > 4.9, "{}", fastest(1));
    assert!(
        strongest(1, 1.0) <= 20.0 && strongest(1, 1.0) > 19.0,
        "{}",
        strongest(1, 1.0)
    );
    assert!(
        strongest(1, -1.0) <= 40.0 && strongest(1, -1.0) > 36.0,
        "{}",
        strongest(1, -1.0)
    );
    assert_eq!(trace.stretches(1).len(), 1);
    let rests = |id| trace.stretches(id)[0].rows.last().map(|row| row.tick);
    assert_eq!(rests(1), rests(2));
}

#[test]
fn an_s_curve_keeps_the_limits_that_were_asked_for() {
    let robot = Robot::start("vcan1");
    robot.enable();
    let request = "move 1=3 2=-1 --profile s-curve --vmax 5 --amax 20 --dmax 40 --jmax 400";
    robot.run(request).success();
    let trace = robot.finish();
    trace.keeps(&Limits::default(), 400.0);
    let peak = |value: fn(&Row) -> f64| trace.axis(1).iter().map(value).fold(0.0, f64::max);
    let (fastest, up, down) = (
        peak(|row| row.velocity.abs()),
        peak(|row| row.acceleration),
        peak(|row| -row.acceleration),
    );
    assert!(fastest <= 5.0 && fastest > 4.9, "{fastest}");
    assert!(up <= 20.0 && up > 19.0, "{up}");
    assert!(down <= 40.0 && down > 39.0, "{down}");
    let rests = |id| trace.stretches(id)[0].rows.last().map(|row| row.tick);
    assert_eq!(rests(1), rests(2));
}

#[test]
fn a_retarget_in_mid_move_does_not_jump() {
    let robot = Robot::start("vcan2");
    let mut hand = ByHand::new(robot.bus);
    let one = axis(1);
    hand.hold_and_enable(one);
    hand.beat_until("enabled axis", one, is_enabled);
    // Tight moves that meet each other in one part after the other, there and back.
    for (round, target) in [2.0, -1.0, 3.0, 0.5, -2.0, 2.5].into_iter().enumerate() {
        let duration = Ticks(400 + 40 * round as u32);
        hand.move_to(one, target, duration);
        let mut left = 3 + 2 * round;
        while left > 0 {
            hand.beat_until("next feedback", one, |report| {
                matches!(report, Report::Feedback { .. })
            });
            left -= 1;
        }
    }
    hand.beat_until("rest", one, rests);
    let trace = robot.finish();
    trace.keeps(&Limits::default(), 2.0 * JERK);
    let last = trace.axis(1).last().expect("rows");
    assert!((last.position - 2.5).abs() <= 0.5e-6, "{last:?}");
    assert_eq!(trace.stretches(1).len(), 1, "the retargets came too late");
}

#[test]
fn cansend_alone_moves_an_axis() {
    let robot = Robot::start("vcan2");
    let mut hand = ByHand::with_cansend(robot.bus);
    let two = axis(2);
    hand.hold_and_enable(two);
    hand.beat_until("enabled axis", two, is_enabled);
    hand.move_to(two, -1.0, Ticks(1_000));
    let moves = |report: &Report| matches!(report, Report::Feedback { moving: true, .. });
    hand.beat_until("motion", two, moves);
    hand.beat_until("rest", two, rests);
    let trace = robot.finish();
    trace.keeps(&Limits::default(), JERK);
    let [stretch] = trace.stretches(2)[..] else {
        panic!("it did not move once");
    };
    let fit = stretch.fit(1_000);
    assert!(fit.error <= 2e-6, "{fit:?}");
    assert!(
        (stretch.ends().1 + 1.0).abs() <= 0.5e-6,
        "{:?}",
        stretch.ends()
    );
}

fn is_enabled(report: &Report) -> bool {
    match report {
        Report::Feedback { state, .. } => *state == u8::from(State::OperationEnabled),
        _ => false,
    }
}

fn rests(report: &Report) -> bool {
    matches!(report, Report::Feedback { moving: false, .. })
}
