//! A piece of motion that is a polynomial in time of degree three at most, in integers.
//!
//! Position is from + d1 u + d2 u^2 + d3 u^3 with u = elapsed / duration. A piece begins and ends
//! between two ticks as well as on one: its elapsed time is counted in 2^-32 of a tick, so the
//! pieces of a time-optimal motion need no rounding to whole ticks. The next piece begins where
//! from + d1 + d2 + d3 leads to, exactly, so rounding cannot add up over pieces.

use super::Contribution;
use super::fixed::{multiply, scale};
use super::trajectory::Sample;
use crate::limits::Limits;
use crate::time::{TICKS_PER_SECOND, Tick, Ticks};
use crate::units::{COUNTS_PER_TURN, Position};

/// Bits behind the point of the position's coefficients.
///
/// A piece stays inside the travel of +-2^42 counts, and its coefficients are at most a few times
/// its difference of at most 2^43.
pub(crate) const COEFFICIENT_BITS: u32 = 16;

/// The farthest place that a piece may begin at, in counts: 16 times the travel, and raised it
/// leaves room for two bits in an i64.
pub(crate) const FARTHEST: i64 = 1 << (62 - COEFFICIENT_BITS);

/// No coefficient reaches this: the sum of three fits an i64.
const LARGEST_COEFFICIENT: u64 = 1 << 61;

/// Ticks behind the point of times inside a motion.
const TIME_BITS: u32 = 32;

/// Parts of 2^-32 of a tick in one second.
const PARTS_PER_SECOND: f64 = TICKS_PER_SECOND as f64 * (1u64 << TIME_BITS) as f64;

/// 1 - 2^-51: more than an f64's quotient of two rounded numbers can be too large by.
const ROUNDED_DOWN: f64 = 1.0 - 2.0 * f64::EPSILON;

/// What a jerk that was planned at its limit comes to at least, for durations that are rounded to
/// 2^-32 of a tick.
const ALMOST: f64 = 1.0 - 1e-6;

/// A time after the start of a motion, in 2^-32 of a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(crate) struct Moment(u64);

impl Moment {
    /// The nearest to `seconds`, which is not negative.
    pub(crate) fn from_seconds(seconds: f64) -> Self {
        Self((seconds * PARTS_PER_SECOND + 0.5) as u64)
    }

    /// At the end of whole ticks.
    pub(crate) fn from_ticks(ticks: Ticks) -> Self {
        Self(u64::from(ticks.0) << TIME_BITS)
    }

    /// The whole tick before, where that is so near that it can only be meant.
    ///
    /// A duration in f64 misses its ticks by rounding: a few times 2^-41 s for the longest. 2^-22 of
    /// a tick is far more than that, and a motion moves nothing in that time before it rests.
    pub(crate) fn settled(self) -> Self {
        let fraction = self.0 as u32;
        if fraction < 1 << (TIME_BITS - 22) {
            Self(self.0 - u64::from(fraction))
        } else {
            self
        }
    }

    /// The first tick that is not before this time in a motion that starts at `start`.
    pub(crate) fn tick(self, start: Tick) -> Tick {
        Tick(start.0.saturating_add(self.ticks()))
    }

    /// Whole ticks to the first tick that is not before.
    pub(crate) fn ticks(self) -> u64 {
        self.0.div_ceil(1 << TIME_BITS)
    }

    /// What is missing to that tick.
    fn to_tick(self) -> u32 {
        (self.0 as u32).wrapping_neg()
    }
}

/// One polynomial piece, over the ticks from its start to just before the next piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Phase {
    /// The first tick that it covers.
    first: Tick,
    /// The first tick that it no longer covers.
    end: Tick,
    /// From its start to `first`, in 2^-32 of a tick.
    ahead: u32,
    /// Bits by which the elapsed time is raised, as the duration was for its reciprocal.
    shift: u8,
    departs: bool,
    steps: bool,
    /// 2^127 over the duration raised to the top of 64 bits.
    reciprocal: u64,
    /// Where it begins, raised by [`COEFFICIENT_BITS`].
    from: i64,
    /// Raised by [`COEFFICIENT_BITS`].
    position: [i64; 3],
    /// Counts per second.
    velocity: [i64; 3],
    /// Counts per second squared.
    acceleration: [i64; 2],
}

/// When a piece begins and ends, counted from the start of its motion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    /// The tick at which the motion starts.
    pub start: Tick,
    /// When the piece begins.
    pub from: Moment,
    /// When it ends.
    pub to: Moment,
    /// The same in seconds, with the digits that an f64 has.
    pub seconds: f64,
}

impl Phase {
    /// A piece of constant jerk that begins at the place `from`, raised by [`COEFFICIENT_BITS`],
    /// with the velocity, acceleration and jerk of `entry`, in turns and seconds.
    ///
    /// `None` where it would run over more counts than a position can hold.
    pub(crate) fn new(span: Span, from: i64, entry: Sample) -> Option<Self> {
        let counts = |turns: f64| turns * COUNTS_PER_TURN as f64;
        let velocity = counts(entry.velocity);
        let acceleration = counts(entry.acceleration);
        let jerk = counts(entry.jerk);
        let duration = span.to.0.checked_sub(span.from.0)?;
        if duration == 0 {
            return None;
        }
        let seconds = span.seconds;
        let raised = seconds * (1u64 << COEFFICIENT_BITS) as f64;
        let change = acceleration * seconds;
        let ramp = jerk * seconds;
        let bend = ramp * seconds * 0.5;
        let phase = Self {
            first: span.from.tick(span.start),
            end: span.to.tick(span.start),
            ahead: span.from.to_tick(),
            shift: duration.leading_zeros() as u8,
            departs: false,
            steps: false,
            reciprocal: reciprocal(duration << duration.leading_zeros()),
            from,
            position: [
                (velocity * raised) as i64,
                (change * raised * 0.5) as i64,
                (bend * raised * (1.0 / 3.0)) as i64,
            ],
            velocity: [velocity as i64, change as i64, bend as i64],
            acceleration: [acceleration as i64, ramp as i64],
        };
        let fits = |value: &i64| value.unsigned_abs() < LARGEST_COEFFICIENT;
        let fit = phase.position.iter().all(fits)
            && phase.velocity.iter().all(fits)
            && phase.acceleration.iter().all(fits);
        fit.then_some(phase)
    }

    /// The first tick that the phase covers.
    pub(crate) fn first(&self) -> Tick {
        self.first
    }

    /// The first tick that the phase no longer covers.
    pub(crate) fn end(&self) -> Tick {
        self.end
    }

    /// Whether it covers a tick at all: one that lies between two ticks is never looked at.
    pub(crate) fn is_seen(&self) -> bool {
        self.first < self.end
    }

    /// Leaves the ticks from `end` on to another phase.
    pub(crate) fn cut(&mut self, end: Tick) {
        self.end = self.end.min(end);
    }

    /// Moves its exit to the place `to`, raised by [`COEFFICIENT_BITS`]: takes up the rounding of
    /// a whole chain, so that its last phase ends exactly where it was meant to.
    pub(crate) fn end_at(&mut self, to: i64) {
        let missing = to.saturating_sub(self.exit());
        let [linear, ..] = &mut self.position;
        *linear = linear.saturating_add(missing);
    }

    /// Moves the whole phase by `counts`.
    pub(crate) fn shift(&mut self, counts: i64) {
        let raised = counts.saturating_mul(1 << COEFFICIENT_BITS);
        self.from = self.from.saturating_add(raised);
    }

    /// Marks the first phase of a move that leaves from rest, and that can be dropped as long as
    /// it has not begun.
    pub(crate) fn depart(&mut self) {
        self.departs = true;
    }

    /// Whether the phase is the first of a move that leaves from rest.
    pub(crate) fn departs(&self) -> bool {
        self.departs
    }

    /// Marks a phase of a trapezoid, whose acceleration steps.
    pub(crate) fn step(&mut self) {
        self.steps = true;
    }

    /// Whether the acceleration steps, as only a trapezoid's does.
    pub(crate) fn steps(&self) -> bool {
        self.steps
    }

    /// The position where the phase begins, in counts.
    pub(crate) fn entry_position(&self) -> i64 {
        rounded(self.from)
    }

    /// The place where the next phase begins, raised by [`COEFFICIENT_BITS`].
    pub(crate) fn exit(&self) -> i64 {
        let [d1, d2, d3] = self.position;
        self.from.saturating_add(d1 + d2 + d3)
    }

    /// The motion at a tick that the phase covers.
    #[inline]
    pub(crate) fn contribution(&self, tick: Tick) -> Contribution {
        let ticks = tick.0.saturating_sub(self.first.0);
        let elapsed = (ticks << TIME_BITS).wrapping_add(u64::from(self.ahead));
        // The reciprocal is rounded down, so the product is below one half.
        let u = multiply(elapsed << self.shift, self.reciprocal) << 1;
        let [d1, d2, d3] = self.position;
        let [v0, v1, v2] = self.velocity;
        let [a0, a1] = self.acceleration;
        let moved = scale(d1 + scale(d2 + scale(d3, u), u), u);
        Contribution {
            position: rounded(self.from.saturating_add(moved)),
            velocity: v0 + scale(v1 + scale(v2, u), u),
            acceleration: a0 + scale(a1, u),
        }
    }
}

impl Phase {
    /// Whether the ticks from `now` on keep `limits`; `false` where that is not plain.
    pub(crate) fn keeps(&self, now: Tick, limits: &Limits) -> bool {
        if self.end <= now {
            return true;
        }
        let from = self.contribution(now.max(self.first));
        let to = self.last();
        let fastest = self.turn().max(from.velocity.abs()).max(to.velocity.abs());
        // Over the whole phase the velocity has the sign of its ends, or passes zero.
        let ends = (from.velocity.signum(), to.velocity.signum());
        let strong = |acceleration: i64| {
            let limit = match ends.0 + ends.1 {
                0 => limits.slower_acceleration(),
                direction if (direction > 0) == (acceleration > 0) => limits.acceleration(),
                _ => limits.deceleration(),
            };
            acceleration.abs() > limit.counts()
        };
        // No place is farther from where it begins than this.
        let way = fastest as f64 * self.end.since(now).seconds();
        let farthest = |sign: f64| Position::from_counts(from.position.saturating_add((sign * way) as i64));
        let between = limits.allow(Position::from_counts(from.position))
            && limits.allow(Position::from_counts(to.position));
        let straight = ends.0 * ends.1 >= 0 && self.turn() == 0;
        fastest <= limits.velocity().counts()
            && !strong(from.acceleration)
            && !strong(to.acceleration)
            && (self.steps || self.jerk() * ALMOST <= limits.jerk().counts() as f64)
            && (between && straight || limits.allow(farthest(1.0)) && limits.allow(farthest(-1.0)))
    }

    /// Whether velocity and acceleration change from here to the next phase, or to rest, by no
    /// more than `limits` change them in a tick: between the two there can be phases that no tick
    /// sees.
    pub(crate) fn joins(&self, next: Option<&Self>, limits: &Limits) -> bool {
        let entry = next.map_or((0, 0), |next| {
            let ([velocity, ..], [acceleration, _]) = (next.velocity, next.acceleration);
            (velocity, acceleration)
        });
        let exit = self.last();
        let within = |change: i64, limit: i64| change.abs() <= limit / TICKS_PER_SECOND as i64;
        let strongest = limits.slower_acceleration().counts();
        within(entry.0.saturating_sub(exit.velocity), strongest)
            && (self.steps
                || within(
                    entry.1.saturating_sub(exit.acceleration),
                    limits.jerk().counts(),
                ))
    }

    /// What it ends with.
    fn last(&self) -> Contribution {
        let [v0, v1, v2] = self.velocity;
        let [a0, a1] = self.acceleration;
        Contribution {
            position: rounded(self.exit()),
            velocity: v0 + v1 + v2,
            acceleration: a0 + a1,
        }
    }

    /// The magnitude of the velocity where it turns inside the phase; zero where it does not.
    fn turn(&self) -> i64 {
        let [v0, v1, v2] = self.velocity.map(|coefficient| coefficient as f64);
        let [a0, a1] = self.acceleration;
        if (a0 > 0) == (a0 + a1 > 0) {
            return 0;
        }
        // v0 + v1 u + v2 u^2 at u = -v1 / (2 v2)
        (v0 - v1 * v1 / (4.0 * v2)).abs() as i64
    }

    /// The magnitude of the jerk, in counts/s^3.
    fn jerk(&self) -> f64 {
        let [_, ramp] = self.acceleration;
        // reciprocal = 2^127 / (duration 2^shift)
        let shifted = (1u64 << self.shift.min(63)) as f64 / (1u128 << 127) as f64;
        (ramp as f64 * self.reciprocal as f64 * shifted * PARTS_PER_SECOND).abs()
    }
}

/// The nearest count to a place that is raised by [`COEFFICIENT_BITS`].
fn rounded(place: i64) -> i64 {
    const HALF: i64 = 1 << (COEFFICIENT_BITS - 1);
    place.saturating_add(HALF) >> COEFFICIENT_BITS
}

/// 2^127 / `duration` for a duration in [2^63, 2^64): at most 2^-50 of it too small, never too
/// large.
fn reciprocal(duration: u64) -> u64 {
    const NUMERATOR: f64 = (1u128 << 127) as f64 * ROUNDED_DOWN;
    // The saturating conversion gives 2^64 - 1 for the 2^64 of a power of two.
    (NUMERATOR / duration as f64) as u64
}
