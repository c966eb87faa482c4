//! Drives that get into trouble in mid-move: a latched fault with its meaning, no torque, and nothing goes
//! on by itself.

use super::rig::{MAKES, Rig};
use canter::drive_model::{Make, Trial, Trouble};
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::drive::settings::DriveKind;
use canter_shared::wire::command::Action;

/// Well into a move that is long enough.
const AFTER: u32 = 600;

/// An ODrive says in its heartbeat what it is in, each 100 ms.
const HEARTBEAT: u64 = 101;

/// drive.timeout, and the 10 ms at which an ODrive tells its place.
const SILENCE: u64 = 62;

/// Until an axis is 0.5 rad away, and following.time.
const STRAYING: u64 = 250;

/// What becomes of axis 1, whose drive gets into this trouble in the middle of a move, and is found to be in
/// it after so many ticks at most; the others go on.
fn suffers(make: &Make, trouble: Trouble, most: u64) -> (Rig, Fault) {
    let trial = Trial {
        trouble,
        after: AFTER,
    };
    let mut rig = Rig::new(make, &[trial], &[]);
    rig.enable();
    for axis in 1..=3 {
        rig.move_to(axis, 1.8, 2_500);
    }
    rig.until("fault", AFTER + 2_000, |rig| rig.state(1) == State::Fault);
    let fault = rig.fault(1).expect("a fault has a name");
    let found = rig.ticks - rig.troubled.expect("it is in trouble");
    assert!(
        found <= most,
        "{make:?} {trouble:?}: found after {found} ms"
    );
    // Its own end is long past: nothing went on.
    rig.steps(3_000);
    assert_eq!(
        (rig.state(1), rig.fault(1)),
        (State::Fault, Some(fault)),
        "{make:?}"
    );
    assert!(
        !rig.seen(1).enabled,
        "{make:?} {trouble:?}: {:?}",
        rig.seen(1)
    );
    assert!(
        (rig.seen(1).position - 1.8).abs() > 0.1,
        "{make:?} {trouble:?}: it went on"
    );
    for axis in 2..=3 {
        assert_eq!(rig.fault(axis), None, "{make:?} {trouble:?}");
        assert!(
            (rig.seen(axis).position - 1.8).abs() < 1e-3,
            "{make:?} {trouble:?}"
        );
    }
    (rig, fault)
}

/// It is cleared and enabled, and goes from where it is.
fn recovers(rig: &mut Rig) {
    rig.control(1, Action::Clear);
    rig.until("a drive that is well", 2_000, |rig| {
        rig.state(1) == State::SwitchOnDisabled
    });
    assert!(!rig.seen(1).enabled);
    rig.control(1, Action::Enable);
    rig.until("torque", 1_000, |rig| {
        rig.state(1) == State::OperationEnabled
    });
    rig.move_to(1, 0.2, 2_000);
    rig.steps(2_200);
    assert!(
        (rig.seen(1).position - 0.2).abs() < 1e-3,
        "{:?}",
        rig.seen(1)
    );
}

#[test]
fn a_fault_of_the_drive_is_passed_on_with_its_meaning() {
    for make in &MAKES {
        let (mut rig, fault) = suffers(make, Trouble::Fault, HEARTBEAT);
        assert_eq!(fault, Fault::DriveUndervoltage, "{make:?}");
        recovers(&mut rig);
    }
}

#[test]
fn a_drive_that_reboots_stays_without_torque() {
    for make in &MAKES {
        let (mut rig, fault) = suffers(make, Trouble::Reboot, SILENCE);
        assert_eq!(fault, Fault::DriveLost, "{make:?}");
        recovers(&mut rig);
    }
}

/// It follows still, and would for ever: it is told not to, though nobody hears whether it obeys.
#[test]
fn a_drive_that_falls_silent_is_lost_and_told_to_let_go() {
    for make in &MAKES {
        let (_, fault) = suffers(make, Trouble::Silence, SILENCE);
        assert_eq!(fault, Fault::DriveLost, "{make:?}");
    }
}

#[test]
fn a_drive_that_hears_nothing_stops_by_its_own_watchdog() {
    for make in &MAKES {
        let make = Make {
            watchdog: Some(100),
            ..*make
        };
        let (_, fault) = suffers(&make, Trouble::Deaf, 100 + HEARTBEAT);
        let wanted = match make.kind {
            DriveKind::Odrive => Fault::DriveStarved,
            // These speak only when they are spoken to.
            _ => Fault::DriveLost,
        };
        assert_eq!(fault, wanted, "{make:?}");
    }
}

#[test]
fn a_drive_that_drops_out_is_not_enabled_again() {
    for make in &MAKES {
        let (mut rig, fault) = suffers(make, Trouble::DropOut, STRAYING);
        let wanted = match make.kind {
            // Nothing in its answers says so; it is its place that tells.
            DriveKind::Mit => Fault::FollowingError,
            _ => Fault::DriveFault,
        };
        assert_eq!(fault, wanted, "{make:?}");
        recovers(&mut rig);
    }
}

/// A watchdog that is on must not trip while the node lives, enabled or not.
#[test]
fn a_watchdog_is_fed_in_every_state() {
    for make in &MAKES {
        let make = Make {
            watchdog: Some(100),
            ..*make
        };
        let mut rig = Rig::new(&make, &[], &[]);
        rig.enable();
        rig.steps(1_000);
        rig.control(1, Action::Disable);
        rig.steps(1_000);
        assert!((1..=3).all(|axis| !rig.seen(axis).faulted), "{make:?}");
        assert_eq!(rig.fault(1), None, "{make:?}");
    }
}

/// Nobody feeds it before the node has heard it: it is cleared like any other fault.
#[test]
fn a_watchdog_that_tripped_before_the_node_was_there_is_cleared() {
    let make = Make {
        watchdog: Some(25),
        ..MAKES[0]
    };
    let mut rig = Rig::new(&make, &[], &[]);
    rig.steps(500);
    for axis in 1..=3 {
        assert!(rig.seen(axis).faulted);
        assert_eq!(rig.state(axis), State::NotReadyToSwitchOn);
        rig.control(axis, Action::Hold);
        rig.control(axis, Action::Clear);
    }
    rig.enable();
    rig.steps(500);
    assert!(!rig.seen(1).faulted);
}
