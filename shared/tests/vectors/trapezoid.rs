//! Trapezoids against gearpy, ODrive and Ruckig.

use super::csv::{Row, rows};
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::error::ProfileError;
use canter_shared::motion::trajectory::{Sample, Starting, Trajectory};
use canter_shared::motion::trapezoid::exact::{plan, time_optimal, to_rest};

fn bounds(velocity: f64, acceleration: f64, deceleration: f64) -> Bounds {
    Bounds::new(velocity, acceleration, deceleration, f64::INFINITY).expect("valid")
}

/// gearpy's positions, start and stop velocity and start time included; where that library is
/// wrong, an error.
#[test]
fn gearpy() {
    let points = rows("gearpy_points.csv");
    let mut seen = 0;
    for case in rows("gearpy_cases.csv") {
        let [x0, x1, v_max, up, down, v0, v1, t0] =
            case.numbers(["x0", "x1", "v_max", "a_acc", "a_dec", "v0", "v1", "t0"]);
        let planned = plan(
            Sample::coasting(x0, v0),
            Sample::coasting(x1, v1),
            &bounds(v_max, up, down),
        );
        if case.number("sound") == 0.0 {
            let error = planned.expect_err("not a sound case");
            let overruns = case.text("name").contains("overruns");
            match error {
                ProfileError::StartTooFast { velocity, fastest } if overruns => {
                    assert_eq!((velocity, fastest), (5.0, 2.0));
                }
                ProfileError::Value { value, .. } if !overruns => assert_eq!(value, -8.0),
                other => panic!("{case:?}: {other}"),
            }
            continue;
        }
        let trajectory = Starting {
            start: t0,
            trajectory: planned.unwrap_or_else(|error| panic!("{case:?}: {error}")),
        };
        let duration = case.number("duration");
        assert!((trajectory.duration() - duration).abs() <= 1e-12 * duration);
        let peak = trajectory.peaks().velocity;
        assert!(
            (peak - case.number("v_peak")).abs() <= 1e-9 * peak,
            "{case:?}"
        );
        for point in points
            .iter()
            .filter(|row| row.text("case") == case.text("case"))
        {
            let [t, want] = point.numbers(["t", "pos"]);
            let got = trajectory.at(t).position;
            assert!(
                (got - want).abs() <= 1e-9 * (x1 - x0).abs().max(1e-3 * x0.abs()),
                "{case:?} at {t}: {got}, not {want}"
            );
            seen += 1;
        }
    }
    assert!(seen > 400);
}

fn odrive(case: &Row) -> (Sample, f64, Result<Bounds, ProfileError>) {
    let [from, velocity, target, v_max, up, down] =
        case.numbers(["Xi", "Vi", "Xf", "Vmax", "Amax", "Dmax"]);
    (
        Sample::coasting(from, velocity),
        target,
        Bounds::new(v_max, up, down, f64::INFINITY),
    )
}

/// ODrive's planner, which computes in f32: the same moves from rest, and none longer from other
/// velocities unless it breaks the deceleration limit; no jump where it jumps.
#[test]
fn odrive_retargets() {
    let points = rows("odrive_trap_points.csv");
    for case in rows("odrive_trap_cases.csv") {
        let (from, target, limits) = odrive(&case);
        if case.text("kind") == "amax0" {
            assert!(matches!(limits, Err(ProfileError::Value { value, .. }) if value == 0.0));
            continue;
        }
        let limits = limits.expect("valid");
        let planned = to_rest(from, target, &limits).expect("valid");
        assert_eq!(planned.at(planned.duration()), Sample::at_rest(target));
        assert_eq!(planned.at(0.0).position, from.position);
        let theirs = case.number("Tf");
        let ours = planned.duration();
        let peaks = planned.peaks();
        let fastest = limits.velocity().max(from.velocity.abs());
        assert!(peaks.velocity <= fastest * (1.0 + 1e-12), "{case:?}");
        if case.text("kind") == "rest" {
            assert!((ours - theirs).abs() <= 1e-5 * theirs, "{case:?}: {ours}");
        }
        // Where the axis has to turn back it slows down first: ours at the deceleration limit,
        // theirs at the acceleration limit.
        let stops_at =
            from.position + from.velocity * from.velocity.abs() / (2.0 * limits.deceleration());
        let opposed = from.velocity * (target - stops_at) < 0.0;
        // Above the limit ours is the harder brake, which is sooner inside and later there.
        let above = from.velocity.abs() > limits.velocity();
        if case.number("sound") == 1.0
            && !above
            && (limits.deceleration() >= limits.acceleration() || !opposed)
        {
            assert!(ours <= theirs * (1.0 + 2e-5), "{case:?}: {ours}");
        }
        if case.text("kind") == "rest" {
            for point in points
                .iter()
                .filter(|row| row.text("case") == case.text("case"))
            {
                let [t, position, velocity] = point.numbers(["t", "pos", "vel"]);
                let at = planned.at(t);
                // An f32 carries 2^-24 of the position and of the time.
                let position_bound = 1e-6 * position.abs().max(target.abs()) + 1e-5 * fastest * t;
                assert!(
                    (at.position - position).abs() <= position_bound,
                    "{case:?} at {t}"
                );
                let velocity_bound = 1e-5 * fastest
                    + 2e-7 * ours * limits.acceleration().max(limits.deceleration())
                    + 1e-4 * peaks.velocity;
                assert!(
                    (at.velocity - velocity).abs() <= velocity_bound,
                    "{case:?} at {t}"
                );
            }
        }
    }
}

/// Ruckig without a jerk limit, with limits by sign and a stop velocity.
#[test]
fn ruckig_without_jerk_limit() {
    let points = rows("ruckig_points.csv");
    let mut seen = 0;
    for case in rows("ruckig_cases.csv") {
        if case.text("kind") != "trap_nojerk" {
            continue;
        }
        let [p0, v0, pf, vf, v_max, a_max] =
            case.numbers(["p0", "v0", "pf", "vf", "v_max", "a_max"]);
        let v_min = case.optional("v_min").unwrap_or(-v_max);
        let a_min = case.optional("a_min").unwrap_or(-a_max);
        let up = bounds(v_max, a_max, -a_min);
        let down = bounds(-v_min, -a_min, a_max);
        let from = Sample::coasting(p0, v0);
        let planned = time_optimal(from, Sample::coasting(pf, vf), &up, &down).expect("valid");
        let want = case.number("duration");
        let got = planned.duration();
        assert!((got - want).abs() <= 1e-9 * want, "{case:?}: {got}");
        for point in points
            .iter()
            .filter(|row| row.text("case") == case.text("case"))
        {
            let [t, position, velocity] = point.numbers(["t", "pos", "vel"]);
            let at = planned.at(t);
            assert!(
                (at.position - position).abs() <= 1e-7 * (pf - p0).abs(),
                "{case:?} at {t}"
            );
            assert!((at.velocity - velocity).abs() <= 1e-7 * planned.peaks().velocity);
        }
        seen += 1;
        // With limits that are the same both ways, the ways to stop agree.
        if v_min == -v_max && a_min == -a_max && vf == 0.0 {
            let rest = to_rest(from, pf, &up).expect("valid");
            assert!((rest.duration() - want).abs() <= 1e-9 * want, "{case:?}");
        }
    }
    assert!(seen > 30);
}
