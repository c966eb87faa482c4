//! Numbers that other programs computed, through the command line.

use super::{canter_plan, rows_at, summary};
use csv::{Row, rows};

/// The reader that the library's own tests use.
#[allow(dead_code)]
#[path = "../../../shared/tests/vectors/csv.rs"]
mod csv;

/// The points of one case.
fn points_of<'a>(points: &'a [Row], case: &'a Row) -> impl Iterator<Item = &'a Row> {
    points
        .iter()
        .filter(|point| point.text("case") == case.text("case"))
}

/// Asks for the positions at the times of a case's points, and compares each.
#[track_caller]
fn compare(arguments: &str, points: &[&Row], columns: &[(&str, usize, f64)]) {
    let times = points.iter().map(|point| point.number("t"));
    let answers = rows_at(arguments, times);
    for (point, answer) in points.iter().zip(&answers) {
        for (column, place, tolerance) in columns {
            let (want, got) = (point.number(column), answer[*place]);
            assert!(
                (got - want).abs() <= *tolerance,
                "{arguments}: {column} at {} is {got}, not {want}",
                answer[0]
            );
        }
    }
}

#[track_caller]
fn duration(arguments: &str) -> f64 {
    summary(arguments)["duration"].as_f64().expect("seconds")
}

#[test]
fn beta_as_s_curve_beta() {
    let points = rows("beta_scurve_points.csv");
    for case in rows("beta_scurve_cases.csv") {
        let [v, a, x0, x1] = ["v_max", "a_max", "x0", "x1"].map(|column| case.text(column));
        let arguments = format!("--profile beta --from {x0} --to {x1} --vmax {v} --amax {a}");
        let told = summary(&arguments);
        let want = case.number("motion_time");
        let got = told["duration"].as_f64().expect("seconds");
        assert!((got - want).abs() <= 1e-14 * want, "{case:?}: {got}");
        for (key, column) in [
            ("peak_velocity", "peak_vel_exact"),
            ("peak_acceleration", "peak_acc_exact"),
            ("peak_jerk", "peak_jerk_exact"),
        ] {
            let (got, want) = (told[key].as_f64().expect("a number"), case.number(column));
            assert!((got - want).abs() <= 1e-12 * want, "{case:?}: {key} {got}");
        }
        let range = (case.number("x1") - case.number("x0")).abs();
        // Far from zero a position has no more digits than its own.
        let digits = f64::EPSILON * case.number("x0").abs().max(case.number("x1").abs());
        let points: Vec<&Row> = points_of(&points, &case).collect();
        compare(
            &arguments,
            &points,
            &[("pos_mp40", 1, 1e-12 * range + digits)],
        );
    }
}

#[test]
fn trapezoid_as_gearpy_where_gearpy_is_sound() {
    let points = rows("gearpy_points.csv");
    let mut sound = 0;
    for case in rows("gearpy_cases.csv") {
        let [from, to, v, a, d, v0, v1, t0] =
            ["x0", "x1", "v_max", "a_acc", "a_dec", "v0", "v1", "t0"]
                .map(|column| case.text(column));
        let arguments = format!(
            "--profile trapezoid --from {from} --to {to} --vmax {v} --amax {a} --dmax {d} \
             --v0 {v0} --v1 {v1} --t0 {t0}"
        );
        if case.number("sound") == 0.0 {
            let refused = canter_plan(&arguments, "");
            assert_eq!(refused.status.code(), Some(1), "{case:?}: {refused:#?}");
            let flag = if case.number("v0") == 0.0 {
                "--v1"
            } else {
                "--v0"
            };
            let words = refused.stderr.starts_with(&format!("error: {flag}: "));
            assert!(words, "{case:?}: {refused:#?}");
            assert!(refused.stdout.is_empty(), "{refused:#?}");
            continue;
        }
        sound += 1;
        let want = case.number("duration");
        assert!(
            (duration(&arguments) - want).abs() <= 1e-12 * want,
            "{case:?}"
        );
        let range = (case.number("x1") - case.number("x0")).abs();
        let tolerance = 1e-9 * range.max(1e-3 * case.number("x0").abs());
        let points: Vec<&Row> = points_of(&points, &case).collect();
        compare(&arguments, &points, &[("pos", 1, tolerance)]);
    }
    assert!(sound > 10);
}

#[test]
fn quintic_as_python_robotics() {
    let points = rows("quintic_points.csv");
    for case in rows("quintic_cases.csv") {
        let [from, v0, a0, to, v1, a1, duration] =
            ["xs", "vxs", "axs", "xe", "vxe", "axe", "T"].map(|column| case.text(column));
        let arguments = format!(
            "--profile quintic --from {from} --to {to} --v0 {v0} --v1 {v1} --a0 {a0} --a1 {a1} \
             --duration {duration}"
        );
        let points: Vec<&Row> = points_of(&points, &case).collect();
        let columns = [("pos", 1), ("vel", 2), ("acc", 3), ("jerk", 4)];
        let tolerances = columns.map(|(column, place)| {
            let sizes = points.iter().map(|point| point.number(column).abs());
            (column, place, 1e-9 * sizes.fold(1e-3, f64::max))
        });
        compare(&arguments, &points, &tolerances);
    }
}

#[test]
fn s_curve_as_ruckig() {
    let points = rows("ruckig_points.csv");
    let mut seen = 0;
    for case in rows("ruckig_cases.csv") {
        // The others have limits that differ by direction, which the command line has no flags for,
        // no jerk limit, or no target.
        let kinds = ["rest", "v0", "v0a0", "v0a0vf", "v0_over_limit"];
        if !kinds.contains(&case.text("kind")) {
            continue;
        }
        seen += 1;
        let [from, v0, a0, to, v1, v, a, j] =
            ["p0", "v0", "a0", "pf", "vf", "v_max", "a_max", "j_max"]
                .map(|column| case.text(column));
        let arguments = format!(
            "--profile s-curve --from {from} --to {to} --v0 {v0} --a0 {a0} --v1 {v1} \
             --vmax {v} --amax {a} --jmax {j}"
        );
        let want = case.number("duration");
        let got = duration(&arguments);
        assert!((got - want).abs() <= 1e-9 * want, "{case:?}: {got}");
        let range = case.number("pos_max") - case.number("pos_min");
        let points: Vec<&Row> = points_of(&points, &case).collect();
        let rate = |limit: &str| 1e-7 * case.number(limit).max(case.number("v0").abs());
        compare(
            &arguments,
            &points,
            &[
                ("pos", 1, 1e-7 * range),
                ("vel", 2, rate("v_max")),
                ("acc", 3, 1e-7 * case.number("a_max")),
            ],
        );
    }
    assert!(seen >= 100, "{seen} cases");
}
