//! CiA 402 over CANopen. Node 3; frames by hand from CiA 301 and 402.

use super::bench::{Bench, settings, texts, turns};
use canter_shared::drive::cia402::Cia402;
use canter_shared::drive::cia402::objects::SETUP;
use canter_shared::drive::settings::DriveKind;
use canter_shared::drive::{Condition, Drive, Trouble};
use canter_shared::parameter::Parameter;
use canter_shared::units::COUNTS_PER_TURN;

const TPDO: u16 = 0x183;
const SDO_ANSWER: u16 = 0x583;
const BOOT: u16 = 0x703;
const EMCY: u16 = 0x083;

const PRE_OPERATIONAL: &str = "000#8003";
const START: &str = "000#0103";
const SYNC: &str = "080#";

fn bench(changes: &[(Parameter, f64)]) -> Bench<Cia402> {
    Bench::new(Cia402::new(&settings(DriveKind::Cia402, 3, changes)))
}

fn tells(bench: &mut Bench<Cia402>, statusword: u16, place: i32) {
    let [a, b] = statusword.to_le_bytes();
    let [c, d, e, f] = place.to_le_bytes();
    bench.hear(TPDO, &[a, b, c, d, e, f]);
}

/// Answers every write, as long as there are some; gives what was sent.
fn set_up(bench: &mut Bench<Cia402>) -> Vec<String> {
    let mut sent = Vec::new();
    for _ in 0..SETUP.len() + 1 {
        let frames = bench.step();
        sent.extend(texts(&frames));
        for frame in frames.iter().filter(|frame| frame.id() == 0x603) {
            let mut answer = [0; 8];
            answer[..4].copy_from_slice(&frame.data()[..4]);
            answer[0] = 0x60;
            bench.hear(SDO_ANSWER, &answer);
        }
    }
    sent
}

fn running(changes: &[(Parameter, f64)]) -> Bench<Cia402> {
    let mut bench = bench(changes);
    set_up(&mut bench);
    tells(&mut bench, 0x0250, 16_384);
    assert_eq!(bench.condition(), Condition::Disabled);
    bench
}

fn enabled(changes: &[(Parameter, f64)]) -> Bench<Cia402> {
    let mut bench = running(changes);
    bench.enable();
    for statusword in [0x0250, 0x0231, 0x0233, 0x1237] {
        tells(&mut bench, statusword, 16_384);
        bench.step();
    }
    assert_eq!(bench.condition(), Condition::Enabled);
    bench
}

#[test]
fn a_drive_is_set_up_and_started_in_order() {
    let mut bench = bench(&[(Parameter::DrivePeriod, 0.002)]);
    assert_eq!(bench.condition(), Condition::Lost);
    let sent = set_up(&mut bench);
    let wanted = [
        PRE_OPERATIONAL,
        "603#2B40600000000000",
        "603#2300140103020080",
        "603#2F00160000000000",
        "603#2300160110004060",
        "603#2300160220007A60",
        "603#2F00160002000000",
        "603#2F00140201000000",
        "603#2300140103020000",
        "603#2300180183010080",
        "603#2F001A0000000000",
        "603#23001A0110004160",
        "603#23001A0220006460",
        "603#2F001A0002000000",
        "603#2F00180201000000",
        "603#2300180183010000",
        "603#2F60600008000000",
        "603#2FC2600102000000",
        "603#2FC26002FD000000",
        "603#2B17100064000000",
        START,
    ];
    assert_eq!(sent[..wanted.len()], wanted);
    // Only SYNC until it has said where it is: then torque is off, and its target where it is.
    let next = texts(&bench.steps(4));
    assert!(
        next.iter().all(|text| text == SYNC) && !next.is_empty(),
        "{next:?}"
    );
    assert_eq!(bench.condition(), Condition::Lost);
    tells(&mut bench, 0x0250, -2);
    assert_eq!(bench.condition(), Condition::Disabled);
    assert_eq!(texts(&bench.steps(2)), ["203#0000FEFFFFFF", SYNC]);
}

#[test]
fn enabling_goes_up_step_by_step_from_where_the_drive_is() {
    let mut bench = running(&[]);
    bench.enable();
    for (statusword, control) in [
        (0x0250, "0600"),
        (0x0231, "0700"),
        (0x0233, "0F00"),
        // Enabled, but it does not look at its target yet.
        (0x0237, "0F00"),
    ] {
        tells(&mut bench, statusword, 16_384);
        assert_eq!(bench.condition(), Condition::Disabled);
        // 16384 of 65536 increments: the target is where it is.
        assert_eq!(
            texts(&bench.step()),
            [&format!("203#{control}00400000"), SYNC]
        );
    }
    tells(&mut bench, 0x1237, 16_384);
    assert_eq!(bench.condition(), Condition::Enabled);
    bench.lead(-0.5, 0.0, 0.0);
    assert_eq!(texts(&bench.step()), ["203#0F000080FFFF", SYNC]);
}

#[test]
fn increments_gear_and_direction_are_exact() {
    let mut bench = enabled(&[
        (Parameter::DriveIncrements, 10_000.0),
        (Parameter::GearRatio, 5.0),
        (Parameter::DriveDirection, 1.0),
    ]);
    assert!((turns(bench.drive.report().position) + 16_384.0 / 50_000.0).abs() < 1e-9);
    bench.lead(1.0, 0.0, 0.0);
    // -50 000 = 0xFFFF3CB0.
    assert_eq!(texts(&bench.step()), ["203#0F00B03CFFFF", SYNC]);
}

/// 2 Nm in thousandths of the rated 5 Nm: 400. The third object is mapped, and nothing else is other than
/// for a drive that takes no torque.
#[test]
fn a_torque_offset_goes_with_the_target_where_the_drive_takes_one() {
    let torque = [
        (Parameter::RatedTorque, 5.0),
        (Parameter::DriveInertia, 0.02),
    ];
    let sent = set_up(&mut bench(&torque));
    let plain = set_up(&mut bench(&[(Parameter::DriveInertia, 0.02)]));
    assert_eq!(
        sent[5..8],
        [
            plain[5].as_str(),
            "603#230016031000B260",
            "603#2F00160003000000",
        ]
    );
    assert_eq!((&sent[..5], &sent[8..21]), (&plain[..5], &plain[7..20]));

    let mut bench = running(&torque);
    assert_eq!(texts(&bench.step()), ["203#0000004000000000", SYNC]);
    let mut bench = enabled(&torque);
    for (acceleration, told) in [
        (100.0, "9001"),
        (-100.0, "70FE"),
        // Far beyond an i16 of thousandths.
        (90_000.0, "FF7F"),
        (-90_000.0, "0080"),
    ] {
        bench.lead(-0.5, 0.0, acceleration / std::f64::consts::TAU);
        let wanted = format!("203#0F000080FFFF{told}");
        assert_eq!(texts(&bench.step()), [wanted.as_str(), SYNC]);
    }
    // Where it goes out there is none.
    tells(&mut bench, 0x0250, 16_384);
    bench.command.enable = false;
    assert_eq!(texts(&bench.step()), ["203#0000004000000000", SYNC]);
}

#[test]
fn the_speed_is_that_of_the_places() {
    let mut bench = enabled(&[]);
    for tick in 1..=100 {
        // 131 increments in 1 ms: two turns a second, nearly.
        tells(&mut bench, 0x1237, 16_384 + 131 * tick);
        bench.step();
    }
    let speed = bench.drive.report().velocity.counts() as f64 / COUNTS_PER_TURN as f64;
    assert!((speed - 131_000.0 / 65_536.0).abs() < 0.01, "{speed}");
}

#[test]
fn a_place_that_an_i32_cannot_tell_is_a_fault() {
    let mut bench = enabled(&[(Parameter::DriveIncrements, 67_108_864.0)]);
    bench.lead(40.0, 0.0, 0.0);
    // Torque off, its target where it is.
    assert_eq!(texts(&bench.step()), ["203#000000400000", SYNC]);
    assert_eq!(bench.condition(), Condition::Faulted(Trouble::Range));
}

#[test]
fn a_drive_that_drops_out_is_not_led_up_again() {
    for statusword in [0x0250, 0x0231, 0x0233, 0x0017, 0x0237] {
        let mut bench = enabled(&[]);
        tells(&mut bench, statusword, 16_384);
        assert_eq!(bench.condition(), Condition::Disabled, "{statusword:#x}");
        for _ in 0..20 {
            let sent = texts(&bench.step());
            assert!(sent[0].starts_with("203#0000"), "{sent:?}");
            tells(&mut bench, 0x0250, 16_384);
        }
        // Once the axis has taken its order back, it may.
        bench.command.enable = false;
        bench.step();
        bench.command.enable = true;
        assert!(texts(&bench.step())[0].starts_with("203#0600"));
    }
}

#[test]
fn faults_have_the_meaning_of_the_emcy() {
    for (code, trouble) in [
        (Some(0x3220u16), Trouble::Undervoltage),
        (Some(0x4210), Trouble::Temperature),
        (Some(0x8611), Trouble::Following),
        (None, Trouble::Other),
    ] {
        let mut bench = enabled(&[]);
        if let Some(code) = code {
            let [low, high] = code.to_le_bytes();
            bench.hear(EMCY, &[low, high, 4, 0, 0, 0, 0, 0]);
        }
        assert_eq!(bench.condition(), Condition::Enabled);
        tells(&mut bench, 0x021F, 16_384);
        assert_eq!(bench.condition(), Condition::Faulted(trouble));
        tells(&mut bench, 0x0218, 16_384);
        assert_eq!(bench.condition(), Condition::Faulted(trouble));
    }
    let mut bench = enabled(&[]);
    tells(&mut bench, 0x3237, 16_384);
    assert_eq!(bench.condition(), Condition::Faulted(Trouble::Following));
}

#[test]
fn a_fault_is_reset_by_a_rising_edge_when_the_axis_is_cleared() {
    let mut bench = running(&[]);
    tells(&mut bench, 0x0218, 16_384);
    assert!(
        texts(&bench.steps(3))
            .iter()
            .all(|text| !text.starts_with("203#8000"))
    );
    bench.command.reset = true;
    let mut sent = bench.step();
    bench.command.reset = false;
    sent.extend(bench.steps(3));
    let controls: Vec<_> = texts(&sent)
        .into_iter()
        .filter(|text| text.starts_with("203"))
        .collect();
    assert_eq!(
        controls
            .iter()
            .filter(|text| text.starts_with("203#8000"))
            .count(),
        1
    );
    assert_eq!(&controls[3][..8], "203#0000");
    // Nor is one lost that a full bus holds up.
    tells(&mut bench, 0x0218, 16_384);
    bench.command.reset = true;
    bench.wait(1);
    bench.command.reset = false;
    bench.wait(3);
    let sent = texts(&bench.steps(3)).join(" ");
    assert_eq!(sent.matches("203#8000").count(), 1, "{sent}");
    // A reset of a drive that has no fault does not forget a later one.
    tells(&mut bench, 0x0250, 16_384);
    bench.command.reset = true;
    bench.step();
    bench.command.reset = false;
    tells(&mut bench, 0x0218, 16_384);
    assert!(
        texts(&bench.steps(20))
            .iter()
            .all(|text| !text.starts_with("203#8000"))
    );
}

#[test]
fn one_that_begins_anew_is_set_up_anew_and_told_so() {
    let mut bench = enabled(&[]);
    bench.hear(BOOT, &[0]);
    assert_eq!(bench.condition(), Condition::Faulted(Trouble::Restart));
    bench.command.enable = false;
    let sent = set_up(&mut bench);
    assert_eq!(sent[0], PRE_OPERATIONAL);
    assert!(sent.contains(&START.into()));
    bench.step();
    tells(&mut bench, 0x0250, 5);
    assert_eq!(bench.condition(), Condition::Disabled);
}

#[test]
fn one_that_left_the_operational_state_is_set_up_anew() {
    let mut bench = running(&[]);
    // A heartbeat from before the start may still be on its way.
    bench.hear(BOOT, &[0x7F]);
    assert_eq!(bench.condition(), Condition::Disabled);
    for _ in 0..201 {
        bench.step();
        tells(&mut bench, 0x0250, 5);
    }
    bench.hear(BOOT, &[0x05]);
    assert_eq!(bench.condition(), Condition::Disabled);
    bench.hear(BOOT, &[0x7F]);
    assert_eq!(bench.condition(), Condition::Lost);
    assert_eq!(set_up(&mut bench)[0], PRE_OPERATIONAL);
}

#[test]
fn a_refused_write_is_a_fault_that_is_tried_again() {
    let mut bench = bench(&[]);
    bench.step();
    // Another object's refusal, and another node's, are not this one's.
    bench.hear(SDO_ANSWER, &[0x80, 0x41, 0x60, 0, 0, 0, 2, 6]);
    assert!(
        bench
            .ignores(0x584, &[0x80, 0x40, 0x60, 0, 0, 0, 2, 6])
            .is_some()
    );
    assert_eq!(bench.condition(), Condition::Lost);
    bench.hear(SDO_ANSWER, &[0x80, 0x40, 0x60, 0, 0, 0, 2, 6]);
    assert_eq!(bench.condition(), Condition::Faulted(Trouble::Setup));
    assert_eq!(bench.steps(999), []);
    assert_eq!(set_up(&mut bench)[0], PRE_OPERATIONAL);
    tells(&mut bench, 0x0250, 0);
    bench.step();
    assert_eq!(bench.condition(), Condition::Disabled);
}

#[test]
fn one_that_is_not_there_is_asked_ten_times_a_second() {
    let mut bench = bench(&[]);
    let sent = texts(&bench.steps(1_000));
    assert_eq!(sent.len(), 20);
    assert_eq!(
        sent.iter().filter(|text| *text == PRE_OPERATIONAL).count(),
        10
    );
    assert_eq!(bench.condition(), Condition::Lost);
}

#[test]
fn silence_is_a_loss() {
    let mut bench = enabled(&[]);
    bench.steps(48);
    assert_eq!(bench.condition(), Condition::Enabled);
    bench.steps(3);
    assert_eq!(bench.condition(), Condition::Lost);
    // It comes back: nothing goes on by itself.
    tells(&mut bench, 0x0250, 16_384);
    assert_eq!(bench.condition(), Condition::Disabled);
}
