//! The core and the node's image on an emulated Cortex-M4F.

mod emulated;
mod image;
mod target {
    mod clock;
    mod crash;
    mod exercise;
    mod stack;
}

use std::collections::BTreeMap;
use std::process::{Command, Stdio};

use canter_images::scenario;
use canter_shared::axis::state::State;
use canter_shared::limits::Limits;
use canter_shared::motion::beta::{Beta, exact::shape};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::{COUNTS_PER_TURN, Position, Velocity};
use canter_shared::wire::command::Command as Say;
use canter_shared::wire::id::Address;
use canter_shared::wire::report::{Board, IdentityPart, Report};
use canter_tests::measurement;
use canter_tests::process::Process;
use emulated::{Emulated, Record, Served};

/// What `canter_firmware::planning::LEAD` counts on.
const PLAN: u64 = 80_000;

/// Runs a measuring image to its end, and gives what it printed.
fn run(name: &str) -> BTreeMap<String, u64> {
    let finished = Process::spawn(
        Command::new("qemu-system-arm")
            .args(["-M", "netduinoplus2", "-kernel"])
            .arg(image::path(name))
            .args(["-nographic", "-monitor", "none", "-serial", "none"])
            .args(["-icount", "shift=0"])
            .args(["-semihosting-config", "enable=on,target=native"]),
    )
    .finish()
    .success();
    let results = finished.stdout.lines().map(|line| {
        let (name, value) = line.split_once('=').expect("each line is name=value");
        let value = value.parse().expect("each value is a number");
        (name.to_owned(), value)
    });
    results.collect()
}

#[track_caller]
fn holds(results: &BTreeMap<String, u64>, name: &str, bound: u64) {
    let value = results[name];
    let bounded = format!("<= {bound}");
    measurement("target", name, &format!("{value} instructions"), &bounded);
    assert!(value <= bound, "{name}: {value} is over {bound}");
}

#[test]
fn the_core_keeps_its_budget_of_instructions() {
    let results = run("measure");
    assert_eq!(results["calibration.nops_1000"], 1_000, "the count is off");
    holds(&results, "beta.position.most", 250);
    holds(&results, "beta.setpoint.most", 450);
    for name in ["at_rest", "beta", "trapezoid", "without_host"] {
        holds(&results, &format!("node.tick_{name}.most"), 1_500);
    }
    holds(&results, "node.tick_overtaking.most", 1_500);
    // Two beta moves at once: the worst that a tick can meet.
    holds(&results, "node.tick_overlaid.most", 1_500);
    holds(&results, "node.handle_frame.most", 2_000);
    holds(&results, "node.handle_frame_overtaking.most", 2_000);
    // These copy a motion under the node's lock, which holds off the tick.
    holds(&results, "node.take_plan.most", 4_000);
    holds(&results, "node.commit.most", 4_000);
    // Planning holds off nothing, but must be done within its lead.
    for name in ["beta", "trapezoid"] {
        holds(&results, &format!("node.start_{name}.most"), PLAN);
        holds(&results, &format!("node.retarget_{name}.most"), PLAN);
    }
    holds(&results, "node.stop.most", PLAN);
}

/// What changes a motion, over a few hundred random situations each; and how deep the stack gets.
#[test]
fn motions_keep_their_budget_of_instructions_and_stack() {
    let results = run("measure_motion");
    for name in ["s_curve", "trapezoid"] {
        holds(&results, &format!("motion.tick_{name}.most"), 600);
    }
    for name in ["overlay", "stop_beta", "stop_trapezoid", "stop_s_curve"] {
        holds(&results, &format!("motion.{name}.most"), 20_000);
    }
    for name in ["beta", "trapezoid"] {
        for what in ["start", "retarget", "retarget_again"] {
            holds(&results, &format!("motion.{what}_{name}.most"), 20_000);
        }
        holds(&results, &format!("motion.limits_{name}.most"), PLAN);
    }
    for what in ["start", "retarget", "retarget_again", "limits"] {
        holds(&results, &format!("motion.{what}_s_curve.most"), PLAN);
    }
    for name in ["start", "retarget", "stop", "limits", "tick"] {
        bytes(&results, &format!("stack.{name}"), 10_240);
    }
    bytes(&results, "motion.bytes", 1_536);
}

#[track_caller]
fn bytes(results: &BTreeMap<String, u64>, name: &str, bound: u64) {
    let value = results[name];
    let bounded = format!("<= {bound}");
    measurement("target", name, &format!("{value} bytes"), &bounded);
    assert!(value <= bound, "{name}: {value} is over {bound}");
}

/// The device's evaluator, which has the same bits here as there, against the exact curve.
#[test]
fn the_beta_evaluation_is_exact_to_1e_12_of_the_range() {
    // So large that the rounding to a count is below 1e-13 of it.
    let range = Position::from_counts(1000 * COUNTS_PER_TURN);
    let mut worst = 0.0f64;
    for duration in [1u32, 999, 4_096, 65_537, 1_000_003, (1 << 22) - 1] {
        let beta = Beta::new(Tick(0), range, Ticks(duration));
        for tick in (0..=duration).step_by(1 + duration as usize / 20_000) {
            let x = 2.0 * f64::from(tick) / f64::from(duration) - 1.0;
            let want = shape(x).value * range.counts() as f64;
            let got = beta.position(Tick(tick.into())).counts() as f64;
            worst = worst.max((got - want).abs() / range.counts() as f64);
        }
    }
    measurement(
        "target",
        "beta.position error / range",
        &format!("{worst:.1e}"),
        "<= 1e-12",
    );
    assert!(worst <= 1e-12, "{worst}");
}

/// Four axes that never rest, with a bus that carries another leg's traffic too.
#[test]
fn four_axes_leave_the_processor_to_others() {
    const CLOCK: f64 = 170e6;
    let results = run("measure_traffic");
    for part in ["ticks", "frames", "plans", "sends"] {
        let value = format!("{} instructions", results[&format!("traffic.{part}")]);
        measurement(
            "target",
            &format!("four axes, one second, {part}"),
            &value,
            "",
        );
    }
    // Instructions over cycles; a processor that waits for its flash takes some 1.3 cycles for each.
    let share = results["traffic.instructions"] as f64 / CLOCK;
    measurement(
        "target",
        "four axes with full traffic, of 170 MHz",
        &format!("{:.2} %", 100.0 * share),
        "<= 5 %",
    );
    assert!(share <= 0.05, "{results:?}");
    // And there was traffic: all of them moved all the time, and planned, and were told to.
    assert_eq!(results["traffic.moving"], 4_000);
    assert!(results["traffic.received"] >= 600, "{results:?}");
    assert!(results["traffic.accepted"] >= 16, "{results:?}");
    assert_eq!(results["traffic.refused"], 0);
}

/// Four axes that never rest, each with a link to a real drive: the ticks, what they send at each, and what
/// the drives answer. What the hosts' bus adds is measured above.
#[test]
fn four_axes_with_drives_leave_the_processor_to_others() {
    const CLOCK: f64 = 170e6;
    let results = run("measure_drive");
    for kind in ["odrive", "mit", "cia402"] {
        let whole = results[&format!("drive.{kind}.whole.mean")];
        let share = whole as f64 * 1_000.0 / CLOCK;
        measurement(
            "target",
            &format!("four axes with {kind}, of 170 MHz"),
            &format!("{:.2} % ({whole} instructions in 1 ms)", 100.0 * share),
            "<= 5 %",
        );
        assert!(share <= 0.05, "{kind}: {results:?}");
        assert!(
            results[&format!("drive.{kind}.moving")] >= 3_990,
            "{results:?}"
        );
    }
    bytes(&results, "drive.bytes", 144);
}

#[test]
fn host_and_device_produce_the_same_bits() {
    let device = run("digest");
    let host = scenario::play();
    measurement(
        "target",
        "ticks with the same bits on host and device",
        &scenario::TICKS.to_string(),
        ">= 10000",
    );
    assert_eq!(device["scenario.setpoints"], host.setpoints);
    assert_eq!(device["scenario.frames"], host.frames);
    // And the scenario is worth playing.
    assert!(host.moved > scenario::TICKS, "{host:?}");
    assert!(host.accepted > 100, "{host:?}");
    assert!(host.retargets > 50, "{host:?}");
}

#[test]
fn the_emulated_node_speaks_slcan_and_answers_a_scan() {
    let mut node = Emulated::start();
    // Closed, it refuses frames and answers the rest.
    node.write(b"t7000\r");
    node.expect(b"\x07");
    for (say, answer) in [
        (&b"V\r"[..], &b"V0101\r"[..]),
        (b"N\r", b"NQEMU\r"),
        (b"S8\r", b"\r"),
        (b"nonsense\r", b"\x07"),
        (b"O\r", b"\r"),
    ] {
        node.write(say);
        node.expect(answer);
    }
    node.say(Address::All, Say::IdentityRequest);
    let mut seen = BTreeMap::new();
    while seen.len() < 3 {
        let (axis, report) = node.report();
        if let Report::Identity(IdentityPart::Version { board, .. }) = report {
            assert_eq!(Board::try_from(board), Ok(Board::Emulated));
            seen.insert(axis.get(), ());
        }
    }
    assert_eq!(seen.into_keys().collect::<Vec<_>>(), [1, 2, 3]);
}

/// The whole chain: `canter move` over SLCAN to the image, whose setpoints are looked at where they
/// leave for the drives.
#[test]
fn the_emulated_node_moves_bit_for_bit_as_the_host_predicts() {
    let node = Served::start();
    node.run("enable all").success();
    let moved = node
        .run("move 1=90deg 2=-0.5turn 3=1rad --json")
        .success()
        .json();
    let arrivals = moved["axes"].as_array().expect("a list of axes");
    let mut starts = Vec::new();
    let mut compared = 0;
    for (id, arrival) in (1..).zip(arrivals) {
        let records = node.records(id);
        for pair in records.windows(2) {
            let moving = pair[0].velocity != 0 || pair[1].velocity != 0;
            let next = pair[0].tick.wrapping_add(1);
            assert!(
                !moving || pair[1].tick == next,
                "a tick is missing: {pair:?}"
            );
        }
        let radians = |key: &str| arrival[key].as_f64().expect("a number");
        let target = Position::from_radians(radians("target")).expect("in range");
        let duration = Ticks((radians("duration") * 1e3).round() as u32);
        let first = records.iter().find(|record| record.velocity != 0);
        let first = u64::from(first.expect("it moved").tick);
        // The first steps of the curve may be below a count, so the start is a little before.
        let predicts = |start: u64| {
            let beta = Beta::new(Tick(start), target, duration);
            let inside = |record: &&Record| u64::from(record.tick) >= start;
            let same = |record: &Record| record.setpoint() == beta.at(Tick(record.tick.into()));
            records.iter().filter(inside).all(same)
        };
        let start = (first - 8..first).find(|start| predicts(*start));
        starts.push(start.expect("the host's curve, to the bit"));
        let after = |record: &&Record| u64::from(record.tick) >= first;
        compared += records.iter().filter(after).count();
        assert_eq!(
            records.last().map(|record| record.position),
            Some(target.counts())
        );
    }
    assert_eq!(starts, [starts[0]; 3], "the axes left in different ticks");
    let measured = compared.to_string();
    measurement(
        "target",
        "setpoints over slcan as predicted, to the bit",
        &measured,
        "all",
    );
}

#[test]
fn the_emulated_node_stops_and_latches_when_its_host_is_killed() {
    let node = Served::start();
    node.run("enable all").success();
    let mut host = node
        .command("move 1=8turn --duration 6")
        .stderr(Stdio::null())
        .spawn()
        .expect("canter starts");
    let fast = Velocity::from_radians(10.0).expect("in range").counts();
    node.wait_for("motion", 1, |record| record.velocity >= fast);
    host.kill().expect("it still runs");
    host.wait().expect("it ends");
    node.wait_for("fault", 1, |record| record.state == u8::from(State::Fault));
    let records = node.records(1);
    keeps_its_limits(&records);
    let position = records.last().map(|record| record.position);
    assert!(position < Some(8 * COUNTS_PER_TURN));
    let status = node.run("status --json").success().json();
    assert_eq!(status["axes"][0]["fault"], "host_timeout", "{status}");
    assert_eq!(
        node.records(1).last().map(|record| record.position),
        position
    );
}

#[test]
fn the_emulated_node_stops_when_its_host_is_interrupted_and_goes_on_from_there() {
    let node = Served::start();
    node.run("enable all").success();
    let host = Process::spawn(&mut node.command("move 1=8turn --duration 6"));
    let fast = Velocity::from_radians(10.0).expect("in range").counts();
    node.wait_for("motion", 1, |record| record.velocity >= fast);
    host.signal("INT");
    assert_eq!(host.finish().status.code(), Some(1));
    let rest = node.records(1).last().copied().expect("records");
    assert_eq!(rest.velocity, 0);
    assert_eq!(rest.state, u8::from(State::OperationEnabled));
    assert!(rest.position < 8 * COUNTS_PER_TURN, "it was not stopped");
    node.run("move 1=0").success();
    let records = node.records(1);
    assert_eq!(records.last().map(|record| record.position), Some(0));
    keeps_its_limits(&records);
}

/// No tick missing while it moves, no setpoint over a limit, no jump of position, velocity or
/// acceleration (a stop may begin while a move's own jerk is at its peak, so twice the limit).
#[track_caller]
fn keeps_its_limits(records: &[Record]) {
    let limits = Limits::default();
    let jerk = limits.jerk().counts() as f64;
    for pair in records.windows(2) {
        let [before, now] = [pair[0], pair[1]];
        assert!(now.velocity.abs() <= limits.velocity().counts(), "{now:?}");
        let strongest = limits.slower_acceleration().counts();
        assert!(now.acceleration.abs() <= strongest, "{now:?}");
        if before.velocity == 0 && now.velocity == 0 {
            continue;
        }
        assert_eq!(now.tick, before.tick.wrapping_add(1), "a tick is missing");
        let moved = (now.position - before.position) as f64;
        let mean = (now.velocity + before.velocity) as f64 / 2.0;
        // The trapezium rule's error is jerk * T^3 / 12.
        assert!(
            (moved - mean * 1e-3).abs() <= 4.0 + 2.0 * jerk * 1e-9 / 12.0,
            "{pair:?}"
        );
        let change = (now.acceleration - before.acceleration).abs() as f64;
        assert!(change <= 2.0 * jerk * 1e-3, "{pair:?}");
    }
}

/// A tick evaluates a stream or shapes a setpoint; a knot is looked at when its frame comes.
#[test]
fn streams_and_shapers_keep_their_budget_of_instructions() {
    let results = run("measure_stream");
    for name in ["stream.cubic.at", "stream.quintic.at", "shaping.shape"] {
        holds(&results, &format!("{name}.most"), 600);
    }
    for name in ["cubic", "quintic"] {
        // The tick that enters a stretch makes its piece; who asks ahead of that makes one each time.
        holds(&results, &format!("stream.{name}.advance.most"), 700);
        holds(&results, &format!("stream.{name}.at_ahead.most"), 1_200);
        holds(&results, &format!("stream.{name}.push.most"), 1_600);
        // No frame carries knots with accelerations, so that nobody can send hostile ones.
        let hostile = if name == "quintic" { 12_000 } else { 8_000 };
        holds(
            &results,
            &format!("stream.hostile_{name}.push.most"),
            hostile,
        );
        // Some of the hostile knots must have been taken on, or only refusals were measured.
        let accepted = results[&format!("stream.hostile_{name}.accepted")];
        assert!(accepted > 1_000, "{results:?}");
    }
    holds(&results, "node.stream_begin", 2_000);
    holds(&results, "node.knot.most", 2_000);
    holds(&results, "node.tick_stream.most", 1_500);
    holds(&results, "node.tick_stream_brake.most", 1_500);
    holds(&results, "shaping.change", 20_000);
    holds(&results, "shaping.reset", 1_500);
    for (name, bound) in [("stream.bytes", 512), ("shaping.bytes", 3_200)] {
        bytes(&results, name, bound);
    }
}
