//! Axes in a `canter node` process on a bus of the test's own, 1 to 3 as a rule.

use canter_shared::time::Ticks;
use canter_shared::units::Position;
use canter_shared::wire::command::{Action, Command as Word, ProfileKind};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId, Function};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;
use canter_tests::PATIENCE;
use canter_tests::candump::cansend;
use canter_tests::process::{Finished, Process};
use canter_tests::trace::Trace;
use socketcan::{
    CanFilter, CanFrame, CanSocket, EmbeddedFrame, Frame as _, Socket, SocketOptions, StandardId,
};
use std::path::PathBuf;
use std::process::Command;
use std::time::{Duration, Instant};

/// How often a hand-made host asks for something.
const ATTEMPTS: u32 = 8;

/// Between two heartbeats of a hand-made host.
const BEAT: Duration = Duration::from_millis(40);

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
        Self::of_axes(bus, "1-3")
    }

    /// Starts these axes in one process and waits until they are there.
    pub fn of_axes(bus: &'static str, axes: &str) -> Self {
        let directory = tempfile::tempdir().expect("a directory for the trace");
        let trace = directory.path().join("trace.csv");
        let mut node = Command::new(canter_tests::canter());
        node.args(["--can", bus, "node", "--axes", axes, "--trace"]);
        let mut node = Process::spawn(node.arg(&trace));
        node.wait_for("start", |line| line.text.starts_with("running "));
        Self {
            bus,
            node,
            trace,
            _directory: directory,
        }
    }

    /// The node's process.
    pub fn process(&self) -> u32 {
        self.node.id()
    }

    /// Cuts its power, as far as a process has any.
    pub fn kill(&self) {
        self.node.signal("KILL");
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

    /// Waits for a report of `axis`, from now on.
    #[track_caller]
    pub fn wait_for(&self, what: &str, axis: AxisId, wanted: impl Fn(&Report) -> bool) {
        wait_for(self.bus, what, axis, wanted);
    }

    /// Ends the node, and gives its whole trace.
    pub fn finish(self) -> Trace {
        self.node.signal("INT");
        self.node.finish().success();
        Trace::read(&self.trace)
    }
}

/// Bus time now: the host's monotonic clock, which SYNC gave to the node.
pub fn now_in_ticks() -> u64 {
    canter::bus::monotonic_time().0 / 1_000
}

/// Waits for a report of `axis` on `bus`, from now on.
#[track_caller]
pub fn wait_for(bus: &str, what: &str, axis: AxisId, wanted: impl Fn(&Report) -> bool) {
    let socket = CanSocket::open(bus).expect("the bus is up");
    wait_for_report(&socket, what, axis, wanted);
}

#[track_caller]
fn wait_for_report(socket: &CanSocket, what: &str, axis: AxisId, wanted: impl Fn(&Report) -> bool) {
    let given_up = Instant::now() + PATIENCE;
    let mut last = None;
    while Instant::now() < given_up {
        if let Some((from, report)) = next_report(socket, PATIENCE)
            && from == axis
        {
            if wanted(&report) {
                return;
            }
            last = Some(report);
        }
    }
    panic!("no {what}; the last that axis {axis} said: {last:?}");
}

/// The next frame of the bus as a report, where it is one.
fn next_report(socket: &CanSocket, limit: Duration) -> Option<(AxisId, Report)> {
    let frame = socket.read_frame_timeout(limit).ok()?;
    let frame = Frame::new(frame.raw_id() as u16, frame.data())?;
    Report::decode(&frame).ok()?
}

/// A commander made by hand, frame by frame: for what no `canter` command does.
pub struct ByHand {
    bus: &'static str,
    cansend: bool,
    socket: CanSocket,
    session: u16,
    sequence: u8,
}

impl ByHand {
    /// Opens `bus`.
    pub fn new(bus: &'static str) -> Self {
        Self {
            bus,
            cansend: false,
            socket: CanSocket::open(bus).expect("the bus is up"),
            session: 0x0BAD,
            sequence: 0,
        }
    }

    /// The same, whom only some kinds of frames reach: there may be very many.
    pub fn hearing(bus: &'static str, functions: &[Function]) -> Self {
        let by_hand = Self::new(bus);
        let filters: Vec<_> = functions
            .iter()
            .map(|function| CanFilter::new(u32::from(u8::from(*function)) << 6, 0x7C0))
            .collect();
        by_hand.socket.set_filters(&filters).expect("filters");
        by_hand
    }

    /// The same, whom nothing but what one axis says of these kinds reaches.
    pub fn hearing_one(bus: &'static str, axis: AxisId, functions: &[Function]) -> Self {
        let by_hand = Self::new(bus);
        let id = |function: &Function| u32::from(u8::from(*function)) << 6 | u32::from(axis.get());
        let filters: Vec<_> = functions
            .iter()
            .map(|function| CanFilter::new(id(function), 0x7FF))
            .collect();
        by_hand.socket.set_filters(&filters).expect("filters");
        by_hand
    }

    /// The same, with can-utils' own cansend for every frame; a process for each takes its time.
    pub fn with_cansend(bus: &'static str) -> Self {
        Self {
            cansend: true,
            ..Self::new(bus)
        }
    }

    /// Sends a command.
    pub fn send(&mut self, address: Address, word: Word) {
        let frame = word.encode(address).expect("the values fit");
        if self.cansend {
            let hex: String = frame
                .data()
                .iter()
                .map(|byte| format!("{byte:02X}"))
                .collect();
            cansend(self.bus, &format!("{:03X}#{hex}", frame.id()));
            return;
        }
        let id = StandardId::new(frame.id()).expect("11 bits");
        let frame = CanFrame::new(id, frame.data()).expect("8 bytes");
        self.socket.write_frame(&frame).expect("the bus takes it");
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

    /// Keeps the session alive until a report of `axis` is as wanted.
    #[track_caller]
    pub fn beat_until(&mut self, what: &str, axis: AxisId, wanted: impl Fn(&Report) -> bool) {
        self.listen(what, |heard| {
            heard.is_some_and(|(from, report)| from == axis && wanted(report))
        });
    }

    /// Keeps the session alive for a while.
    pub fn beat_for(&mut self, duration: Duration) {
        let end = Instant::now() + duration;
        self.listen("end", |_| Instant::now() >= end);
    }

    /// Keeps the session alive and hears everybody until that is `enough`; `None` is silence.
    #[track_caller]
    pub fn listen(
        &mut self,
        what: &str,
        mut enough: impl FnMut(Option<(AxisId, &Report)>) -> bool,
    ) {
        let given_up = Instant::now() + PATIENCE;
        let mut next = Instant::now();
        loop {
            assert!(Instant::now() < given_up, "no {what}");
            if Instant::now() >= next {
                next = Instant::now() + BEAT;
                let session = self.session;
                self.send(Address::All, Word::HostHeartbeat { session });
            }
            let heard = next_report(&self.socket, BEAT);
            if enough(heard.as_ref().map(|(from, report)| (*from, report))) {
                return;
            }
        }
    }

    /// Asks an axis for something, and again under another number where its own is taken; gives the
    /// last answer, if any.
    #[track_caller]
    pub fn insist(&mut self, axis: AxisId, action: Action) -> Option<Reason> {
        let mut answer = None;
        for _ in 0..ATTEMPTS {
            self.sequence = self.sequence.wrapping_add(1);
            let (sequence, session) = (self.sequence, self.session);
            let word = Word::Control {
                action,
                sequence,
                session,
            };
            self.send(axis.into(), word);
            let given_up = Instant::now() + 2 * BEAT;
            self.listen("answer", |heard| match heard {
                Some((
                    from,
                    Report::Acknowledgement {
                        sequence: to,
                        function: Function::Control,
                        reason,
                        detail,
                    },
                )) if from == axis && *to == sequence => {
                    answer = Some((*reason, *detail as u8));
                    true
                }
                _ => Instant::now() >= given_up,
            });
            match answer {
                Some((Reason::StaleSequence, last)) => self.sequence = last,
                Some(_) => break,
                None => {}
            }
        }
        answer.map(|(reason, _)| reason)
    }
}

/// An axis id that exists.
pub fn axis(id: u8) -> AxisId {
    AxisId::new(id).expect("1 to 63")
}
