//! Parameters and ids that a node process keeps in a file, which nobody asks it to end first.

use super::robot::axis;
use canter_shared::wire::report::Report;
use canter_tests::PATIENCE;
use canter_tests::process::{Finished, Process};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};

const BUS: &str = "vcan7";

/// Axes 1 to 3 with a store.
fn node(store: &Path) -> Process {
    let mut node = Command::new(canter_tests::canter());
    node.args(["--can", BUS, "node", "--axes", "1-3", "--store"]);
    let mut node = Process::spawn(node.arg(store));
    node.wait_for("start", |line| line.text.starts_with("running 3 axes"));
    node
}

fn command(arguments: &str) -> Command {
    let mut command = Command::new(canter_tests::canter());
    command.args(["--can", BUS]);
    command.args(arguments.split_whitespace());
    command
}

fn canter(arguments: &str) -> Finished {
    Process::spawn(&mut command(arguments)).finish()
}

/// The value and the saved value of a parameter of an axis.
#[track_caller]
fn values(id: u8, name: &str) -> (Value, Value) {
    let json = canter(&format!("param get {name} --axis {id} --json"));
    let json = json.success().json();
    (json["value"].clone(), json["saved"].clone())
}

/// What the three axes have, which all tell the same number.
fn file_of(number: u32) -> String {
    let axis = |id| {
        format!(
            "[axis.{id}]\nlimits.velocity = {number}\nlimits.jerk = {}\nfollowing.error = 0.{number}\n",
            number * 100
        )
    };
    [1, 2, 3].map(axis).concat()
}

/// The number that the axes tell.
///
/// # Panics
/// Where they tell different ones: then old and new are mixed.
#[track_caller]
fn number() -> u32 {
    let text = canter("param export --axis 1-3").success().stdout;
    let told = |name: &str| -> Vec<String> {
        let lines = text.lines().filter(|line| line.starts_with(name));
        let value = |line: &str| {
            line.split(['=', '#'])
                .nth(1)
                .map(|text| text.trim().to_owned())
        };
        lines.filter_map(value).collect()
    };
    let velocities = told("limits.velocity");
    let number: u32 = velocities[0].parse().expect("a whole number");
    assert_eq!(velocities, [&*velocities[0]; 3], "{text}");
    assert_eq!(
        told("limits.jerk"),
        [&*(number * 100).to_string(); 3],
        "{text}"
    );
    assert_eq!(
        told("following.error"),
        [&*format!("0.{number}"); 3],
        "{text}"
    );
    number
}

/// Killed after the file has changed so often, or once the save has ended.
fn kill_while_saving(node: Process, store: &Path, changes: usize) {
    let mut saving = command("param save --axis 1-3");
    let saving = saving.stdout(Stdio::null()).stderr(Stdio::null());
    let mut saving = saving.spawn().expect("it starts");
    let mut last = std::fs::read(store).expect("the store");
    let mut seen = 0;
    let given_up = std::time::Instant::now() + PATIENCE;
    while seen < changes && saving.try_wait().expect("a child").is_none() {
        assert!(std::time::Instant::now() < given_up, "the save never ended");
        let now = std::fs::read(store).expect("the store");
        if now != last {
            (seen, last) = (seen + 1, now);
        }
    }
    node.signal("KILL");
    drop(node);
    // It may have been answered or not; without a node it gives up.
    saving.wait().expect("a child");
}

#[test]
fn a_node_that_is_killed_while_it_saves_has_the_old_or_the_new() {
    let directory = tempfile::tempdir().expect("a directory");
    let (store, file) = (
        directory.path().join("store"),
        directory.path().join("p.toml"),
    );
    let import = |number: u32, save: &str| {
        std::fs::write(&file, file_of(number)).expect("it is written");
        canter(&format!("param import {} {save}", file.display())).success();
    };
    let mut running = node(&store);
    import(11, "--save");
    let mut old = 11;
    let mut kept = [0, 0];
    for round in 0..8 {
        let new = 12 + round;
        import(new, "");
        kill_while_saving(running, &store, round as usize % 5);
        running = node(&store);
        let now = number();
        assert!(now == old || now == new, "{now} is neither {old} nor {new}");
        kept[usize::from(now == new)] += 1;
        old = now;
    }
    canter_tests::measurement(
        "vcan",
        "node killed while it saves",
        &format!("{} times the old, {} times the new", kept[0], kept[1]),
        "never a mix",
    );
}

#[test]
fn an_id_and_what_was_saved_outlive_the_process() {
    let directory = tempfile::tempdir().expect("a directory");
    let store = directory.path().join("store");
    let running = node(&store);
    let scan = canter("scan --json").success().json();
    let chip = scan["nodes"][0]["chip"]
        .as_str()
        .expect("a chip")
        .to_owned();
    let several = canter(&format!("scan --assign {chip}=33"));
    assert_eq!(several.status.code(), Some(1));
    assert!(several.stderr.contains("axes 1, 2, 3"), "{several:#?}");
    canter("param set limits.velocity 7 --axis 3 --save").success();
    // Not saved, and so gone afterwards.
    canter("param set limits.velocity 8 --axis 2").success();
    canter(&format!("scan --assign {chip}/3=33 --save")).success();
    canter("param set limits.velocity 9 --axis 2").success();
    assert_eq!(values(2, "limits.velocity"), (9.into(), 8.into()));
    running.signal("KILL");
    drop(running);

    let mut again = Command::new(canter_tests::canter());
    again.args(["--can", BUS, "node", "--axes", "1-3", "--store"]);
    let mut running = Process::spawn(again.arg(&store));
    running.wait_for("the kept ids", |line| line.text.starts_with("axes 1,2,33"));
    running.wait_for("start", |line| line.text.starts_with("running 3 axes"));
    assert_eq!(values(33, "limits.velocity"), (7.into(), 7.into()));
    assert_eq!(values(2, "limits.velocity"), (8.into(), 8.into()));
    // What the node keeps to is what a move is planned with: 7 rad/s.
    canter("enable 33").success();
    let moved = canter("move 33=7 --json").success().json();
    let duration = moved["axes"][0]["duration"].as_f64().expect("a number");
    assert!(duration > 1.0, "{moved}");

    let second = Process::spawn(
        Command::new(canter_tests::canter())
            .args(["--can", BUS, "node", "--axes", "4-6", "--store"])
            .arg(&store),
    );
    let second = second.finish();
    assert_eq!(second.status.code(), Some(1));
    assert!(
        second.stderr.contains("used by another node"),
        "{second:#?}"
    );
    running.signal("INT");
    running.finish().success();
    let other = Process::spawn(
        Command::new(canter_tests::canter())
            .args(["--can", BUS, "node", "--axes", "1-2", "--store"])
            .arg(&store),
    );
    let other = other.finish();
    assert!(other.stderr.contains("keeps 3 axes"), "{other:#?}");
}

#[test]
fn a_store_that_has_gone_bad_is_a_fault() {
    let directory = tempfile::tempdir().expect("a directory");
    let store = directory.path().join("store");
    let running = node(&store);
    canter("param set limits.velocity 7 --axis 1 --save").success();
    running.signal("INT");
    running.finish().success();
    let mut bytes = std::fs::read(&store).expect("the store");
    bytes[100] ^= 4;
    std::fs::write(&store, bytes).expect("it is written");

    let running = node(&store);
    super::robot::wait_for(BUS, "the fault", axis(1), |report| match report {
        Report::Heartbeat { fault, .. } => *fault != 0,
        _ => false,
    });
    let status = canter("status --json").success().json();
    for axis in status["axes"].as_array().expect("a list") {
        assert_eq!(axis["fault"], "parameters_lost", "{axis}");
    }
    assert_eq!(values(1, "limits.velocity"), (20.into(), 20.into()));
    // The cure that the table of faults names.
    canter("param set limits.velocity 6 --axis 1 --save").success();
    canter("clear all").success();
    canter("enable all").success();
    running.signal("KILL");
    drop(running);
    let _running = node(&store);
    assert_eq!(values(1, "limits.velocity"), (6.into(), 6.into()));
    let status = canter("status --json").success().json();
    assert_eq!(status["axes"][0]["fault"], Value::Null);
}
