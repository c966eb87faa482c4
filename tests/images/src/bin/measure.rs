//! Counts the instructions of the core's inner functions.
#![no_std]
#![no_main]

use core::hint::black_box;

use canter_images::{Spread, count, finish, report};
use canter_shared::drive::simulated::Simulated;
use canter_shared::limits::Limits;
use canter_shared::motion::beta::Beta;
use canter_shared::node::{Board, Identity, Node};
use canter_shared::time::{LocalTime, Tick, Ticks};
use canter_shared::units::{COUNTS_PER_TURN, Position};
use canter_shared::wire::command::{Action, Command, ProfileKind};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId};
use cortex_m_rt::entry;

const SESSION: u16 = 1;

#[entry]
fn main() -> ! {
    report("calibration.nops_1000", count(nops_1000));
    measure_beta();
    measure_node();
    finish()
}

/// A known number of instructions, to see that the count is right.
#[inline(always)]
fn nops_1000() {
    // SAFETY: does nothing, a thousand times.
    unsafe { core::arch::asm!(".rept 1000", "nop", ".endr", options(nomem, nostack)) };
}

fn measure_beta() {
    let beta = Beta::new(
        Tick(0),
        Position::from_counts(3 * COUNTS_PER_TURN),
        Ticks(1_000),
    );
    let (mut position, mut setpoint) = (Spread::new(), Spread::new());
    for tick in 1..1_000 {
        let (beta, tick) = (black_box(&beta), black_box(Tick(tick)));
        position.add(count(|| beta.position(tick)));
        setpoint.add(count(|| beta.at(tick)));
    }
    position.report("beta.position");
    setpoint.report("beta.setpoint");
}

/// Ticks between two heartbeats of the host.
const BEAT: u32 = 100;

/// A node with one axis, its answers thrown away.
struct Bench {
    node: Node<Simulated, 1>,
    sequence: u8,
    ticks: u32,
    /// Whether the host sends its heartbeat.
    beats: bool,
    /// Whether somebody plans.
    plans: bool,
    /// What is done under the node's lock: for a frame, to take a plan, to commit it.
    decisions: Spread,
    takes: Spread,
    commits: Spread,
}

impl Bench {
    fn new() -> Self {
        let mut node = Node::new(Identity {
            chip: [0; 12],
            firmware: [0; 3],
            board: Board::Emulated,
        });
        if let Some(axis) = AxisId::new(1) {
            let added = node.add_axis(axis, Limits::default(), Simulated::new(Position::ZERO));
            assert!(added.is_ok(), "a node has room for its axis");
        }
        Self {
            node,
            sequence: 0,
            ticks: 0,
            beats: true,
            plans: true,
            decisions: Spread::new(),
            takes: Spread::new(),
            commits: Spread::new(),
        }
    }

    fn enabled() -> Self {
        let mut bench = Self::new();
        bench.tick();
        bench.control(Action::Hold);
        bench.control(Action::Enable);
        for _ in 0..10 {
            bench.tick();
        }
        bench
    }

    fn tick(&mut self) -> u32 {
        let now = self.node.next_tick();
        let node = &mut self.node;
        let count = count(|| node.tick(black_box(now)).len());
        while node.poll_transmit(now).is_some() {}
        self.ticks += 1;
        if self.beats && self.ticks.is_multiple_of(BEAT) {
            self.say(Command::HostHeartbeat { session: SESSION });
        }
        count
    }

    fn say(&mut self, command: Command) -> u32 {
        let now = self.node.next_tick();
        let axis = match command {
            Command::HostHeartbeat { .. } => Address::All,
            _ => AxisId::new(1).map_or(Address::All, Address::Axis),
        };
        let Ok(frame) = command.encode(axis) else {
            panic!("{command:?} does not fit a frame")
        };
        self.handle(now, &frame)
    }

    fn handle(&mut self, now: LocalTime, frame: &Frame) -> u32 {
        let node = &mut self.node;
        let decide = count(|| node.handle_frame(black_box(now), black_box(frame)));
        self.decisions.add(decide);
        if self.plans { self.plan() } else { 0 }
    }

    /// Plans what waits, as a task of low priority does: the instructions without those under the
    /// node's lock, which are kept apart.
    fn plan(&mut self) -> u32 {
        let node = &mut self.node;
        let mut plan = None;
        let take = count(|| plan = node.take_plan(Ticks(1)));
        let Some(plan) = plan else {
            return 0;
        };
        let mut finished = None;
        let work = count(|| finished = Some(plan.work()));
        let commit = count(|| {
            if let Some(finished) = &finished {
                node.commit(finished);
            }
        });
        self.takes.add(take);
        self.commits.add(commit);
        work
    }

    fn sequence(&mut self) -> u8 {
        self.sequence = self.sequence.wrapping_add(1);
        self.sequence
    }

    fn control(&mut self, action: Action) -> u32 {
        let sequence = self.sequence();
        self.say(Command::Control {
            action,
            sequence,
            session: SESSION,
        })
    }

    fn go(&mut self, turns: i64, profile: ProfileKind) -> u32 {
        let sequence = self.sequence();
        self.say(Command::Move {
            profile,
            staged: false,
            target: Position::from_counts(turns * COUNTS_PER_TURN),
            duration: Ticks(2_000),
            sequence,
        })
    }
}

fn measure_node() {
    let mut bench = Bench::enabled();
    let mut still = Spread::new();
    for _ in 0..1_000 {
        still.add(bench.tick());
    }
    still.report("node.tick_at_rest");
    for (profile, name) in [
        (ProfileKind::Beta, "beta"),
        (ProfileKind::Trapezoid, "trapezoid"),
    ] {
        let (mut start, mut moving, mut retarget) = (Spread::new(), Spread::new(), Spread::new());
        for round in 0..20 {
            start.add(bench.go(1 + round % 3, profile));
            for _ in 0..500 + 50 * (round as u32 % 16) {
                moving.add(bench.tick());
            }
            retarget.add(bench.go(-3 + round % 5, profile));
            for _ in 0..4_500 {
                bench.tick();
            }
        }
        start.report(format_args!("node.start_{name}"));
        moving.report(format_args!("node.tick_{name}"));
        retarget.report(format_args!("node.retarget_{name}"));
    }
    measure_overlaid(&mut bench);
    measure_stops(&mut bench);
    measure_overtaken();
    bench.decisions.report("node.handle_frame");
    bench.takes.report("node.take_plan");
    bench.commits.report("node.commit");
}

/// Stops in mid-move, by a frame and because the host falls silent.
fn measure_stops(bench: &mut Bench) {
    let (mut stop, mut ticks) = (Spread::new(), Spread::new());
    for (profile, round) in [ProfileKind::Beta, ProfileKind::Trapezoid]
        .into_iter()
        .flat_map(|profile| (0..10).map(move |round| (profile, round)))
    {
        bench.go(3 - 6 * (round % 2), profile);
        for _ in 0..100 + 200 * round as u32 {
            bench.tick();
        }
        let sequence = bench.sequence();
        stop.add(bench.say(Command::Stop { sequence }));
        for _ in 0..500 {
            bench.tick();
        }
    }
    bench.go(0, ProfileKind::Beta);
    bench.beats = false;
    for _ in 0..600 {
        ticks.add(bench.tick());
        let planned = bench.plan();
        if planned > 0 {
            stop.add(planned);
        }
    }
    stop.report("node.stop");
    ticks.report("node.tick_without_host");
}

/// As many moves laid over each other as there is room for, and then the host falls silent.
fn measure_overlaid(bench: &mut Bench) {
    let mut ticks = Spread::new();
    for target in [1, 2, 3, 4] {
        let sequence = bench.sequence();
        bench.say(Command::Move {
            profile: ProfileKind::Beta,
            staged: false,
            target: Position::from_counts(target * COUNTS_PER_TURN / 16),
            duration: Ticks(5_000),
            sequence,
        });
        for _ in 0..200 {
            ticks.add(bench.tick());
        }
    }
    for _ in 0..6_000 {
        bench.tick();
    }
    ticks.report("node.tick_overlaid");
}

/// What a move that waits for its plan adds to the frames and the tick that call it off.
fn measure_overtaken() {
    let (mut frames, mut ticks) = (Spread::new(), Spread::new());
    for round in 0..3 {
        let mut bench = Bench::enabled();
        bench.go(3, ProfileKind::Beta);
        for _ in 0..500 {
            bench.tick();
        }
        bench.plans = false;
        bench.decisions = Spread::new();
        bench.go(1, ProfileKind::Trapezoid);
        bench.go(2, ProfileKind::Beta);
        match round {
            0 => _ = bench.say(Command::EmergencyStop),
            1 => _ = bench.control(Action::Disable),
            _ => bench.beats = false,
        }
        for _ in 0..400 {
            ticks.add(bench.tick());
        }
        frames.merge(&bench.decisions);
    }
    frames.report("node.handle_frame_overtaking");
    ticks.report("node.tick_overtaking");
}
