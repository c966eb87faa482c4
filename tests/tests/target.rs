//! The core and the node's image on an emulated Cortex-M4F.

mod emulated;
mod image;

use std::collections::BTreeMap;
use std::process::Command;

use canter_images::scenario;
use canter_shared::axis::state::State;
use canter_shared::motion::beta::Beta;
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::{COUNTS_PER_TURN, Position};
use canter_shared::wire::command::{Action, Command as Say, ProfileKind};
use canter_shared::wire::id::{Address, AxisId};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::{Board, IdentityPart, Report};
use canter_tests::measurement;
use canter_tests::process::Process;
use emulated::Emulated;

/// One tick at 170 MHz, in instructions of at least one cycle each.
const TICK: u64 = 170_000;

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
    holds(&results, "beta.position.most", 600);
    holds(&results, "beta.setpoint.most", 1_200);
    holds(&results, "node.tick_at_rest.most", 2_000);
    holds(&results, "node.tick_beta.most", 3_000);
    holds(&results, "node.tick_trapezoid.most", 3_000);
    // Planning holds off the tick, so it must leave room for one.
    for name in ["beta", "trapezoid"] {
        holds(&results, &format!("node.start_{name}.most"), TICK / 2);
        holds(&results, &format!("node.retarget_{name}.most"), TICK / 2);
    }
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

#[test]
fn the_emulated_node_moves_as_the_host_predicts() {
    const SESSION: u16 = 77;
    const DURATION: Ticks = Ticks(800);
    let mut node = Emulated::start();
    node.open();
    let axis = AxisId::new(2).expect("a node's second axis");
    let control = |action, sequence| Say::Control {
        action,
        sequence,
        session: SESSION,
    };
    // The drive has said its first word when the axis may be enabled.
    node.wait_for_state(axis, State::SwitchOnDisabled);
    // Released, the axis needs no heartbeats that a busy machine could delay.
    node.say(axis.into(), control(Action::Hold, 1));
    node.say(axis.into(), control(Action::Enable, 2));
    node.say(axis.into(), control(Action::Release, 3));
    let rest = node.wait_for_state(axis, State::OperationEnabled);
    assert_eq!(rest.position, 0);

    let target = Position::from_counts(-COUNTS_PER_TURN - (1 << 20));
    node.say(axis.into(), control(Action::Hold, 4));
    node.say(
        axis.into(),
        Say::Move {
            profile: ProfileKind::Beta,
            staged: false,
            target,
            duration: DURATION,
            sequence: 5,
        },
    );
    node.say(axis.into(), control(Action::Release, 6));
    loop {
        if let (
            from,
            Report::Acknowledgement {
                sequence: 5,
                reason,
                ..
            },
        ) = node.report()
        {
            assert_eq!((from, reason), (axis, Reason::Accepted));
            break;
        }
    }

    // The trace has every tick; the first that is not at rest tells when the move began.
    let mut records = Vec::new();
    while records
        .last()
        .is_none_or(|record: &emulated::Record| record.position != target.counts())
    {
        records.push(node.record(axis));
    }
    for record in records.windows(2) {
        assert_eq!(
            record[1].tick,
            record[0].tick.wrapping_add(1),
            "a tick is missing"
        );
    }
    let end = records.last().expect("the target was reached").tick;
    let start = end - DURATION.0;
    let beta = Beta::new(Tick(start.into()), target, DURATION);
    for record in &records {
        let expected = beta.at(Tick(record.tick.into()));
        assert_eq!(record.setpoint(), expected, "at tick {}", record.tick);
    }
    let moving = records.iter().filter(|record| record.velocity != 0);
    let moving = moving.count();
    let between = DURATION.0 as usize - 1;
    measurement(
        "target",
        "setpoints of a move, bit for bit as predicted",
        &moving.to_string(),
        &format!("= {between}"),
    );
    assert_eq!(moving, between, "between start and end the axis moves");
}
