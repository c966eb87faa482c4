//! The beta S-curve against s-curve-beta and 40 digits.

use super::csv::rows;
use canter_shared::motion::beta::exact::{Profile, shape};

#[test]
fn unit_curve_and_its_derivatives() {
    for row in rows("beta_shape.csv") {
        let at = shape(row.number("x"));
        for (got, want, bound) in [
            (at.value, "f_mp40", 1e-15),
            (at.first, "df_exact", 1e-13),
            (at.second, "d2f_exact", 1e-13),
            (at.third, "d3f_exact", 1e-12),
        ] {
            assert!((got - row.number(want)).abs() <= bound, "{row:?}: {got}");
        }
    }
}

#[test]
fn durations_and_positions() {
    for row in rows("beta_scurve_cases.csv") {
        let [v, a, x0, x1, time] = row.numbers(["v_max", "a_max", "x0", "x1", "motion_time"]);
        let got = Profile::shortest(x1 - x0, v, a, f64::INFINITY);
        assert!((got - time).abs() <= 1e-12 * time, "{row:?}: {got}");
    }
    for row in rows("beta_scurve_points.csv") {
        let [x0, x1, duration, time, want] =
            row.numbers(["x0", "x1", "motion_time", "t", "pos_mp40"]);
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
