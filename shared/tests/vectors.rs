//! The beta S-curve against numbers that other programs computed; see tests/vectors.

use canter_shared::motion::beta::exact::{Profile, shape};
use std::path::Path;

fn rows(name: &str) -> Vec<Vec<String>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../tests/vectors")
        .join(name);
    let text = std::fs::read_to_string(&path).expect("the vectors are part of the project");
    let rows: Vec<Vec<String>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect();
    assert!(!rows.is_empty());
    rows
}

fn number(cell: &str) -> f64 {
    cell.parse().expect("a number")
}

#[test]
fn unit_curve_and_its_derivatives() {
    for row in rows("beta_shape.csv") {
        let at = shape(number(&row[0]));
        for (got, want, bound) in [
            (at.value, &row[3], 1e-14),
            (at.first, &row[4], 1e-13),
            (at.second, &row[5], 1e-13),
            (at.third, &row[6], 1e-12),
        ] {
            assert!((got - number(want)).abs() <= bound, "{row:?}: {got}");
        }
    }
}

#[test]
fn durations_and_positions() {
    for row in rows("beta_scurve_cases.csv") {
        let [v, a, x0, x1, time] = [1, 2, 3, 4, 5].map(|column| number(&row[column]));
        let got = Profile::shortest(x1 - x0, v, a, f64::INFINITY);
        assert!((got - time).abs() <= 1e-12 * time, "{row:?}: {got}");
    }
    for row in rows("beta_scurve_points.csv") {
        let [x0, x1, duration, time, want] = [3, 4, 5, 6, 9].map(|column| number(&row[column]));
        let range = (x1 - x0).abs();
        let got = match Profile::with_duration(x0, x1, duration) {
            Some(profile) => profile.at(time).position,
            None => x0,
        };
        assert!(
            (got - want).abs() <= 1e-12 * range.max(x0.abs() * 1e-3),
            "{row:?}: {got}"
        );
    }
}
