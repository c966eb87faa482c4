//! A path from the command line, over real CAN, to a node: as it was planned, and inside the limits.

use super::robot::Robot;
use canter_shared::limits::Limits;
use canter_tests::measurement;
use std::io::Write;

/// Three axes around a corner, at a speed that is asked for, to rest.
const PATH: &str = "axes = [1, 2, 3]\n[[waypoint]]\nat = [0.5, 0.0, 0.0]\n[[waypoint]]\n\
                    at = [\"90deg\", 1.0, 0.2]\nspeed = 2.0\n[[waypoint]]\nat = [0.2, -0.3, 0.0]\n";

/// An acceleration in rad/s^2 may step by twice the limit from tick to tick: two passes know no jerk.
const ANY_JERK: f64 = 2.0 * 200.0 / 1e-3;

#[test]
fn a_path_is_followed_by_all_axes_together_and_loses_no_knot() {
    let mut file = tempfile::NamedTempFile::with_suffix(".toml").expect("a place for files");
    file.write_all(PATH.as_bytes()).expect("written");
    let name = file.path().display();
    let robot = Robot::start("vcan3");
    robot.enable();
    let done = robot
        .run(&format!("path {name} --run --json"))
        .success()
        .json();
    let trace = robot.finish();
    trace.keeps(&Limits::default(), ANY_JERK);

    let axes = done["axes"].as_array().expect("a list of axes");
    let mut begun = Vec::new();
    for (id, target) in [(1u8, 0.2), (2, -0.3), (3, 0.0)] {
        let axis = &axes[usize::from(id) - 1];
        assert!(axis["skew_us"].as_u64().expect("a skew") <= 50, "{done}");
        let stretches = trace.stretches(id);
        let along = stretches.last().expect("it moved");
        let end = along.ends().1;
        assert!((end - target).abs() <= 1e-6, "axis {id} ends at {end}");
        begun.push(along.rows[0].tick);
    }
    // Knots are at whole periods, and all axes leave their first waypoint in one tick.
    let spread = begun.iter().max().zip(begun.iter().min());
    let (last, first) = spread.expect("three axes");
    assert!(last - first <= 1, "{begun:?}");
    let missing: u64 = axes
        .iter()
        .filter_map(|axis| axis["missing_knots"].as_u64())
        .sum();
    assert_eq!(missing, 0, "{done}");
    measurement(
        "vcan",
        "path --run, 3 axes: knots missing",
        &missing.to_string(),
        "0",
    );
}
