//! Axes 1 to 3 in a `canter node` process on a bus of the test's own.

use canter_shared::time::Ticks;
use canter_shared::units::Position;
use canter_shared::wire::command::{Action, Command as Word, ProfileKind};
use canter_shared::wire::id::{Address, AxisId};
use canter_tests::PATIENCE;
use canter_tests::process::{Finished, Process};
use canter_tests::trace::Trace;
use socketcan::{CanFrame, CanSocket, EmbeddedFrame, Socket, StandardId};
use std::path::PathBuf;
use std::process::Command;
use std::time::{Duration, Instant};

/// A node process, its bus and its trace.
pub struct Robot {
    pub bus: &'static str,
    node: Process,
    trace: PathBuf,
    _directory: tempfile::TempDir,
}

impl Robot {
    /// Starts axes 1 to 3 on `bus` and waits until they are there.
    pub fn start(bus: &'static str) -> Self {
        let directory = tempfile::tempdir().expect("a directory for the trace");
        let trace = directory.path().join("trace.csv");
        let mut node = Command::new(canter_tests::canter());
        node.args(["--can", bus, "node", "--axes", "1-3", "--trace"]);
        let mut node = Process::spawn(node.arg(&trace));
        node.wait_for("start", |line| line.text.starts_with("running 3 axes"));
        Self {
            bus,
            node,
            trace,
            _directory: directory,
        }
    }

    /// A `canter` command on this bus, not started yet.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(canter_tests::canter());
        command.args(["--can", self.bus]);
        command.args(arguments.split_whitespace());
        command
    }

    /// Runs a `canter` command on this bus to its end.
    pub fn run(&self, arguments: &str) -> Finished {
        Process::spawn(&mut self.command(arguments)).finish()
    }

    /// Enables all axes.
    #[track_caller]
    pub fn enable(&self) {
        self.run("enable all").success();
    }

    /// The trace so far.
    pub fn trace(&self) -> Trace {
        Trace::read(&self.trace)
    }

    /// Waits until the trace says so: it grows while the node runs.
    #[track_caller]
    pub fn wait_for(&self, what: &str, wanted: impl Fn(&Trace) -> bool) {
        let given_up = Instant::now() + PATIENCE;
        while !wanted(&self.trace()) {
            assert!(Instant::now() < given_up, "no {what}");
            std::thread::yield_now();
        }
    }

    /// Ends the node, and gives its whole trace.
    pub fn finish(self) -> Trace {
        self.node.signal("INT");
        self.node.finish().success();
        Trace::read(&self.trace)
    }
}

/// A commander made by hand, frame by frame: for what no `canter` command does.
pub struct ByHand {
    socket: CanSocket,
    session: u16,
    sequence: u8,
}

impl ByHand {
    /// Opens `bus`.
    pub fn new(bus: &str) -> Self {
        Self {
            socket: CanSocket::open(bus).expect("the bus is up"),
            session: 0x0BAD,
            sequence: 0,
        }
    }

    /// Sends a command.
    pub fn send(&mut self, address: Address, word: Word) {
        let frame = word.encode(address).expect("the values fit");
        let id = StandardId::new(frame.id()).expect("11 bits");
        let frame = CanFrame::new(id, frame.data()).expect("8 bytes");
        socketcan::Socket::write_frame(&self.socket, &frame).expect("the bus takes it");
    }

    /// Takes and enables `axis`.
    pub fn hold_and_enable(&mut self, axis: AxisId) {
        for action in [Action::Hold, Action::Enable] {
            self.sequence = self.sequence.wrapping_add(1);
            let word = Word::Control {
                action,
                sequence: self.sequence,
                session: self.session,
            };
            self.send(axis.into(), word);
        }
    }

    /// Moves `axis` at once.
    pub fn move_to(&mut self, axis: AxisId, radians: f64, duration: Ticks) {
        self.sequence = self.sequence.wrapping_add(1);
        let word = Word::Move {
            profile: ProfileKind::Beta,
            staged: false,
            target: Position::from_radians(radians).expect("in range"),
            duration,
            sequence: self.sequence,
        };
        self.send(axis.into(), word);
    }

    /// Keeps the session alive for as long as `wanted` does not hold.
    #[track_caller]
    pub fn beat_until(&mut self, what: &str, mut wanted: impl FnMut() -> bool) {
        let given_up = Instant::now() + PATIENCE;
        while !wanted() {
            assert!(Instant::now() < given_up, "no {what}");
            let session = self.session;
            self.send(Address::All, Word::HostHeartbeat { session });
            // Waits for the next frame of the bus, or a heartbeat's time.
            let _ = self.socket.read_frame_timeout(Duration::from_millis(20));
        }
    }
}

/// An axis id that exists.
pub fn axis(id: u8) -> AxisId {
    AxisId::new(id).expect("1 to 63")
}
