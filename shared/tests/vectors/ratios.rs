//! How much longer a beta move takes than the time-optimal ones within the same limits.

use super::csv::rows;
use canter_shared::motion::beta::exact::Profile;
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::trajectory::{Sample, Trajectory};
use canter_shared::motion::trapezoid::exact::plan;

/// With range and acceleration one, and the velocity limit the column's.
#[test]
fn beta_and_trapezoid() {
    for row in rows("time_optimal_ratio.csv") {
        let limits =
            Bounds::new(row.number("s=v/sqrt(a*R)"), 1.0, 1.0, f64::INFINITY).expect("valid");
        let beta = Profile::within(0.0, 1.0, &limits).expect("valid");
        let trapezoid = plan(Sample::at_rest(0.0), Sample::at_rest(1.0), &limits).expect("valid");
        for (got, column) in [
            (beta.duration(), "T_beta"),
            (trapezoid.duration(), "T_trap"),
            (beta.duration() / trapezoid.duration(), "ratio_trap"),
            (beta.peaks().jerk, "beta_peak_jerk"),
        ] {
            let want = row.number(column);
            assert!(
                (got - want).abs() <= 1e-12 * want,
                "{row:?} {column}: {got}"
            );
        }
    }
}
