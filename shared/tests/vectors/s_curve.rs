//! Against what Ruckig 0.19.4 computed; see tests/vectors.

use super::csv::{Row, rows, text};
use canter_shared::motion::s_curve::{SignedBounds, change_velocity, lasting, time_optimal};
use canter_shared::motion::segments::Segments;
use canter_shared::motion::trajectory::{Sample, Trajectory};
use std::collections::HashMap;

/// The case with all lengths multiplied by `length`.
fn planned(row: &Row, length: f64) -> Segments {
    let get = |name| length * row.number(name);
    let (fastest, strongest) = (get("v_max"), get("a_max"));
    let below = |name, above: f64| {
        -row.optional(name)
            .map_or(above, |limit| length * limit.abs())
    };
    let bounds = SignedBounds::new(
        fastest,
        below("v_min", fastest),
        strongest,
        below("a_min", strongest),
        get("j_max"),
    )
    .expect("valid limits");
    let from = Sample {
        acceleration: get("a0"),
        ..Sample::coasting(get("p0"), get("v0"))
    };
    let planned = if row.text("kind") == "velocity_iface_stop" {
        change_velocity(from, get("vf"), &bounds)
    } else {
        time_optimal(from, Sample::coasting(get("pf"), get("vf")), &bounds)
    };
    planned.expect("a valid case")
}

/// Every kind but the one without a limit of jerk, which is a trapezoid.
fn cases() -> HashMap<String, Segments> {
    let cases: HashMap<_, _> = rows("ruckig_cases.csv")
        .iter()
        .filter(|row| row.text("kind") != "trap_nojerk")
        .map(|row| (row.text("case").to_owned(), planned(row, 1.0)))
        .collect();
    assert_eq!(cases.len(), 170);
    cases
}

#[test]
fn durations_are_equal() {
    let cases = cases();
    for row in rows("ruckig_cases.csv") {
        let Some(curve) = cases.get(row.text("case")) else {
            continue;
        };
        let want = row.number("duration");
        let error = (curve.duration() - want) / want;
        assert!(error.abs() <= 1e-12, "{row:?}: {error}");
    }
}

/// From 1e-11 to 1e9 times as long.
#[test]
fn durations_do_not_depend_on_the_unit_of_length() {
    let cases = cases();
    for row in rows("ruckig_cases.csv") {
        let Some(curve) = cases.get(row.text("case")) else {
            continue;
        };
        for power in [-36, -20, 20, 30] {
            let other = planned(&row, 2f64.powi(power)).duration();
            let error = (other - curve.duration()) / curve.duration();
            assert!(error.abs() <= 1e-12, "{row:?}: {error}");
        }
    }
}

#[test]
fn samples_are_equal() {
    let cases = cases();
    let mut compared = 0;
    for row in rows("ruckig_points.csv") {
        let Some(curve) = cases.get(row.text("case")) else {
            continue;
        };
        let get = |name| row.number(name);
        let at = curve.at(get("t"));
        let peaks = curve.peaks();
        let range = (0..=10)
            .map(|tenth| curve.at(curve.duration() * f64::from(tenth) / 10.0))
            .map(|at| (at.position - curve.start().position).abs())
            .fold(0.0, f64::max);
        let position = (at.position - get("pos")).abs();
        let velocity = (at.velocity - get("vel")).abs();
        let acceleration = (at.acceleration - get("acc")).abs();
        assert!(position <= 1e-9 * range, "{row:?}: {at:?}");
        assert!(velocity <= 1e-9 * peaks.velocity, "{row:?}: {at:?}");
        assert!(acceleration <= 1e-9 * peaks.acceleration, "{row:?}: {at:?}");
        compared += 1;
    }
    assert_eq!(compared, 170 * 11);
}

/// Axes that start and arrive together: ours cruise at the velocity that theirs cruise at.
#[test]
fn synchronised_samples_are_equal() {
    let groups: serde_json::Value =
        serde_json::from_str(&text("ruckig_sync.json")).expect("valid JSON");
    let groups = groups.as_array().expect("a list");
    assert!(!groups.is_empty());
    let mut worst: f64 = 0.0;
    for group in groups {
        let value = |name: &str, axis: usize| group[name][axis].as_f64().expect("a number");
        let duration = group["duration"].as_f64().expect("a number");
        for axis in 0..group["p0"].as_array().expect("a list").len() {
            let (fastest, strongest) = (value("v_max", axis), value("a_max", axis));
            let jerk = value("j_max", axis);
            let bounds = SignedBounds::new(fastest, -fastest, strongest, -strongest, jerk)
                .expect("valid limits");
            let (from, to) = (value("p0", axis), value("pf", axis));
            let alone = time_optimal(Sample::at_rest(from), Sample::at_rest(to), &bounds)
                .expect("a valid case");
            let want = value("independent_min", axis);
            assert!((alone.duration() - want).abs() <= 1e-12 * want);
            let curve = lasting(Sample::at_rest(from), to, duration, &bounds).expect("long enough");
            for sample in group["samples"].as_array().expect("a list") {
                let at = curve.at(sample["t"].as_f64().expect("a number"));
                let want = sample["p"][axis].as_f64().expect("a number");
                let error = (at.position - want).abs() / (to - from).abs();
                worst = worst.max(error);
            }
        }
    }
    assert!(worst <= 1e-7, "{worst}");
}
