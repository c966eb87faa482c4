//! What `canter gait` prints.

use super::{canter_gait, refuses};
use canter_tests::process::Finished;

/// The names of the columns, and the rows.
#[track_caller]
fn table(finished: &Finished) -> (Vec<&str>, Vec<Vec<f64>>) {
    let mut lines = finished.stdout.lines();
    let names: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let rows: Vec<Vec<f64>> = lines
        .map(|line| {
            line.split(',')
                .map(|cell| cell.parse().expect("a number"))
                .collect()
        })
        .collect();
    assert!(rows.iter().all(|row| row.len() == names.len()));
    (names, rows)
}

#[test]
fn a_trot_starts_and_ends_standing_and_goes_somewhere() {
    let finished = canter_gait("plan trot --vx 0.5").success();
    let (names, rows) = table(&finished);
    let column = |name: &str| names.iter().position(|other| *other == name).expect(name);
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    for row in [first, last] {
        for axis in 1..=12 {
            assert_eq!(row[column(&format!("velocity_{axis}"))], 0.0);
            assert_eq!(row[column(&format!("acceleration_{axis}"))], 0.0);
        }
    }
    for axis in 1..=12 {
        let name = column(&format!("position_{axis}"));
        assert!((first[name] - last[name]).abs() < 1e-9, "axis {axis}");
    }
    // The first feet lift in the first row already, from rest.
    for leg in ["front_left", "front_right", "rear_left", "rear_right"] {
        assert_eq!(last[column(&format!("{leg}_grounded"))], 1.0);
    }
    // Four cycles at 0.5 m/s; half a cycle each is lost and won by speeding up and slowing down.
    let way = last[column("body_x")];
    assert!((way - 4.0 * 0.4 * 0.5).abs() < 1e-9, "{way}");
    assert!(
        rows.windows(2)
            .all(|pair| (pair[1][0] - pair[0][0] - 1e-3).abs() < 1e-9)
    );
}

#[test]
fn a_steady_cycle_ends_as_it_begins() {
    for gait in [
        "walk --vx 0.15",
        "trot --vx 0.3",
        "pace --vx 0.3",
        "bound --vx 0.3",
        "pronk --vx 0.25",
        "gallop --vx 0.3",
    ] {
        let finished = canter_gait(&format!("plan {gait} --yaw-rate 10deg --steady")).success();
        let (names, rows) = table(&finished);
        let (first, last) = (&rows[0], &rows[rows.len() - 1]);
        for (index, name) in names.iter().enumerate() {
            let is_axis = name.starts_with("position_") || name.starts_with("velocity_");
            assert!(
                !is_axis || (first[index] - last[index]).abs() < 1e-8,
                "{gait} {name}: {} {}",
                first[index],
                last[index]
            );
        }
    }
}

#[test]
fn the_summary_says_how_near_the_limits_are() {
    let summary = canter_gait("plan trot --vx 0.5 --format json")
        .success()
        .json();
    assert_eq!(summary["gait"], "trot");
    assert_eq!(
        summary["pattern"]["offsets"],
        serde_json::json!([0.0, 0.5, 0.5, 0.0])
    );
    let axes = summary["axes"].as_array().expect("a list");
    assert_eq!(axes.len(), 12);
    let most = axes
        .iter()
        .map(|axis| axis["acceleration_share"].as_f64().expect("a share"));
    let most = most.fold(0.0, f64::max);
    assert!(most > 0.5 && most <= 1.0, "{most}");
    assert!(summary["samples"].is_null());
    let with_rows = canter_gait("plan stand --dt 0.1 --format json")
        .success()
        .json();
    assert!(
        with_rows["samples"]
            .as_array()
            .is_some_and(|rows| !rows.is_empty())
    );
    let same = canter_gait("--json plan trot --vx 0.5").success().json();
    assert_eq!(same, summary);
}

#[test]
fn the_picture_has_feet_axes_and_figures() {
    let finished = canter_gait("plan walk --vx 0.2 --cycles 1 --format svg").success();
    let svg = &finished.stdout;
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
    for words in [
        "feet as the hips see them",
        "feet above the ground",
        "acceleration",
        "moments of a cycle",
        "axis 12",
    ] {
        assert!(svg.contains(words), "{words}");
    }
}

#[test]
fn the_list_names_every_gait() {
    let list = canter_gait("list").success().stdout;
    let json = canter_gait("list --json").success().json();
    for name in ["stand", "walk", "trot", "pace", "bound", "pronk", "gallop"] {
        assert!(list.contains(name), "{list}");
        let gaits = json["gaits"].as_array().expect("a list");
        assert!(gaits.iter().any(|gait| gait["name"] == name));
    }
}

#[test]
fn refusals_say_what_to_do() {
    for (arguments, status, words) in [
        ("plan trot --vx 0.5 --period 0.3", 1, "longer period"),
        ("plan trot --vx 2 --period 1.2", 1, "too far from the hip"),
        ("plan trot --vx nan", 2, "vx"),
        ("plan trot --vx inf", 2, "vx"),
        ("plan trot --period 1e9", 2, "the period"),
        ("plan trot --period -1", 2, "--period"),
        (
            "plan trot --duty 0.5 --overlay 60",
            2,
            "the duty with the overlay",
        ),
        ("plan trot --overlay -1", 2, "the overlay"),
        ("plan trot --swing -0.1", 2, "the swing height"),
        ("plan trot --height 0", 2, "the height"),
        ("plan trot --dt 1e-6 --cycles 1000", 2, "--dt"),
        ("plan trot --dt 1e-300", 2, "the time from row to row"),
        ("plan trot --cycles 0", 2, "the number of cycles"),
        ("plan trot --cycles 4000000000", 2, "the number of cycles"),
        ("plan trot --offsets 0,0.5,0.5", 2, "four numbers"),
        ("plan trot --offsets 0,0.5,0.5,nan", 2, "a phase offset"),
        ("plan custom", 2, "--offsets"),
        ("plan stand --vx 0.1", 2, "stand goes nowhere"),
        ("plan canter", 2, "gallop"),
    ] {
        refuses(arguments, status, words);
    }
}
