//! A piece of motion that is a polynomial in time of degree three at most, in integers.
//!
//! Position is from + d1 u + d2 u^2 + d3 u^3 with u = elapsed / duration. A piece begins and ends
//! between two ticks as well as on one: its elapsed time is counted in 2^-32 of a tick, so the
//! pieces of a time-optimal motion need no rounding to whole ticks. The next piece begins where
//! from + d1 + d2 + d3 leads to, exactly, so rounding cannot add up over pieces.
//!
//! What is solved in f64 costs a device without an f64 unit about 100 instructions for each
//! product, so it is turned into integers as soon as it is known, and multiplied there.

use super::Contribution;
use super::fixed::{multiply, reciprocal, scale};
use crate::limits::Limits;
use crate::time::{LONGEST_MOVE, TICKS_PER_SECOND, Tick, Ticks};
use crate::units::{COUNTS_PER_TURN, Position, difference, over_power_of_two, product, sum, whole};

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

/// Bits behind the point of a velocity that a piece begins with, of at most 2^43 counts/s: over
/// the longest move they make less than a count.
const VELOCITY_BITS: u32 = COEFFICIENT_BITS;

/// Bits behind the point of an acceleration that a piece begins with, of at most 2^50 counts/s^2.
const ACCELERATION_BITS: u32 = 8;

/// Bits of a turn's counts.
const TURN_BITS: i32 = COUNTS_PER_TURN.trailing_zeros() as i32;

/// Ticks behind the point of times inside a motion.
const TIME_BITS: u32 = 32;

/// Parts of 2^-32 of a tick in one second.
const PARTS_PER_SECOND: f64 = TICKS_PER_SECOND as f64 * (1u64 << TIME_BITS) as f64;

/// 2^64 / 6
const SIXTH: u64 = u64::MAX / 6;

/// 2^9 seconds over 1000, as a Q64 fraction: what a duration in ticks is multiplied by.
const TICK: u64 = (((1u128 << 64) << TICK_BITS) / TICKS_PER_SECOND as u128) as u64;
const TICK_BITS: u32 = 9;

/// What a jerk that was planned at its limit comes to at least, for durations that are rounded to
/// 2^-32 of a tick.
const ALMOST: f64 = 1.0 - 1e-6;

/// A time after the start of a motion, in 2^-32 of a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(crate) struct Moment(u64);

impl Moment {
    /// The nearest to `seconds`, which is not negative.
    #[inline(never)]
    pub(crate) fn from_seconds(seconds: f64) -> Self {
        let (mantissa, exponent) = parts(seconds);
        // 53 bits and the ten of a thousand fit.
        let ticks = mantissa * TICKS_PER_SECOND;
        Self(shifted(ticks, exponent + TIME_BITS as i32))
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
///
/// An axis has room for two dozen of them, so they are kept small.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Phase {
    /// The first tick that it covers.
    first: Tick,
    /// From its start to `first`, in 2^-32 of a tick.
    ahead: u32,
    extent: Extent,
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

/// What of a phase is small, in one word.
///
/// From the top: the ticks that it covers (24 bits, [`LONGEST_MOVE`] has 22); the bits by which the
/// elapsed time is raised, as the duration was for its reciprocal (6 bits); whether the phase is
/// the first of a move that leaves from rest; whether its acceleration steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Extent(u32);

impl Extent {
    const TICKS_AT: u32 = 8;
    const SHIFT_AT: u32 = 2;
    const DEPARTS: u32 = 1 << 1;
    const STEPS: u32 = 1;

    /// `None` for more ticks than any move has.
    fn new(ticks: Ticks, shift: u32) -> Option<Self> {
        let fits = ticks <= LONGEST_MOVE && shift < u64::BITS;
        fits.then_some(Self(ticks.0 << Self::TICKS_AT | shift << Self::SHIFT_AT))
    }

    fn ticks(self) -> Ticks {
        Ticks(self.0 >> Self::TICKS_AT)
    }

    fn shift(self) -> u32 {
        self.0 >> Self::SHIFT_AT & (u64::BITS - 1)
    }

    fn shorten(&mut self, ticks: Ticks) {
        let ticks = self.ticks().min(ticks);
        self.0 = ticks.0 << Self::TICKS_AT | self.0 & ((1 << Self::TICKS_AT) - 1);
    }

    fn mark(&mut self, flag: u32) {
        self.0 |= flag;
    }

    fn has(self, flag: u32) -> bool {
        self.0 & flag != 0
    }
}

/// Velocity and acceleration where a piece begins or ends.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Rates {
    /// Counts/s, raised by [`VELOCITY_BITS`].
    velocity: i64,
    /// Counts/s^2, raised by [`ACCELERATION_BITS`].
    acceleration: i64,
}

impl Rates {
    /// From turns/s and turns/s^2.
    #[inline(never)]
    pub(crate) fn new(velocity: f64, acceleration: f64) -> Self {
        Self {
            velocity: fixed(velocity, TURN_BITS + VELOCITY_BITS as i32),
            acceleration: fixed(acceleration, TURN_BITS + ACCELERATION_BITS as i32),
        }
    }
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
}

/// A time as a factor: `fraction` of 2^`exponent` seconds.
struct Factor {
    fraction: u64,
    exponent: i32,
}

impl Factor {
    /// Of a duration that is raised by `shift` to the top of 64 bits.
    fn new(raised: u64, shift: u32) -> Self {
        Self {
            fraction: multiply(raised, TICK),
            exponent: 64 - TIME_BITS as i32 - TICK_BITS as i32 - shift as i32,
        }
    }

    /// `value` times the time; saturates.
    fn times(&self, value: i64) -> i64 {
        let part = scale(value, self.fraction);
        if self.exponent < 0 {
            part >> self.exponent.unsigned_abs()
        } else {
            product(part, 1 << self.exponent)
        }
    }
}

impl Phase {
    /// A piece of constant jerk that begins at the place `from`, raised by [`COEFFICIENT_BITS`],
    /// with the rates `entry`, and ends with those of `exit`.
    ///
    /// `None` where it would run over more counts than a position can hold.
    pub(crate) fn new(span: Span, from: i64, entry: Rates, exit: Rates) -> Option<Self> {
        let duration = span.to.0.checked_sub(span.from.0)?;
        if duration == 0 {
            return None;
        }
        let shift = duration.leading_zeros();
        let raised = duration << shift;
        let time = Factor::new(raised, shift);
        let ramp = difference(exit.acceleration, entry.acceleration);
        let change = time.times(entry.acceleration);
        // Counts with the bits of an acceleration, raised to those of a coefficient.
        let way = |rate: i64| {
            let raised = 1 << (COEFFICIENT_BITS - ACCELERATION_BITS);
            product(time.times(rate), raised)
        };
        let position = [
            time.times(entry.velocity),
            over_power_of_two(way(change), 1),
            scale(way(time.times(ramp)), SIXTH),
        ];
        let (start, end) = (
            entry.velocity >> VELOCITY_BITS,
            exit.velocity >> VELOCITY_BITS,
        );
        let change = change >> ACCELERATION_BITS;
        let velocity = [start, change, difference(end - start, change)];
        let acceleration = [
            entry.acceleration >> ACCELERATION_BITS,
            ramp >> ACCELERATION_BITS,
        ];
        let fits = |value: &i64| value.unsigned_abs() < LARGEST_COEFFICIENT;
        let fit = position
            .iter()
            .chain(&velocity)
            .chain(&acceleration)
            .all(fits);
        let first = span.from.tick(span.start);
        let extent = Extent::new(span.to.tick(span.start).since(first), shift)?;
        fit.then_some(Self {
            first,
            ahead: span.from.to_tick(),
            extent,
            reciprocal: reciprocal(raised),
            from,
            position,
            velocity,
            acceleration,
        })
    }

    /// The first tick that the phase covers.
    pub(crate) fn first(&self) -> Tick {
        self.first
    }

    /// The first tick that the phase no longer covers.
    pub(crate) fn end(&self) -> Tick {
        self.first.after(self.extent.ticks())
    }

    /// Whether `tick` is behind it.
    pub(crate) fn is_over(&self, tick: Tick) -> bool {
        tick.0.saturating_sub(self.first.0) >= u64::from(self.extent.ticks().0)
    }

    /// Whether it covers a tick at all: one that lies between two ticks is never looked at.
    pub(crate) fn is_seen(&self) -> bool {
        self.extent.ticks() > Ticks(0)
    }

    /// Leaves the ticks from `end` on to another phase.
    pub(crate) fn cut(&mut self, end: Tick) {
        self.extent.shorten(end.since(self.first));
    }

    /// Moves its exit to the place `to`, raised by [`COEFFICIENT_BITS`]: takes up the rounding of
    /// a whole chain, so that its last phase ends exactly where it was meant to.
    pub(crate) fn end_at(&mut self, to: i64) {
        let missing = difference(to, self.exit());
        let [linear, ..] = &mut self.position;
        *linear = sum(*linear, missing);
    }

    /// Moves the whole phase by `counts`.
    pub(crate) fn shift(&mut self, counts: i64) {
        let raised = product(counts, 1 << COEFFICIENT_BITS);
        self.from = sum(self.from, raised);
    }

    /// Marks the first phase of a move that leaves from rest, and that can be dropped as long as
    /// it has not begun.
    pub(crate) fn depart(&mut self) {
        self.extent.mark(Extent::DEPARTS);
    }

    /// Whether the phase is the first of a move that leaves from rest.
    pub(crate) fn departs(&self) -> bool {
        self.extent.has(Extent::DEPARTS)
    }

    /// Marks a phase of a trapezoid, whose acceleration steps.
    pub(crate) fn step(&mut self) {
        self.extent.mark(Extent::STEPS);
    }

    /// Whether the acceleration steps, as only a trapezoid's does.
    pub(crate) fn steps(&self) -> bool {
        self.extent.has(Extent::STEPS)
    }

    /// The position where the phase begins, in counts.
    pub(crate) fn entry_position(&self) -> i64 {
        rounded(self.from)
    }

    /// The position where the next phase begins, in counts.
    pub(crate) fn exit_position(&self) -> i64 {
        rounded(self.exit())
    }

    /// The least and the greatest place on its way, raised by [`COEFFICIENT_BITS`].
    pub(crate) fn reach(&self) -> (i64, i64) {
        let exit = self.exit();
        let mut reach = (self.from.min(exit), self.from.max(exit));
        let [v0, v1, v2] = self.velocity;
        let [a0, a1] = self.acceleration;
        // The place turns where the velocity passes zero: between two velocities of different
        // signs, or twice where it comes near zero and the acceleration changes its sign.
        let crosses = v0.signum() * (v0 + v1 + v2).signum() < 0;
        let nears = v0.signum() * a0.signum() < 0 && a0.signum() * (a0 + a1).signum() < 0;
        if crosses || nears {
            let [v0, v1, v2] = [v0, v1, v2].map(|coefficient| coefficient as f64);
            let square = v1 * v1 - 4.0 * v2 * v0;
            if square >= 0.0 {
                // Both roots without cancellation.
                let half = -0.5 * (v1 + libm::sqrt(square).copysign(v1));
                for u in [half / v2, v0 / half] {
                    if u > 0.0 && u < 1.0 {
                        let [d1, d2, d3] = self.position.map(|coefficient| coefficient as f64);
                        let moved = u * (d1 + u * (d2 + u * d3));
                        let place = sum(self.from, whole(moved));
                        reach = (reach.0.min(place), reach.1.max(place));
                    }
                }
            }
        }
        reach
    }

    /// The place where the next phase begins, raised by [`COEFFICIENT_BITS`].
    pub(crate) fn exit(&self) -> i64 {
        let [d1, d2, d3] = self.position;
        sum(self.from, d1 + d2 + d3)
    }

    /// The motion at a tick that the phase covers.
    #[inline]
    pub(crate) fn contribution(&self, tick: Tick) -> Contribution {
        let ticks = tick.0.saturating_sub(self.first.0);
        let elapsed = (ticks << TIME_BITS).wrapping_add(u64::from(self.ahead));
        // The reciprocal is rounded down, so the product is below one half.
        let u = multiply(elapsed << self.extent.shift(), self.reciprocal) << 1;
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
        if self.end() <= now {
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
        let way = fastest as f64 * self.end().since(now).seconds();
        let farthest =
            |sign: f64| Position::from_counts(from.position.saturating_add((sign * way) as i64));
        let between = limits.allow(Position::from_counts(from.position))
            && limits.allow(Position::from_counts(to.position));
        let straight = ends.0 * ends.1 >= 0 && self.turn() == 0;
        fastest <= limits.velocity().counts()
            && !strong(from.acceleration)
            && !strong(to.acceleration)
            && (self.steps() || self.jerk() * ALMOST <= limits.jerk().counts() as f64)
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
            && (self.steps()
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
            position: self.exit_position(),
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
        let shifted = (1u64 << self.extent.shift()) as f64 / (1u128 << 127) as f64;
        (ramp as f64 * self.reciprocal as f64 * shifted * PARTS_PER_SECOND).abs()
    }
}

/// The nearest count to a place that is raised by [`COEFFICIENT_BITS`].
fn rounded(place: i64) -> i64 {
    const HALF: i64 = 1 << (COEFFICIENT_BITS - 1);
    place.saturating_add(HALF) >> COEFFICIENT_BITS
}

/// The mantissa of a magnitude, and the exponent of its last bit. What is not a number is endless.
fn parts(value: f64) -> (u64, i32) {
    const MANTISSA_BITS: u32 = f64::MANTISSA_DIGITS - 1;
    let bits = value.to_bits();
    let exponent = (bits >> MANTISSA_BITS) & 0x7FF;
    if exponent == 0 {
        // Zero, or too small to count.
        return (0, 0);
    }
    let mantissa = (bits & ((1 << MANTISSA_BITS) - 1)) | (1 << MANTISSA_BITS);
    // 1023 is the exponent of one.
    (mantissa, exponent as i32 - 1023 - MANTISSA_BITS as i32)
}

/// `value` times 2^`exponent`, rounded to the nearest; saturates.
fn shifted(value: u64, exponent: i32) -> u64 {
    if value == 0 {
        0
    } else if exponent >= 0 {
        if exponent as u32 <= value.leading_zeros() {
            value << exponent
        } else {
            u64::MAX
        }
    } else if exponent > -64 {
        // Half of the last place that is left.
        ((value >> (-exponent - 1)) + 1) >> 1
    } else {
        0
    }
}

/// `value` times 2^`bits`, rounded to the nearest; saturates.
#[inline(never)]
pub(super) fn fixed(value: f64, bits: i32) -> i64 {
    let (mantissa, exponent) = parts(value);
    let magnitude = shifted(mantissa, exponent + bits).min(i64::MAX as u64) as i64;
    if value.is_sign_negative() {
        -magnitude
    } else {
        magnitude
    }
}
