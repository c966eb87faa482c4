//! A node and its drives, each in a process of its own, on two real buses: the host's and the drives'.

use super::robot::{axis, wait_for};
use canter_shared::axis::state::State;
use canter_shared::limits::Limits;
use canter_shared::motion::beta::Beta;
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::{COUNTS_PER_TURN, Position};
use canter_shared::wire::report::Report;
use canter_tests::candump::{Candump, Logged};
use canter_tests::measurement;
use canter_tests::process::{Finished, Process};
use canter_tests::trace::Trace;
use std::path::PathBuf;
use std::process::Command;

/// The default jerk limit, twice: a stop may begin while a move's own jerk is at its peak.
const JERK: f64 = 2.0 * 20_000.0;

/// Every kind of drive, with what it takes to be met on a busy machine: none stops by itself meanwhile.
const KINDS: [&str; 4] = [
    "odrive --firmware 0.6",
    "odrive --firmware 0.5",
    "mit --watchdog 2",
    "cia402",
];

/// Long enough for the trouble that comes 1 s after the drive was enabled.
const LONG_MOVE: &str = "move 1=1.9turn 2=-1.9turn 3=1turn --duration 6";

/// A node with axes 1 to 3, and their drives.
struct Driven {
    bus: &'static str,
    node: Process,
    drives: Process,
    trace: PathBuf,
    directory: tempfile::TempDir,
}

impl Driven {
    /// Starts both; `drives` is the kind and what is special about it.
    fn start(buses: [&'static str; 2], drives: &str) -> Self {
        Self::with_period(buses, drives, 0.005)
    }

    /// The same, with another period of setpoints.
    fn with_period([bus, drive_bus]: [&'static str; 2], drives: &str, period: f64) -> Self {
        let directory = tempfile::tempdir().expect("a directory for the trace");
        let trace = directory.path().join("trace.csv");
        let kind = drives.split(' ').next().expect("a kind");
        let mut command = Command::new(canter_tests::canter());
        command.args(["--can", drive_bus, "drive", "--nodes", "1-3", "--kind"]);
        let mut drive_process = Process::spawn(command.args(drives.split(' ')));
        drive_process.wait_for("start", |line| line.text.starts_with("running 3 drives"));
        let mut command = Command::new(canter_tests::canter());
        command.args(["--can", bus, "node", "--axes", "1-3", "--drive", kind]);
        command.args(["--drive-can", drive_bus, "--trace"]);
        let mut node = Process::spawn(command.arg(&trace));
        node.wait_for("start", |line| line.text.starts_with("running 3 axes"));
        let driven = Self {
            bus,
            node,
            drives: drive_process,
            trace,
            directory,
        };
        // What a drive is, is set while the node runs. A machine that is busy elsewhere is no lost drive, nor
        // one that does not follow: it would be told of many ticks at once. And it has less to do.
        let firmware = if drives.contains("0.5") { "0.5" } else { "0.6" };
        let section = |axis| {
            format!(
                "[axis.{axis}]\nhost.timeout = 5\ndrive.odrive_firmware = \"{firmware}\"\ndrive.timeout = 1\n\
                 drive.period = {period}\noverspeed.margin = 0\nfollowing.error = 0\n"
            )
        };
        let file = driven.directory.path().join("parameters.toml");
        std::fs::write(&file, (1..=3).map(section).collect::<String>()).expect("a file");
        let import = format!("param import {}", file.display());
        driven.run(&import).success();
        driven
    }

    fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(canter_tests::canter());
        command.args(["--can", self.bus]);
        command.args(arguments.split_whitespace());
        command
    }

    fn run(&self, arguments: &str) -> Finished {
        Process::spawn(&mut self.command(arguments)).finish()
    }

    /// Waits until these axes are there, without torque.
    fn wait_for_drives(&self, axes: &[u8]) {
        let wanted = State::SwitchOnDisabled;
        for id in axes.iter().copied() {
            wait_for(self.bus, wanted.name(), axis(id), |report| match report {
                Report::Heartbeat { state, .. } => *state == u8::from(wanted),
                _ => false,
            });
        }
    }

    fn enable(&self) {
        self.wait_for_drives(&[1, 2, 3]);
        self.run("enable all").success();
    }

    /// Waits until a drive says this.
    #[track_caller]
    fn drive_says(&mut self, words: &str) -> String {
        self.drives
            .wait_for(words, |line| line.text.contains(words))
            .text
    }

    /// Waits until each of the three has said this, in whichever order.
    #[track_caller]
    fn all_drives_say(&mut self, words: &str) {
        for _ in 1..=3 {
            self.drive_says(words);
        }
    }

    /// Moves into the trouble of the first drive, and gives the fault that came of it.
    #[track_caller]
    fn fault_in_mid_move(&self) -> String {
        self.enable();
        let moved = self.run(LONG_MOVE);
        assert_eq!(moved.status.code(), Some(1), "{moved:#?}");
        let status = self.run("status --json").success().json();
        let first = &status["axes"][0];
        assert_eq!(first["state"], "fault", "{status} {moved:#?}");
        // Nothing goes on by itself, and a host is told why.
        let refused = self.run("move 1=0 --enable");
        assert_eq!(refused.status.code(), Some(1), "{refused:#?}");
        first["fault"].as_str().expect("a name").to_owned()
    }

    /// Clears, enables, and moves from wherever it is.
    #[track_caller]
    fn recover(&self) {
        self.run("clear all").success();
        self.wait_for_drives(&[1]);
        self.run("enable all").success();
        self.run("move 1=0.2turn --duration 3").success();
    }

    fn trace(&self) -> Trace {
        Trace::read(&self.trace)
    }

    /// Ends both, and gives the whole trace.
    fn finish(self) -> Trace {
        self.node.signal("INT");
        self.node.finish().success();
        self.drives.signal("INT");
        self.drives.finish().success();
        Trace::read(&self.trace)
    }
}

#[test]
fn axes_with_drives_of_each_kind_move_as_they_are_told() {
    for kind in KINDS {
        let mut driven = Driven::start(["vcan12", "vcan13"], &format!("{kind} --position 0.25"));
        driven.enable();
        driven.drive_says("enabled at 0.25");
        let moved = driven
            .run("move 1=-1.5turn 2=1turn --json")
            .success()
            .json();
        for (place, target) in [(0, -1.5), (1, 1.0)] {
            let position = moved["axes"][place]["position"].as_f64().expect("a number");
            let away = position / std::f64::consts::TAU - target;
            assert!(away.abs() < 0.01, "{kind}: {moved}");
        }
        driven.run("disable all").success();
        driven.drive_says("disabled");
        driven.finish().keeps(&Limits::default(), JERK);
    }
}

/// Frame by frame, as candump sees it.
#[test]
fn drives_are_started_in_the_order_that_their_documents_ask_for() {
    for (kind, ids, wanted) in [
        (
            "odrive",
            [0x04B, 0x04C, 0x047],
            &[
                "04B#0300000001000000",
                "04C#0000003F00000000",
                "047#08000000",
            ][..],
        ),
        (
            "mit --watchdog 2",
            [0x002; 3],
            &["002#FFFFFFFFFFFFFFFC", "002#A02"],
        ),
        (
            "cia402",
            [0x202, 0x602, 0x602],
            &[
                "000#8002",
                "602#2B40600000000000",
                "602#2300140102020080",
                "602#2F60600008000000",
                "000#0102",
                "202#000000800000",
                "080#",
                "202#060000800000",
                "202#070000800000",
                "202#0F0000800000",
            ],
        ),
    ] {
        let mut candump = Candump::start_for("vcan15", &[&[0x000, 0x080], &ids[..]].concat());
        // Half a turn: 0x3F000000, 41002 of 65535 in 25 rad, 32768 increments.
        let drives = format!("{kind} --position 0.5");
        let driven = Driven::with_period(["vcan14", "vcan15"], &drives, 0.001);
        driven.enable();
        for text in wanted {
            let is = |frame: &Logged| {
                let hex: String = frame
                    .data
                    .iter()
                    .map(|byte| format!("{byte:02X}"))
                    .collect();
                format!("{:03X}#{hex}", frame.id).starts_with(text)
            };
            candump.wait_for(text, is);
        }
        // At 1 kHz from then on, as well as this machine runs.
        let node_to_drive = |frame: &Logged| {
            // An answer of a drive in mini-cheetah mode has its id too; it begins with it.
            [0x04C, 0x002, 0x202].contains(&frame.id) && frame.data.first() != Some(&2)
        };
        let mut times = Vec::new();
        while times.len() < 200 {
            times.push(candump.wait_for("setpoint", node_to_drive).time_us);
        }
        let mean = (times[199] - times[0]) as f64 / 199.0;
        measurement(
            "vcan",
            &format!("{kind}: between two setpoints, mean"),
            &format!("{mean:.0} us"),
            "-",
        );
        driven.finish();
    }
}

/// A motor of 2 Nm turns 0.02 kg m^2, so an acceleration of 1 rad/s^2 takes 10 thousandths of its torque.
#[test]
fn a_canopen_drive_that_takes_torque_is_told_what_its_axis_needs() {
    let mut candump = Candump::start_for("vcan13", &[0x201, 0x601]);
    let driven = Driven::start(["vcan12", "vcan13"], "cia402");
    driven
        .run("param set drive.rated_torque 2 --axis 1")
        .success();
    driven
        .run("param set drive.inertia 0.02 --axis 1")
        .success();
    candump.wait_for("60B2 as the third object", |frame| {
        frame.id == 0x601 && frame.data == [0x23, 0x00, 0x16, 0x03, 0x10, 0x00, 0xB2, 0x60]
    });
    driven.enable();
    driven.run("move 1=1.5turn --duration 1.3").success();
    let (mut most, mut least) = (0, 0);
    candump.wait_for("a brake's end", |frame| {
        // Controlword, target and torque of a drive that is enabled.
        let torque = match frame.data[..] {
            [0x0F, 0, _, _, _, _, low, high] => i16::from_le_bytes([low, high]),
            _ => 0,
        };
        assert!(torque <= 0 || least == 0, "{frame:?} after {least}");
        (most, least) = (most.max(torque), least.min(torque));
        least < 0 && torque == 0
    });
    let way = Position::from_counts(3 * COUNTS_PER_TURN / 2);
    let peak = 10.0
        * Beta::new(Tick(0), way, Ticks(1_300))
            .peak_acceleration()
            .radians();
    for told in [most, -least] {
        assert!(
            (f64::from(told) - peak).abs() < 0.02 * peak,
            "{told} {peak}"
        );
    }
    driven.finish();
}

#[test]
fn a_drives_fault_is_latched_with_its_meaning_and_cleared() {
    for kind in KINDS {
        let mut driven = Driven::start(["vcan16", "vcan17"], &format!("{kind} --fault-at 1"));
        assert_eq!(driven.fault_in_mid_move(), "drive_undervoltage", "{kind}");
        driven.drive_says("stopped by a fault");
        driven.recover();
        driven.finish();
    }
}

#[test]
fn a_drive_that_reboots_is_lost_until_it_is_cleared() {
    for kind in KINDS {
        // Its reboot takes longer than drive.timeout.
        let mut driven = Driven::start(["vcan18", "vcan19"], &format!("{kind} --reboot-at 1"));
        let fault = driven.fault_in_mid_move();
        assert_eq!(fault, "drive_lost", "{kind}");
        driven.drive_says("its power goes and comes");
        driven.recover();
        driven.finish();
    }
}

/// It still hears: it is told to let go.
#[test]
fn a_drive_that_falls_silent_is_lost_and_stays_without_torque() {
    for kind in KINDS {
        let mut driven = Driven::start(["vcan18", "vcan19"], &format!("{kind} --silent-at 1"));
        assert_eq!(driven.fault_in_mid_move(), "drive_lost", "{kind}");
        driven.drive_says("drive 1: disabled");
        driven.finish();
    }
}

#[test]
fn drives_that_are_found_enabled_are_disabled_before_anything_else() {
    for kind in KINDS {
        let mut driven = Driven::start(["vcan20", "vcan21"], &format!("{kind} --start-enabled"));
        // A drive in mini-cheetah mode that was told nothing yet has no gains: nothing to see.
        if !kind.starts_with("mit") {
            driven.all_drives_say("disabled");
        }
        driven.enable();
        driven.run("move 1=1turn").success();
        driven.finish().keeps(&Limits::default(), JERK);
    }
}

/// The node is gone: only the drives themselves can end it.
#[test]
fn drives_whose_node_was_killed_stop_by_their_own_watchdogs() {
    for kind in [
        "odrive --watchdog 0.3",
        "mit --watchdog 0.3",
        "cia402 --watchdog 0.3",
    ] {
        let mut driven = Driven::start(["vcan22", "vcan23"], kind);
        // A machine that takes long to start the node finds its drives stopped already.
        driven.run("clear all").success();
        driven.enable();
        let moving = Process::spawn(&mut driven.command(LONG_MOVE));
        wait_for(driven.bus, "motion", axis(1), |report| match report {
            Report::Feedback { velocity, .. } => velocity.radians() > 1.0,
            _ => false,
        });
        assert!(!driven.trace().axis(1).is_empty());
        driven.node.signal("KILL");
        driven.all_drives_say("disabled");
        drop(moving);
        driven.drives.signal("INT");
        driven.drives.finish().success();
    }
}

#[test]
fn a_node_with_drives_needs_their_bus_and_no_other() {
    let run = |arguments: &str| {
        let mut command = Command::new(canter_tests::canter());
        Process::spawn(command.args(arguments.split(' '))).finish()
    };
    for (arguments, words) in [
        ("--can vcan12 node --axes 1 --drive mit", "--drive-can"),
        (
            "--can vcan12 node --axes 1 --drive mit --drive-can vcan12",
            "the same bus",
        ),
        (
            "--can vcan12 node --axes 1 --drive mit --drive-can sim",
            "--drive-can",
        ),
        (
            "--can vcan12 drive --kind simulated --nodes 1",
            "--kind odrive",
        ),
        (
            "--can vcan12 drive --kind mit --nodes 1 --trouble-node 2",
            "--nodes",
        ),
        ("drive --kind mit --nodes 1", "--can"),
    ] {
        let finished = run(arguments);
        assert_eq!(
            finished.status.code(),
            Some(1),
            "{arguments}: {finished:#?}"
        );
        assert!(
            finished.stderr.contains(words),
            "{arguments}: {finished:#?}"
        );
    }
}
