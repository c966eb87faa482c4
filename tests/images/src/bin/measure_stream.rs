//! Counts the instructions of streamed motion and of input shaping.
#![no_std]
#![no_main]

use core::hint::black_box;
use core::num::NonZeroU8;

use canter_images::{count, finish, report};
use canter_shared::limits::Limits;
use canter_shared::motion::Setpoint;
use canter_shared::motion::beta::Beta;
use canter_shared::motion::stream::{Knot, LOOK_AHEAD, Stream};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::{Acceleration, COUNTS_PER_TURN, Position, Velocity};
use cortex_m_rt::entry;

#[entry]
fn main() -> ! {
    measure_stream();
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
        let (mut push, mut at) = (0, 0);
        let mut now = Tick(0);
        for number in 1..=200 {
            let knot = knot(motion.at(Tick(20 * number)), quintic);
            let stream = &mut stream;
            let pushed = count(|| stream.push(now, number as u8, black_box(&knot), &limits));
            push = push.max(pushed);
            if number as usize >= LOOK_AHEAD {
                // Of all the pieces that are held.
                for later in 0..20 * LOOK_AHEAD as u32 {
                    let tick = black_box(now.after(Ticks(later)));
                    at = at.max(count(|| stream.at(tick)));
                }
                now = now.after(Ticks(20));
            }
        }
        assert!(stream.ends() == Tick(4_000), "every knot was taken on");
        report(format_args!("stream.{name}.at.most"), at);
        report(format_args!("stream.{name}.push.most"), push);
    }
    measure_hostile_knots(&limits, period);
    report("stream.bytes", size_of::<Stream>());
}

/// Knots that come near the limits, and over them: those take longest to be looked at.
fn measure_hostile_knots(limits: &Limits, period: NonZeroU8) {
    let mut random = 1u64;
    let mut below = |limit: i64| {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (random >> 33) as i64 % (2 * limit) - limit
    };
    let (velocity, acceleration) = (limits.velocity().counts(), limits.acceleration().counts());
    let (mut most, mut accepted) = (0, 0);
    for _ in 0..20_000 {
        // In steps that a 31-bit number can count: a second's way is 20 ms of it, 50 times over.
        let scaled = |value: i64, full: i64| full / 1_000 * value;
        let mut state = |position| Setpoint {
            position: Position::from_counts(position),
            velocity: Velocity::from_counts(scaled(below(1_000), velocity)),
            acceleration: Acceleration::from_counts(scaled(below(1_000), acceleration)),
        };
        let (from, mut to) = (state(0), state(0));
        let mean = (from.velocity.counts() + to.velocity.counts()) / 2;
        // Half of the time the two velocities are near each other.
        let near = mean & 1 == 0;
        if near {
            to.velocity = Velocity::from_counts(
                from.velocity.counts() + scaled(below(100), acceleration / 5),
            );
        }
        let mean = (from.velocity.counts() + to.velocity.counts()) / 2;
        to.position =
            Position::from_counts(mean / 50 + scaled(below(1_000), acceleration / 20_000));
        let mut stream = Stream::new(Tick(0), 0, from, period);
        let knot = knot(to, true);
        let stream = &mut stream;
        most = most.max(count(|| stream.push(Tick(0), 1, black_box(&knot), limits)));
        accepted += u32::from(stream.ends() > Tick(0));
    }
    report("stream.hostile.accepted", accepted);
    report("stream.hostile.push.most", most);
}
