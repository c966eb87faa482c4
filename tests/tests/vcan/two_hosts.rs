//! Two `canter` commands on one bus at one time, each with axes of its own.

use super::robot::{Robot, axis};
use canter_shared::limits::Limits;
use canter_shared::wire::command::Command;
use canter_shared::wire::frame::Frame;
use canter_shared::wire::report::Report;
use canter_tests::candump::{Candump, Logged};
use canter_tests::process::Process;
use std::time::Duration;

/// The default limit of jerk in rad/s^3.
const JERK: f64 = 20_000.0;

/// The number and the time of a SYNC.
fn sync(logged: &Logged) -> Option<(u8, u64)> {
    let frame = Frame::new(logged.id as u16, &logged.data)?;
    match Command::decode(&frame) {
        Ok(Some((_, Command::Sync { counter, time }))) => Some((counter, time.0)),
        _ => None,
    }
}

#[test]
fn two_commands_move_their_axes_by_one_clock() {
    let robot = Robot::start("vcan6");
    robot.enable();
    let mut candump = Candump::start(robot.bus);
    let command = |words| Process::spawn(&mut robot.command(words));
    let first = command("move 1=1 --duration 2 --json");
    let moves = |report: &Report| matches!(report, Report::Feedback { moving: true, .. });
    robot.wait_for("motion", axis(1), moves);
    // It listens for half a second, moves with the first one, and is alone in the end.
    let second = command("move 2=-0.5turn 3=90deg --duration 3 --json");
    let finished = [first, second].map(|process| process.finish().success().json());
    let trace = robot.finish();
    trace.keeps(&Limits::default(), JERK);

    let mut spans = Vec::new();
    for moved in &finished {
        for arrival in moved["axes"].as_array().expect("a list of axes") {
            let number = |name: &str| arrival[name].as_f64().expect("a number");
            let id = number("axis") as u8;
            let [stretch] = trace.stretches(id)[..] else {
                panic!("axis {id} did not move once");
            };
            let duration = (number("duration") * 1e3).round() as u64;
            let fit = stretch.fit(duration);
            assert!(fit.error <= 2e-6, "axis {id}: {fit:?}");
            assert_eq!(stretch.ends().1, number("target"), "axis {id}");
            spans.push((fit.start, fit.start + duration));
        }
    }
    let [one, two, three] = spans[..] else {
        panic!("{spans:?}");
    };
    assert_eq!(two.0, three.0, "axes 2 and 3 left together");
    assert!(two.0 < one.1 && one.1 < two.1, "{one:?} and {two:?}");

    // One clock: the numbers go on over both commands, and so does the time.
    let mut syncs = Vec::new();
    while let Some(logged) = candump.next(Duration::ZERO) {
        syncs.extend(sync(&logged));
    }
    let late = syncs.iter().filter(|sync| sync.1 / 1_000 > one.1 + 1_000);
    assert!(late.count() > 10, "the second command took over");
    let broken = syncs
        .windows(2)
        .filter(|pair| pair[1].0 != pair[0].0.wrapping_add(1) || pair[1].1 <= pair[0].1);
    // A command that a busy machine held up for 0.3 s was thought to have gone.
    let broken = broken.count();
    assert!(broken <= syncs.len() / 50, "{broken} of {}", syncs.len());
}
