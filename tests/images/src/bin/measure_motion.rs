//! Counts the instructions and the stack of whatever changes a motion, over random situations.
#![no_std]
#![no_main]

use core::hint::black_box;

use canter_images::{Spread, count, finish, report, stack};
use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::beta::Beta;
use canter_shared::motion::trapezoid::Trapezoid;
use canter_shared::motion::{Motion, Move, Profile, shortest_s_curve};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::{COUNTS_PER_RADIAN, Position};
use cortex_m_rt::entry;

/// Situations for each profile.
const ROUNDS: u32 = 300;

#[entry]
fn main() -> ! {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let mut deepest = Deepest::default();
    for (profile, name) in [
        (Profile::Beta, "beta"),
        (Profile::SCurve, "s_curve"),
        (Profile::Trapezoid, "trapezoid"),
    ] {
        measure(profile, name, &mut random, &mut deepest);
    }
    measure_overlays(&mut random);
    report("stack.start", deepest.start);
    report("stack.retarget", deepest.retarget);
    report("stack.stop", deepest.stop);
    report("stack.limits", deepest.limits);
    report("stack.tick", deepest.tick);
    report("motion.bytes", size_of::<Motion>());
    finish()
}

/// Numbers without order, the same in each run.
struct Random(u64);

impl Random {
    /// From `least` to `greatest`.
    fn between(&mut self, least: f64, greatest: f64) -> f64 {
        let Self(state) = self;
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        least + (greatest - least) * ((*state >> 11) as f64 / (1u64 << 53) as f64)
    }

    fn position(&mut self, radians: f64) -> Position {
        let counts = self.between(-radians, radians) * COUNTS_PER_RADIAN;
        Position::from_counts(counts as i64)
    }

    /// The default limits, or others around them.
    fn limits(&mut self) -> Limits {
        let mut times = |value: f64| value * self.between(0.2, 2.0);
        let values = LimitValues {
            velocity: times(DEFAULT_VALUES.velocity),
            acceleration: times(DEFAULT_VALUES.acceleration),
            deceleration: times(DEFAULT_VALUES.deceleration),
            jerk: times(DEFAULT_VALUES.jerk),
            ..DEFAULT_VALUES
        };
        Limits::new(&values).unwrap_or_default()
    }
}

/// The deepest stacks, in bytes.
#[derive(Default)]
struct Deepest {
    start: u32,
    retarget: u32,
    stop: u32,
    limits: u32,
    tick: u32,
}

fn deeper(deepest: &mut u32, bytes: u32) {
    *deepest = (*deepest).max(bytes);
}

/// A move to a random place, from once to three times as long as it needs from rest.
fn asked(profile: Profile, from: &Motion, limits: &Limits, random: &mut Random) -> Option<Move> {
    let target = random.position(30.0);
    let range = target - from.target();
    let shortest = match profile {
        Profile::Beta => Beta::shortest(range, limits),
        Profile::SCurve => shortest_s_curve(range, limits),
        _ => Trapezoid::shortest(range, limits).map(|shortest| shortest.duration()),
    };
    let slower = random.between(1.0, 3.0);
    let duration = Ticks((f64::from(shortest?.0) * slower) as u32);
    Some(Move {
        target,
        duration,
        profile,
    })
}

fn go(motion: &mut Motion, now: Tick, asked: Move, limits: &Limits) -> bool {
    motion.start(now, now, black_box(asked), limits).is_ok()
}

/// One profile's moves from rest, retargets (also of what a retarget made), stops and changes of
/// limits, and the ticks that follow.
fn measure(profile: Profile, name: &str, random: &mut Random, deepest: &mut Deepest) {
    let mut counts: [Spread; 6] = Default::default();
    let [start, retarget, again, stop, change, tick] = &mut counts;
    for _ in 0..ROUNDS {
        let limits = random.limits();
        let mut motion = Motion::at_rest(Position::ZERO);
        let Some(first) = asked(profile, &motion, &limits, random) else {
            continue;
        };
        let rest = motion.clone();
        start.add(count(|| go(&mut motion, Tick(10), first, &limits)));
        let mut same = rest.clone();
        deeper(
            &mut deepest.start,
            stack(|| go(&mut same, Tick(10), first, &limits)),
        );
        let part = random.between(0.02, 0.98);
        let now = Tick(10 + (f64::from(first.duration.0) * part) as u64);
        let Some(second) = asked(profile, &motion, &limits, random) else {
            continue;
        };
        let others = random.limits();
        for (planned, deep, what) in [
            (&mut *retarget, &mut deepest.retarget, What::Go(second)),
            (&mut *stop, &mut deepest.stop, What::Stop),
            (&mut *change, &mut deepest.limits, What::Limits(others)),
        ] {
            let mut next = motion.clone();
            planned.add(count(|| what.happens(&mut next, now, &limits)));
            let mut same = motion.clone();
            deeper(deep, stack(|| what.happens(&mut same, now, &limits)));
            for later in 1..20 {
                let at = now.after(Ticks(later * 7));
                tick.add(count(|| ticks(&mut next, at)));
                let mut same = next.clone();
                deeper(&mut deepest.tick, stack(|| ticks(&mut same, at)));
            }
            if let (What::Go(_), Some(third)) = (&what, asked(profile, &next, &limits, random)) {
                let later = now.after(Ticks(140));
                again.add(count(|| go(&mut next, later, third, &limits)));
            }
        }
    }
    start.report(format_args!("motion.start_{name}"));
    retarget.report(format_args!("motion.retarget_{name}"));
    again.report(format_args!("motion.retarget_again_{name}"));
    stop.report(format_args!("motion.stop_{name}"));
    change.report(format_args!("motion.limits_{name}"));
    tick.report(format_args!("motion.tick_{name}"));
}

/// What befalls a motion.
#[derive(Clone, Copy)]
enum What {
    Go(Move),
    Stop,
    Limits(Limits),
}

impl What {
    fn happens(self, motion: &mut Motion, now: Tick, limits: &Limits) -> bool {
        match black_box(self) {
            Self::Go(asked) => motion.start(now, now, asked, limits).is_ok(),
            Self::Stop => motion.stop(now, limits) > now,
            Self::Limits(others) => motion.change_limits(now, &others).is_ok(),
        }
    }
}

/// What the tick does with a motion.
fn ticks(motion: &mut Motion, tick: Tick) -> Position {
    let tick = black_box(tick);
    let setpoint = black_box(motion.at(tick));
    motion.fold(tick);
    setpoint.position
}

/// Retargets of beta moves that leave room to be laid over: half of the limits at most.
fn measure_overlays(random: &mut Random) {
    let limits = Limits::default();
    let (mut overlay, mut tick) = (Spread::new(), Spread::new());
    let mut round = 0;
    while round < ROUNDS {
        let mut motion = Motion::at_rest(Position::ZERO);
        let Some(mut first) = asked(Profile::Beta, &motion, &limits, random) else {
            continue;
        };
        first.duration = Ticks(2 * first.duration.0 + 100);
        go(&mut motion, Tick(0), first, &limits);
        let part = random.between(0.02, 0.98);
        let now = Tick((f64::from(first.duration.0) * part) as u64);
        let Some(mut second) = asked(Profile::Beta, &motion, &limits, random) else {
            continue;
        };
        second.duration = Ticks(2 * second.duration.0 + 100);
        overlay.add(count(|| go(&mut motion, now, second, &limits)));
        for later in 1..20 {
            let at = now.after(Ticks(later * 5));
            tick.add(count(|| ticks(&mut motion, at)));
        }
        round += 1;
    }
    overlay.report("motion.overlay");
    tick.report("motion.tick_overlaid");
}
