//! Counts the instructions of the core's inner functions.
#![no_std]
#![no_main]

use core::fmt::Display;
use core::hint::black_box;

use canter_images::{count, finish, report};
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
    debug();
    measure_node();
    finish()
}

/// A known number of instructions, to see that the count is right.
#[inline(always)]
fn nops_1000() {
    // SAFETY: does nothing, a thousand times.
    unsafe { core::arch::asm!(".rept 1000", "nop", ".endr", options(nomem, nostack)) };
}

/// The least, the mean and the most of some counts.
struct Spread {
    least: u32,
    most: u32,
    sum: u32,
    counts: u32,
}

impl Spread {
    fn new() -> Self {
        Self {
            least: u32::MAX,
            most: 0,
            sum: 0,
            counts: 0,
        }
    }

    fn add(&mut self, count: u32) {
        self.least = self.least.min(count);
        self.most = self.most.max(count);
        self.sum += count;
        self.counts += 1;
    }

    fn merge(&mut self, other: &Self) {
        self.least = self.least.min(other.least);
        self.most = self.most.max(other.most);
        self.sum += other.sum;
        self.counts += other.counts;
    }

    fn report(&self, name: impl Display) {
        let mean = self.sum / self.counts.max(1);
        report(format_args!("{name}.least"), self.least);
        report(format_args!("{name}.mean"), mean);
        report(format_args!("{name}.most"), self.most);
    }
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

fn debug() {
    use canter_shared::motion::bounds::Bounds;
    use canter_shared::motion::s_curve::*;
    use canter_shared::motion::trajectory::*;
    use canter_shared::motion::*;
    let (mut a, mut b, mut c, mut d, mut e, mut f) = (
        Spread::new(),
        Spread::new(),
        Spread::new(),
        Spread::new(),
        Spread::new(),
        Spread::new(),
    );
    let mut r = 0x9E37_79B9_7F4A_7C15u64;
    let mut rnd = move || {
        r ^= r << 13;
        r ^= r >> 7;
        r ^= r << 17;
        (r >> 11) as f64 / (1u64 << 53) as f64
    };
    let bd = Bounds::new(3.18, 31.8, 31.8, 3183.0).unwrap();
    let sb = SignedBounds::forward(&bd).unwrap();
    for _ in 0..300 {
        let from = Sample {
            position: 0.0,
            velocity: 6.0 * (rnd() - 0.5),
            acceleration: 60.0 * (rnd() - 0.5),
            jerk: 0.0,
        };
        let from = black_box(from);
        let t = black_box(4.0 * (rnd() - 0.5));
        a.add(count(|| change_velocity(from, 0.0, &sb)));
        b.add(count(|| to_rest(from, t, &sb)));
        c.add(count(|| lasting(from, t, 2.0, &sb)));
        d.add(count(|| trapezoid::exact::to_rest(from, t, &bd)));
    }
    a.report("s.change"); b.report("s.to_rest"); c.report("s.lasting"); d.report("t.to_rest");
    let (x, y) = (black_box(1.2345f64), black_box(3.456f64));
    report("add", count(|| black_box(x) + black_box(y)));
    report("sub", count(|| black_box(x) - black_box(y)));
    report("mul", count(|| black_box(x) * black_box(y)));
    report("div", count(|| black_box(x) / black_box(y)));
    report("cmp", count(|| black_box(x) < black_box(y)));
    report("sqrt", count(|| black_box(x).abs()));
    report("i2d", count(|| black_box(123456789012i64) as f64));
    report("d2i", count(|| black_box(x) as i64));
    let limits = Limits::default();
    for p in [Profile::Beta, Profile::SCurve, Profile::Trapezoid] {
        let (mut a, mut b, mut c) = (Spread::new(), Spread::new(), Spread::new());
        for _ in 0..200 {
            let mut m = Motion::at_rest(Position::ZERO);
            let go = Move {
                target: Position::from_counts((rnd() * 4e10) as i64 - 20_000_000_000),
                duration: Ticks(4000),
                profile: p,
            };
            a.add(count(|| {
                m.start(Tick(0), Tick(0), black_box(go), &limits).is_ok()
            }));
            let now = Tick(1000 + (2500.0 * rnd()) as u64);
            let mut m2 = m.clone();
            let go = Move {
                target: Position::from_counts((rnd() * 4e10) as i64 - 20_000_000_000),
                duration: Ticks(1000),
                profile: p,
            };
            b.add(count(|| m.start(now, now, black_box(go), &limits).is_ok()));
            c.add(count(|| m2.stop(now, black_box(&limits))));
            d.add(count(|| black_box(&m2).clone()));
            let m2 = black_box(&m);
            e.add(count(|| m2.at(black_box(Tick(now.0 + 100)))));
            f.add(count(|| m.fold(black_box(Tick(now.0)))));
        }
        a.report("m.start");
        b.report("m.retarget");
        c.report("m.stop");
        d.report("clone");
        e.report("at");
        f.report("fold");
    }
}
