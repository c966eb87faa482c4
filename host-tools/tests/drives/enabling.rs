//! Drives that are well.

use super::rig::{MAKES, Rig, START};
use canter::drive_model::Make;
use canter_shared::axis::state::State;
use canter_shared::drive::settings::DriveKind;
use canter_shared::parameter::Parameter;
use canter_shared::wire::command::Action;

#[test]
fn axes_enable_where_their_drives_are_move_and_let_go() {
    for make in &MAKES {
        let mut rig = Rig::new(make, &[], &[]);
        rig.enable();
        for axis in 1..=3 {
            assert!(rig.seen(axis).enabled, "{make:?}");
        }
        rig.move_to(1, 1.3, 800);
        rig.move_to(2, -0.7, 800);
        rig.steps(1_000);
        for (axis, target) in [(1, 1.3), (2, -0.7), (3, START)] {
            let seen = rig.seen(axis);
            // The coarsest of them packs 4 rad/turn into 16 bits.
            assert!(
                (seen.position - target).abs() < 1e-3,
                "{make:?} {axis} {seen:?}"
            );
            assert!(
                (rig.places[usize::from(axis) - 1] - target).abs() < 1e-3,
                "{make:?}"
            );
        }
        for axis in 1..=3 {
            rig.control(axis, Action::Disable);
        }
        rig.steps(20);
        for axis in 1..=3 {
            assert!(!rig.seen(axis).enabled, "{make:?}");
            assert_eq!(rig.state(axis), State::SwitchOnDisabled, "{make:?}");
        }
        // It may be moved by hand, and is enabled where it is then.
        rig.enable();
        rig.steps(50);
        assert_eq!(rig.fault(1), None, "{make:?}");
    }
}

#[test]
fn every_tick_has_its_setpoint_and_other_periods_are_kept() {
    for make in &MAKES {
        for (period, wanted) in [(0.001, 1_000..=1_000), (0.004, 249..=251)] {
            let mut rig = Rig::new(make, &[], &[(Parameter::DrivePeriod, period)]);
            rig.enable();
            rig.steps(10);
            rig.sent.clear();
            rig.move_to(1, 1.0, 950);
            rig.steps(1_000);
            let setpoint = match make.kind {
                DriveKind::Odrive => 0x2C,
                DriveKind::Mit => 0x01,
                _ => 0x201,
            };
            let frames = rig.sent.iter().filter(|(_, frame)| frame.id() == setpoint);
            let count = frames.count();
            assert_eq!(rig.fault(1), None, "{make:?} {period}");
            assert!(wanted.contains(&count), "{make:?}: {count} in a second");
            if make.kind == DriveKind::Cia402 {
                let syncs = rig.sent.iter().filter(|(_, frame)| frame.id() == 0x080);
                assert!(wanted.contains(&syncs.count()));
            }
        }
    }
}

#[test]
fn gear_direction_and_offset_hold_on_the_way_round() {
    for make in &MAKES {
        let changes = [
            (Parameter::GearRatio, 2.5),
            (Parameter::DriveDirection, 1.0),
            (Parameter::DriveOffset, 1.0),
        ];
        let mut rig = Rig::new(make, &[], &changes);
        rig.enable();
        let offset = 1.0 / std::f64::consts::TAU;
        assert!(
            (rig.places[0] - (offset - START / 2.5)).abs() < 1e-3,
            "{make:?}"
        );
        rig.move_to(1, 0.5, 800);
        rig.steps(1_000);
        let wanted = -2.5 * (0.5 - offset);
        let seen = rig.seen(1);
        assert!((seen.position - wanted).abs() < 1e-3, "{make:?} {seen:?}");
        assert!((rig.places[0] - 0.5).abs() < 1e-3, "{make:?}");
    }
}

#[test]
fn drives_that_are_found_enabled_are_disabled_first() {
    for make in &MAKES {
        let make = Make {
            starts_enabled: true,
            ..*make
        };
        let mut rig = Rig::new(&make, &[], &[]);
        rig.until("rest", 500, |rig| {
            (1..=3).all(|axis| !rig.seen(axis).enabled)
        });
        rig.steps(200);
        assert!(!rig.seen(1).enabled, "{make:?}");
        rig.enable();
        rig.move_to(1, 0.5, 800);
        rig.steps(1_000);
        assert!((rig.seen(1).position - 0.5).abs() < 1e-3, "{make:?}");
    }
}

/// Its protocol cannot tell another place, so none is accepted: 12.5 rad are 1.989 turns.
#[test]
fn a_target_outside_of_the_drives_range_is_refused() {
    let mut rig = Rig::new(&MAKES[2], &[], &[]);
    rig.enable();
    for (target, goes) in [(1.98, true), (2.0, false), (-2.0, false), (-1.98, true)] {
        let before = rig.places[0];
        rig.move_to(1, target, 4_000);
        rig.steps(4_200);
        let wanted = if goes { target } else { before };
        assert!(
            (rig.places[0] - wanted).abs() < 1e-3,
            "{target}: {}",
            rig.places[0]
        );
        assert_eq!(rig.fault(1), None);
    }
}
