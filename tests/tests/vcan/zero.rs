//! Where an axis is becomes a position of one's choice: shown at once, kept where asked, moved from.

use super::robot::Robot;

#[test]
fn a_zero_is_where_the_axis_is_and_moves_begin_there() {
    let robot = Robot::start("vcan4");
    robot.enable();
    robot.run("move 1=1.5 2=-0.7").success();
    let refused = robot.run("zero 1");
    assert_eq!(refused.status.code(), Some(1), "{refused:#?}");
    assert!(refused.stderr.contains("disable"), "{refused:#?}");
    robot.run("disable all").success();

    let zeroed = robot.run("zero 1 --json").success().json();
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    let of = |document: &serde_json::Value, field: &str| number(&document["axes"][0][field]);
    // Feedback and offset are rounded on the wire.
    assert!(of(&zeroed, "position").abs() < 2e-6, "{zeroed}");
    assert!((of(&zeroed, "offset") + 1.5).abs() < 2e-6, "{zeroed}");
    let other = robot.run("zero 2 --at 30deg --json").success().json();
    let thirty = 30f64.to_radians();
    assert!((of(&other, "position") - thirty).abs() < 2e-6, "{other}");
    // Nothing moved, so a second time changes nothing.
    let again = robot.run("zero 2 --at 30deg --json").success().json();
    assert!((of(&again, "offset") - of(&again, "offset_before")).abs() < 2e-6);

    robot.enable();
    let moved = robot.run("move 1=0.25 --json").success().json();
    assert!((of(&moved, "position") - 0.25).abs() < 1e-3, "{moved}");
    // From zero to a quarter, and not from where it was before.
    let trace = robot.finish();
    let rows = trace.axis(1);
    let last = rows.last().expect("rows").position;
    assert!((last - 0.25).abs() < 2e-6, "{last}");
    let enabled = rows
        .iter()
        .rev()
        .take_while(|row| row.state == "operation enabled");
    let least = enabled.map(|row| row.position).fold(f64::MAX, f64::min);
    assert!(least > -1e-4, "{least}");
}
