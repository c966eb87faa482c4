//! Counts the instructions of streamed motion and of input shaping.
#![no_std]
#![no_main]

use core::hint::black_box;
use core::num::NonZeroU8;

use canter_images::{count, finish, report};
use canter_shared::axis::Axis;
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::drive::simulated::Simulated;
use canter_shared::limits::Limits;
use canter_shared::motion::Setpoint;
use canter_shared::motion::beta::Beta;
use canter_shared::motion::shaping::{MOST_IMPULSES, Shaper, ShaperKind, Shaping};
use canter_shared::motion::stream::{Knot, LOOK_AHEAD, Stream};
use canter_shared::node::{Board, Identity, Node};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::{Acceleration, COUNTS_PER_TURN, Position, Velocity};
use canter_shared::wire::command::{Action, Command, wire_position, wire_velocity};
use canter_shared::wire::id::{Address, AxisId};
use cortex_m_rt::entry;

#[entry]
fn main() -> ! {
    measure_stream();
    measure_streaming_axis();
    measure_shaping();
    finish()
}

fn knot(state: Setpoint, quintic: bool) -> Knot {
    Knot {
        position: state.position,
        velocity: state.velocity,
        acceleration: quintic.then_some(state.acceleration),
    }
}

fn measure_stream() {
    let limits = Limits::default();
    let period = NonZeroU8::MIN.saturating_add(19);
    let range = Position::from_counts(3 * COUNTS_PER_TURN);
    let motion = Beta::new(Tick(0), range, Ticks(4_000));
    for (quintic, name) in [(false, "cubic"), (true, "quintic")] {
        let mut stream = Stream::new(Tick(0), 0, motion.at(Tick(0)), period);
        let (mut push, mut advance, mut at, mut ahead) = (0, 0, 0, 0);
        let mut now = Tick(0);
        for number in 1..=200 {
            let knot = knot(motion.at(Tick(20 * number)), quintic);
            let stream = &mut stream;
            let pushed = count(|| stream.push(now, number as u8, black_box(&knot), &limits));
            push = push.max(pushed);
            if number as usize >= LOOK_AHEAD {
                // Of all the pieces that are held, as who plans asks for them.
                for later in 0..20 * LOOK_AHEAD as u32 {
                    let tick = black_box(now.after(Ticks(later)));
                    ahead = ahead.max(count(|| stream.at(tick)));
                }
                // And of the one under way, as the tick asks.
                for _ in 0..20 {
                    let tick = black_box(now);
                    advance = advance.max(count(|| stream.advance(tick)));
                    at = at.max(count(|| stream.at(tick)));
                    now = now.after(Ticks(1));
                }
            }
        }
        assert!(stream.ends() == Tick(4_000), "every knot was taken on");
        report(format_args!("stream.{name}.advance.most"), advance);
        report(format_args!("stream.{name}.at.most"), at);
        report(format_args!("stream.{name}.at_ahead.most"), ahead);
        report(format_args!("stream.{name}.push.most"), push);
    }
    measure_hostile_knots(&limits, period, false, "cubic");
    measure_hostile_knots(&limits, period, true, "quintic");
    report("stream.bytes", size_of::<Stream>());
}

/// Numbers without order, the same in each run.
struct Random(u64);

impl Random {
    /// A number from `-limit` to just below `limit`.
    fn within(&mut self, limit: i64) -> i64 {
        let Self(state) = self;
        // Knuth's MMIX generator.
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let high = (*state >> 33) as i64;
        high % (2 * limit) - limit
    }

    /// Such a part of `full`, in thousandths.
    fn part(&mut self, full: i64) -> i64 {
        full / 1_000 * self.within(1_000)
    }
}

/// Knots that come near the limits, and over them: those take longest to be looked at.
fn measure_hostile_knots(limits: &Limits, period: NonZeroU8, quintic: bool, name: &str) {
    let mut random = Random(1);
    let (velocity, acceleration) = (limits.velocity().counts(), limits.acceleration().counts());
    let (mut most, mut accepted) = (0, 0);
    for _ in 0..20_000 {
        let mut state = || Setpoint {
            position: Position::ZERO,
            velocity: Velocity::from_counts(random.part(velocity)),
            acceleration: Acceleration::from_counts(random.part(acceleration)),
        };
        let (from, mut to) = (state(), state());
        // 20 ms are a fiftieth of a second: half of the time a velocity that is within reach.
        if random.within(1) < 0 {
            let change = Velocity::from_counts(random.part(acceleration / 50));
            to.velocity = from.velocity + change;
        }
        let mean = (from.velocity + to.velocity).counts() / 2;
        // And a way that is near the one that the velocities ask for.
        let bend = random.part(acceleration / 20_000);
        to.position = Position::from_counts(mean / 50 + bend);
        let mut stream = Stream::new(Tick(0), 0, from, period);
        let (stream, knot) = (&mut stream, knot(to, quintic));
        most = most.max(count(|| stream.push(Tick(0), 1, black_box(&knot), limits)));
        accepted += u32::from(stream.ends() > Tick(0));
    }
    report(format_args!("stream.hostile_{name}.accepted"), accepted);
    report(format_args!("stream.hostile_{name}.push.most"), most);
}

/// A stream as it comes to a node: a frame for each knot, a tick each millisecond, then no more
/// knots, so that it brakes.
fn measure_streaming_axis() {
    const SESSION: u16 = 1;
    let mut node: Node<Simulated, 1> = Node::new(Identity {
        chip: [0; 12],
        firmware: [0; 3],
        board: Board::Emulated,
    });
    let Some(axis) = AxisId::new(1) else {
        panic!("1 is an axis")
    };
    let added = node.add_axis(axis, Limits::default(), Simulated::new(Position::ZERO));
    assert!(added.is_ok(), "a node has room for its axis");
    let tick = |node: &mut Node<Simulated, 1>, moved: &mut u32| {
        let now = node.next_tick();
        let mut moves = false;
        let spent = count(|| {
            let setpoints = node.tick(black_box(now));
            moves = setpoints
                .iter()
                .any(|axis| axis.setpoint.velocity > Velocity::ZERO);
        });
        if moves {
            *moved = spent.max(*moved);
        }
        while node.poll_transmit(now).is_some() {}
    };
    let say = |node: &mut Node<Simulated, 1>, command: Command| {
        let address = match command {
            Command::HostHeartbeat { .. } => Address::All,
            _ => Address::Axis(axis),
        };
        let Ok(frame) = command.encode(address) else {
            panic!("{command:?} does not fit a frame")
        };
        let now = node.next_tick();
        count(|| node.handle_frame(black_box(now), black_box(&frame)))
    };
    let mut ignored = 0;
    tick(&mut node, &mut ignored);
    for (action, sequence) in [(Action::Hold, 1), (Action::Enable, 2)] {
        say(
            &mut node,
            Command::Control {
                action,
                sequence,
                session: SESSION,
            },
        );
        for _ in 0..10 {
            tick(&mut node, &mut ignored);
        }
    }
    let start = node.bus_time(node.next_tick()).next_tick().after(Ticks(1));
    let begin = say(
        &mut node,
        Command::StreamBegin {
            start,
            period: 20,
            number: 0,
            sequence: 3,
        },
    );
    let range = Position::from_counts(3 * COUNTS_PER_TURN);
    let motion = Beta::new(Tick(0), range, Ticks(4_000));
    let (mut knot, mut streaming, mut braking) = (0, 0, 0);
    for number in 1..=100 {
        let state = motion.at(Tick(20 * number));
        let command = Command::Knot {
            position: wire_position(state.position),
            velocity: wire_velocity(state.velocity),
            number: (number % 64) as u8,
        };
        knot = knot.max(say(&mut node, command));
        // The start is two ticks ahead: one knot less fits.
        if number as usize >= LOOK_AHEAD - 1 {
            for _ in 0..20 {
                tick(&mut node, &mut streaming);
            }
            if number % 10 == 0 {
                say(&mut node, Command::HostHeartbeat { session: SESSION });
            }
        }
    }
    while node
        .axes()
        .all(|axis| axis.state() == State::OperationEnabled)
    {
        tick(&mut node, &mut streaming);
    }
    let underrun = |axis: &Axis| axis.fault() == Some(Fault::StreamUnderrun);
    assert!(node.axes().all(underrun), "it has run dry");
    while node
        .axes()
        .any(|axis| axis.state() == State::FaultReactionActive)
    {
        tick(&mut node, &mut braking);
    }
    report("node.stream_begin", begin);
    report("node.knot.most", knot);
    report("node.tick_stream.most", streaming);
    report("node.tick_stream_brake.most", braking);
    report("axis.bytes", size_of::<Axis>());
}

fn measure_shaping() {
    // Half a period between two ticks, so that all the parts are there.
    let Ok(shaping) = Shaping::new(ShaperKind::Ei, black_box(7.3), black_box(0.05)) else {
        panic!("a shaper for 7.3 Hz can be made")
    };
    assert!(shaping.impulses_in_ticks().len() == MOST_IMPULSES);
    let mut shaper = Shaper::none();
    let change = count(|| shaper.change(Some(&shaping)));
    let motion = Beta::new(
        Tick(0),
        Position::from_counts(-3 * COUNTS_PER_TURN),
        Ticks(1_000),
    );
    let mut shape = 0;
    for tick in 0..1_500 {
        let setpoint = black_box(motion.at(Tick(tick)));
        shape = shape.max(count(|| shaper.shape(setpoint)));
    }
    assert!(shaper.is_settled(), "the move has ended");
    report("shaping.shape.most", shape);
    report("shaping.change", change);
    report("shaping.reset", count(|| shaper.reset(Position::ZERO)));
    report("shaping.bytes", size_of::<Shaper>());
}
