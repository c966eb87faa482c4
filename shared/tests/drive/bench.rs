//! A link, led by hand.

use canter_shared::drive::settings::{DriveKind, DriveSettings};
use canter_shared::drive::{Condition, Drive, DriveCommand};
use canter_shared::parameter::{Parameter, Values};
use canter_shared::time::Tick;
use canter_shared::units::{Acceleration, COUNTS_PER_TURN, Position, Velocity};
use canter_shared::wire::frame::Frame;

/// The settings of the drive of this id with a few parameters changed, by name and as a host writes them.
pub fn settings(kind: DriveKind, node: u8, changes: &[(Parameter, f64)]) -> DriveSettings {
    let mut values = Values::defaults(node);
    let kind = (Parameter::DriveKind, f64::from(u8::from(kind)));
    for (parameter, value) in changes.iter().chain([&kind]) {
        let raw = parameter.nearest(*value).expect("in range");
        values = values.with(*parameter, raw).expect("it fits").0;
    }
    values.drive()
}

/// A link, its tick and what it was told last.
pub struct Bench<D> {
    pub drive: D,
    pub command: DriveCommand,
    tick: Tick,
}

impl<D: Drive> Bench<D> {
    pub fn new(drive: D) -> Self {
        Self {
            drive,
            command: DriveCommand::default(),
            tick: Tick(0),
        }
    }

    /// One tick: what is sent, a SYNC last.
    pub fn step(&mut self) -> Vec<Frame> {
        self.drive.command(self.tick, self.command);
        self.tick.0 += 1;
        let mut sent: Vec<_> = std::iter::from_fn(|| self.drive.poll_transmit()).collect();
        if self.drive.take_sync() {
            sent.push(canter_shared::drive::cia402::sync());
        }
        sent
    }

    /// So many ticks in which nothing gets on the bus: it is full, or the node was held up.
    pub fn wait(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.drive.command(self.tick, self.command);
            self.tick.0 += 1;
        }
    }

    /// So many ticks; what is sent in all of them.
    pub fn steps(&mut self, ticks: u32) -> Vec<Frame> {
        (0..ticks).flat_map(|_| self.step()).collect()
    }

    /// A frame from the drive.
    #[track_caller]
    pub fn hear(&mut self, id: u16, data: &[u8]) {
        assert!(
            self.ignores(id, data).is_none(),
            "not taken: {id:#05x} {data:02x?}"
        );
    }

    /// A frame that is none of this drive's: `None` where it was taken all the same.
    pub fn ignores(&mut self, id: u16, data: &[u8]) -> Option<()> {
        let frame = Frame::new(id, data).expect("a frame");
        (!self.drive.receive(&frame)).then_some(())
    }

    pub fn condition(&self) -> Condition {
        self.drive.report().condition
    }

    /// The axis as it enables: the drive is told to be where it says it is.
    pub fn enable(&mut self) {
        let report = self.drive.report();
        self.command = DriveCommand {
            enable: true,
            position: report.position,
            ..DriveCommand::default()
        };
    }

    pub fn lead(&mut self, turns: f64, turns_per_second: f64, acceleration: f64) {
        let counts = |value: f64| (value * COUNTS_PER_TURN as f64).round() as i64;
        self.command.position = Position::from_counts(counts(turns));
        self.command.velocity = Velocity::from_counts(counts(turns_per_second));
        self.command.acceleration = Acceleration::from_counts(counts(acceleration));
    }
}

/// Id and payload, as they are written in documents: `04C#0000803F00000000`.
pub fn texts(frames: &[Frame]) -> Vec<String> {
    let text = |frame: &Frame| {
        let hex: String = frame
            .data()
            .iter()
            .map(|byte| format!("{byte:02X}"))
            .collect();
        format!("{:03X}#{hex}", frame.id())
    };
    frames.iter().map(text).collect()
}

/// In turns.
pub fn turns(position: Position) -> f64 {
    position.counts() as f64 / COUNTS_PER_TURN as f64
}
