//! The command line on the simulated robot: what it prints, what it writes, how it ends.

use std::path::Path;
use std::process::Command;

use canter_tests::measurement;
use canter_tests::process::{Finished, Process};

fn canter(arguments: &str) -> Finished {
    let mut command = Command::new(canter_tests::canter());
    command.env_remove("CANTER_CAN");
    Process::spawn(command.args(arguments.split_whitespace())).finish()
}

fn demo(directory: &Path, seed: u32) -> Finished {
    let out = directory.display();
    canter(&format!("demo --out {out} --seed {seed}"))
}

#[test]
fn the_demonstration_leaves_a_report_setpoints_and_a_bus_log() {
    let directory = tempfile::tempdir().expect("a directory");
    let out = directory.path().join("new/demo");
    let finished = demo(&out, 1).success();
    for word in [
        "start skew",
        "distance from the curve",
        "distance from the ideal curves",
        "bus load in the trot",
    ] {
        assert!(finished.stdout.contains(word), "{finished:#?}");
    }

    let csv = std::fs::read_to_string(out.join("setpoints.csv")).expect("setpoints.csv");
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("t,axis,position,velocity,acceleration"));
    // One row for each axis and millisecond, none missing.
    let mut expected: Option<(u64, u64)> = None;
    let mut rows = 0;
    for line in lines {
        let cells: Vec<f64> = line
            .split(',')
            .map(|cell| cell.parse().expect("a number"))
            .collect();
        let [t, axis, _, velocity, acceleration] = cells[..] else {
            panic!("not five cells: {line}");
        };
        let at = ((t * 1e3).round() as u64, axis as u64);
        assert_eq!(at, expected.unwrap_or(at), "{line}");
        expected = Some(if at.1 == 12 {
            (at.0 + 1, 1)
        } else {
            (at.0, at.1 + 1)
        });
        assert!(
            velocity.abs() <= 20.0 && acceleration.abs() <= 200.0,
            "{line}"
        );
        rows += 1;
    }
    // Eight seconds of walking, and moves before and after it.
    assert!(rows > 12 * 9_000, "{rows} rows");

    let log = std::fs::read_to_string(out.join("bus.log")).expect("bus.log");
    let lines = log.lines().map(canter::log::candump::parse);
    assert!(lines.clone().all(|line| line.is_ok()));
    assert!(lines.count() > 1_000);

    let html = std::fs::read_to_string(out.join("report.html")).expect("report.html");
    // How it looks, and that it asks for nothing, is for the tests of `report`.
    assert!(html.matches("<svg").count() >= 20);
}

#[test]
fn the_demonstration_keeps_its_promises() {
    let directory = tempfile::tempdir().expect("a directory");
    let out = directory.path().display();
    let told = canter(&format!("demo --json --out {out}")).success().json();
    let promises = told["promises"].as_array().expect("a list");
    for (what, most) in [
        ("bus load in the trot", 40.0),
        ("trot: setpoints off their ideal curves", 50.0),
        ("start skew, all axes", 20.0),
        ("peak velocity", 100.0),
        ("peak acceleration", 100.0),
    ] {
        let promise = promises.iter().find(|promise| promise["what"] == what);
        let promise = promise.unwrap_or_else(|| panic!("{what}: {told:#}"));
        let value = promise["value"].as_f64().expect("a number");
        assert_eq!(promise["at_most"], most);
        assert!(0.0 < value && value <= most, "{promise}");
        let unit = promise["unit"].as_str().expect("a unit");
        let value = format!("{value:.1} {unit}");
        measurement(
            "fast",
            &format!("demo: {what}"),
            &value,
            &format!("{most} {unit}"),
        );
    }
    assert!(
        promises.iter().all(|promise| promise["kept"] == true),
        "{told:#}"
    );
}

#[test]
fn a_robot_that_cannot_walk_shows_the_rest() {
    let directory = tempfile::tempdir().expect("a directory");
    let file = directory.path().join("robot.toml");
    std::fs::write(&file, "[[axis]]\nid = 7\n[[axis]]\nid = 9\n").expect("written");
    let out = directory.path().join("out");
    let (file, out) = (file.display(), out.display());
    let shown = canter(&format!("--robot {file} demo --out {out}")).success();
    assert!(shown.stderr.contains("does not walk: "), "{shown:#?}");
    assert!(!shown.stdout.contains("walk"), "{shown:#?}");
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let directory = tempfile::tempdir().expect("a directory");
    let read = |name: &str, seed| {
        let out = directory.path().join(name);
        demo(&out, seed).success();
        ["setpoints.csv", "bus.log", "report.html"]
            .map(|file| std::fs::read(out.join(file)).expect("it was written"))
    };
    let first = read("first", 7);
    assert!(first == read("second", 7), "the second time is different");
    assert!(first[1] != read("third", 8)[1], "the seed does nothing");
}

#[test]
fn a_demonstration_that_cannot_be_written_fails() {
    let finished = canter("demo --out /proc/nowhere");
    assert_eq!(finished.status.code(), Some(1));
    assert!(finished.stderr.contains("/proc/nowhere"), "{finished:#?}");
}

#[test]
fn scan_and_status_tell_of_twelve_axes() {
    let scan = canter("scan --json").success();
    assert!(scan.stderr.starts_with("bus: sim"), "{scan:#?}");
    let nodes = scan.json();
    let nodes = nodes["nodes"].as_array().expect("a list");
    let ids: Vec<_> = nodes
        .iter()
        .map(|node| node["axis"].as_u64().expect("a number"))
        .collect();
    assert_eq!(ids, (1..=12).collect::<Vec<_>>());
    assert!(
        nodes
            .iter()
            .all(|node| node["protocol"] == "1.2" && node["doubled"] == false)
    );

    let status = canter("status --json").success().json();
    let axes = status["axes"].as_array().expect("a list");
    assert_eq!(axes.len(), 12);
    for axis in axes {
        assert_eq!(axis["state"], "switch on disabled");
        assert_eq!(axis["fault"], serde_json::Value::Null);
        for key in [
            "position",
            "velocity",
            "bus_off",
            "error_frames",
            "lost",
            "rejected",
        ] {
            assert_eq!(axis[key].as_f64(), Some(0.0), "{key}: {axis}");
        }
    }
}

#[test]
fn watch_tells_of_twelve_axes_until_its_time_is_over() {
    let watched = canter("watch --for 0.3 --period 0.1 --json").success();
    let lines = watched.stdout.lines();
    let documents: Vec<serde_json::Value> = lines
        .map(|line| serde_json::from_str(line).expect("a document on each line"))
        .collect();
    let times: Vec<_> = documents.iter().map(|told| told["time"].as_f64()).collect();
    assert_eq!(times, [0.1, 0.2, 0.3].map(Some), "{watched:#?}");
    let status = canter("status --json").success().json();
    let axes = documents[2]["axes"].as_array().expect("a list");
    assert_eq!(axes.len(), 12);
    for (axis, status) in axes.iter().zip(status["axes"].as_array().expect("a list")) {
        let mut wanted = status.clone();
        wanted["silent"] = false.into();
        assert_eq!(*axis, wanted);
    }

    // A table at the end at least, and an empty line between two.
    let shown = canter("watch --for 2.5").success().stdout;
    let tables: Vec<_> = shown.split("\n\n").collect();
    assert_eq!(tables.len(), 3, "{shown}");
    assert!(
        tables
            .iter()
            .all(|table| table.trim_end().lines().count() == 13),
        "{shown}"
    );

    for period in ["0.01", "61", "often"] {
        let refused = canter(&format!("watch --period {period}"));
        assert_eq!(refused.status.code(), Some(2), "{refused:#?}");
        assert!(refused.stderr.contains(period), "{refused:#?}");
    }
}

/// Virtual time goes no faster than real time here, and so it runs until it is ended.
#[test]
fn watch_without_an_end_is_ended_by_a_signal_or_by_a_reader_that_has_seen_enough() {
    for signal in ["INT", "TERM"] {
        let mut command = Command::new(canter_tests::canter());
        command.env_remove("CANTER_CAN");
        let mut watch = Process::spawn(command.args(["watch", "--json", "--period", "0.02"]));
        watch.wait_for("a document", |line| line.text.starts_with('{'));
        watch.signal(signal);
        watch.finish().success();
    }
    let canter = canter_tests::canter();
    let script = format!(
        "set -o pipefail; {} --can sim watch --json --period 0.02 | head -n 2",
        canter.display()
    );
    let finished = Process::spawn(Command::new("bash").args(["-c", &script])).finish();
    assert_eq!(finished.success().stdout.lines().count(), 2);
}

#[test]
fn a_move_ends_at_its_targets() {
    for profile in ["beta", "trapezoid"] {
        let request = format!("move 1=90deg 2-3=-0.5turn 4=1 --profile {profile} --json");
        let moved = canter(&request).success().json();
        let axes = moved["axes"].as_array().expect("a list");
        assert_eq!(axes.len(), 4);
        for axis in axes {
            assert_eq!(axis["arrived"], true);
            let [target, position] =
                ["target", "position"].map(|key| axis[key].as_f64().expect("a number"));
            assert!((target - position).abs() <= 1e-6, "{axis}");
            assert!(
                axis["skew_us"].as_u64().is_some_and(|skew| skew <= 50),
                "{axis}"
            );
            assert_eq!(axis["duration"], axes[0]["duration"]);
        }
    }
}

#[test]
fn durations_follow_the_request() {
    let duration = |arguments: &str| {
        let moved = canter(&format!("move {arguments} --json")).success().json();
        moved["axes"][0]["duration"].as_f64().expect("seconds")
    };
    assert_eq!(duration("1=1 --duration 1.5"), 1.5);
    assert_eq!(duration("1=1 --duration 250ms"), 0.25);
    // 32 / (5 pi) R / v, and a tick or two for rounding up.
    let want = 32.0 / (5.0 * std::f64::consts::PI) * 3.0 / 2.0;
    assert!((duration("1=3 --vmax 2") - want).abs() <= 2e-3);
    // Each on its own: the shorter way takes less.
    let moved = canter("move 1=1 2=10 --independent --json")
        .success()
        .json();
    assert!(moved["axes"][0]["duration"].as_f64() < moved["axes"][1]["duration"].as_f64());
}

#[test]
fn verbs_that_change_axes_say_what_became_of_them() {
    for (arguments, state) in [
        ("enable all --json", "operation enabled"),
        ("disable 1-3 --json", "switch on disabled"),
        ("clear 2 --json", "switch on disabled"),
        ("stop all --json", "switch on disabled"),
        ("estop 5 --json", "fault"),
    ] {
        let told = canter(arguments).success().json();
        let axes = told["axes"].as_array().expect("a list");
        assert!(!axes.is_empty());
        assert!(
            axes.iter().all(|axis| axis["state"] == state),
            "{arguments}: {told}"
        );
    }
}

#[test]
fn errors_have_their_exit_codes_and_a_json_form() {
    for (arguments, code) in [
        ("", 2),
        ("dance", 2),
        ("move 1=x", 2),
        ("move 13=1", 1),
        ("node --axes 1-3", 1),
        ("--robot /no/such/robot.toml status", 1),
        ("scan --can vcan99", 1),
    ] {
        let finished = canter(arguments);
        assert_eq!(
            finished.status.code(),
            Some(code),
            "{arguments}: {finished:#?}"
        );
        assert!(finished.stdout.is_empty(), "{finished:#?}");
    }
    let failed = canter("move 13=1 --json");
    let error = failed.json()["error"].as_str().expect("words").to_owned();
    assert!(error.contains("axis 13 does not answer"), "{error}");
}

#[test]
fn a_robot_file_changes_axes_and_limits() {
    let directory = tempfile::tempdir().expect("a directory");
    let file = directory.path().join("robot.toml");
    std::fs::write(
        &file,
        "[[axis]]\nid = 7\n[axis.limits]\nposition_max = 1.0\n",
    )
    .expect("written");
    let robot = file.display();
    canter(&format!("--robot {robot} move 7=1")).success();
    let outside = canter(&format!("--robot {robot} move 7=1.001"));
    assert_eq!(outside.status.code(), Some(1));
    assert!(
        outside.stderr.contains("outside its travel"),
        "{outside:#?}"
    );
}

#[test]
fn a_robot_file_shapes_an_axis() {
    let directory = tempfile::tempdir().expect("a directory");
    let file = directory.path().join("robot.toml");
    let robot = |shaper: &str| {
        let text = format!("[[axis]]\nid = 7\n[axis.shaper]\n{shaper}\n[[axis]]\nid = 8\n");
        std::fs::write(&file, text).expect("written");
        canter(&format!(
            "--json --robot {} move 7=2 8=-1 --profile s-curve",
            file.display()
        ))
    };
    let moved = robot("kind = \"ei\"\nfrequency = 9.0").success().json();
    for axis in moved["axes"].as_array().expect("a list") {
        assert_eq!(axis["arrived"], true, "{axis}");
    }
    for (shaper, word) in [
        ("kind = \"ei\"\nfrequency = 0.5", "frequency"),
        (
            "kind = \"zv\"\nfrequency = 9.0\ndamping = 2.0",
            "damping ratio",
        ),
        ("kind = \"zvx\"\nfrequency = 9.0", "zvx"),
    ] {
        let refused = robot(shaper);
        assert_eq!(refused.status.code(), Some(1), "{refused:#?}");
        assert!(refused.stderr.contains(word), "{refused:#?}");
    }
}

#[test]
fn other_tools_get_the_protocol_completions_and_a_manual() {
    let file = canter_tests::root().join("canter.dbc");
    let dbc = std::fs::read_to_string(file).expect("canter.dbc");
    // Lines are compared as a process gives them, without what ends them.
    let printed = canter("dbc").success().stdout;
    assert!(printed.trim_end() == dbc.trim_end(), "dbc");
    let help = canter("--help").success().stdout;
    let lines = help.lines().skip_while(|line| *line != "Commands:");
    // What goes on with a verb's description is further in.
    let verbs: Vec<&str> = lines
        .skip(1)
        .map_while(|line| line.strip_prefix("  "))
        .filter(|line| !line.starts_with(' '))
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    assert!(verbs.len() > 15, "{help}");
    let manual = canter("man").success().stdout;
    for shell in ["bash", "zsh", "fish"] {
        let script = canter(&format!("completions {shell}")).success().stdout;
        for verb in &verbs {
            assert!(script.contains(verb), "{shell} lacks {verb}");
        }
    }
    for verb in verbs.iter().filter(|verb| **verb != "help") {
        assert!(manual.contains(&format!("canter\\-{verb}")), "{verb}");
    }
    assert_eq!(canter("completions sh").status.code(), Some(2));
}
