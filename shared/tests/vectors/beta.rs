//! The beta S-curve against s-curve-beta and 40 digits.

use super::csv::rows;
use canter_shared::motion::beta::exact::{Profile, shape};
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::trajectory::Trajectory;

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

/// `pos_mp40` is the true position; their interpolated table errs by 1e-6 of the range.
#[test]
fn durations_and_positions() {
    for row in rows("beta_scurve_cases.csv") {
        let [v, a, x0, x1, time] = row.numbers(["v_max", "a_max", "x0", "x1", "motion_time"]);
        let bounds = Bounds::new(v, a, a, f64::INFINITY).expect("valid");
        let profile = Profile::within(x0, x1, &bounds).expect("valid");
        let got = profile.duration();
        assert!((got - time).abs() <= 1e-12 * time, "{row:?}: {got}");
        let peaks = profile.peaks();
        for (got, want) in [
            (peaks.velocity, "peak_vel_exact"),
            (peaks.acceleration, "peak_acc_exact"),
            (peaks.jerk, "peak_jerk_exact"),
        ] {
            assert!(
                (got - row.number(want)).abs() <= 1e-12 * got,
                "{row:?}: {got}"
            );
        }
    }
    let mut worst: f64 = 0.0;
    for row in rows("beta_scurve_points.csv") {
        let [x0, x1, duration, time, want] =
            row.numbers(["x0", "x1", "motion_time", "t", "pos_mp40"]);
        let profile = Profile::lasting(x0, x1, duration).expect("valid");
        let got = profile.at(time).position;
        // A position of 1000 carries 1e-13 itself.
        let carried = f64::EPSILON * x0.abs().max(x1.abs());
        let error = (got - want).abs();
        assert!(error <= 1e-12 * (x1 - x0).abs() + carried, "{row:?}: {got}");
        worst = worst.max(((error - carried) / (x1 - x0).abs()).max(0.0));
    }
    assert!(worst <= 1e-15, "{worst}");
}
