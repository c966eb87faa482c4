//! What candump wrote down of a move makes the same move again.

use super::robot::Robot;
use canter::log::candump;
use canter_shared::time::BusTime;
use canter_shared::wire::frame::Frame;
use canter_tests::candump::Candump;
use std::time::Duration;

#[test]
fn a_replayed_log_makes_the_same_setpoints_again() {
    let robot = Robot::start("vcan10");
    let mut dump = Candump::start(robot.bus);
    robot.run("move 1=1.5 2=-0.7 --enable").success();
    let first = robot.finish();
    let mut log = Vec::new();
    while let Some(logged) = dump.next(Duration::ZERO) {
        let frame = Frame::new(logged.id as u16, &logged.data).expect("one of canter's");
        candump::write_on(&mut log, &logged.interface, BusTime(logged.time_us), &frame)
            .expect("a vector takes everything");
    }
    let directory = tempfile::tempdir().expect("a directory");
    let file = directory.path().join("bus.log");
    std::fs::write(&file, log).expect("room");

    // Another node, which knows nothing of it.
    let robot = Robot::start("vcan10");
    let replayed = robot.run(&format!("log replay {} --json", file.display()));
    let replayed = replayed.success().json();
    let second = robot.finish();
    for (axis, target) in [(1, 1.5), (2, -0.7)] {
        let ([before], [after]) = (&first.stretches(axis)[..], &second.stretches(axis)[..]) else {
            panic!("axis {axis} did not move once in each");
        };
        // The log's SYNCs give its bus time again, and the trigger names the tick.
        assert_eq!(before.rows, after.rows, "axis {axis}");
        let heard = &replayed["axes"][usize::from(axis) - 1]["position"];
        let off = heard.as_f64().expect("a number") - target;
        assert!(off.abs() < 1e-3, "{replayed}");
    }
    assert!(second.stretches(3).is_empty());
}
