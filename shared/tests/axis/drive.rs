//! A drive that is not there, drops out, never enables, or stands far away.

use super::bench::{Bench, beta, travel, turns};
use canter_shared::axis::Outcome;
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::drive::simulated::Simulated;
use canter_shared::drive::{Condition, Trouble};
use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::parameter::Parameter;
use canter_shared::wire::command::{Action, Command};
use canter_shared::wire::reason::Reason;

const NOT_READY: Outcome = Outcome::Rejected(Reason::DriveNotReady);

/// Runs with the drive never told to enable.
#[track_caller]
fn runs_without_torque(bench: &mut Bench, ticks: u64) {
    for _ in 0..ticks {
        bench.step();
        assert!(!bench.command.enable, "{}", bench.axis.state());
    }
}

#[test]
fn a_drive_that_is_not_well_is_not_enabled() {
    for condition in [Condition::Lost, Condition::Faulted(Trouble::Other)] {
        let mut bench = Bench::new(Limits::default(), 3.0);
        bench.condition = Some(condition);
        runs_without_torque(&mut bench, 5);
        assert_eq!(bench.axis.state(), State::NotReadyToSwitchOn);
        assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
        assert_eq!(bench.control(Action::Enable), NOT_READY, "{condition:?}");
        runs_without_torque(&mut bench, 100);
        // Once it is well it can be enabled, but is not by itself.
        bench.condition = None;
        runs_without_torque(&mut bench, 100);
        assert_eq!(bench.axis.state(), State::SwitchOnDisabled);
        assert_eq!(bench.axis.fault(), None);
        assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
        bench.run(10);
        assert_eq!(bench.axis.state(), State::OperationEnabled);
        assert_eq!(bench.setpoint.position, turns(3.0));
    }
}

#[test]
fn a_drive_that_says_nothing_is_not_enabled() {
    let mut bench = Bench::new(Limits::default(), 3.0);
    bench.heard = false;
    runs_without_torque(&mut bench, 5);
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    assert_eq!(bench.control(Action::Enable), NOT_READY);
    runs_without_torque(&mut bench, 100);
    assert_eq!(bench.axis.state(), State::NotReadyToSwitchOn);
}

#[test]
fn a_drive_that_gets_lost_before_it_is_told_to_enable_is_not_enabled() {
    for condition in [Condition::Lost, Condition::Faulted(Trouble::Other)] {
        let mut bench = Bench::new(Limits::default(), 3.0);
        bench.run(5);
        assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
        assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
        bench.condition = Some(condition);
        runs_without_torque(&mut bench, 5);
        bench.condition = None;
        runs_without_torque(&mut bench, 100);
        assert_eq!(bench.axis.state(), State::SwitchOnDisabled);
    }
}

#[test]
fn an_emergency_stop_before_the_first_word_of_the_drive_leaves_no_way_to_torque() {
    let mut bench = Bench::new(Limits::default(), 3.0);
    bench.heard = false;
    assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    assert_eq!(bench.control(Action::Clear), Outcome::Accepted);
    assert_eq!(bench.control(Action::Enable), NOT_READY);
    runs_without_torque(&mut bench, 10);
    assert_eq!(bench.control(Action::Enable), NOT_READY);
    runs_without_torque(&mut bench, 10);
    bench.heard = true;
    bench.run(5);
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    bench.run(10);
    assert_eq!(bench.setpoint.position, turns(3.0));
}

/// The states in which the drive follows, each in mid-move.
fn in_motion(state: State) -> Bench {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.go(10.0, 8_000), Outcome::Accepted);
    bench.run(2_000);
    let outcome = match state {
        State::QuickStopActive => bench.control(Action::Disable),
        State::FaultReactionActive => bench.send(Command::EmergencyStop),
        _ => Outcome::Accepted,
    };
    assert_eq!(outcome, Outcome::Accepted);
    bench.run(2);
    assert_eq!(bench.axis.state(), state);
    assert!(bench.velocity() > 1.0);
    bench
}

#[test]
fn a_drive_that_drops_out_ends_everything_at_once() {
    for state in [
        State::OperationEnabled,
        State::QuickStopActive,
        State::FaultReactionActive,
    ] {
        for (condition, fault) in [
            (Condition::Disabled, Fault::DriveFault),
            (Condition::Faulted(Trouble::Other), Fault::DriveFault),
            (Condition::Lost, Fault::DriveLost),
        ] {
            let mut bench = in_motion(state);
            bench.condition = Some(condition);
            bench.step();
            let case = format!("{condition:?} in {state}");
            assert_eq!(bench.axis.state(), State::Fault, "{case}");
            assert!(!bench.command.enable, "{case}");
            assert_eq!(bench.velocity(), 0.0, "{case}");
            let first = if state == State::FaultReactionActive {
                Fault::EmergencyStop
            } else {
                fault
            };
            assert_eq!(bench.axis.fault(), Some(first), "{case}");
            // It comes back, and nothing goes on.
            bench.condition = None;
            runs_without_torque(&mut bench, 100);
            assert_eq!(bench.axis.fault(), Some(first), "{case}");
        }
    }
}

#[test]
fn a_drive_that_drops_out_at_rest_is_a_fault_too() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    bench.condition = Some(Condition::Disabled);
    bench.step();
    assert_eq!(bench.axis.state(), State::Fault);
    assert_eq!(bench.axis.fault(), Some(Fault::DriveFault));
}

#[test]
fn a_drive_that_does_not_enable_in_time_is_a_fault() {
    let mut bench = Bench::new(Limits::default(), 3.0);
    bench.condition = Some(Condition::Disabled);
    bench.run(5);
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    bench.run(1_000);
    assert_eq!(bench.axis.state(), State::ReadyToSwitchOn);
    assert_eq!(
        bench.send(beta(3, 1.0, 1_000)),
        Outcome::Rejected(Reason::NotEnabled)
    );
    bench.run(3);
    assert_eq!(bench.axis.state(), State::Fault);
    assert_eq!(bench.axis.fault(), Some(Fault::EnableTimeout));
    assert!(!bench.command.enable);
}

#[test]
fn the_setpoint_follows_a_drive_that_is_moved_by_hand_until_it_holds() {
    let mut bench = Bench::new(travel(10.0), 0.0);
    bench.condition = Some(Condition::Disabled);
    bench.run(5);
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    for place in [0.5, 1.0, 4.0] {
        bench.drive = Simulated::new(turns(place));
        bench.run(2);
        assert_eq!(bench.setpoint.position, turns(place));
    }
    bench.condition = None;
    bench.run(10);
    assert_eq!(bench.axis.state(), State::OperationEnabled);
    assert_eq!(bench.setpoint.position, turns(4.0));
    bench.stays(1_000);
}

/// Beyond the farthest travel, and as far as Feedback can tell.
#[test]
fn a_drive_that_stands_far_away_is_led_back() {
    let limits = Limits::new(&LimitValues {
        velocity: 1e4,
        acceleration: 1e6,
        deceleration: 1e6,
        jerk: 1e9,
        ..DEFAULT_VALUES
    })
    .expect("in range");
    for place in [1_001.0, -1_010.0, 1_023.9, -1_023.9] {
        for quick in [false, true] {
            let mut bench = Bench::enabled(limits, place);
            // At 10 rad in a tick the simulated drive is away by more than the default.
            bench.set(Parameter::FollowingError, 0);
            // Somewhat above the shortest time, 2 pi 32 / (5 pi) / 1e4 s for a turn.
            let milliseconds = (f64::abs(place) * 1.3) as u32;
            let outcome = if quick {
                bench.go_trapezoid(0.0, milliseconds)
            } else {
                bench.go(0.0, milliseconds)
            };
            // The bench holds every setpoint to the limits, those in the middle above all.
            assert_eq!(outcome, Outcome::Accepted);
            bench.ticks_to_rest(u64::from(milliseconds) + 1);
            assert_eq!(bench.place(), 0.0);
        }
    }
}
