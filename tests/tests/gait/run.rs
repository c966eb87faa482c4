//! `canter gait run` on the simulated robot.

use super::{canter_gait, refuses};
use canter_tests::process::{Finished, Process};
use serde_json::Value;
use std::process::Command;

/// Runs `canter gait run` with these arguments and these orders on its standard input.
#[track_caller]
fn led(arguments: &str, orders: &str) -> Finished {
    let mut command = Command::new(canter_tests::canter());
    command.args(["gait", "run"]);
    command.args(arguments.split_whitespace());
    let mut process = Process::spawn(command.args(["--orders", "-"]));
    process.write(orders);
    process.finish()
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// Which orders were taken.
fn orders(walked: &Value) -> Vec<&str> {
    let orders = walked["orders"].as_array().expect("a list").iter();
    orders.filter_map(|order| order["order"].as_str()).collect()
}

#[test]
fn a_trot_stands_up_walks_its_cycles_and_sits() {
    let finished = canter_gait("run trot --vx 0.5 --cycles 5").success();
    let words = &finished.stderr;
    let phases = ["stands up", "walks", "settles", "sits down", "sits\n"];
    let mut from = 0;
    for phase in phases {
        let at = words[from..].find(&format!(" s: {phase}"));
        from += at.unwrap_or_else(|| panic!("no `{phase}` in its place: {words}"));
    }
    for item in ["robot", "axes", "faults", "limits", "pose", "motion", "bus"] {
        assert!(words.contains(&format!("{item}: ")), "{item}: {words}");
    }
    assert!(finished.stdout.starts_with("gait done: trot in "));
    assert!(finished.stdout.contains("27 % of 1000000 bit/s"));
}

#[test]
fn json_says_how_it_went_for_each_axis_and_what_the_bus_carried() {
    let finished = canter_gait("run pace --vx 0.3 --duration 2 --json").success();
    let walked = finished.json();
    assert_eq!(walked["gait"], "pace");
    let axes = walked["axes"].as_array().expect("axes");
    let ids = axes.iter().map(|axis| axis["axis"].as_u64());
    assert!(ids.eq((1..=12).map(Some)));
    for axis in axes {
        assert_eq!(axis["missing_knots"], 0);
        assert!(number(&axis["skew_us"]) < 100.0, "{axis}");
        assert_eq!(
            axis["start_us"].as_u64().map(|start| start % 1000 < 100),
            Some(true)
        );
        assert!(axis["position"].is_f64());
    }
    // Up in a second, two of walking, and down.
    let duration = number(&walked["duration"]);
    assert!(duration > 4.0 && duration < 7.0, "{duration}");
    assert!(number(&walked["deviation"]) < 50e-6);
    let budget = &walked["budget"];
    let shares = budget["shares"].as_array().expect("shares").iter();
    let sum: f64 = shares.map(|share| number(&share["rate"])).sum();
    assert!((sum - number(&budget["rate"])).abs() < 1e-6);
    assert!((number(&budget["load"]) - sum / 1e6).abs() < 1e-9);
    assert_eq!(walked["preflight"].as_array().map(Vec::len), Some(7));
}

#[test]
fn lines_lead_it_and_bad_ones_change_nothing() {
    let good = "vx 0.3 # faster\nwait 1\ngait pace\nwait 3\nvy -0.05 yaw 20deg\nwait 1\nstop\n";
    let bad = "vx 9\nhop\nvx\nwait\n\ngait canter\nvx 0.3\nheight 0.39\n";
    let led_well = led("trot --vx 0.1 --json", good).success().json();
    assert_eq!(orders(&led_well), ["body", "gait", "body", "stop"]);
    assert_eq!(led_well["refused"], 0);
    assert_eq!(led_well["orders"][0]["body"]["vx"], 0.3);
    let finished = led("trot --vx 0.1 --json", &format!("{bad}{good}")).success();
    let led_badly = finished.json();
    // `vx 0.3` comes twice.
    assert_eq!(orders(&led_badly), ["body", "body", "gait", "body", "stop"]);
    assert_eq!(led_badly["refused"], 2);
    for words in [
        "line 2: `hop` is no order: write `vx 0.3`",
        "line 3: `vx` stands there without its value",
        "line 6: `canter` is no gait: choose one of stand, walk",
        "order refused: axis",
    ] {
        assert!(finished.stderr.contains(words), "{words}: {finished:#?}");
    }
    let file = tempfile::NamedTempFile::new().expect("a file");
    std::fs::write(file.path(), good).expect("room");
    let arguments = format!(
        "run trot --vx 0.1 --json --orders {}",
        file.path().display()
    );
    assert_eq!(canter_gait(&arguments).success().json(), led_well);
}

#[test]
fn orders_that_end_leave_it_four_cycles_and_a_stop_does_not() {
    let ended = led("trot --json", "vx 0.1\n").success().json();
    let stopped = led("trot --json", "vx 0.1\nstop\n").success().json();
    let [ended, stopped] = [ended, stopped].map(|walked| number(&walked["duration"]));
    let unled = canter_gait("run trot --vx 0.1 --json").success().json();
    assert_eq!(ended, number(&unled["duration"]));
    assert!(stopped < ended - 1.0, "{stopped} {ended}");
}

#[test]
fn what_cannot_be_walked_moves_nothing_and_says_what_to_do() {
    for (arguments, status, words) in [
        ("run trot --vx 3", 1, "ask for less speed"),
        ("run trot --sit 0.5", 1, "bring it nearer"),
        (
            "run trot --bitrate 250000",
            1,
            "107 % of a bus of 250000 bit/s, and 80 % are the most",
        ),
        ("run trot --bitrate 123", 2, "a usual bit rate"),
        ("run trot --vx nan", 2, "vx"),
        ("run trot --sit nan", 2, "the height"),
        ("run trot --cycles 0", 2, "--cycles"),
        ("run trot --cycles 2 --duration 3", 2, "--duration"),
        ("run stand --cycles 2", 2, "stand goes nowhere"),
        ("run stand --vx 0.1", 2, "stand goes nowhere"),
        ("run custom", 2, "--offsets"),
        (
            "run trot --orders nowhere.txt",
            1,
            "cannot read the orders nowhere.txt",
        ),
    ] {
        let refused = refuses(arguments, status, words);
        assert!(!refused.stderr.contains("stands up"), "{arguments}");
    }
}

#[test]
fn a_robot_without_four_legs_or_with_slow_axes_does_not_walk() {
    let file = tempfile::NamedTempFile::new().expect("a file");
    for (text, words) in [
        ("[[axis]]\nid = 1\n", "name four [[leg]]"),
        (&*slow_robot(), "an acceleration of"),
    ] {
        std::fs::write(file.path(), text).expect("room");
        let robot = format!("run trot --vx 0.5 --robot {}", file.path().display());
        let finished = canter_gait(&robot);
        assert_eq!(finished.status.code(), Some(1), "{finished:#?}");
        assert!(finished.stderr.contains(words), "{finished:#?}");
    }
}

/// The robot that is assumed, with axes of 50 rad/s^2.
fn slow_robot() -> String {
    use canter::robot::Robot;
    let mut text = String::new();
    for id in 1..=12 {
        text += &format!(
            "[[axis]]\nid = {id}\n[axis.limits]\nacceleration = 50.0\ndeceleration = 50.0\n"
        );
    }
    for leg in Robot::default().legs() {
        let axes = leg.axes.map(|axis| axis.get());
        let hip = 0.06 * leg.place[1].signum();
        text += &format!(
            "[[leg]]\nname = \"{}\"\nkind = \"serial\"\nhip = {hip}\nupper = 0.2\nlower = 0.2\n\
             axes = {axes:?}\nsigns = {:?}\noffsets = {:?}\nplace = {:?}\n",
            leg.name, leg.signs, leg.offsets, leg.place
        );
    }
    text
}
