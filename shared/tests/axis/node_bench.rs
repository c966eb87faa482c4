//! A node on a bench: local time goes from tick to tick, and every setpoint is kept with the
//! local time at which it left.

use super::bench::{AXIS, SESSION, frame};
use canter_shared::axis::Axis;
use canter_shared::axis::state::State;
use canter_shared::drive::simulated::Simulated;
use canter_shared::drive::{Condition, Drive, DriveCommand, DriveReport};
use canter_shared::limits::Limits;
use canter_shared::node::{AxisSetpoint, Board, Identity, Node};
use canter_shared::time::{BusTime, LocalTime, Tick};
use canter_shared::units::{Position, Velocity};
use canter_shared::wire::command::{Action, Command};

/// The bus's clock minus the node's at the beginning, in microseconds.
pub const OFFSET: u64 = 1_000_000_000;

/// A drive that is there but never enables.
pub struct Lame;

impl Drive for Lame {
    fn command(&mut self, _tick: Tick, _command: DriveCommand) {}

    fn report(&self) -> DriveReport {
        DriveReport {
            condition: Condition::Disabled,
            position: Position::ZERO,
            velocity: Velocity::ZERO,
        }
    }
}

/// One setpoint and the local time at which it left, in microseconds.
#[derive(Debug, Clone, Copy)]
pub struct Sent {
    pub at: u64,
    pub setpoint: AxisSetpoint,
}

/// A node with one axis.
pub struct NodeBench<D> {
    pub node: Node<D, 1>,
    /// Local time in microseconds.
    pub now: u64,
    /// Whether the host sends its heartbeat.
    pub beats: bool,
    pub sent: Vec<Sent>,
    beaten: u64,
    counter: u8,
}

impl NodeBench<Simulated> {
    /// Held with number 1 and enabled with number 2, its clock set once.
    pub fn enabled() -> Self {
        let mut bench = Self::new(Simulated::new(Position::ZERO));
        bench.hold_and_enable();
        bench.run(20_000);
        assert_eq!(bench.axis().state(), State::OperationEnabled);
        bench
    }
}

impl<D: Drive> NodeBench<D> {
    pub fn new(drive: D) -> Self {
        let identity = Identity {
            chip: [0; 12],
            firmware: [0; 3],
            board: Board::Simulated,
        };
        let mut node = Node::new(identity);
        node.add_axis(AXIS, Limits::default(), drive)
            .expect("there is room");
        Self {
            node,
            now: 0,
            beats: true,
            sent: Vec::new(),
            beaten: 0,
            counter: 0,
        }
    }

    pub fn hold_and_enable(&mut self) {
        self.run(20_000);
        self.sync(self.now + OFFSET);
        self.run(5_000);
        for (sequence, action) in [(1, Action::Hold), (2, Action::Enable)] {
            self.send(super::bench::control(sequence, action));
        }
    }

    pub fn axis(&self) -> &Axis {
        self.node.axes().next().expect("one axis")
    }

    /// Runs the ticks that are due within some local microseconds.
    pub fn run(&mut self, microseconds: u64) {
        let end = self.now + microseconds;
        loop {
            let beat = self.beaten + 50_000;
            let tick = self.node.next_tick().0.max(self.now);
            if self.beats && beat <= tick.min(end) {
                self.now = self.now.max(beat);
                self.beaten = self.now;
                self.send(Command::HostHeartbeat { session: SESSION });
            } else if tick <= end {
                self.now = tick;
                for setpoint in self.node.tick(LocalTime(tick)) {
                    self.sent.push(Sent {
                        at: tick,
                        setpoint: *setpoint,
                    });
                }
            } else {
                break;
            }
            self.node.plan();
            while self.node.poll_transmit(LocalTime(self.now)).is_some() {}
        }
        self.now = end;
    }

    pub fn send(&mut self, command: Command) {
        self.node.handle_frame(LocalTime(self.now), &frame(command));
        self.node.plan();
    }

    /// A SYNC that says what bus time it is.
    pub fn sync(&mut self, time: u64) {
        self.counter = self.counter.wrapping_add(1);
        self.sync_numbered(self.counter, time);
    }

    /// A SYNC of this number, as from another host.
    pub fn sync_numbered(&mut self, counter: u8, time: u64) {
        self.send(Command::Sync {
            counter,
            time: BusTime(time),
        });
    }

    /// A SYNC that is so many microseconds ahead of the node's own clock.
    pub fn sync_ahead(&mut self, microseconds: i64) {
        let shown = self.node.bus_time(LocalTime(self.now)).0;
        self.sync(shown.saturating_add_signed(microseconds));
    }

    /// Bus time that passes in some local microseconds of running.
    pub fn bus_time_in(&mut self, mut run: impl FnMut(&mut Self)) -> (u64, u64) {
        let (local, bus) = (self.now, self.node.bus_time(LocalTime(self.now)));
        run(self);
        let shown = self.node.bus_time(LocalTime(self.now));
        (self.now - local, shown.0 - bus.0)
    }
}

/// The most setpoints that left within one local millisecond.
pub fn most_in_a_millisecond(sent: &[Sent]) -> usize {
    let in_window = |index: usize| {
        let window = sent[index..].iter();
        let from = sent[index].at;
        window.take_while(|sent| sent.at < from + 1_000).count()
    };
    (0..sent.len()).map(in_window).max().unwrap_or(0)
}

/// The greatest speed in rad per local second over `ticks` setpoints in turn; 2 us are allowed
/// for whole microseconds at both ends.
pub fn fastest(sent: &[Sent], ticks: usize) -> f64 {
    let speed = |pair: &[Sent]| {
        let (first, last) = (pair[0], pair[pair.len() - 1]);
        let moved = last.setpoint.setpoint.position - first.setpoint.setpoint.position;
        moved.abs().radians() / ((last.at - first.at + 2) as f64 * 1e-6)
    };
    sent.windows(ticks + 1).map(speed).fold(0.0, f64::max)
}
