//! Whatever a drive says, and whatever the axis wants of it.

use super::bench::{Bench, settings};
use canter_shared::drive::link::DriveLink;
use canter_shared::drive::mit::EXIT;
use canter_shared::drive::settings::DriveKind;
use canter_shared::drive::{Condition, Drive};
use canter_shared::parameter::Parameter;
use canter_shared::wire::frame::Frame;
use proptest::prelude::*;

/// Something that happens to a link.
#[derive(Debug, Clone)]
enum Event {
    /// So many ticks.
    Pass(u8),
    /// The axis changes its mind.
    Want {
        enable: bool,
        reset: bool,
        turns: f64,
    },
    /// A frame comes.
    Hear { id: u16, data: Vec<u8> },
}

/// Frames that mean something to the drive of id 3 of each kind, more often than chance would have them.
fn frames() -> impl Strategy<Value = Event> {
    let ids = prop_oneof![
        prop::sample::select(vec![0x061, 0x069, 0, 3, 0x083, 0x183, 0x583, 0x703]),
        0u16..0x800,
    ];
    let byte = || {
        prop_oneof![
            prop::sample::select(vec![0, 1, 3, 8, 0x37, 0x12, 0x60, 0x80, 0xFF]),
            any::<u8>()
        ]
    };
    let any_data = prop::collection::vec(byte(), 0..=8);
    let known = prop::sample::select(vec![
        // Heartbeats and estimates of an ODrive, answers of the others.
        (0x061, vec![0, 0, 0, 0, 1, 0, 0, 0]),
        (0x061, vec![0, 0, 0, 0, 8, 0, 0, 0]),
        (0x069, vec![0, 0, 0x80, 0x3E, 0, 0, 0, 0]),
        (3, vec![3, 0x80, 0, 0x7F, 0xF7, 0xFF, 30, 0]),
        (3, vec![3, 0x80, 0, 0x7F, 0xF7, 0xFF, 30, 2]),
        (0x183, vec![0x50, 0x02, 0, 0x40, 0, 0]),
        (0x183, vec![0x31, 0x02, 0, 0x40, 0, 0]),
        (0x183, vec![0x33, 0x02, 0, 0x40, 0, 0]),
        (0x183, vec![0x37, 0x12, 0, 0x40, 0, 0]),
        (0x183, vec![0x18, 0x02, 0, 0x40, 0, 0]),
        (0x703, vec![0]),
        (0x703, vec![0x7F]),
    ]);
    prop_oneof![
        (ids, any_data).prop_map(|(id, data)| Event::Hear { id, data }),
        known.prop_map(|(id, data)| Event::Hear { id, data }),
    ]
}

fn events() -> impl Strategy<Value = Vec<Event>> {
    let want = (any::<bool>(), any::<bool>(), -3.0..3.0f64).prop_map(|(enable, reset, turns)| {
        Event::Want {
            enable,
            reset,
            turns,
        }
    });
    let event = prop_oneof![
        2 => (1u8..60).prop_map(Event::Pass),
        1 => want,
        5 => frames(),
    ];
    prop::collection::vec(event, 1..200)
}

/// Whether a frame gives torque, or leads on to it.
fn enables(frame: &Frame) -> bool {
    match (frame.id(), frame.data().len()) {
        (0x067, _) => frame.word() == 8,
        (3, _) => frame.word() != EXIT,
        (0x203, _) => frame.word() & 0x0F != 0,
        _ => false,
    }
}

fn holds(kind: DriveKind, events: &[Event]) -> Result<(), TestCaseError> {
    let changes = [(Parameter::MitMaster, 1.0)];
    let mut bench = Bench::new(DriveLink::new(&settings(kind, 3, &changes)));
    for event in events {
        match event {
            Event::Want {
                enable,
                reset,
                turns,
            } => {
                bench.lead(*turns, 0.0, 0.0);
                (bench.command.enable, bench.command.reset) = (*enable, *reset);
            }
            Event::Hear { id, data } => {
                let frame = Frame::new(*id, data).expect("a frame");
                bench.drive.receive(&frame);
            }
            Event::Pass(ticks) => {
                for _ in 0..*ticks {
                    let sent = bench.step();
                    // What a drive is asked about it also answers, so that all of them get somewhere.
                    for frame in sent.iter().filter(|frame| frame.id() == 0x603) {
                        let mut answer = [0; 8];
                        answer[..4].copy_from_slice(&frame.data()[..4]);
                        answer[0] = 0x60;
                        let answer = Frame::new(0x583, &answer).expect("a frame");
                        bench.drive.receive(&answer);
                    }
                    let condition = bench.condition();
                    if !bench.command.enable {
                        prop_assert!(!sent.iter().any(enables), "{:02x?}", sent);
                        prop_assert_ne!(condition, Condition::Enabled);
                    }
                    if matches!(condition, Condition::Lost) && kind == DriveKind::Cia402 {
                        prop_assert!(!sent.iter().any(enables), "{:02x?}", sent);
                    }
                }
            }
        }
    }
    Ok(())
}

proptest! {
    /// No frame makes a link panic, or give torque that nobody wants.
    #[test]
    fn nobody_but_the_axis_gives_torque(events in events()) {
        for kind in [DriveKind::Odrive, DriveKind::Mit, DriveKind::Cia402] {
            holds(kind, &events)?;
        }
    }
}
