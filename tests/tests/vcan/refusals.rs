//! What must be refused, with a clear word, and without anything moving.

use super::robot::Robot;
use canter_tests::process::Process;
use std::process::Command;

#[test]
fn bad_requests_are_clear_errors_and_move_nothing() {
    let robot = Robot::start("vcan7");
    let refused = robot.run("move 1=1");
    assert_eq!(refused.status.code(), Some(1));
    assert!(refused.stderr.contains("canter enable 1"), "{refused:#?}");

    robot.enable();
    for (arguments, code, words) in [
        ("move 1=nan", 2, "finite"),
        ("move 1=inf", 2, "finite"),
        ("move 1=90grad", 2, "no angle"),
        ("move 1", 2, "AXIS=POSITION"),
        ("move", 2, "AXIS=POSITION"),
        ("move 0=1", 2, "no axis"),
        ("move 64=1", 2, "no axis"),
        ("move 1=1 1=2", 1, "named twice"),
        ("move 1=1 --vmax nan", 2, "finite"),
        ("move 1=1 --vmax 0", 2, "more than 0"),
        ("move 1=1 --amax -5", 2, "more than 0"),
        ("move 1=1 --vmax 1e300", 1, "limits.velocity"),
        ("move 1=1 --amax 1e9", 1, "limits.acceleration"),
        ("move 1=1 --vmax 21", 1, "above the limit of axis 1"),
        ("move 1=1 --jmax 1e-9", 1, "limits.jerk"),
        ("move 1=1 --duration 0", 2, "more than 0"),
        ("move 1=1 --duration nan", 2, "finite"),
        ("move 1=1 --duration 0.01", 1, "too short"),
        ("move 1=1 --duration 1e9", 1, "longer than"),
        ("move 40=1", 1, "axis 40 does not answer"),
        ("move 1=1 40=1", 1, "axis 40 does not answer"),
        ("move 1=1001turn", 1, "outside its travel"),
        ("move 1=1 2=1e18", 1, "outside its travel"),
        ("move 1=1 --profile spline", 2, "trapezoid"),
        ("--robot /no/such/robot.toml move 1=1", 1, "robot.toml"),
        ("node --axes 4 --trace /no/such/trace.csv", 1, "trace.csv"),
        ("node --axes 4 --drive none", 2, "simulated"),
        ("enable 41", 1, "axis 41 does not answer"),
    ] {
        let finished = robot.run(arguments);
        assert_eq!(
            finished.status.code(),
            Some(code),
            "{arguments}: {finished:#?}"
        );
        assert!(
            finished.stderr.contains(words),
            "{arguments}: {finished:#?}"
        );
    }
    for (bus, words) in [
        ("vcan99", "no CAN interface"),
        ("slcan:/dev/no-such-tty", "no-such-tty"),
        ("slcan:tcp:127.0.0.1:1", "127.0.0.1:1"),
        ("", ""),
        ("telegraph:1", "telegraph"),
    ] {
        let mut command = Command::new(canter_tests::canter());
        let finished = Process::spawn(command.args(["--can", bus, "scan"])).finish();
        assert!(
            matches!(finished.status.code(), Some(1 | 2)),
            "{bus}: {finished:#?}"
        );
        assert!(finished.stderr.contains(words), "{bus}: {finished:#?}");
    }
    assert!(!robot.finish().moved(), "something moved");
}
