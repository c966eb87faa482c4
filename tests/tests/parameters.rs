//! `canter param` and `canter scan --assign` on the simulated robot, which is fresh at each command.

use std::process::Command;

use canter_tests::process::{Finished, Process};

fn canter(arguments: &str) -> Finished {
    let mut command = Command::new(canter_tests::canter());
    command.env_remove("CANTER_CAN");
    Process::spawn(command.args(arguments.split_whitespace())).finish()
}

/// What it ends with where it is refused: a usage error is 2, a refusal 1.
#[track_caller]
fn refused(arguments: &str, code: i32, words: &str) {
    let finished = canter(arguments);
    assert_eq!(finished.status.code(), Some(code), "{finished:#?}");
    assert!(finished.stderr.contains(words), "{finished:#?}");
}

#[test]
fn get_prints_what_the_design_promises() {
    for (name, value, unit, default) in [
        ("limits.velocity", 20.0, "rad/s", 20.0),
        ("limits.acceleration", 200.0, "rad/s^2", 200.0),
        ("limits.deceleration", 200.0, "rad/s^2", 200.0),
        ("limits.jerk", 20_000.0, "rad/s^3", 20_000.0),
        ("host.timeout", 0.25, "s", 0.25),
        ("drive.node", 3.0, "", 3.0),
    ] {
        let json = canter(&format!("param get {name} --axis 3 --json"));
        let json = json.success().json();
        assert_eq!(json["name"], name);
        assert_eq!(json["value"].as_f64(), Some(value), "{json}");
        assert_eq!(json["unit"], unit);
        assert_eq!(json["default"].as_f64(), Some(default), "{json}");
        assert!(json["min"].as_f64() <= Some(value), "{json}");
        assert!(json["max"].as_f64() >= Some(value), "{json}");
    }
    let words = canter("param get limits.velocity --axis 3").success();
    assert_eq!(words.stdout, "20 rad/s\n");
    let choice = canter("param get host.reaction --axis 1 --json").success();
    assert_eq!(choice.json()["value"], "controlled_stop");
}

#[test]
fn list_has_every_parameter_once() {
    let json = canter("param list --axis 7 --json").success().json();
    assert_eq!(json["axis"], 7);
    let list = json["parameters"].as_array().expect("a list");
    let names: Vec<_> = list.iter().map(|entry| &entry["name"]).collect();
    let table = canter_shared::parameter::Parameter::ALL;
    assert_eq!(names, table.map(|parameter| parameter.entry().name));
}

#[test]
fn angles_and_times_are_taken_in_every_unit() {
    let json = canter("param set limits.position_min -100deg --axis 1-2 --json");
    let json = json.success().json();
    assert_eq!(json["changes"][1]["axis"], 2);
    assert_eq!(json["changes"][1]["value"], -1.745329252);
    let json = canter("param set host.timeout 300ms --axis all --json").success();
    assert_eq!(json.json()["changes"][11]["value"], 0.3);
    let json = canter("param set bus.reaction quick_stop --axis 1 --save --json").success();
    assert_eq!(json.json()["saved"], true);
}

#[test]
fn what_is_wrong_is_named_with_its_range_and_the_cure() {
    refused("param get limits.speed --axis 1", 2, "is no parameter");
    refused(
        "param get velocity --axis 1",
        2,
        "did you mean `limits.velocity`?",
    );
    refused("param get limits.jerk --axis 64", 2, "from 1 to 63");
    refused(
        "param set limits.velocity 1e5 --axis 1",
        2,
        "limits.velocity must be from 0.0001 to 10000 rad/s, but it is 100000",
    );
    refused(
        "param set limits.jerk high --axis 1",
        2,
        "`high` is no value",
    );
    refused(
        "param set host.reaction brake --axis 1",
        2,
        "write controlled_stop, quick_stop, disable",
    );
    refused(
        "param set limits.jerk 1 --axis 13",
        1,
        "axis 13 does not answer",
    );
    refused(
        "--robot tests/robots/none.toml param list --axis 1",
        1,
        "cannot read the robot file",
    );
}

#[test]
fn what_contradicts_another_parameter_changes_nothing() {
    let directory = tempfile::tempdir().expect("a directory");
    let robot = directory.path().join("robot.toml");
    let text = "[[axis]]\nid = 1\n[axis.limits]\nposition_max = 1.0\n";
    std::fs::write(&robot, text).expect("it is written");
    let robot = robot.display();
    refused(
        &format!("--robot {robot} param set limits.position_min 2 --axis 1"),
        1,
        "axis 1: limits.position_min does not fit limits.position_max",
    );
}

/// The robot file's numbers are the node's, to the digit.
#[test]
fn a_robot_files_limits_are_the_parameters_of_its_nodes() {
    let directory = tempfile::tempdir().expect("a directory");
    let robot = directory.path().join("robot.toml");
    let text = "[[axis]]\nid = 5\n[axis.limits]\nvelocity = 5.1\nposition_max = 3.25\n\
                [axis.shaper]\nkind = \"zvd\"\nfrequency = 12.5\ndamping = 0.02\n";
    std::fs::write(&robot, text).expect("it is written");
    for (name, value) in [
        ("limits.velocity", "5.1 rad/s\n"),
        ("limits.position_max", "3.25 rad\n"),
        ("shaper.kind", "zvd\n"),
        ("shaper.frequency", "12.5 Hz\n"),
        ("shaper.damping", "0.02\n"),
    ] {
        let arguments = format!("--robot {} param get {name} --axis 5", robot.display());
        assert_eq!(canter(&arguments).success().stdout, value, "{name}");
    }
}

#[test]
fn what_is_exported_is_imported() {
    let directory = tempfile::tempdir().expect("a directory");
    let file = directory.path().join("parameters.toml");
    let name = file.display();
    canter(&format!("param export --axis 1-3 {name}")).success();
    let text = std::fs::read_to_string(&file).expect("it was written");
    assert_eq!(text, canter("param export --axis 1-3").success().stdout);
    let changed = text.replace("limits.velocity = 20 ", "limits.velocity = 12.5 ");
    assert_ne!(changed, text);
    std::fs::write(&file, changed).expect("it is written");
    let json = canter(&format!("param import {name} --save --json"));
    let json = json.success().json();
    let changes = json["changes"].as_array().expect("a list");
    assert_eq!(
        changes.len(),
        3 * canter_shared::parameter::Parameter::COUNT
    );
    assert_eq!(changes[0]["value"], 12.5);
}

#[test]
fn a_bad_file_is_refused_before_anything_is_sent() {
    let directory = tempfile::tempdir().expect("a directory");
    let file = directory.path().join("parameters.toml");
    for (text, words) in [
        (
            "[axis.1]\nlimits.velocity = 1e9\n",
            "limits.velocity must be",
        ),
        (
            "[axis.1]\nlimits.velocity = 5\nlimits.speed = 5\n",
            "limits.speed",
        ),
        ("[axis.70]\n", "axis.70"),
        (
            "[axis.1]\nlimits.position_max = -1\nlimits.position_min = 1\n",
            "does not fit",
        ),
    ] {
        std::fs::write(&file, text).expect("it is written");
        refused(&format!("param import {}", file.display()), 1, words);
    }
}

#[test]
fn an_id_is_given_by_chip() {
    let scanned = canter("scan --json").success().json();
    let chip = scanned["nodes"][2]["chip"]
        .as_str()
        .expect("a chip")
        .to_owned();
    let given = canter(&format!("scan --assign {chip}=40 --save --json"));
    let given = given.success().json();
    let nodes = given["nodes"].as_array().expect("a list");
    let axes: Vec<_> = nodes
        .iter()
        .filter_map(|node| node["axis"].as_u64())
        .collect();
    assert_eq!(axes, [1, 2, 4, 5, 6, 7, 8, 9, 10, 11, 12, 40]);
    assert_eq!(nodes[11]["chip"].as_str(), Some(&*chip));

    refused(
        &format!("scan --assign {chip}=4"),
        1,
        "axis 4 is there already",
    );
    refused(
        &format!("scan --assign {chip}/9=40"),
        1,
        "no axis of the old id",
    );
    let other = "0".repeat(24);
    refused(
        &format!("scan --assign {other}=40"),
        1,
        "no node with the chip",
    );
    refused("scan --assign 12=40", 2, "24 hexadecimal digits");
    refused(&format!("scan --assign {chip}=64"), 2, "is no axis");
    refused("scan --save", 2, "--assign");
}
