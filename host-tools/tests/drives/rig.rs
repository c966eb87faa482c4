//! Three axes, their drives and a host, tick by tick.

use canter::drive_model::{Make, Seen, Station, Trial, model};
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::drive::link::DriveLink;
use canter_shared::drive::settings::{DriveKind, OdriveFirmware};
use canter_shared::limits::Limits;
use canter_shared::node::{Board, Identity, Node};
use canter_shared::parameter::{Parameter, Values};
use canter_shared::time::Ticks;
use canter_shared::units::{COUNTS_PER_TURN, Position};
use canter_shared::wire::command::{Action, Command, ProfileKind};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId};
use canter_shared::wire::report::Report;

/// The fastest that an axis goes, and a little more for what a tick adds, in turns/s.
const FASTEST: f64 = 20.0 / std::f64::consts::TAU * 1.01;

/// Every kind of drive, both ODrives.
pub const MAKES: [Make; 4] = [
    make(DriveKind::Odrive, OdriveFirmware::V6),
    make(DriveKind::Odrive, OdriveFirmware::V5),
    make(DriveKind::Mit, OdriveFirmware::V6),
    make(DriveKind::Cia402, OdriveFirmware::V6),
];

const fn make(kind: DriveKind, firmware: OdriveFirmware) -> Make {
    Make {
        kind,
        firmware,
        watchdog: None,
        starts_enabled: false,
    }
}

/// Where the drives stand when it begins, in turns of their shafts.
pub const START: f64 = 0.3;

/// A node, its drives and its host.
pub struct Rig {
    pub node: Node<DriveLink, 3>,
    pub stations: Vec<Station>,
    /// What the node told its drives, with the tick.
    pub sent: Vec<(u64, Frame)>,
    /// The last feedback of each axis, in turns.
    pub places: [f64; 3],
    pub ticks: u64,
    /// When the first drive got into trouble.
    pub troubled: Option<u64>,
    /// The most that a target goes on from one setpoint to the next, in turns of the drive.
    most: f64,
    before: Vec<Seen>,
    sequence: u8,
}

impl Rig {
    /// Drives of this make, with trouble for the first one, and parameters that differ from the defaults.
    pub fn new(make: &Make, trials: &[Trial], changes: &[(Parameter, f64)]) -> Self {
        let mut node = Node::new(Identity {
            chip: [7; 12],
            firmware: [0, 1, 0],
            board: Board::Host,
        });
        let mut stations = Vec::new();
        let mut most = 0.0;
        for id in 1..=3 {
            let mut values = Values::of_limits(id, &Limits::default());
            let kinds = [
                (
                    Parameter::OdriveFirmware,
                    f64::from(u8::from(make.firmware)),
                ),
                (Parameter::DriveKind, f64::from(u8::from(make.kind))),
            ];
            for (parameter, value) in changes.iter().chain(&kinds) {
                let raw = parameter.nearest(*value).expect("in range");
                values = values.with(*parameter, raw).expect("it fits").0;
            }
            let value = |parameter: Parameter| parameter.in_unit(values.get(parameter));
            most = FASTEST * value(Parameter::DrivePeriod) * value(Parameter::GearRatio);
            let link = DriveLink::new(&values.drive());
            let axis = AxisId::new(id).expect("1 to 63");
            node.add_axis_with_values(axis, &values, link)
                .expect("room");
            let model = model(make, id, START).expect("a model");
            let trials = if id == 1 { trials.to_vec() } else { Vec::new() };
            stations.push(Station::new(id, model, trials));
        }
        Self {
            node,
            before: stations.iter().map(Station::seen).collect(),
            stations,
            sent: Vec::new(),
            places: [0.0; 3],
            ticks: 0,
            troubled: None,
            most,
            sequence: 0,
        }
    }

    /// A tick of the node, and one of the drives.
    pub fn step(&mut self) {
        if self.ticks.is_multiple_of(50) {
            self.say(Address::All, Command::HostHeartbeat { session: 1 });
        }
        self.ticks += 1;
        let now = self.node.next_tick();
        self.node.tick(now);
        self.node.plan();
        while let Some(frame) = self.node.poll_transmit(now) {
            if let Ok(Some((axis, Report::Feedback { position, .. }))) = Report::decode(&frame) {
                self.places[usize::from(axis.get()) - 1] =
                    position.counts() as f64 / COUNTS_PER_TURN as f64;
            }
        }
        while let Some(frame) = self.node.poll_drive_transmit() {
            self.sent.push((self.ticks, frame));
            for station in &mut self.stations {
                station.receive(&frame);
            }
        }
        for station in &mut self.stations {
            if station.tick().is_some() {
                self.troubled = Some(self.ticks);
            }
            while let Some(frame) = station.poll_transmit() {
                self.node.handle_drive_frame(&frame);
            }
        }
        self.check();
    }

    pub fn steps(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.step();
        }
    }

    /// What holds at every tick, whatever happens: a drive that gets torque is told to be where it is,
    /// and from then on its target never jumps.
    fn check(&mut self) {
        for (station, before) in self.stations.iter().zip(&mut self.before) {
            let now = station.seen();
            let node = station.node();
            if now.enabled && !before.enabled {
                let away = (now.target - now.position).abs();
                assert!(
                    away < 2e-3,
                    "tick {}, drive {node} jumps: {now:?}",
                    self.ticks
                );
            }
            if now.enabled && before.enabled {
                let step = (now.target - before.target).abs();
                // What the coarsest of them adds by its rounding.
                let most = self.most + 1e-4;
                assert!(
                    step <= most,
                    "tick {}, drive {node}: {before:?} {now:?}",
                    self.ticks
                );
            }
            *before = now;
        }
    }

    pub fn say(&mut self, to: Address, command: Command) {
        let frame = command.encode(to).expect("the values fit");
        let now = self.node.next_tick();
        self.node.handle_frame(now, &frame);
        self.node.plan();
    }

    pub fn control(&mut self, axis: u8, action: Action) {
        self.sequence = self.sequence.wrapping_add(1);
        let command = Command::Control {
            action,
            sequence: self.sequence,
            session: 1,
        };
        self.say(AxisId::new(axis).expect("1 to 63").into(), command);
    }

    pub fn move_to(&mut self, axis: u8, turns: f64, duration: u32) {
        self.sequence = self.sequence.wrapping_add(1);
        let command = Command::Move {
            profile: ProfileKind::Beta,
            staged: false,
            target: Position::from_counts((turns * COUNTS_PER_TURN as f64) as i64),
            duration: Ticks(duration),
            sequence: self.sequence,
        };
        self.say(AxisId::new(axis).expect("1 to 63").into(), command);
    }

    pub fn state(&self, axis: u8) -> State {
        self.axis(axis).state()
    }

    pub fn fault(&self, axis: u8) -> Option<Fault> {
        self.axis(axis).fault()
    }

    fn axis(&self, id: u8) -> &canter_shared::axis::Axis {
        let mut axes = self.node.axes();
        axes.find(|axis| axis.id().get() == id)
            .expect("it is there")
    }

    /// The drive of this axis.
    pub fn seen(&self, axis: u8) -> Seen {
        self.stations[usize::from(axis) - 1].seen()
    }

    /// Steps until it is so.
    #[track_caller]
    pub fn until(&mut self, what: &str, most: u32, is: impl Fn(&Self) -> bool) -> u32 {
        for tick in 0..most {
            if is(self) {
                return tick;
            }
            self.step();
        }
        let (state, fault) = (self.state(1), self.fault(1));
        panic!(
            "no {what} in {most} ticks: {state}, {fault:?}, {:?}",
            self.seen(1)
        );
    }

    /// Enables all axes from whatever they are in.
    #[track_caller]
    pub fn enable(&mut self) {
        self.until("drives", 1_000, |rig| {
            (1..=3).all(|axis| rig.state(axis) == State::SwitchOnDisabled)
        });
        for axis in 1..=3 {
            self.control(axis, Action::Hold);
            self.control(axis, Action::Enable);
        }
        self.until("torque", 1_000, |rig| {
            (1..=3).all(|axis| rig.state(axis) == State::OperationEnabled)
        });
    }
}
