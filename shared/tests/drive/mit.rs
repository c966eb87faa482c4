//! The mini-cheetah mode.

use super::bench::{Bench, settings, texts, turns};
use canter_shared::drive::mit::{ENTER, EXIT, MODELS, Mit};
use canter_shared::drive::settings::DriveKind;
use canter_shared::drive::{Condition, Drive, Trouble};
use canter_shared::parameter::Parameter;
use canter_shared::units::COUNTS_PER_TURN;
use proptest::prelude::*;

const ENTER_TEXT: &str = "005#FFFFFFFFFFFFFFFC";
const EXIT_TEXT: &str = "005#FFFFFFFFFFFFFFFD";

fn bench(changes: &[(Parameter, f64)]) -> Bench<Mit> {
    Bench::new(Mit::new(&settings(DriveKind::Mit, 5, changes)))
}

/// The answer of a CubeMars drive of id 5 at this place, 16 bits, at rest.
fn answer(bench: &mut Bench<Mit>, place: u16, error: u8) {
    let [high, low] = place.to_be_bytes();
    bench.hear(5, &[5, high, low, 0x7F, 0xF7, 0xFF, 30, error]);
}

fn enabled(changes: &[(Parameter, f64)]) -> Bench<Mit> {
    let mut bench = bench(changes);
    bench.steps(2);
    answer(&mut bench, 0x8000, 0);
    bench.enable();
    assert_eq!(texts(&bench.step()), [ENTER_TEXT]);
    answer(&mut bench, 0x8000, 0);
    assert_eq!(bench.condition(), Condition::Disabled);
    let first = texts(&bench.step());
    assert_eq!(first.len(), 1);
    assert!(first[0].starts_with("005#8000"), "{first:?}");
    answer(&mut bench, 0x8000, 0);
    assert_eq!(bench.condition(), Condition::Enabled);
    bench
}

/// Without it the drive would answer setpoints, seem to follow, and hold no torque.
#[test]
fn the_word_to_enter_is_sent_first_however_late() {
    for late in [2, 3, 40] {
        let mut bench = bench(&[]);
        bench.steps(2);
        answer(&mut bench, 0x8000, 0);
        bench.enable();
        bench.wait(late);
        assert_eq!(texts(&bench.step()), [ENTER_TEXT], "{late} ticks late");
        answer(&mut bench, 0x8000, 0);
        assert_eq!(bench.condition(), Condition::Disabled);
        assert!(texts(&bench.step())[0].starts_with("005#8000"));
        answer(&mut bench, 0x8000, 0);
        assert_eq!(bench.condition(), Condition::Enabled);
    }
}

/// A node throws frames away that are too old for a drive whose bus was gone.
#[test]
fn no_setpoint_is_sent_before_the_word_to_enter_was_answered() {
    let mut bench = bench(&[]);
    bench.steps(2);
    answer(&mut bench, 0x8000, 0);
    bench.enable();
    for _ in 0..3 {
        assert_eq!(texts(&bench.step()), [ENTER_TEXT]);
        assert_eq!(texts(&bench.steps(50)), [""; 0]);
    }
    assert_eq!(texts(&bench.step()), [ENTER_TEXT]);
    answer(&mut bench, 0x8000, 0);
    assert!(texts(&bench.step())[0].starts_with("005#8000"));
    assert_eq!(bench.condition(), Condition::Disabled);
    answer(&mut bench, 0x8000, 0);
    assert_eq!(bench.condition(), Condition::Enabled);
}

#[test]
fn a_drive_without_torque_is_told_so_and_heard_by_it() {
    let mut bench = bench(&[]);
    assert_eq!(bench.condition(), Condition::Lost);
    let sent = texts(&bench.steps(100));
    assert_eq!(sent, [EXIT_TEXT; 10]);
    answer(&mut bench, 0xC000, 0);
    assert_eq!(bench.condition(), Condition::Disabled);
    // 49152 * 25 / 65535 - 12.5 = 6.25029 rad.
    let radians = turns(bench.drive.report().position) * std::f64::consts::TAU;
    assert!((radians - 6.250_286).abs() < 1e-5, "{radians}");
}

#[test]
fn both_kinds_of_answers_are_taken_and_nobody_elses() {
    let mut bench = bench(&[(Parameter::MitMaster, 0x10 as f64)]);
    for (id, data) in [
        (5, &[6, 0x80, 0, 0x7F, 0xF7, 0xFF, 0, 0][..]),
        (6, &[5, 0x80, 0, 0x7F, 0xF7, 0xFF, 0, 0]),
        (0, &[5, 0x80, 0, 0x7F, 0xF7, 0xFF, 0]),
        (5, &[5, 0x80, 0, 0x7F, 0xF7, 0xFF]),
        (5, &[]),
    ] {
        assert!(bench.ignores(id, data).is_some(), "{id} {data:02x?}");
    }
    assert_eq!(bench.condition(), Condition::Lost);
    // bgkatz: 7 bytes to the master, the last one is a voltage; a velocity of 3 / 4 of 4095.
    bench.hear(0x10, &[5, 0x40, 0x00, 0xBF, 0xF7, 0xFF, 200]);
    let report = bench.drive.report();
    assert_eq!(report.condition, Condition::Disabled);
    assert!((turns(report.position) + 6.249_904 / std::f64::consts::TAU).abs() < 1e-6);
    let speed = report.velocity.counts() as f64 / COUNTS_PER_TURN as f64 * std::f64::consts::TAU;
    assert!(
        (speed - (3071.0 * 100.0 / 4095.0 - 50.0)).abs() < 1e-3,
        "{speed}"
    );
}

/// By hand: kp 50 is 409 (0x199), kd 1 is 819 (0x333).
#[test]
fn a_setpoint_is_packed_with_gains_and_feed_forward() {
    let mut bench = enabled(&[(Parameter::DriveInertia, 0.1)]);
    let tau = std::f64::consts::TAU;
    // 1 rad: 35388 = 0x8A3C; 10.01 rad/s: 60.01 * 4095 / 100 = 2457.4: 0x999; 30 rad/s^2: 3 Nm, 0x954.
    bench.lead(1.0 / tau, 10.01 / tau, 30.0 / tau);
    assert_eq!(texts(&bench.step()), ["005#8A3C999199333954"]);
}

#[test]
fn a_place_outside_the_range_is_a_fault_and_no_other_place() {
    for (radians, inside) in [(12.4, true), (-12.4, true), (12.6, false), (-12.6, false)] {
        let mut bench = enabled(&[]);
        bench.lead(radians / std::f64::consts::TAU, 0.0, 0.0);
        let sent = texts(&bench.step());
        if inside {
            assert_ne!(sent, [EXIT_TEXT]);
            assert_eq!(bench.condition(), Condition::Enabled);
        } else {
            assert_eq!(sent, [EXIT_TEXT], "{radians}");
            // Whatever it answers: the axis has not taken its order back.
            answer(&mut bench, 0x8000, 0);
            assert_eq!(bench.condition(), Condition::Faulted(Trouble::Range));
            assert_eq!(texts(&bench.steps(10)), [EXIT_TEXT], "{radians}");
            bench.command.enable = false;
            bench.step();
            answer(&mut bench, 0x8000, 0);
            assert_eq!(bench.condition(), Condition::Disabled);
        }
    }
}

#[test]
fn a_drive_at_the_end_of_its_range_may_be_beyond() {
    for place in [0, 0xFFFF] {
        let mut bench = enabled(&[]);
        answer(&mut bench, place, 0);
        assert_eq!(bench.condition(), Condition::Faulted(Trouble::Range));
    }
}

#[test]
fn errors_have_a_meaning() {
    for (error, trouble) in [
        (1, Trouble::Temperature),
        (2, Trouble::Current),
        (3, Trouble::Overvoltage),
        (4, Trouble::Undervoltage),
        (5, Trouble::Encoder),
        (6, Trouble::Motor),
        (7, Trouble::Other),
    ] {
        let mut bench = enabled(&[]);
        answer(&mut bench, 0x8000, error);
        assert_eq!(bench.condition(), Condition::Faulted(trouble));
        // The axis disables, and the drive is well again.
        bench.command.enable = false;
        assert_eq!(texts(&bench.step()), [EXIT_TEXT]);
        answer(&mut bench, 0x8000, 0);
        assert_eq!(bench.condition(), Condition::Disabled);
    }
}

#[test]
fn disabling_leaves_the_mode_at_once() {
    let mut bench = enabled(&[]);
    bench.command.enable = false;
    assert_eq!(texts(&bench.step()), [EXIT_TEXT]);
    assert_eq!(bench.condition(), Condition::Disabled);
    assert_eq!(texts(&bench.steps(20)), [EXIT_TEXT; 2]);
}

#[test]
fn silence_is_a_loss_and_a_drive_that_did_not_enter_is_told_again() {
    let mut bench = enabled(&[]);
    bench.steps(50);
    assert_eq!(bench.condition(), Condition::Enabled);
    bench.step();
    assert_eq!(bench.condition(), Condition::Lost);

    let mut bench = super::mit::bench(&[]);
    answer(&mut bench, 0x8000, 0);
    bench.enable();
    let entered = texts(&bench.steps(120))
        .iter()
        .filter(|text| *text == ENTER_TEXT)
        .count();
    assert_eq!(entered, 3);
}

proptest! {
    /// Whatever the axis wants of whichever drive: no special frame is sent but to enter and to leave,
    /// and what is sent besides is inside of the range.
    #[test]
    fn no_command_is_sent_as_a_special_frame(
        model in 0..MODELS.len(),
        gains in (prop_oneof![Just(500.0), 0.0..500.0], prop_oneof![Just(5.0), 0.0..5.0]),
        reversed in 0..2,
        wanted in prop::collection::vec((any::<bool>(), -20.0..20.0f64, -1e4..1e4f64, -1e6..1e6f64), 1..60),
    ) {
        let mut bench = bench(&[
            (Parameter::MitModel, model as f64),
            (Parameter::MitKp, gains.0),
            (Parameter::MitKd, gains.1),
            (Parameter::DriveDirection, f64::from(reversed)),
            (Parameter::DriveInertia, 1.0),
        ]);
        answer(&mut bench, 0x8000, 0);
        for (enable, place, speed, acceleration) in wanted {
            bench.lead(place, speed, acceleration);
            bench.command.enable = enable;
            for frame in bench.step() {
                prop_assert_eq!(frame.data().len(), 8);
                let special = [ENTER, EXIT].contains(&frame.word());
                let is_marked = frame.data()[..7] == [0xFF; 7];
                prop_assert_eq!(is_marked, special);
                prop_assert!(frame.word() != ENTER || enable);
                if !special {
                    prop_assert!(enable);
                }
            }
            answer(&mut bench, 0x8000, 0);
        }
    }
}
