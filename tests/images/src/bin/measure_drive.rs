//! Counts the instructions of four axes that move, with links to real drives: their ticks, what they send
//! to the drives at each, and what the drives answer.
#![no_std]
#![no_main]

use core::hint::black_box;

use canter_images::{Spread, count, finish, report};
use canter_shared::drive::link::DriveLink;
use canter_shared::drive::settings::DriveKind;
use canter_shared::node::{Board, Identity, Node};
use canter_shared::parameter::{Parameter, Values};
use canter_shared::time::Ticks;
use canter_shared::units::{COUNTS_PER_TURN, Position};
use canter_shared::wire::command::{Action, Command, ProfileKind};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId};
use cortex_m_rt::entry;

const AXES: usize = 4;
const SESSION: u16 = 1;

/// Ticks that are measured, after those in which the drives are found and enabled.
const BEFORE: u32 = 600;
const TICKS: u32 = 1_000;

#[entry]
fn main() -> ! {
    for (kind, name) in [
        (DriveKind::Odrive, "odrive"),
        (DriveKind::Mit, "mit"),
        (DriveKind::Cia402, "cia402"),
    ] {
        measure(kind, name);
    }
    report("drive.bytes", size_of::<DriveLink>() as u32);
    finish()
}

fn axes() -> impl Iterator<Item = AxisId> {
    (1..=AXES as u8).filter_map(AxisId::new)
}

fn values(axis: AxisId, kind: DriveKind) -> Values {
    let mut values = Values::defaults(axis.get());
    for (parameter, value) in [
        (Parameter::GearRatio, 6.0),
        (Parameter::DriveInertia, 0.001),
        (Parameter::MitModel, 6.0),
        (Parameter::DriveKind, f64::from(u8::from(kind))),
    ] {
        let raw = parameter.nearest(value).unwrap_or_default();
        if let Ok((changed, _)) = values.with(parameter, raw) {
            values = changed;
        }
    }
    values
}

struct Bench {
    node: Node<DriveLink, AXES>,
    kind: DriveKind,
    tick: u32,
    sequence: u8,
    ticks: Spread,
    sends: Spread,
    answers: Spread,
    whole: Spread,
    moving: u32,
}

fn measure(kind: DriveKind, name: &str) {
    let mut node = Node::new(Identity {
        chip: [0; 12],
        firmware: [0; 3],
        board: Board::Emulated,
    });
    for axis in axes() {
        let values = values(axis, kind);
        let added = node.add_axis_with_values(axis, &values, DriveLink::new(&values.drive()));
        assert!(added.is_ok(), "a node has room for its axes");
    }
    let mut bench = Bench {
        node,
        kind,
        tick: 0,
        sequence: 0,
        ticks: Spread::new(),
        sends: Spread::new(),
        answers: Spread::new(),
        whole: Spread::new(),
        moving: 0,
    };
    for _ in 0..BEFORE + TICKS {
        bench.tick();
    }
    for (part, spread) in [
        ("tick", &bench.ticks),
        ("send", &bench.sends),
        ("answer", &bench.answers),
        ("whole", &bench.whole),
    ] {
        spread.report(format_args!("drive.{name}.{part}"));
    }
    report(format_args!("drive.{name}.moving"), bench.moving);
}

impl Bench {
    fn tick(&mut self) {
        let measured = self.tick >= BEFORE;
        let now = self.node.next_tick();
        let node = &mut self.node;
        let tick = count(|| node.tick(black_box(now)).len());
        // Room for all that is sent in a tick.
        let mut sent = [None::<Frame>; 4 * AXES];
        let mut many = 0;
        let send = count(|| {
            while let Some(frame) = node.poll_drive_transmit() {
                if let Some(place) = sent.get_mut(many) {
                    *place = Some(frame);
                    many += 1;
                }
            }
        });
        let mut answers = 0;
        for frame in sent.into_iter().flatten() {
            answers += self.answer(&frame);
        }
        if self.kind == DriveKind::Odrive {
            for axis in 1..=AXES as u16 {
                // Where it is at each tick, and how it is ten times in a second.
                answers += self.hear(axis << 5 | 0x09, &[0, 0, 0x80, 0x3E, 0, 0, 0x40, 0x40]);
                if (self.tick + 7 * u32::from(axis)).is_multiple_of(100) {
                    let state = if self.tick < 150 { 1 } else { 8 };
                    answers += self.hear(axis << 5 | 0x01, &[0, 0, 0, 0, state, 0, 0, 0]);
                }
            }
        }
        if measured {
            self.ticks.add(tick);
            self.sends.add(send);
            self.answers.add(answers);
            self.whole.add(tick + send + answers);
            let moving = self.node.axes().filter(|axis| axis.is_moving()).count();
            self.moving += moving as u32;
        }
        while self.node.poll_transmit(now).is_some() {}
        self.host();
        self.node.plan();
        self.tick += 1;
    }

    fn hear(&mut self, id: u16, data: &[u8]) -> u32 {
        let node = &mut self.node;
        let Some(frame) = Frame::new(id, data) else {
            return 0;
        };
        count(|| node.handle_drive_frame(black_box(&frame)))
    }

    /// What a drive says to a frame.
    fn answer(&mut self, frame: &Frame) -> u32 {
        let id = frame.id();
        let said = frame.data();
        match self.kind {
            DriveKind::Mit => self.hear(id, &[id as u8, 0x80, 0x12, 0x7F, 0xF7, 0xFF, 30, 0]),
            DriveKind::Cia402 if id & !0x7F == 0x600 => {
                let mut answer = [0x60, 0, 0, 0, 0, 0, 0, 0];
                for (to, from) in answer.iter_mut().zip(said).skip(1).take(3) {
                    *to = *from;
                }
                self.hear(id - 0x80, &answer)
            }
            DriveKind::Cia402 if id == 0x080 => {
                let status = match self.tick {
                    0..200 => [0x50, 0x02],
                    200..220 => [0x31, 0x02],
                    220..240 => [0x33, 0x02],
                    _ => [0x37, 0x12],
                };
                let axes = 1..=AXES as u16;
                let place = [status[0], status[1], 0, 0x40, 0, 0];
                axes.map(|axis| self.hear(0x180 + axis, &place)).sum()
            }
            _ => 0,
        }
    }

    fn host(&mut self) {
        if self.tick.is_multiple_of(50) {
            self.say(Address::All, Command::HostHeartbeat { session: SESSION });
        }
        for axis in axes() {
            let address = Address::Axis(axis);
            let sequence = self.sequence.wrapping_add(1);
            let session = SESSION;
            let control = |action| Command::Control {
                action,
                sequence,
                session,
            };
            let command = match self.tick {
                // Those watch a drive that stands still in these tests.
                40 => control(Action::Hold),
                41 => control(Action::Configure),
                42 => silent(Parameter::FollowingError, sequence),
                43 => silent(Parameter::OverspeedMargin, sequence),
                130 => control(Action::Enable),
                tick if tick > 500 && tick.is_multiple_of(100) => {
                    let turns = i64::from(tick / 100 % 2) * COUNTS_PER_TURN / 8;
                    Command::Move {
                        profile: ProfileKind::Beta,
                        staged: false,
                        target: Position::from_counts(turns),
                        duration: Ticks(400),
                        sequence,
                    }
                }
                _ => continue,
            };
            self.sequence = sequence;
            self.say(address, command);
        }
    }

    fn say(&mut self, address: Address, command: Command) {
        let now = self.node.next_tick();
        if let Ok(frame) = command.encode(address) {
            self.node.handle_frame(now, &frame);
        }
    }
}

fn silent(parameter: Parameter, sequence: u8) -> Command {
    Command::ParameterWrite {
        parameter: parameter.into(),
        value: 0,
        sequence,
    }
}
