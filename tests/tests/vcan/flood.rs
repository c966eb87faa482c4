//! A bus gone mad: thousands of random and forged frames a second at a node that somebody uses.

use super::robot::{ByHand, Robot, axis};
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::limits::Limits;
use canter_shared::wire::command::{Action, Command as Word};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, Function};
use canter_shared::wire::layout::{LAYOUTS, Sender};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;
use canter_tests::{PATIENCE, measurement};
use nix::sys::socket::{MsgFlags, MultiHeaders, sendmmsg};
use socketcan::{CanFilter, CanSocket, EmbeddedFrame, Frame as _, Socket, SocketOptions};
use std::collections::BTreeSet;
use std::io::IoSlice;
use std::os::fd::AsRawFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How long it lasts.
const LASTS: Duration = Duration::from_secs(30);

/// Frames a second, asked for and sent.
const RATE: u64 = 10_000;

/// An emergency stop is answered within this.
const ANSWER: Duration = Duration::from_millis(10);

/// Stops that must have been answered for the figures to mean something: where they are not by then, it
/// lasts up to so many times as long.
const LEAST_ANSWERS: usize = 20;
const LONGER: u32 = 4;

/// A stop that is not answered after this is one that met a fault.
const MISSED: Duration = Duration::from_millis(500);

/// Acceleration may step twice in a tick, from one limit to the other and back: forged trapezoids that
/// last for less than a tick do that.
const JERK: f64 = 2.0 * 2.0 * 200.0 / 1e-3;

/// A generator of 64 bits at a time: Vigna's SplitMix64. The same seed gives the same flood.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }
}

/// What would end the test before it is over: an axis that stands still with a fault breaks nothing.
fn ends_it(function: Function) -> bool {
    matches!(function, Function::EmergencyStop | Function::Stop)
}

/// The kernel's `struct can_frame`: id, length, 3 bytes of no interest, data.
type KernelFrame = [u8; 16];

/// One frame of the flood: any id, or one of a host's to an axis that is there; half of these with
/// the bytes that belong to it, the others with as many as chance has it.
fn forged(random: &mut Random) -> KernelFrame {
    let data = random.next().to_le_bytes();
    let commands: Vec<_> = LAYOUTS
        .iter()
        .filter(|layout| layout.sender == Sender::Host && !ends_it(layout.function))
        .collect();
    let (id, length) = if random.below(4) == 0 {
        // Axes 4 to 63: a report of axes 1 to 3 would say that there are two of them.
        let id = (random.below(28) + 3) << 6 | (random.below(60) + 4);
        (id as u16, random.below(9) as usize)
    } else {
        let layout = commands[random.below(commands.len() as u64) as usize];
        let length = match random.below(2) {
            0 => usize::from(layout.length),
            _ => random.below(9) as usize,
        };
        let to = random.below(4) as u16;
        (u16::from(u8::from(layout.function)) << 6 | to, length)
    };
    let mut frame = [0; 16];
    frame[..4].copy_from_slice(&u32::from(id).to_ne_bytes());
    frame[4] = length as u8;
    frame[8..8 + length].copy_from_slice(&data[..length]);
    frame
}

/// Sends frames in one call of the system; gives how many the bus took.
fn send(socket: &CanSocket, frames: &[KernelFrame]) -> u64 {
    let slices: Vec<_> = frames.iter().map(|frame| [IoSlice::new(frame)]).collect();
    let mut headers = MultiHeaders::<()>::preallocate(frames.len(), None);
    let addresses = vec![None; frames.len()];
    let file = socket.as_raw_fd();
    let flags = MsgFlags::empty();
    sendmmsg(file, &mut headers, &slices, addresses, [], flags)
        .map_or(0, |sent| sent.count() as u64)
}

/// A thread that floods a bus until it is told to end.
struct Flood {
    ends: Arc<AtomicBool>,
    sent: Arc<AtomicU64>,
    thread: JoinHandle<()>,
}

impl Flood {
    fn start(bus: &'static str) -> Self {
        let ends = Arc::new(AtomicBool::new(false));
        let sent = Arc::new(AtomicU64::new(0));
        let (told, count) = (Arc::clone(&ends), Arc::clone(&sent));
        let thread = std::thread::spawn(move || {
            let socket = CanSocket::open(bus).expect("the bus is up");
            // It only sends: what it does not read must not fill anybody's memory.
            socket.set_filter_drop_all().expect("a filter");
            let mut random = Random(1);
            let begin = Instant::now();
            while !told.load(Ordering::Relaxed) {
                let due = begin.elapsed().as_micros() as u64 * RATE / 1_000_000;
                let missing = due.saturating_sub(count.load(Ordering::Relaxed));
                // Many at a time: a system call for each would take the whole processor.
                let frames: Vec<_> = (0..missing.min(100)).map(|_| forged(&mut random)).collect();
                if frames.is_empty() {
                    std::thread::sleep(Duration::from_millis(1));
                } else {
                    count.fetch_add(send(&socket, &frames), Ordering::Relaxed);
                }
            }
        });
        Self { ends, sent, thread }
    }

    fn end(self) -> u64 {
        self.ends.store(true, Ordering::Relaxed);
        self.thread.join().expect("the flood ends well");
        self.sent.load(Ordering::Relaxed)
    }
}

/// Sees emergency stops and faults, each at the time at which the kernel had it on the bus: how long a
/// test waits for the processor is not in it.
struct Witness(CanSocket);

impl Witness {
    fn new(bus: &str) -> Self {
        let socket = CanSocket::open(bus).expect("the bus is up");
        let filters = [Function::EmergencyStop, Function::Fault]
            .map(|function| CanFilter::new(u32::from(u8::from(function)) << 6, 0x7C0));
        socket.set_filters(&filters).expect("filters");
        socket.set_recv_timestamp(true).expect("times");
        socket.set_nonblocking(true).expect("a socket");
        Self(socket)
    }

    /// From the last emergency stop to when the last of `axes` told that it had met it.
    fn answer(&self, axes: usize) -> Option<Duration> {
        let (mut asked, mut told) = (None, None);
        let mut stopped = BTreeSet::new();
        while let Ok((frame, time)) = self.0.read_frame_with_timestamp() {
            let frame = Frame::new(frame.raw_id() as u16, frame.data())?;
            if let Ok(Some((_, Word::EmergencyStop))) = Word::decode(&frame) {
                asked = Some(time);
                stopped.clear();
            } else if let Ok(Some((from, Report::Fault { fault, .. }))) = Report::decode(&frame)
                && fault == u8::from(Fault::EmergencyStop)
                && stopped.insert(from)
            {
                told = Some(time);
            }
        }
        told.filter(|_| stopped.len() == axes)?
            .duration_since(asked?)
            .ok()
    }
}

/// Kilobytes of memory that a process has (`man proc_pid_status`, VmRSS).
fn memory(process: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).expect("it runs");
    let line = status.lines().find(|line| line.starts_with("VmRSS:"));
    let line = line.expect("a process has memory");
    line.split_whitespace()
        .nth(1)
        .and_then(|word| word.parse().ok())
        .expect("kilobytes")
}

/// Takes, clears and enables an axis, however often a forged command comes between or takes it away.
///
/// It hears that axis alone: what all of them answer to thousands of forged commands would keep it from
/// hearing its own answers in time.
fn enable(bus: &'static str, id: u8) {
    let heard = [Function::Acknowledgement, Function::Heartbeat];
    let mut host = ByHand::hearing_one(bus, axis(id), &heard);
    let given_up = Instant::now() + PATIENCE;
    let mut state = None;
    while state != Some(State::OperationEnabled) {
        assert!(Instant::now() < given_up, "axis {id} stays {state:?}");
        let answers = [Action::Hold, Action::Clear, Action::Enable]
            .map(|action| host.insist(axis(id), action));
        if answers == [Some(Reason::Accepted); 3] {
            // The drive takes some ticks, and the next heartbeat a tenth of a second.
            let given_up = Instant::now() + MISSED;
            host.listen("heartbeat", |heard| {
                if let Some((from, Report::Heartbeat { state: told, .. })) = heard
                    && from == axis(id)
                {
                    state = State::try_from(*told).ok();
                }
                state == Some(State::OperationEnabled) || Instant::now() >= given_up
            });
        }
    }
}

#[test]
fn a_flood_of_forged_frames_breaks_no_limit_and_holds_off_no_emergency_stop() {
    let robot = Robot::start("vcan8");
    let mut host = ByHand::hearing(robot.bus, &[]);
    for id in 1..=3 {
        enable(robot.bus, id);
    }
    let flood = Flood::start(robot.bus);
    let begin = Instant::now();
    let mut early = None;
    let (mut answers, mut missed) = (Vec::new(), 0);
    let goes_on = |answered| {
        let lasted = begin.elapsed();
        lasted < LASTS || answered < LEAST_ANSWERS && lasted < LONGER * LASTS
    };
    while goes_on(answers.len()) {
        // Let it be moved by the forged moves for a while.
        host.beat_for(Duration::from_millis(700));
        if early.is_none() && begin.elapsed() > LASTS / 6 {
            early = Some(memory(robot.process()));
        }
        // One that hears nothing else, so that nothing else delays it.
        let mut bystander = ByHand::hearing(robot.bus, &[Function::Fault]);
        let witness = Witness::new(robot.bus);
        let sent = Instant::now();
        bystander.send(Address::All, Word::EmergencyStop);
        let mut stopped = BTreeSet::new();
        let given_up = sent + MISSED;
        bystander.listen("end of the wait", |heard| {
            if let Some((from, Report::Fault { fault, .. })) = heard
                && *fault == u8::from(Fault::EmergencyStop)
            {
                stopped.insert(from);
            }
            stopped.len() == 3 || Instant::now() >= given_up
        });
        if stopped.len() == 3 {
            answers.push(witness.answer(3).expect("it saw what the bystander saw"));
        } else {
            // One that had a fault already, because this test beat too late, says nothing.
            missed += 1;
        }
        for id in 1..=3 {
            enable(robot.bus, id);
        }
    }
    let late = memory(robot.process());
    let lasted = begin.elapsed();
    let sent = flood.end();
    let rate = sent as f64 / lasted.as_secs_f64();
    answers.sort();
    let milliseconds = |share: usize| {
        let at = (answers.len() * share / 100).min(answers.len() - 1);
        answers[at].as_secs_f64() * 1e3
    };
    let (middle, worst) = (milliseconds(50), milliseconds(100));
    let is_late = middle > ANSWER.as_secs_f64() * 1e3;
    let grown = late.saturating_sub(early.expect("it lasted"));
    measurement(
        "vcan",
        "flood: frames a second",
        &format!("{rate:.0}"),
        &format!(">= {RATE}"),
    );
    measurement(
        "vcan",
        "flood: emergency stop answered within",
        &format!("{middle:.2} ms, worst of {} {worst:.2} ms", answers.len()),
        "<= 10 ms",
    );
    measurement(
        "vcan",
        "flood: memory grown",
        &format!("{grown} kB"),
        "<= 512 kB",
    );
    let trace = robot.finish();
    trace.keeps(&Limits::default(), JERK);
    assert!(trace.moved(), "the forged moves moved nothing");
    assert!(rate >= 0.9 * RATE as f64, "{rate} frames a second");
    assert!(answers.len() >= LEAST_ANSWERS, "{missed} stops missed");
    // The worst is shown, and is the machine's: now and then it has something else to do.
    assert!(!is_late, "half of the stops took longer than {middle} ms");
    assert!(grown <= 512, "{grown} kB");
}
