//! ODrive. Frames by hand from its documents: id = node << 5 | command, little-endian.

use super::bench::{Bench, settings, texts, turns};
use canter_shared::drive::odrive::Odrive;
use canter_shared::drive::settings::DriveKind;
use canter_shared::drive::{Condition, Drive, Trouble};
use canter_shared::parameter::Parameter;
use canter_shared::units::Velocity;

/// Node 2: ids 0x040 to 0x05F.
const HEARTBEAT: u16 = 0x041;
const ESTIMATES: u16 = 0x049;

const IDLE: u8 = 1;
const CLOSED_LOOP: u8 = 8;

fn bench(changes: &[(Parameter, f64)]) -> Bench<Odrive> {
    Bench::new(Odrive::new(&settings(DriveKind::Odrive, 2, changes)))
}

fn heartbeat(bench: &mut Bench<Odrive>, state: u8, errors: u32) {
    let [a, b, c, d] = errors.to_le_bytes();
    bench.hear(HEARTBEAT, &[a, b, c, d, state, 0, 0, 0]);
}

fn estimates(bench: &mut Bench<Odrive>, turns: f32, speed: f32) {
    let data = [turns.to_le_bytes(), speed.to_le_bytes()].concat();
    bench.hear(ESTIMATES, &data);
}

/// A drive that was heard at a quarter of a turn, idle.
fn heard(changes: &[(Parameter, f64)]) -> Bench<Odrive> {
    let mut bench = bench(changes);
    heartbeat(&mut bench, IDLE, 0);
    estimates(&mut bench, 0.25, 0.0);
    bench.step();
    bench
}

fn enabled(changes: &[(Parameter, f64)]) -> Bench<Odrive> {
    let mut bench = heard(changes);
    bench.enable();
    bench.step();
    bench.step();
    heartbeat(&mut bench, CLOSED_LOOP, 0);
    estimates(&mut bench, 0.25, 0.0);
    assert_eq!(bench.condition(), Condition::Enabled);
    bench
}

#[test]
fn it_is_lost_until_both_of_its_frames_were_heard() {
    let mut bench = bench(&[]);
    assert_eq!(bench.condition(), Condition::Lost);
    heartbeat(&mut bench, IDLE, 0);
    assert_eq!(bench.condition(), Condition::Lost);
    // Nothing is said to who is not there.
    assert_eq!(bench.steps(100), []);
    estimates(&mut bench, -1.5, 0.75);
    assert_eq!(bench.condition(), Condition::Disabled);
    let report = bench.drive.report();
    assert_eq!(turns(report.position), -1.5);
    assert_eq!(report.velocity, Velocity::from_counts(3 << 30));
}

#[test]
fn only_whole_frames_of_this_node_are_taken() {
    let mut bench = bench(&[]);
    for (id, data) in [
        (0x061, &[0; 8][..]),
        (0x029, &[0; 8]),
        (HEARTBEAT, &[0; 7]),
        (ESTIMATES, &[0; 4]),
        (0x04C, &[0; 8]),
        (0x057, &[0; 8]),
        (0x441, &[0; 8]),
    ] {
        assert!(bench.ignores(id, data).is_some(), "{id:#05x} {data:?}");
    }
    assert_eq!(bench.condition(), Condition::Lost);
}

#[test]
fn enabling_goes_from_where_the_drive_is_and_in_order() {
    let mut bench = heard(&[]);
    bench.enable();
    // The order is taken, a setpoint goes with it: 0.25 turn is 0x3E800000.
    assert_eq!(texts(&bench.step()), ["04C#0000803E00000000"]);
    // Position control from the input as it is, the input where the drive is, closed loop.
    let start = [
        "04B#0300000001000000",
        "04C#0000803E00000000",
        "047#08000000",
    ];
    assert_eq!(texts(&bench.step()), start);
    assert_eq!(bench.condition(), Condition::Disabled);
    assert_eq!(texts(&bench.step()), ["04C#0000803E00000000"]);
    heartbeat(&mut bench, CLOSED_LOOP, 0);
    assert_eq!(bench.condition(), Condition::Enabled);
}

#[test]
fn a_setpoint_is_position_velocity_and_torque_as_the_layout_says() {
    let mut bench = enabled(&[(Parameter::DriveInertia, 0.01)]);
    // 1.5 turns: 0x3FC00000; -2 turn/s: -2000; 10 turn/s^2 = 62.83 rad/s^2, 0.6283 Nm: 628 = 0x0274.
    bench.lead(1.5, -2.0, 10.0);
    assert_eq!(texts(&bench.step()), ["04C#0000C03F30F87402"]);
    // What an i16 cannot hold is its end.
    bench.lead(-1.0, 100.0, -100_000.0);
    assert_eq!(texts(&bench.step()), ["04C#000080BFFF7F0080"]);
    bench.lead(0.0, -100.0, 100_000.0);
    assert_eq!(texts(&bench.step()), ["04C#000000000080FF7F"]);
}

#[test]
fn gear_direction_and_offset_are_between_axis_and_drive() {
    let mut bench = enabled(&[
        (Parameter::GearRatio, 6.0),
        (Parameter::DriveDirection, 1.0),
        (Parameter::DriveOffset, std::f64::consts::PI),
    ]);
    // The drive at 0.25 turn: the axis at 0.5 - 0.25 / 6.
    assert!((turns(bench.drive.report().position) - (0.5 - 0.25 / 6.0)).abs() < 1e-9);
    // The axis at a whole turn: the drive at -6 * 0.5 = -3 (0xC0400000); +1 turn/s: -6000 = 0xE890.
    bench.lead(1.0, 1.0, 0.0);
    assert_eq!(texts(&bench.step()), ["04C#000040C090E80000"]);
}

#[test]
fn a_setpoint_leaves_at_each_period() {
    let mut bench = enabled(&[(Parameter::DrivePeriod, 0.004)]);
    bench.steps(4);
    let mut last = 0;
    for tick in 1..=40 {
        bench.lead(f64::from(tick), 0.0, 0.0);
        let sent = bench.step();
        assert!(sent.len() <= 1);
        if !sent.is_empty() {
            assert!(last == 0 || tick - last == 4, "{last} {tick}");
            last = tick;
        }
    }
    assert!(last >= 37);
}

#[test]
fn disabling_takes_torque_away_at_once() {
    let mut bench = enabled(&[]);
    bench.command.enable = false;
    assert_eq!(texts(&bench.step())[0], "047#01000000");
    assert_eq!(bench.condition(), Condition::Disabled);
    // One that did not hear it is told again at its next heartbeat.
    heartbeat(&mut bench, CLOSED_LOOP, 0);
    assert!(texts(&bench.step()).contains(&"047#01000000".into()));
    assert_eq!(bench.condition(), Condition::Disabled);
}

#[test]
fn one_that_is_found_enabled_is_disabled_first() {
    let mut bench = bench(&[]);
    heartbeat(&mut bench, CLOSED_LOOP, 0);
    estimates(&mut bench, 3.0, 0.0);
    assert_eq!(bench.condition(), Condition::Disabled);
    assert!(texts(&bench.step()).contains(&"047#01000000".into()));
    // The axis may want it meanwhile: it is not taken for enabled, and its idle is waited for.
    bench.enable();
    bench.step();
    heartbeat(&mut bench, CLOSED_LOOP, 0);
    assert_eq!(bench.condition(), Condition::Disabled);
    assert!(texts(&bench.step()).contains(&"047#01000000".into()));
    heartbeat(&mut bench, IDLE, 0);
    assert!(texts(&bench.step()).contains(&"047#08000000".into()));
}

#[test]
fn one_that_calibrates_is_not_interrupted() {
    let mut bench = heard(&[]);
    heartbeat(&mut bench, 3, 0);
    bench.enable();
    let sent = texts(&bench.steps(40));
    assert!(sent.iter().all(|text| text.starts_with("04C#")), "{sent:?}");
    heartbeat(&mut bench, IDLE, 0);
    assert!(texts(&bench.step()).contains(&"047#08000000".into()));
}

#[test]
fn one_that_did_not_hear_is_told_again_but_never_one_that_dropped_out() {
    let mut bench = heard(&[]);
    bench.enable();
    bench.steps(2);
    let told = |sent: &[String]| sent.contains(&"047#08000000".into());
    for _ in 0..2 {
        // Its heartbeats may come from before the order.
        heartbeat(&mut bench, IDLE, 0);
        estimates(&mut bench, 0.25, 0.0);
        assert!(!told(&texts(&bench.steps(99))));
    }
    heartbeat(&mut bench, IDLE, 0);
    assert!(!told(&texts(&bench.steps(3))));
    heartbeat(&mut bench, IDLE, 0);
    assert!(told(&texts(&bench.step())));

    let mut bench = enabled(&[]);
    heartbeat(&mut bench, IDLE, 0);
    assert_eq!(bench.condition(), Condition::Disabled);
    for _ in 0..20 {
        heartbeat(&mut bench, IDLE, 0);
        estimates(&mut bench, 0.25, 0.0);
        let sent = texts(&bench.steps(40));
        assert!(!told(&sent), "{sent:?}");
    }
    // Nor is one that comes back by itself taken for led before the axis has taken its order back.
    bench.command.enable = false;
    bench.step();
    heartbeat(&mut bench, CLOSED_LOOP, 0);
    assert_eq!(bench.condition(), Condition::Disabled);
}

#[test]
fn silence_of_either_frame_is_a_loss() {
    let mut bench = enabled(&[(Parameter::DriveTimeout, 0.03)]);
    bench.steps(30);
    assert_eq!(bench.condition(), Condition::Enabled);
    bench.step();
    assert_eq!(bench.condition(), Condition::Lost);

    let mut bench = enabled(&[]);
    for tick in 1..=360 {
        estimates(&mut bench, 0.25, 0.0);
        bench.step();
        let wanted = if tick > 350 {
            Condition::Lost
        } else {
            Condition::Enabled
        };
        assert_eq!(bench.condition(), wanted, "{tick}");
    }
}

#[test]
fn errors_have_a_meaning_in_both_generations() {
    for (firmware, data, trouble) in [
        (0.0, [0x00, 0x20, 0, 0, 1, 0, 0, 0], Trouble::Temperature),
        (0.0, [0x00, 0x01, 0, 0, 1, 0, 0, 0], Trouble::Overvoltage),
        (0.0, [0x00, 0x02, 0, 0, 1, 0, 0, 0], Trouble::Undervoltage),
        (0.0, [0x00, 0x10, 0, 0, 1, 0, 0, 0], Trouble::Current),
        (0.0, [0x08, 0x00, 0, 0, 1, 0, 0, 0], Trouble::Encoder),
        (0.0, [0, 0, 0, 0x01, 1, 0, 0, 0], Trouble::Starved),
        (0.0, [0, 0, 0, 0x02, 1, 0, 0, 0], Trouble::Other),
        (1.0, [0x00, 0x08, 0, 0, 1, 0, 0, 0], Trouble::Starved),
        (1.0, [0x00, 0x00, 0x04, 0, 1, 0, 0, 0], Trouble::Temperature),
        // Motor, encoder and controller have flags of their own; the last bit is no error.
        (1.0, [0, 0, 0, 0, 1, 1, 0, 0], Trouble::Motor),
        (1.0, [0, 0, 0, 0, 1, 0, 1, 0], Trouble::Encoder),
        (1.0, [0, 0, 0, 0, 1, 0, 0, 0x81], Trouble::Following),
    ] {
        let mut bench = enabled(&[(Parameter::OdriveFirmware, firmware)]);
        bench.hear(HEARTBEAT, &data);
        assert_eq!(
            bench.condition(),
            Condition::Faulted(trouble),
            "{data:02x?}"
        );
    }
    let mut bench = enabled(&[(Parameter::OdriveFirmware, 1.0)]);
    bench.hear(HEARTBEAT, &[0, 0, 0, 0, 8, 0, 0, 0x80]);
    assert_eq!(bench.condition(), Condition::Enabled);
    // What those bytes hold in 0.6 is no error either: result 3, a move done.
    let mut bench = enabled(&[]);
    bench.hear(HEARTBEAT, &[0, 0, 0, 0, 8, 3, 1, 0]);
    assert_eq!(bench.condition(), Condition::Enabled);
}

#[test]
fn errors_are_cleared_when_the_axis_is() {
    for (firmware, wanted) in [(0.0, "058#00"), (1.0, "058#")] {
        let mut bench = heard(&[(Parameter::OdriveFirmware, firmware)]);
        heartbeat(&mut bench, IDLE, 0x800);
        bench.command.reset = true;
        assert_eq!(texts(&bench.step())[0], wanted);
        bench.command.reset = false;
        assert!(!texts(&bench.steps(30)).contains(&wanted.into()));
        heartbeat(&mut bench, IDLE, 0);
        assert_eq!(bench.condition(), Condition::Disabled);
    }
}

/// Its watchdog, where it is on, wants to hear something in every state.
#[test]
fn an_idle_drive_hears_where_it_is() {
    let mut bench = heard(&[]);
    estimates(&mut bench, 7.0, 0.0);
    let sent = texts(&bench.steps(45));
    assert_eq!(sent, ["04C#0000E04000000000", "04C#0000E04000000000"]);
}

#[test]
fn what_is_no_number_is_no_place() {
    for turns in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30] {
        let mut bench = heard(&[]);
        estimates(&mut bench, turns, turns);
        let report = bench.drive.report();
        // Far beyond what Feedback can carry: the axis makes feedback_range of it.
        assert!(report.position.abs().counts() > 1 << 60, "{turns}");
        assert!(report.velocity.abs().counts() > 1 << 60, "{turns}");
    }
}
