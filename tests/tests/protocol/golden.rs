//! One frame or more of each kind, byte for byte, and what the codec makes of it.

use canter::dbc::message_name;
use canter_shared::parameter::Parameter;
use canter_shared::time::{BusTime, Tick, Ticks};
use canter_shared::units::{Acceleration, Jerk, Position, Velocity};
use canter_shared::wire::ProtocolVersion;
use canter_shared::wire::command::{Action, AssignPart, Command, Item, ProfileKind};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId, Function, split};
use canter_shared::wire::layout::{LAYOUTS, Layout};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::{IdentityPart, Report};
use canter_tests::root;

/// A line of the file.
pub struct Golden {
    /// The frame's name in canter.dbc.
    pub message: String,
    /// As cansend takes it: `207#00002000A00F0003`.
    pub text: String,
    /// The same as a frame.
    pub frame: Frame,
    /// The fields that it has, and their raw values.
    pub raw: Vec<(String, i64)>,
    /// In words.
    pub meaning: String,
}

/// Reads `207#00002000A00F0003`.
pub fn parse(text: &str) -> Option<Frame> {
    let (id, hex) = text.split_once('#')?;
    let bytes = hex.len().is_multiple_of(2).then_some(hex.len() / 2)?;
    let byte = |at: usize| u8::from_str_radix(hex.get(2 * at..2 * at + 2)?, 16).ok();
    let data = (0..bytes).map(byte).collect::<Option<Vec<u8>>>()?;
    let id = u16::from_str_radix(id, 16).ok().filter(|_| id.len() == 3)?;
    Frame::new(id, &data)
}

/// The reverse of [`parse`].
pub fn text(frame: &Frame) -> String {
    let bytes = frame.data().iter().map(|byte| format!("{byte:02X}"));
    format!("{:03X}#{}", frame.id(), bytes.collect::<String>())
}

/// The file's lines.
pub fn read() -> Vec<Golden> {
    let path = root().join("tests/golden/frames.tsv");
    let file = std::fs::read_to_string(path).expect("tests/golden/frames.tsv is there");
    let lines = file.lines().skip(1);
    let goldens = lines.map(|line| {
        let cells: Vec<_> = line.split('\t').collect();
        let [message, text, raw, meaning] = cells[..] else {
            panic!("four columns: {line}");
        };
        let fields = raw.split(' ').filter(|raw| *raw != "-").map(|raw| {
            let (name, value) = raw.split_once('=').expect("fields are name=value");
            (name.to_owned(), value.parse().expect("a whole number"))
        });
        Golden {
            message: message.to_owned(),
            text: text.to_owned(),
            frame: parse(text).unwrap_or_else(|| panic!("no frame: {text}")),
            raw: fields.collect(),
            meaning: meaning.to_owned(),
        }
    });
    goldens.collect()
}

enum Said {
    Host(Address, Command),
    Node(Report),
}

fn seven() -> AxisId {
    AxisId::new(7).expect("7 is an axis")
}

/// What the lines of the file mean, in their order.
fn said() -> Vec<Said> {
    const SESSION: u16 = 0xC0DE;
    let all = |command| Said::Host(Address::All, command);
    let axis = |command| Said::Host(Address::Axis(seven()), command);
    let control = |action, sequence| {
        axis(Command::Control {
            action,
            sequence,
            session: SESSION,
        })
    };
    let moves = |profile, staged, counts, milliseconds, sequence| {
        axis(Command::Move {
            profile,
            staged,
            target: Position::from_counts(counts),
            duration: Ticks(milliseconds),
            sequence,
        })
    };
    let answer = |sequence, function, reason, detail| {
        Said::Node(Report::Acknowledgement {
            sequence,
            function,
            reason,
            detail,
        })
    };
    const TURN: i64 = 1 << 32;
    const STEP: i64 = 1 << 9;
    vec![
        all(Command::EmergencyStop),
        axis(Command::EmergencyStop),
        all(Command::Sync {
            counter: 5,
            time: BusTime(3_600_000_001),
        }),
        all(Command::Trigger {
            group: 4,
            session: SESSION,
            start: Tick(3_600_500),
        }),
        axis(Command::Knot {
            position: Position::from_counts(TURN / 4),
            velocity: Velocity::from_counts(-TURN / 2),
            number: 5,
        }),
        all(Command::Stop { sequence: 9 }),
        axis(Command::Stop { sequence: 10 }),
        all(Command::HostHeartbeat { session: SESSION }),
        control(Action::Hold, 1),
        control(Action::Enable, 2),
        control(Action::Disable, 5),
        control(Action::Release, 6),
        axis(Command::TrapezoidShape {
            acceleration: Ticks(250),
            deceleration: Ticks(400),
            sequence: 11,
        }),
        moves(ProfileKind::Beta, false, TURN / 4, 1_000, 3),
        moves(ProfileKind::Trapezoid, false, -TURN * 3 / 2, 2_000, 12),
        moves(ProfileKind::SCurve, false, TURN * 3 / 2, 500, 14),
        axis(Command::RampLimits {
            acceleration: Acceleration::from_counts(20 * TURN),
            deceleration: Acceleration::from_counts(10 * TURN),
            sequence: 15,
        }),
        moves(
            ProfileKind::Beta,
            true,
            1_000 * TURN - STEP,
            (1 << 22) - 1,
            4,
        ),
        moves(ProfileKind::Trapezoid, true, -STEP, 3, 4),
        moves(ProfileKind::SCurve, true, -TURN / 2, 1_500, 17),
        axis(Command::PeakLimits {
            velocity: Velocity::from_counts(2 * TURN),
            jerk: Jerk::from_counts(2_000 * TURN),
            sequence: 16,
        }),
        answer(1, Function::Control, Reason::Accepted, 0),
        answer(2, Function::Control, Reason::Accepted, 0),
        answer(3, Function::MoveBeta, Reason::Accepted, 1_000),
        answer(3, Function::MoveBeta, Reason::TooFast, 228),
        Said::Node(Report::Started {
            sequence: 3,
            time: BusTime(3_600_001_005),
        }),
        Said::Node(Report::Fault {
            fault: 2,
            time: BusTime(3_601_250_000),
        }),
        axis(Command::StreamBegin {
            start: Tick(3_600_500),
            period: 20,
            number: 4,
            sequence: 18,
        }),
        Said::Node(Report::Feedback {
            position: Position::from_counts(-TURN / 4),
            velocity: Velocity::from_counts(-TURN / 2),
            state: 4,
            moving: true,
            target_reached: false,
        }),
        Said::Node(Report::Feedback {
            position: Position::from_counts(TURN / 4),
            velocity: Velocity::ZERO,
            state: 4,
            moving: false,
            target_reached: true,
        }),
        Said::Node(Report::Heartbeat {
            state: 7,
            fault: 2,
            session: 0,
            bus_off: 1,
            error_frames: 2,
            lost: 3,
            rejected: 4,
        }),
        Said::Node(Report::Heartbeat {
            state: 4,
            fault: 0,
            session: SESSION,
            bus_off: 0,
            error_frames: 0,
            lost: 0,
            rejected: 0,
        }),
        axis(Command::ParameterRead {
            parameter: Parameter::VelocityLimit.into(),
            item: Item::Default,
        }),
        axis(Command::ParameterWrite {
            parameter: Parameter::VelocityLimit.into(),
            value: 12_500_000_000,
            sequence: 19,
        }),
        axis(Command::ParameterWrite {
            parameter: Parameter::PositionMinimum.into(),
            value: -1_600_000_000,
            sequence: 20,
        }),
        Said::Node(Report::Parameter {
            parameter: Parameter::VelocityLimit.into(),
            item: Item::Default,
            value: 20_000_000_000,
        }),
        all(Command::IdentityRequest),
        Said::Node(Report::Identity(IdentityPart::Version {
            protocol: ProtocolVersion { major: 1, minor: 2 },
            board: 16,
            firmware: [0, 1, 2],
        })),
        Said::Node(Report::Identity(IdentityPart::ChipFirst([
            1, 2, 3, 4, 5, 6,
        ]))),
        Said::Node(Report::Identity(IdentityPart::ChipLast([
            7, 8, 9, 10, 11, 12,
        ]))),
        all(Command::Assign(AssignPart::ChipFirst([1, 2, 3, 4, 5, 6]))),
        all(Command::Assign(AssignPart::ChipLast([7, 8, 9, 10, 11, 12]))),
        all(Command::Assign(AssignPart::Axis {
            axis: 7,
            new_axis: 9,
            sequence: 21,
        })),
    ]
}

#[test]
fn the_codec_writes_and_reads_the_golden_frames() {
    let goldens = read();
    let said = said();
    assert_eq!(goldens.len(), said.len(), "as many lines as meanings");
    for (golden, said) in goldens.iter().zip(said) {
        let (encoded, command, report) = match said {
            Said::Host(address, command) => {
                let encoded = command.encode(address).expect("every value fits");
                (encoded, Some((address, command)), None)
            }
            Said::Node(report) => (report.encode(seven()), None, Some((seven(), report))),
        };
        assert_eq!(text(&encoded), golden.text, "{}", golden.meaning);
        assert_eq!(
            Command::decode(&golden.frame),
            Ok(command),
            "{}",
            golden.text
        );
        assert_eq!(Report::decode(&golden.frame), Ok(report), "{}", golden.text);
    }
}

#[test]
fn the_table_of_fields_reads_the_golden_frames() {
    for golden in read() {
        let (function, address) = split(golden.frame.id()).expect("a known function");
        assert_eq!(golden.message, message_name(function, address));
        let layout = Layout::of(function).expect("a known function");
        assert_eq!(golden.frame.data().len(), usize::from(layout.length));
        let word = golden.frame.word();
        let part = layout.fields.first().map(|first| first.get(word));
        let present = |part_of: Option<u8>| part_of.is_none() || part_of.map(i64::from) == part;
        let read: Vec<_> = layout
            .fields
            .iter()
            .filter(|field| present(field.part))
            .map(|field| (field.name.to_owned(), field.get(word)))
            .collect();
        assert_eq!(read, golden.raw, "{}", golden.text);
    }
}

#[test]
fn every_kind_of_frame_has_a_golden_one() {
    let goldens = read();
    let texts: Vec<_> = goldens.iter().map(|golden| &golden.text).collect();
    for (index, text) in texts.iter().enumerate() {
        assert!(!texts[..index].contains(text), "{text} is there twice");
    }
    for layout in &LAYOUTS {
        let of_this = |golden: &&Golden| {
            split(golden.frame.id()).is_some_and(|(function, _)| function == layout.function)
        };
        let count = goldens.iter().filter(of_this).count();
        let parts = layout.fields.iter().filter_map(|field| field.part);
        let needed = parts.max().map_or(1, |last| usize::from(last) + 1);
        assert!(count >= needed, "{:?}: {count} frames", layout.function);
    }
}
