//! Two nodes with one id on a real bus: neither moves, both can be found, and one that is left works.

use super::robot::Robot;
use canter_tests::process::Process;
use std::process::Command;

#[test]
fn two_nodes_of_one_id_are_found_and_latch_it() {
    let robot = Robot::start("vcan9");
    robot.enable();
    let mut double = Command::new(canter_tests::canter());
    let mut double = Process::spawn(double.args(["--can", "vcan9", "node", "--axes", "2"]));
    double.wait_for("start", |line| line.text.starts_with("running 1 ax"));

    let scan = robot.run("scan --json").json();
    let doubled = |wanted: u64| {
        let nodes = scan["nodes"].as_array().expect("a list");
        let node = nodes.iter().find(|node| node["axis"] == wanted);
        node.unwrap_or_else(|| panic!("axis {wanted} in {scan}"))["doubled"] == true
    };
    assert!(doubled(2) && !doubled(1) && !doubled(3), "{scan}");
    let status = robot.run("status --json").json();
    for axis in status["axes"].as_array().expect("a list") {
        let expected = if axis["axis"] == 2 {
            serde_json::json!("duplicate_axis")
        } else {
            serde_json::Value::Null
        };
        assert_eq!(axis["fault"], expected, "{axis}");
    }
    let refused = robot.run("move 2=1");
    assert_eq!(refused.status.code(), Some(1), "{refused:#?}");

    // Once it is gone the other one is itself again, but not by itself.
    double.signal("INT");
    double.finish().success();
    let status = robot.run("status").stdout;
    assert!(status.contains("duplicate_axis"), "{status}");
    robot.run("clear 2").success();
    robot.run("enable 2").success();
    robot.run("move 2=1").success();
    assert!(robot.finish().moved());
}
