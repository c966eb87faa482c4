//! How much longer a beta move takes than the time-optimal ones within the same limits.

use super::csv::rows;
use canter_shared::motion::beta::exact::Profile;
use canter_shared::motion::beta::{PEAK_ACCELERATION, PEAK_JERK};
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::s_curve;
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

/// Against seven segments with the same limits, and as jerk limit either the peak of the beta move
/// itself or that of a beta move which only the acceleration holds back.
#[test]
fn beta_and_s_curve() {
    // j = 128 / pi R / T^3 where T^2 = 12 sqrt(3) / pi R / a.
    let held_back = PEAK_JERK / PEAK_ACCELERATION.powf(1.5);
    for row in rows("time_optimal_ratio.csv") {
        let velocity = row.number("s=v/sqrt(a*R)");
        let limits = |jerk| Bounds::new(velocity, 1.0, 1.0, jerk).expect("valid");
        let beta = Profile::within(0.0, 1.0, &limits(f64::INFINITY)).expect("valid");
        for (jerk, column, ratio) in [
            (
                beta.peaks().jerk,
                "T_7seg_same_v_a_and_beta_jerk",
                "ratio_7seg",
            ),
            (held_back, "T_7seg_j=2.394a^1.5", "ratio"),
        ] {
            let (from, to) = (Sample::at_rest(0.0), Sample::at_rest(1.0));
            let s_curve = s_curve::plan(from, to, &limits(jerk)).expect("valid");
            for (got, column) in [
                (s_curve.duration(), column),
                (beta.duration() / s_curve.duration(), ratio),
            ] {
                let want = row.number(column);
                assert!(
                    (got - want).abs() <= 1e-12 * want,
                    "{row:?} {column}: {got}"
                );
            }
        }
    }
}
