//! A host, a node of three axes and their drives on two buses, in true time to the nanosecond.

use std::collections::VecDeque;

use canter::bus::Bitrate;
use canter::drive_model::{Make, Model, OdriveModel, Station, model};
use canter::sim::{Passed, Segment, TrueTime};
use canter_shared::axis::state::State;
use canter_shared::drive::link::DriveLink;
use canter_shared::drive::settings::{DriveKind, OdriveFirmware};
use canter_shared::limits::Limits;
use canter_shared::node::{Board, Identity, Node, TICK_LEAD};
use canter_shared::parameter::{Parameter, Values};
use canter_shared::time::{LocalTime, Ticks};
use canter_shared::units::{COUNTS_PER_TURN, Position};
use canter_shared::wire::command::{Action, Command, ProfileKind};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId};

pub const AXES: usize = 3;

/// Nanoseconds of a tick.
const TICK: u64 = 1_000_000;

/// From a tick to its frames in the controller: at 170 MHz three axes take the 1500 instructions each that a
/// tick may take in some 27 us.
pub const HANDING_OVER: u64 = 30_000;

/// What a tick runs ahead of its instant.
pub const LEAD: u64 = TICK_LEAD * 1_000;

/// Frames that the node's controller takes over: the three buffers of an FDCAN, sent in their order.
const ROOM: usize = 3;

/// On either bus the node is this station. On the hosts' bus the host is the other, on the drives' bus the
/// drives follow it.
const NODE: usize = 0;
const HOST: usize = 1;

/// By how much the node's crystal is fast, in parts of 10^6, and what its clock shows when the host's shows 0.
const NODE_FAST: u64 = 50;
const NODE_AHEAD: u64 = 5_000_000;

/// What a drive turns, in kg m^2: its setpoints have a torque.
const INERTIA: f64 = 0.002;

/// Where the drives stand when it begins, in turns.
const START: f64 = 0.3;

/// Ticks of a move, and how far it goes, in turns.
const MOVE: u64 = 500;
const WAY: f64 = 0.4;

/// The drives of a bus, and when they speak.
#[derive(Debug, Clone, Copy)]
pub struct Setup {
    pub kind: DriveKind,
    /// Milliseconds between two estimates of an ODrive.
    pub estimates: u32,
    /// When each drive's millisecond begins after the tick, in nanoseconds.
    pub phases: [u64; AXES],
    /// By how much each drive's crystal is fast, in parts of 10^6.
    pub fast: [i64; AXES],
    /// From the end of a frame to the answer in the drive's controller, in nanoseconds.
    pub reaction: u64,
    /// The drive's id of each axis.
    pub ids: [u8; AXES],
    /// Of a CiA 402 drive's motor, in Nm; 0 where it takes no torque.
    pub rated_torque: f64,
}

/// A setpoint that was on the wire.
#[derive(Debug, Clone, Copy)]
pub struct Sent {
    /// Which of the axes, counted from 0.
    pub axis: usize,
    /// Nanoseconds from the instant of its tick to its first bit and behind its last.
    pub start: i64,
    pub end: i64,
}

struct Drive {
    station: Station,
    next: u64,
    period: u64,
}

pub struct Rig {
    setup: Setup,
    node: Node<DriveLink, AXES>,
    drives: Vec<Drive>,
    hosts_bus: Segment,
    drives_bus: Segment,
    now: u64,
    /// When the last tick ran, and when what it left for the drives is handed over.
    tick: u64,
    handed: Option<u64>,
    /// When the ticks ran that the frames with the node's controller are of.
    waiting: VecDeque<u64>,
    /// Answers that drives are about to give, in the order of their times.
    answers: VecDeque<(u64, usize, Frame)>,
    /// What the host says, and when.
    said: VecDeque<(u64, Frame)>,
    next_beat: u64,
    beats: u64,
    sequence: u8,
    pub sent: Vec<Sent>,
    pub moving: u64,
    pub ticks: u64,
}

impl Rig {
    pub fn new(setup: &Setup) -> Self {
        let mut node = Node::new(Identity {
            chip: [7; 12],
            firmware: [0, 1, 0],
            board: Board::Simulated,
        });
        let make = Make {
            kind: setup.kind,
            firmware: OdriveFirmware::V6,
            watchdog: None,
            starts_enabled: false,
        };
        let mut drives = Vec::new();
        for (place, id) in (1..=AXES as u8).enumerate() {
            let mut values = Values::of_limits(id, &Limits::default());
            for (parameter, value) in [
                (Parameter::DriveKind, f64::from(u8::from(setup.kind))),
                (Parameter::DriveNode, f64::from(setup.ids[place])),
                (Parameter::DriveInertia, INERTIA),
                (Parameter::RatedTorque, setup.rated_torque),
            ] {
                let raw = parameter.nearest(value).expect("in range");
                values = values.with(parameter, raw).expect("it fits").0;
            }
            let link = DriveLink::new(&values.drive());
            node.add_axis_with_values(axis(id), &values, link)
                .expect("room");
            let drive = setup.ids[place];
            let model: Box<dyn Model> = if setup.kind == DriveKind::Odrive {
                let odrive = OdriveModel::new(&make, drive, START);
                Box::new(odrive.with_estimates_each(setup.estimates))
            } else {
                model(&make, drive, START).expect("a model")
            };
            drives.push(Drive {
                station: Station::new(drive, model, Vec::new()),
                next: TICK + setup.phases[place],
                period: TICK.saturating_add_signed(-setup.fast[place]),
            });
        }
        Self {
            setup: *setup,
            node,
            drives,
            hosts_bus: Segment::new(Bitrate::default(), &[ROOM, 64]),
            drives_bus: Segment::new(Bitrate::default(), &[ROOM, 64, 64, 64]),
            now: 0,
            tick: 0,
            handed: None,
            waiting: VecDeque::new(),
            answers: VecDeque::new(),
            said: VecDeque::new(),
            next_beat: 0,
            beats: 0,
            sequence: 0,
            sent: Vec::new(),
            moving: 0,
            ticks: 0,
        }
    }

    /// The drives' bus taken up to now, with the time that has passed.
    pub fn load(&self) -> canter::sim::Load {
        self.drives_bus.load(TrueTime(self.now))
    }

    /// Frames of two stations with one identifier at once, on both buses.
    pub fn clashes(&self) -> u64 {
        self.hosts_bus.clashes() + self.drives_bus.clashes()
    }

    /// Until all axes are enabled, and the bus clock is set.
    pub fn enable(&mut self) {
        self.pass(700);
        for id in 1..=AXES as u8 {
            self.control(id, Action::Hold);
            self.control(id, Action::Enable);
        }
        self.pass(500);
        for axis in self.node.axes() {
            let (state, fault) = (axis.state(), axis.fault());
            assert_eq!(state, State::OperationEnabled, "{fault:?} {:?}", self.setup);
        }
        self.sent.clear();
        (self.ticks, self.moving) = (0, 0);
    }

    /// Axes go to and fro, each on a way of its own.
    pub fn keep_moving(&mut self, moves: u64) {
        for count in 0..moves {
            for id in 1..=AXES as u8 {
                let there = if count % 2 == 0 { WAY } else { 0.0 };
                let turns = START + there / f64::from(id);
                self.sequence = self.sequence.wrapping_add(1);
                let command = Command::Move {
                    profile: ProfileKind::Beta,
                    staged: false,
                    target: Position::from_counts((turns * COUNTS_PER_TURN as f64) as i64),
                    duration: Ticks(MOVE as u32),
                    sequence: self.sequence,
                };
                self.say(axis(id).into(), command);
            }
            self.pass(MOVE);
        }
        for axis in self.node.axes() {
            assert_eq!(axis.fault(), None, "{:?}", self.setup);
        }
    }

    fn control(&mut self, id: u8, action: Action) {
        self.sequence = self.sequence.wrapping_add(1);
        let command = Command::Control {
            action,
            sequence: self.sequence,
            session: 1,
        };
        self.say(axis(id).into(), command);
    }

    fn say(&mut self, to: Address, command: Command) {
        let frame = command.encode(to).expect("the values fit");
        assert!(self.hosts_bus.send(HOST, frame), "the host has room");
    }

    /// Lets so many milliseconds pass.
    fn pass(&mut self, milliseconds: u64) {
        let until = self.now + milliseconds * TICK;
        loop {
            let next = self.next();
            if next > until {
                break;
            }
            self.now = self.now.max(next);
            self.happen();
        }
        self.now = until;
    }

    /// When something happens next.
    fn next(&self) -> u64 {
        let drives = self.drives.iter().map(|drive| drive.next).min();
        let buses = [&self.hosts_bus, &self.drives_bus].map(|bus| bus.due().map(|time| time.0));
        let waits = [
            self.handed,
            self.answers.front().map(|answer| answer.0),
            self.said.front().map(|said| said.0),
            drives,
        ];
        let times = buses.into_iter().chain(waits).flatten();
        times.fold(self.next_beat.min(self.tick_due()), u64::min)
    }

    fn happen(&mut self) {
        let now = self.now;
        if self.next_beat <= now {
            self.beat();
        }
        while let Some((_, frame)) = self.said.pop_front_if(|said| said.0 <= now) {
            self.node.handle_frame(local(now), &frame);
            self.node.plan();
        }
        if self.tick_due() <= now {
            self.tick();
        }
        if self.handed.take_if(|at| *at <= now).is_some() {
            self.lead_drives();
        }
        for place in 0..AXES {
            let drive = &mut self.drives[place];
            if drive.next <= now {
                drive.next += drive.period;
                drive.station.tick();
                self.hear(place, now);
            }
        }
        while let Some((_, place, frame)) = self.answers.pop_front_if(|answer| answer.0 <= now) {
            let room = self.drives_bus.send(1 + place, frame);
            assert!(room, "the drives' bus is too full: {:?}", self.setup);
        }
        if let Some(passed) = self.hosts_bus.step(TrueTime(now))
            && passed.sender == HOST
        {
            // A receiver is late by up to 20 us, each time by something else.
            let late = passed.start.0 % 20_011;
            self.said.push_back((now + late, passed.frame));
        }
        while self.hosts_bus.has_room(NODE)
            && let Some(frame) = self.node.poll_transmit(local(now))
        {
            self.hosts_bus.send(NODE, frame);
        }
        if let Some(passed) = self.drives_bus.step(TrueTime(now)) {
            self.pass_on(&passed);
        }
    }

    /// The host is there: SYNC each 20 ms as it sends it, and its heartbeat.
    fn beat(&mut self) {
        let time = TrueTime(self.now).bus_time();
        let counter = self.beats as u8;
        self.beats += 1;
        self.next_beat += 20 * TICK;
        self.say(Address::All, Command::Sync { counter, time });
        self.say(Address::All, Command::HostHeartbeat { session: 1 });
    }

    fn tick_due(&self) -> u64 {
        true_time(self.node.next_tick())
    }

    fn tick(&mut self) {
        // By the node's clock: like those of all nodes it is behind the host's by a SYNC's way.
        self.tick = self.now;
        self.node.tick(local(self.now));
        self.node.plan();
        self.handed = Some(self.now + HANDING_OVER);
        let moves = self.node.axes().filter(|axis| axis.is_moving());
        self.moving += moves.count() as u64;
        self.ticks += 1;
    }

    /// What the last tick left goes to the controller, as far as there is room.
    fn lead_drives(&mut self) {
        while self.drives_bus.has_room(NODE)
            && let Some(frame) = self.node.poll_drive_transmit()
        {
            self.drives_bus.send(NODE, frame);
            self.waiting.push_back(self.tick);
        }
    }

    /// A frame has come to its end on the drives' bus.
    fn pass_on(&mut self, passed: &Passed) {
        if passed.sender == NODE {
            let tick = self.waiting.pop_front().expect("it was handed over");
            let instant = (tick + LEAD) as i64;
            if let Some(axis) = self.setpoint_of(&passed.frame) {
                self.sent.push(Sent {
                    axis,
                    start: passed.start.0 as i64 - instant,
                    end: passed.end.0 as i64 - instant,
                });
            }
            if self.handed.is_none() {
                self.lead_drives();
            }
            for place in 0..AXES {
                self.drives[place].station.receive(&passed.frame);
                self.hear(place, passed.end.0 + self.setup.reaction);
            }
        } else {
            self.node.handle_drive_frame(&passed.frame);
        }
    }

    /// What a drive has to say is with its controller at `time`.
    fn hear(&mut self, place: usize, time: u64) {
        while let Some(frame) = self.drives[place].station.poll_transmit() {
            let behind = self.answers.partition_point(|answer| answer.0 <= time);
            self.answers.insert(behind, (time, place, frame));
        }
    }

    /// Whose setpoint this is.
    fn setpoint_of(&self, frame: &Frame) -> Option<usize> {
        let id = match self.setup.kind {
            DriveKind::Odrive if frame.id() & 0x1F == 0x0C => frame.id() >> 5,
            DriveKind::Mit => frame.id(),
            DriveKind::Cia402 if frame.id() & !0x7F == 0x200 => frame.id() & 0x7F,
            _ => return None,
        };
        self.setup.ids.iter().position(|own| u16::from(*own) == id)
    }
}

fn axis(id: u8) -> AxisId {
    AxisId::new(id).expect("1 to 63")
}

/// What the node's clock shows.
fn local(time: u64) -> LocalTime {
    LocalTime(NODE_AHEAD + (time + time * NODE_FAST / 1_000_000) / 1_000)
}

/// When the node's clock shows that for the first time; 0 where it always has.
fn true_time(time: LocalTime) -> u64 {
    let since = time.0.saturating_sub(NODE_AHEAD) * 1_000;
    let mut time_of = since - since * NODE_FAST / (1_000_000 + NODE_FAST);
    while local(time_of) < time {
        time_of += 1;
    }
    time_of
}
