//! Quintics against PythonRobotics.

use super::csv::{Row, rows};
use canter_shared::motion::polynomial::Quintic;
use canter_shared::motion::trajectory::{Sample, Trajectory};

fn quintic(case: &Row) -> Quintic {
    let [xs, vxs, axs, xe, vxe, axe, duration] =
        case.numbers(["xs", "vxs", "axs", "xe", "vxe", "axe", "T"]);
    let end = |position, velocity, acceleration| Sample {
        position,
        velocity,
        acceleration,
        jerk: 0.0,
    };
    Quintic::new(end(xs, vxs, axs), end(xe, vxe, axe), duration).expect("valid")
}

#[test]
fn quintics() {
    let points = rows("quintic_points.csv");
    for case in rows("quintic_cases.csv") {
        let ours = quintic(&case);
        let duration = case.number("T");
        // Theirs come out of a linear solver, whose errors grow with the terms that cancel: a
        // power's part in the position counts.
        let mut power = 1.0;
        let scale = ["a0", "a1", "a2", "a3", "a4", "a5"]
            .iter()
            .zip((0..).map(|k| duration.powi(k)))
            .map(|(name, power)| (case.number(name) * power).abs())
            .fold(0.0, f64::max);
        for (got, name) in ours
            .coefficients()
            .iter()
            .zip(["a0", "a1", "a2", "a3", "a4", "a5"])
        {
            let want = case.number(name);
            assert!(
                ((got - want) * power).abs() <= 1e-9 * scale,
                "{case:?} {name}: {got}"
            );
            power *= duration;
        }
        let of_case: Vec<_> = points
            .iter()
            .filter(|row| row.text("case") == case.text("case"))
            .collect();
        let columns = ["pos", "vel", "acc", "jerk"];
        let largest = columns.map(|column| {
            let values = of_case.iter().map(|row| row.number(column).abs());
            values.fold(0.0, f64::max)
        });
        assert!(of_case.len() > 10);
        for point in of_case {
            let at = ours.at(point.number("t"));
            let got = [at.position, at.velocity, at.acceleration, at.jerk];
            for ((got, column), largest) in got.into_iter().zip(columns).zip(largest) {
                let want = point.number(column);
                assert!(
                    (got - want).abs() <= 1e-9 * largest,
                    "{point:?} {column}: {got}"
                );
            }
        }
    }
}
