//! `canter path` as other programs call it.

use canter_tests::process::{Finished, Process};
use std::process::Command;

const CORNER: &str = "1,2\n0,0\n1,0.2\n1.2,-1\n0.1,0.4\n";

/// Runs `canter path` with these arguments and this on its standard input.
#[track_caller]
fn canter_path(arguments: &str, input: &str) -> Finished {
    let mut command = Command::new(canter_tests::canter());
    command.arg("path").args(arguments.split_whitespace());
    let mut process = Process::spawn(&mut command);
    if !input.is_empty() {
        process.write(input);
    }
    process.finish()
}

/// The rows of the CSV, under its header.
#[track_caller]
fn rows(finished: &Finished, header: &str) -> Vec<Vec<f64>> {
    let mut lines = finished.stdout.lines();
    assert_eq!(lines.next(), Some(header), "{finished:#?}");
    let numbers = |line: &str| {
        let cells = line.split(',').map(|cell| cell.parse().expect("a number"));
        cells.collect()
    };
    lines.map(numbers).collect()
}

#[test]
fn csv_goes_from_the_first_waypoint_to_the_last_within_limits() {
    let header = "t,position_1,velocity_1,acceleration_1,position_2,velocity_2,acceleration_2";
    for profile in ["two-pass", "s-curve"] {
        let arguments = format!("- --profile {profile} --vmax 2 --dt 0.01");
        let rows = rows(&canter_path(&arguments, CORNER).success(), header);
        let (first, last) = (&rows[0], &rows[rows.len() - 1]);
        assert_eq!([first[0], first[1], first[4]], [0.0, 0.0, 0.0]);
        assert_eq!(rows[3][0], 0.03);
        assert!((last[1] - 0.1).abs() < 1e-9 && (last[4] - 0.4).abs() < 1e-9);
        let mut fastest: f64 = 0.0;
        for row in &rows {
            fastest = fastest.max(row[2].hypot(row[5]));
            assert!(row[3].abs() <= 200.0 && row[6].abs() <= 200.0, "{row:?}");
        }
        assert!(
            fastest <= 2.0 + 1e-9 && fastest > 1.7,
            "{profile}: {fastest}"
        );
    }
}

#[test]
fn json_says_how_the_axes_use_their_limits() {
    let plain = canter_path("- --json", CORNER).success().json();
    assert_eq!(plain["axes"][1]["axis"], 2);
    assert!(plain["samples"].is_null() && plain["axes"][0]["peak_jerk"].is_null());
    let shares = plain["axes"].as_array().expect("axes").iter();
    let most = shares.map(|axis| axis["acceleration_share"].as_f64().expect("a share"));
    let most = most.fold(0.0, f64::max);
    assert!(most > 0.95 && most <= 1.0, "{most}");
    let smooth = canter_path("- --profile s-curve --format json --dt 0.1", CORNER).success();
    let smooth = smooth.json();
    let jerk = smooth["axes"][0]["jerk_share"].as_f64().expect("a share");
    assert!(jerk <= 1.0 + 1e-6, "{jerk}");
    assert_eq!(smooth["samples"][0]["position"][0], 0.0);
    assert!(smooth["duration"].as_f64() > plain["duration"].as_f64());
}

#[test]
fn a_picture_names_its_axes() {
    let picture = canter_path("- --format svg", CORNER).success().stdout;
    assert!(picture.starts_with("<svg") && picture.contains("axis 2"));
}

#[test]
fn a_path_runs_on_the_simulated_robot() {
    let toml = "axes = [2, 5]\n[[waypoint]]\nat = [0.5, 0.0]\n[[waypoint]]\nat = [\"90deg\", 1.0]\n\
                heading = [1.0, -0.5]\nspeed = 2.0\n[[waypoint]]\nat = [0.2, -0.3]\n";
    for arguments in ["- --run", "- --run --profile s-curve", "- --run --vmax 1.5"] {
        let done = canter_path(arguments, toml).success();
        assert!(
            done.stdout.starts_with("path done: 3 waypoints in "),
            "{done:#?}"
        );
        let done = canter_path(&format!("{arguments} --json"), toml)
            .success()
            .json();
        for (axis, target) in [(0, 0.2), (1, -0.3)] {
            let position = done["axes"][axis]["position"].as_f64().expect("a position");
            assert!((position - target).abs() < 1e-3, "{done}");
            assert_eq!(done["axes"][axis]["missing_knots"], 0);
        }
    }
}

#[test]
fn a_robot_files_limits_hold_for_the_path_and_its_stream() {
    let file = tempfile::NamedTempFile::new().expect("a place for files");
    let limits = "[axis.limits]\nvelocity = 0.5\nacceleration = 2.0\ndeceleration = 1.0\n";
    let robot = format!("[[axis]]\nid = 1\n{limits}[[axis]]\nid = 2\n");
    std::fs::write(file.path(), robot).expect("written");
    let name = file.path().display();
    let plan = canter_path(&format!("- --json --robot {name}"), CORNER)
        .success()
        .json();
    let axis = &plan["axes"][0];
    let peak = |field: &str| axis[field].as_f64().expect("a peak");
    assert!(
        peak("peak_velocity") <= 0.5 && peak("peak_acceleration") <= 1.0,
        "{axis}"
    );
    assert!(peak("peak_velocity") > 0.45, "{axis}");
    canter_path(&format!("- --run --robot {name}"), CORNER).success();
}

#[test]
fn what_cannot_be_ends_with_1_and_says_why() {
    for (arguments, input, words) in [
        ("-", "1\n0\n0\n", "waypoint 2 is where"),
        ("-", "1\n0\nnan\n", "line 3"),
        ("-", "1\n0\n7000\n", "axis 1: the path goes to"),
        ("- --v0 500", "1\n0\n1\n", "start with at most"),
        ("- --v1 500", "1\n0\n1\n", "end with at most"),
        ("- --dt 1e-12", "1\n0\n1\n", "--dt"),
        ("no-such-file.csv", "", "no-such-file.csv"),
    ] {
        let refused = canter_path(arguments, input);
        assert_eq!(refused.status.code(), Some(1), "{arguments}: {refused:#?}");
        assert!(refused.stderr.contains(words), "{arguments}: {refused:#?}");
        assert!(refused.stdout.is_empty(), "{arguments}: {refused:#?}");
    }
    for arguments in [
        "",
        "- --vmax -1",
        "- --v0 nan",
        "- --run --dt 0.1",
        "- --enable",
    ] {
        let refused = canter_path(arguments, "");
        assert_eq!(refused.status.code(), Some(2), "{arguments}: {refused:#?}");
    }
}
