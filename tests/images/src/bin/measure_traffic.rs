//! Counts what a node of four moving axes takes of its processor in one second, with what a bus
//! carries meanwhile: SYNC, heartbeats, moves and their plans, and another leg's traffic.
//!
//! Everything that a board's tasks call of the core is counted, at whatever priority: frames, ticks,
//! plans and what is sent. The interrupts and the executor around it are not.
#![no_std]
#![no_main]

use core::hint::black_box;

use canter_images::{Spread, count, finish, report};
use canter_shared::drive::simulated::Simulated;
use canter_shared::limits::Limits;
use canter_shared::node::{Board, Identity, Node};
use canter_shared::time::{BusTime, LocalTime, Ticks};
use canter_shared::units::{COUNTS_PER_TURN, Position, Velocity};
use canter_shared::wire::command::{Action, Command, ProfileKind, Session};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;
use cortex_m_rt::entry;

const SESSION: Session = 1;

/// Axes of the node: 1 to 4.
const AXES: usize = 4;

/// Axes of other nodes, from 5 on, whose frames arrive here too.
const OTHERS: u8 = 8;

/// Ticks that are counted: one second.
const TICKS: u32 = 1_000;

/// Ticks before that, for the axes to be enabled and to get moving.
const BEFORE: u32 = 200;

/// Ticks between two SYNCs and between two heartbeats of the host: 50 and 10 Hz.
const SYNC: u32 = 20;
const BEAT: u32 = 100;

/// Ticks between two feedbacks and two heartbeats of another axis: 50 and 10 Hz.
const FEEDBACK: u32 = 20;
const HEARTBEAT: u32 = 100;

/// Ticks between two moves of one axis: each of them is a retarget in mid-move.
const MOVE: u32 = 200;

/// Ticks between two moves that the host sends to each of the other axes, and their answers.
const OTHER_MOVE: u32 = 125;

/// Ticks between two knots of one axis: 100 Hz.
const KNOT: u32 = 10;

#[entry]
fn main() -> ! {
    let mut bench = Bench::new();
    for _ in 0..BEFORE {
        bench.tick();
    }
    bench.counts = Counts::default();
    for _ in 0..TICKS {
        bench.tick();
    }
    bench.counts.report();
    finish()
}

/// Instructions of the second, by what they are for.
#[derive(Default)]
struct Counts {
    ticks: Spread,
    frames: Spread,
    plans: Spread,
    sends: Spread,
    /// Ticks in which an axis moved, over all axes.
    moving: u32,
    accepted: u32,
    refused: u32,
}

impl Counts {
    fn report(&self) {
        let parts = [
            ("ticks", &self.ticks),
            ("frames", &self.frames),
            ("plans", &self.plans),
            ("sends", &self.sends),
        ];
        for (name, part) in parts {
            report(format_args!("traffic.{name}"), part.sum());
        }
        self.ticks.report("traffic.tick");
        report("traffic.received", self.frames.counts());
        report("traffic.moving", self.moving);
        report("traffic.accepted", self.accepted);
        report("traffic.refused", self.refused);
        let whole = parts.iter().map(|(_, part)| part.sum()).sum::<u32>();
        report("traffic.instructions", whole);
    }
}

struct Bench {
    node: Node<Simulated, AXES>,
    tick: u32,
    sequence: u8,
    counts: Counts,
}

fn axes() -> impl Iterator<Item = AxisId> {
    (1..=AXES as u8).filter_map(AxisId::new)
}

fn others() -> impl Iterator<Item = AxisId> {
    (1..=OTHERS).filter_map(|other| AxisId::new(AXES as u8 + other))
}

impl Bench {
    fn new() -> Self {
        let mut node = Node::new(Identity {
            chip: [0; 12],
            firmware: [0; 3],
            board: Board::Emulated,
        });
        for axis in axes() {
            let added = node.add_axis(axis, Limits::default(), Simulated::new(Position::ZERO));
            assert!(added.is_ok(), "a node has room for its axes");
        }
        Self {
            node,
            tick: 0,
            sequence: 0,
            counts: Counts::default(),
        }
    }

    /// One tick, with what arrives around it.
    fn tick(&mut self) {
        let now = self.node.next_tick();
        let node = &mut self.node;
        // As `canter_firmware::control::run` does it.
        self.counts.ticks.add(count(|| {
            black_box(node.next_tick());
            node.tick(black_box(now));
            (node.has_plan(), node.stop_overdue())
        }));
        self.plan();
        self.send(now);
        self.hear_host(now);
        self.hear_others(now);
        let moving = self.node.axes().filter(|axis| axis.is_moving()).count();
        self.counts.moving += moving as u32;
        self.tick += 1;
    }

    /// Whether what comes once in `period` ticks is due for the axis, each at its own tick.
    fn is_due(&self, period: u32, axis: AxisId) -> bool {
        let stagger = 7 * u32::from(axis.get());
        (self.tick + stagger).is_multiple_of(period)
    }

    fn hear_host(&mut self, now: LocalTime) {
        if self.tick.is_multiple_of(SYNC) {
            let time = BusTime(now.0);
            let counter = (self.tick / SYNC) as u8;
            self.say(now, Address::All, Command::Sync { counter, time });
        }
        if self.tick.is_multiple_of(BEAT) {
            let session = SESSION;
            self.say(now, Address::All, Command::HostHeartbeat { session });
        }
        for axis in axes() {
            let address = Address::Axis(axis);
            match self.tick {
                1 => self.control(now, address, Action::Hold),
                2 => self.control(now, address, Action::Enable),
                0..20 => {}
                _ if self.is_due(MOVE, axis) => {
                    let command = self.next_move(axis);
                    self.say(now, address, command);
                }
                _ => {}
            }
            if self.is_due(KNOT, axis)
                && let Some(command) = self.next_knot(axis)
            {
                self.say(now, address, command);
            }
        }
    }

    /// Betas laid over each other, trapezoids, s-curves and betas again, to and fro.
    fn next_move(&mut self, axis: AxisId) -> Command {
        let profile = match axis.get() {
            2 => ProfileKind::Trapezoid,
            3 => ProfileKind::SCurve,
            _ => ProfileKind::Beta,
        };
        let step = i64::from(self.tick / MOVE % 4);
        self.sequence = self.sequence.wrapping_add(1);
        Command::Move {
            profile,
            staged: false,
            target: Position::from_counts((step + 1) * COUNTS_PER_TURN / 8),
            duration: Ticks(600),
            sequence: self.sequence,
        }
    }

    /// The next knot of an axis that streams: none, as long as no frame carries knots.
    fn next_knot(&mut self, _axis: AxisId) -> Option<Command> {
        None
    }

    fn control(&mut self, now: LocalTime, address: Address, action: Action) {
        self.sequence = self.sequence.wrapping_add(1);
        let command = Command::Control {
            action,
            sequence: self.sequence,
            session: SESSION,
        };
        self.say(now, address, command);
    }

    /// What the other axes send, and what the host sends to them.
    fn hear_others(&mut self, now: LocalTime) {
        for axis in others() {
            let position = Position::from_counts(i64::from(self.tick) * 1_000_003);
            if self.is_due(FEEDBACK, axis) {
                let report = Report::Feedback {
                    position,
                    velocity: Velocity::from_counts(COUNTS_PER_TURN),
                    state: 5,
                    moving: true,
                    target_reached: false,
                };
                self.hear(now, &report.encode(axis));
            }
            if self.is_due(HEARTBEAT, axis) {
                let report = Report::Heartbeat {
                    state: 5,
                    fault: 0,
                    session: SESSION,
                    bus_off: 0,
                    error_frames: 0,
                    lost: 0,
                    rejected: 0,
                };
                self.hear(now, &report.encode(axis));
            }
            if self.is_due(OTHER_MOVE, axis) {
                let sequence = self.tick as u8;
                let command = Command::Move {
                    profile: ProfileKind::Beta,
                    staged: false,
                    target: position,
                    duration: Ticks(600),
                    sequence,
                };
                let function = command.function();
                self.say(now, Address::Axis(axis), command);
                let report = Report::Acknowledgement {
                    sequence,
                    function,
                    reason: Reason::Accepted,
                    detail: 600,
                };
                self.hear(now, &report.encode(axis));
            }
        }
    }

    fn say(&mut self, now: LocalTime, address: Address, command: Command) {
        let Ok(frame) = command.encode(address) else {
            panic!("{command:?} does not fit a frame")
        };
        self.hear(now, &frame);
    }

    /// One frame, as a board's tasks take it: handled, planned where it asks for it, answered.
    fn hear(&mut self, now: LocalTime, frame: &Frame) {
        let node = &mut self.node;
        // As `canter_firmware::bus::receive` does it.
        self.counts.frames.add(count(|| {
            let before = black_box(node.next_tick());
            node.handle_frame(black_box(now), black_box(frame));
            (node.next_tick() != before, node.has_plan())
        }));
        self.plan();
        self.send(now);
    }

    fn plan(&mut self) {
        let node = &mut self.node;
        self.counts.plans.add(count(|| {
            while let Some(plan) = node.take_plan(Ticks(1)) {
                node.commit(&plan.work());
            }
        }));
    }

    fn send(&mut self, now: LocalTime) {
        loop {
            let node = &mut self.node;
            let mut frame = None;
            let sends = count(|| frame = node.poll_transmit(black_box(now)));
            self.counts.sends.add(sends);
            let Some(frame) = frame else {
                return;
            };
            if let Ok(Some((_, Report::Acknowledgement { reason, .. }))) = Report::decode(&frame) {
                let accepted = u32::from(reason == Reason::Accepted);
                self.counts.accepted += accepted;
                self.counts.refused += 1 - accepted;
            }
        }
    }
}
