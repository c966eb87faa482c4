//! The beta S-curve with p = 5/2: the smoothest profile that one formula gives.
//!
//! Rest to rest over a range R in a duration T, with x = 2 t / T - 1 in [-1, 1] and u = t / T:
//!
//! ```text
//! position      F(x)   = 1/2 + (asin x + x sqrt(1-x^2) (33 - 26 x^2 + 8 x^4) / 15) / pi
//! velocity      F'(x)  = 16 / (5 pi) (1 - x^2)^(5/2)         peak  32 / (5 pi)     R / T
//! acceleration  F''(x) = -16 / pi x (1 - x^2)^(3/2)          peak  12 sqrt(3) / pi R / T^2
//! jerk          F'''(x) = -16 / pi sqrt(1 - x^2) (1 - 4 x^2) peak  128 / pi        R / T^3
//! ```
//!
//! F is the incomplete beta function with both parameters p + 1 = 7/2. Of all p, 5/2 has the
//! least peak jerk, because the jerk's peaks in the middle and at x = +-sqrt(3)/2 are equal there.
//!
//! [`Beta`] is the device's evaluator, in integers; [`exact`] is the same curve in f64, and
//! [`general`] has any p from 2 to 5.

pub mod exact;
pub mod general;

use super::Setpoint;
use super::elementary::cube_root;
use super::fixed::{ALMOST_ONE, multiply, square_root};
use crate::limits::Limits;
use crate::time::{LONGEST_MOVE, Tick, Ticks};
use crate::units::{Acceleration, Jerk, Position, Velocity, whole};
use core::f64::consts::PI;
use core::hint::black_box;

/// Peak velocity of the unit curve: 32 / (5 pi) R / T.
pub const PEAK_VELOCITY: f64 = 32.0 / (5.0 * PI);
/// Peak acceleration of the unit curve: 12 sqrt(3) / pi R / T^2, at x = +-1/2.
pub const PEAK_ACCELERATION: f64 = 12.0 * 1.732_050_807_568_877_2 / PI;
/// Peak jerk of the unit curve: 128 / pi R / T^3.
pub const PEAK_JERK: f64 = 128.0 / PI;

/// P with F(u) = u^(7/2) P(u) on u in [0, 1/2], in powers of y = 1/2 - u from the highest down, in
/// Q59, without signs.
///
/// Near-minimax for the absolute error of F (Remez exchange with weight u^(7/2), 50 digits): the
/// largest error is 1.21e-13 of the range. In powers of y no partial sum changes its sign, so that
/// all of it is done without signs, where a product of two fractions costs three instructions.
static SHAPE: [u64; 10] = [
    27_189_990_582_028_128,
    77_517_242_749_964_032,
    121_756_869_389_002_856,
    160_923_621_070_044_536,
    233_963_121_146_805_498,
    475_337_208_948_163_608,
    2_408_785_211_203_954_854,
    9_715_799_286_967_026_848,
    9_540_357_458_150_898_706,
    3_260_954_456_333_983_600,
];

/// Bits behind the point in [`SHAPE`].
const SHAPE_BITS: u32 = 59;

/// 16 / (3 sqrt 3) / 4 in Q64: the reciprocal of the largest |x| (1 - x^2)^(3/2), which is at
/// x = 1/2, over four.
const ACCELERATION_SHAPE: u64 = 14_200_310_208_837_791_201;

/// Bits by which a range in counts is raised for the product with the shape: a difference of two
/// positions is below 2^44 counts, so 19 bits would still fit an i64.
const RANGE_BITS: u32 = 18;

/// The largest range in counts, 4096 turns: twice what a command can span.
const LARGEST_RANGE: u64 = 1 << 44;

/// One beta move, rest to rest, in integers: a difference of position laid over a base.
///
/// The position's error against the exact curve is below 1e-12 of the range, and the last tick is
/// exact. Velocity and acceleration are rounded towards zero, so that neither passes its peak.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Beta {
    start: Tick,
    duration: Ticks,
    range: i64,
    /// floor(2^64 / duration): one tick as a fraction of the duration.
    step: u64,
    /// Counts per second.
    peak_velocity: i64,
    /// Counts per second squared.
    peak_acceleration: i64,
}

/// What one or several moves add to a base: counts, counts/s and counts/s^2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Contribution {
    pub position: i64,
    pub velocity: i64,
    pub acceleration: i64,
}

impl Contribution {
    /// At rest at a place.
    pub(crate) fn at_rest(position: i64) -> Self {
        Self {
            position,
            ..Self::default()
        }
    }

    /// The same as a setpoint.
    pub(crate) fn setpoint(self) -> Setpoint {
        Setpoint {
            position: Position::from_counts(self.position),
            velocity: Velocity::from_counts(self.velocity),
            acceleration: Acceleration::from_counts(self.acceleration),
        }
    }
}

impl Beta {
    /// A move by `range` that starts to move after `start` and rests from `start + duration` on.
    ///
    /// A duration of zero is taken as one tick. Whether the move keeps any limits is not looked
    /// at here: see [`Self::shortest`] and [`Self::keeps`].
    pub fn new(start: Tick, range: Position, duration: Ticks) -> Self {
        let duration = Ticks(duration.0.max(1));
        let seconds = duration.seconds();
        let range = range.counts();
        let magnitude = range.saturating_abs() as f64;
        Self {
            start,
            duration,
            range,
            step: if duration.0 == 1 {
                ALMOST_ONE
            } else {
                // floor((2^64 - 1) / N) = floor(2^64 / N) unless N is a power of two, where it is
                // one unit of 2^-64 less.
                ALMOST_ONE / u64::from(duration.0)
            },
            // Saturating conversions: a nonsensical move has a nonsensical peak, and is refused.
            peak_velocity: whole(PEAK_VELOCITY * magnitude / seconds),
            peak_acceleration: whole(PEAK_ACCELERATION * magnitude / (seconds * seconds)),
        }
    }

    /// The least duration in which `range` keeps velocity, acceleration, deceleration and jerk
    /// limits; `None` where that is longer than [`LONGEST_MOVE`].
    ///
    /// The curve is symmetric, so the lesser of acceleration and deceleration counts.
    pub fn shortest(range: Position, limits: &Limits) -> Option<Ticks> {
        if range.counts().unsigned_abs() > LARGEST_RANGE {
            return None;
        }
        let magnitude = range.abs().counts() as f64;
        let slowest = limits.slower_acceleration().counts() as f64;
        let by_velocity = PEAK_VELOCITY * magnitude / limits.velocity().counts() as f64;
        let by_acceleration = libm::sqrt(PEAK_ACCELERATION * magnitude / slowest);
        let by_jerk = cube_root(PEAK_JERK * magnitude / limits.jerk().counts() as f64);
        let seconds = by_velocity.max(by_acceleration).max(by_jerk);
        let mut duration = Ticks(Ticks::from_seconds_ceil(seconds)?.0.max(1));
        // Rounding may leave a peak one count over; one tick more brings it under.
        while !Self::new(Tick(0), range, duration).keeps(limits) {
            duration = Ticks(duration.0 + 1);
            if duration > LONGEST_MOVE {
                return None;
            }
        }
        Some(duration)
    }

    /// Whether the move keeps the velocity, acceleration, deceleration and jerk limits.
    pub fn keeps(&self, limits: &Limits) -> bool {
        self.range.unsigned_abs() <= LARGEST_RANGE
            && self.peak_velocity() <= limits.velocity()
            && self.peak_acceleration() <= limits.slower_acceleration()
            && self.peak_jerk() <= limits.jerk()
    }

    /// The largest jerk of the move, without its sign.
    pub fn peak_jerk(&self) -> Jerk {
        let seconds = self.duration.seconds();
        let magnitude = self.range.saturating_abs() as f64;
        let peak = PEAK_JERK * magnitude / (seconds * seconds * seconds);
        Jerk::from_counts(whole(peak))
    }

    /// The largest velocity of the move, without its sign.
    pub fn peak_velocity(&self) -> Velocity {
        Velocity::from_counts(self.peak_velocity)
    }

    /// The largest acceleration and deceleration of the move, without their sign.
    pub fn peak_acceleration(&self) -> Acceleration {
        Acceleration::from_counts(self.peak_acceleration)
    }

    /// The tick at which the move leaves its start.
    pub fn start(&self) -> Tick {
        self.start
    }

    /// How long the move lasts.
    pub fn duration(&self) -> Ticks {
        self.duration
    }

    /// The first tick at which the move has arrived.
    pub fn end(&self) -> Tick {
        self.start.after(self.duration)
    }

    /// The difference of position that the move makes.
    pub fn range(&self) -> Position {
        Position::from_counts(self.range)
    }

    /// The move's own setpoint at `tick`, with the start as position zero.
    pub fn at(&self, tick: Tick) -> Setpoint {
        self.contribution(tick).setpoint()
    }

    /// The difference of position from the start at `tick`.
    #[inline]
    pub fn position(&self, tick: Tick) -> Position {
        let position = match self.place(tick) {
            Place::Before => 0,
            Place::Inside(near) => self.offset(&near),
            Place::After => self.range,
        };
        Position::from_counts(position)
    }

    /// Everything at `tick`: nothing before the start, the whole range from the end on.
    #[inline]
    pub(crate) fn contribution(&self, tick: Tick) -> Contribution {
        let near = match self.place(tick) {
            Place::Before => return Contribution::default(),
            Place::Inside(near) => near,
            Place::After => return Contribution::at_rest(self.range),
        };
        let u = near.fraction;
        // With q = 1 - x^2 = 4 u (1 - u): q/4, its root's half, and from these q^(3/2) / 8.
        let quarter = multiply(u, u.wrapping_neg());
        let three_halves = multiply(quarter, square_root(quarter));
        let velocity = part(self.peak_velocity, multiply(quarter, three_halves));
        // |x| = 1 - 2 u; eight times 4 / 32 is one.
        let distance = (u << 1).wrapping_neg();
        let shape = multiply(multiply(distance, three_halves), ACCELERATION_SHAPE);
        let acceleration = part(self.peak_acceleration, shape);
        let backward = self.range < 0;
        Contribution {
            position: self.offset(&near),
            velocity: signed(velocity, backward),
            acceleration: signed(acceleration, backward != near.second_half),
        }
    }

    #[inline(always)]
    fn place(&self, tick: Tick) -> Place {
        let elapsed = tick.0.wrapping_sub(self.start.0);
        if tick <= self.start {
            Place::Before
        } else if elapsed >= u64::from(self.duration.0) {
            Place::After
        } else {
            let elapsed = elapsed as u32;
            let left = self.duration.0 - elapsed;
            let second_half = elapsed > left;
            let ticks = if second_half { left } else { elapsed };
            Place::Inside(Near {
                fraction: u64::from(ticks) * self.step,
                second_half,
            })
        }
    }

    /// The position inside the move: range * F(u) from the nearer end, rounded to the nearest
    /// count.
    #[inline(always)]
    fn offset(&self, near: &Near) -> i64 {
        let u = near.fraction;
        let y = (1 << 63) - u;
        // From memory each of them is one instruction; as a constant in the code it would be four.
        // Written out: a loop would stay one in an image that is compiled to be small.
        let [c9, c8, c7, c6, c5, c4, c3, c2, c1, c0] = *black_box(&SHAPE);
        let high = c6 - multiply(c7 - multiply(c8 - multiply(c9, y), y), y);
        let middle = c3 - multiply(c4 - multiply(c5 - multiply(high, y), y), y);
        let polynomial = c0 + multiply(c1 + multiply(c2 + multiply(middle, y), y), y);
        let power = multiply(multiply(multiply(u, u), u), square_root(u));
        // F is at most 1/2: Q59 times Q64 >> 64 is Q59, and 5 bits more are Q64.
        let shape = multiply(polynomial, power) << (64 - SHAPE_BITS);
        let magnitude = multiply(self.range.unsigned_abs() << RANGE_BITS, shape);
        let rounded = ((magnitude + (1 << (RANGE_BITS - 1))) >> RANGE_BITS) as i64;
        let moved = signed(rounded, self.range < 0);
        if near.second_half {
            self.range - moved
        } else {
            moved
        }
    }
}

/// Where a tick lies.
enum Place {
    Before,
    Inside(Near),
    After,
}

/// How far a tick is from the nearer end of a move.
///
/// The second half is the first one seen from the end, which keeps the curve symmetric to the last
/// bit and the polynomial's argument at or below one half.
struct Near {
    /// Of the duration, at most one half.
    fraction: u64,
    second_half: bool,
}

/// A peak without its sign times a shape, of which a 32nd is given: it is at most one.
#[inline(always)]
fn part(peak: i64, shape: u64) -> i64 {
    // The root may be an ulp too large: the peak is not passed.
    let shape = shape.min(1 << (64 - 5));
    multiply((peak as u64) << 1, shape << 4) as i64
}

#[inline(always)]
fn signed(magnitude: i64, negative: bool) -> i64 {
    if negative { -magnitude } else { magnitude }
}
