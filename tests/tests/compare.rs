//! `canter compare`: the profiles side by side, and which one to choose.

use canter_tests::process::{Finished, Process};
use serde_json::Value;
use std::process::Command;

#[track_caller]
fn compare(arguments: &str) -> Finished {
    let mut command = Command::new(canter_tests::canter());
    Process::spawn(command.arg("compare").args(arguments.split_whitespace())).finish()
}

const MOVE: &str = "--from 0 --to 1 --vmax 2 --amax 10 --jmax 200";

fn names(document: &Value) -> Vec<String> {
    let profiles = document["profiles"].as_array().expect("a list");
    let name = |row: &Value| match row["shaper"].as_str() {
        Some(shaper) => format!("{} {shaper}", row["profile"].as_str().expect("a name")),
        None => row["profile"].as_str().expect("a name").to_owned(),
    };
    profiles.iter().map(name).collect()
}

fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap_or_else(|| panic!("{key}: {row}"))
}

#[test]
fn there_is_a_row_for_each_profile_and_each_shaper() {
    let told = compare(&format!(
        "{MOVE} --resonance 8 --damping 0.05 --format json"
    ))
    .success()
    .json();
    let bare = ["trapezoid", "s-curve", "beta", "cubic", "quintic", "septic"];
    let mut want = bare.map(str::to_owned).to_vec();
    for shaper in ["ZV", "ZVD", "EI"] {
        want.extend(
            bare[..3]
                .iter()
                .map(|profile| format!("{profile} {shaper}")),
        );
    }
    assert_eq!(names(&told), want);
    let rows = told["profiles"].as_array().expect("a list");
    let least = rows.iter().map(|row| number(row, "duration"));
    let least = least.fold(f64::INFINITY, f64::min);
    for row in rows {
        assert!((number(row, "ratio") - number(row, "duration") / least).abs() < 1e-12);
        assert!(number(row, "peak_velocity") <= 2.0 * (1.0 + 1e-9), "{row}");
        assert!(
            number(row, "peak_acceleration") <= 10.0 * (1.0 + 1e-9),
            "{row}"
        );
        let steps = ["trapezoid", "cubic"].contains(&row["profile"].as_str().expect("a name"));
        assert_eq!(row["peak_jerk"].is_null(), steps, "{row}");
        if !steps {
            assert!(number(row, "peak_jerk") <= 200.0 * (1.0 + 1e-9), "{row}");
        }
        let share = number(row, "residual_share");
        assert!(
            (share - number(row, "residual")).abs() < 1e-15,
            "the way is 1"
        );
        if row["shaper"] == "ZV" {
            assert!(share < 1e-12, "{row}");
        }
    }
    // The closed forms: R / v + v / a, and with the jerk a / j more.
    assert!((number(&rows[0], "duration") - 0.7).abs() < 1e-12);
    assert!((number(&rows[1], "duration") - 0.75).abs() < 1e-12);
}

#[test]
fn it_chooses_the_fastest_that_is_calm() {
    // Stiff enough for the bare s-curve; softer, so that it takes a shaper; too soft for any.
    for (resonance, choice, reason) in [
        (
            8.0,
            "s-curve",
            "the fastest that leaves at most 1 % of the way",
        ),
        (
            5.3,
            "s-curve",
            "the fastest that leaves at most 1 % of the way",
        ),
        (
            2.7,
            "s-curve + ZV",
            "the fastest that leaves at most 1 % of the way",
        ),
        (0.5, "septic", "it leaves the least"),
    ] {
        let arguments = format!("{MOVE} --resonance {resonance} --damping 0");
        let text = compare(&arguments).success().stdout;
        let advice = text.lines().last().expect("a sentence");
        assert!(
            advice.starts_with(&format!("Choose the {choice}: ")) && advice.contains(reason),
            "{resonance}: {text}"
        );
        let told = compare(&format!("{arguments} --json")).success().json();
        assert_eq!(told["advice"], advice);
        let rows = told["profiles"].as_array().expect("a list");
        let chosen = &told["choice"];
        assert!(rows.contains(chosen));
        // A trapezoid, which keeps no jerk limit, is never chosen where one was named.
        for row in rows.iter().filter(|row| !row["peak_jerk"].is_null()) {
            let better = number(row, "residual_share") <= 0.01
                && number(row, "duration") < number(chosen, "duration");
            assert!(!better, "{row} is faster than {chosen}");
        }
    }
}

#[test]
fn whatever_the_spring_the_chosen_one_is_calm_and_nothing_calm_is_faster() {
    for step in 1..=24 {
        let resonance = 0.75 * f64::from(step);
        let told = compare(&format!(
            "{MOVE} --resonance {resonance} --damping 0.02 --json"
        ));
        let told = told.success().json();
        let rows = told["profiles"].as_array().expect("a list");
        let allowed = rows.iter().filter(|row| !row["peak_jerk"].is_null());
        let calm: Vec<&Value> = allowed
            .filter(|row| number(row, "residual_share") <= 0.01)
            .collect();
        let chosen = &told["choice"];
        if calm.is_empty() {
            continue;
        }
        assert!(calm.contains(&chosen), "{resonance} Hz: {chosen}");
        let quickest = calm.iter().map(|row| number(row, "duration"));
        let quickest = quickest.fold(f64::INFINITY, f64::min);
        assert_eq!(number(chosen, "duration"), quickest, "{resonance} Hz");
    }
}

#[test]
fn without_a_resonance_nothing_swings() {
    let finished = compare(MOVE).success();
    assert!(!finished.stdout.contains("swings"), "{finished:#?}");
    let last = finished.stdout.lines().last().expect("a sentence");
    assert_eq!(
        last,
        "Choose the s-curve: the fastest that keeps every limit."
    );
    // Nor is a jerk limit needed: the s-curve is then as gentle as the beta curve.
    let told = compare("--from 3 --to -2 --vmax 2 --amax 10 --json")
        .success()
        .json();
    let rows = told["profiles"].as_array().expect("a list");
    let jerk = |at: usize| number(&rows[at], "peak_jerk");
    assert!((jerk(1) - jerk(2)).abs() < 1e-9 * jerk(2), "{told}");
    assert_eq!(rows.len(), 6);
    assert!(
        told["notes"][0]
            .as_str()
            .is_some_and(|note| note.contains("--jmax"))
    );
    assert!(rows.iter().all(|row| row["residual"].is_null()));
}

#[test]
fn csv_and_svg_hold_the_same() {
    let arguments = format!("{MOVE} --resonance 8 --shaper ei");
    let csv = compare(&format!("{arguments} --format csv")).success();
    let mut lines = csv.stdout.lines();
    assert_eq!(
        lines.next(),
        Some(
            "profile,shaper,duration,ratio,peak_velocity,peak_acceleration,peak_jerk,residual,\
             residual_share"
        )
    );
    let first: Vec<&str> = lines.next().expect("a row").split(',').collect();
    assert_eq!(first[..2], ["trapezoid", ""]);
    assert_eq!(first[6].parse(), Ok(f64::INFINITY));
    assert_eq!(lines.count(), 8);
    assert!(csv.stderr.contains("Choose the "), "{csv:#?}");

    let svg = compare(&format!("{arguments} --format svg"))
        .success()
        .stdout;
    // Four charts and one over the frequency, in one document.
    assert_eq!(svg.matches("<svg ").count(), 6);
    for text in [
        "septic",
        "s-curve + EI",
        "frequency (Hz)",
        "dB of the way",
        "limit",
    ] {
        assert!(svg.contains(text), "no {text}");
    }
}

#[test]
fn what_is_wrong_is_named() {
    for (arguments, code, words) in [
        ("--from 0 --to 1", 2, "--vmax and --amax"),
        ("--from 0 --to 1 --vmax 1", 2, "--vmax and --amax"),
        ("--from 0 --vmax 1 --amax 1", 2, "--to"),
        ("--from 0 --to nan --vmax 1 --amax 1", 2, "--to"),
        (
            "--from 0 --to 1 --vmax 1 --amax 1 --resonance 0",
            2,
            "--resonance",
        ),
        (
            "--from 0 --to 1 --vmax 1 --amax 1 --damping 0.1",
            2,
            "--resonance",
        ),
        (
            "--from 0 --to 1 --vmax 1 --amax 1 --shaper zv",
            2,
            "--resonance",
        ),
        (
            "--from 0 --to 1 --vmax 1 --amax 1 --resonance 5 --damping 1",
            2,
            "--damping",
        ),
        (
            "--from 0 --to 1e9 --vmax 1 --amax 1 --resonance 5",
            1,
            "--resonance",
        ),
    ] {
        let refused = compare(arguments);
        assert_eq!(
            refused.status.code(),
            Some(code),
            "{arguments}: {refused:#?}"
        );
        assert!(refused.stderr.contains(words), "{arguments}: {refused:#?}");
        assert!(refused.stdout.is_empty(), "{arguments}: {refused:#?}");
    }
    // A shaper that cannot be is left out, and said so.
    let told = compare(&format!("{MOVE} --resonance 3 --json"))
        .success()
        .json();
    assert_eq!(told["profiles"].as_array().map(Vec::len), Some(9));
    assert_eq!(told["notes"].as_array().map(Vec::len), Some(2));
}

/// What docs/profiles.md shows is what is printed.
#[test]
fn the_documents_tell_the_truth() {
    let path = canter_tests::root().join("docs/profiles.md");
    let text = std::fs::read_to_string(path).expect("docs/profiles.md");
    let (_, example) = text
        .split_once("```sh\ncanter compare ")
        .expect("a command");
    let (command, rest) = example.split_once("\n```").expect("the end of it");
    let output = rest.split("```").nth(1).expect("what it prints");
    let printed = compare(command).success().stdout;
    let mut shown = 0;
    for line in output
        .lines()
        .filter(|line| !line.is_empty() && *line != "...")
    {
        assert!(
            printed.lines().any(|other| other == line),
            "`{line}` is not in\n{printed}"
        );
        shown += 1;
    }
    assert!(shown >= 5);
}
