//! `canter log` on what the demonstration wrote down: its meaning, how full the bus was, and all of it again.

use std::path::{Path, PathBuf};
use std::process::Command;

use canter_tests::process::{Finished, Process};

fn canter(arguments: &[&str]) -> Finished {
    let mut command = Command::new(canter_tests::canter());
    command.env_remove("CANTER_CAN");
    Process::spawn(command.args(arguments)).finish()
}

/// The log of a demonstration, in a directory of the test's own.
fn demonstration(directory: &Path) -> PathBuf {
    let out = directory.join("demo");
    canter(&["demo", "--out", &out.display().to_string()]).success();
    out.join("bus.log")
}

fn written(directory: &Path, text: &str) -> String {
    let file = directory.join("some.log");
    std::fs::write(&file, text).expect("room");
    file.display().to_string()
}

#[test]
fn a_demonstration_is_decoded_counted_and_played_again() {
    let directory = tempfile::tempdir().expect("a directory");
    let file = demonstration(directory.path());
    let log = std::fs::read_to_string(&file).expect("a log");
    let file = file.display().to_string();

    let decoded = canter(&["log", "decode", &file]).success().stdout;
    assert_eq!(decoded.lines().count(), log.lines().count());
    for (line, told) in log.lines().zip(decoded.lines()) {
        let (stamp, _) = line.rsplit_once(' ').expect("three words");
        assert!(told.starts_with(stamp), "{told} is not of {line}");
        assert!(!told.contains("no frame of canter's"), "{told}");
    }
    for words in [
        "StageBeta_1 target=-1.3",
        "Knot_12 position=",
        "Control_3 action=enable",
    ] {
        assert!(decoded.contains(words), "nothing says {words}");
    }
    let documents = canter(&["--json", "log", "decode", &file]).success().stdout;
    let documents: Vec<serde_json::Value> = documents
        .lines()
        .map(|line| serde_json::from_str(line).expect("a document in each line"))
        .collect();
    assert_eq!(documents.len(), log.lines().count());

    let told = canter(&["--json", "log", "stats", &file]).success().json();
    let bus = &told["interfaces"][0];
    assert_eq!(bus["frames"], log.lines().count());
    let messages = bus["messages"].as_array().expect("a list");
    let sum = |field: &str| -> f64 {
        let values = messages.iter().map(|message| message[field].as_f64());
        values.map(|value| value.expect("a number")).sum()
    };
    let number = |field: &str| bus[field].as_f64().expect("a number");
    assert_eq!(sum("frames"), number("frames"));
    assert!((sum("load") - number("load")).abs() < 1e-9);
    assert!(
        0.1 < number("load") && number("load") < number("peak_load") && number("peak_load") < 0.6
    );
    // Half as quick a bus is twice as full.
    let slow = canter(&["--json", "log", "stats", &file, "--bitrate", "500000"]);
    let slow = slow.success().json()["interfaces"][0]["load"].as_f64();
    assert!((slow.expect("a number") - 2.0 * number("load")).abs() < 1e-9);

    // A fresh robot, led by the log alone, ends where the other did.
    let replayed = canter(&["--json", "log", "replay", &file]).success().json();
    let axes = replayed["axes"].as_array().expect("a list");
    assert_eq!(axes.len(), 12);
    for axis in axes {
        let last = documents
            .iter()
            .rev()
            .find(|document| document["message"] == "Feedback" && document["axis"] == axis["axis"]);
        let last = last.expect("it was heard")["fields"]["position"].as_f64();
        let off = axis["position"].as_f64().expect("a number") - last.expect("a number");
        assert!(off.abs() < 1e-5, "{axis} is off by {off}");
    }
}

#[test]
fn a_log_that_cannot_be_used_is_a_clear_error_and_sends_nothing() {
    let directory = tempfile::tempdir().expect("a directory");
    let fails = |arguments: &[&str], words: &str| {
        let finished = canter(arguments);
        assert_eq!(finished.status.code(), Some(1), "{finished:#?}");
        assert!(finished.stderr.contains(words), "{words}: {finished:#?}");
        finished
    };
    fails(&["log", "stats", "no/such.log"], "no/such.log");
    let sync = "(1.000000) can0 040#0000000000000000";
    let bad = written(directory.path(), &format!("{sync}\nnonsense\n{sync}\n"));
    // What can be read is told all the same.
    let told = fails(&["log", "decode", &bad], "line 2: ");
    assert_eq!(told.stdout.matches("Sync_all").count(), 2);
    let told = fails(&["log", "replay", &bad], "nothing was sent");
    assert!(!told.stderr.contains("bus: sim"), "{told:#?}");
    let two = written(
        directory.path(),
        &format!("{sync}\n{}\n", sync.replace("can0", "can1")),
    );
    fails(&["log", "replay", &two], "choose one with --interface");
    canter(&["log", "replay", &two, "--interface", "can1"]).success();
    // Only a node's own words, and a frame of somebody else's.
    let heard = "(1.000000) can0 501#0000000000000004\n(1.000001) can0 1FFFFFFF#00\n";
    let heard = written(directory.path(), heard);
    fails(&["log", "replay", &heard], "nothing was sent");
    let told = canter(&["log", "decode", &heard]).success();
    assert!(told.stderr.contains("1 29-bit frames"), "{told:#?}");
}
