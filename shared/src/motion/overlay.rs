//! A beta move laid over others: how long it must last for their sum to keep the limits.
//!
//! Each rate of a beta move is monotone between its ends and the places of its peaks, so over a
//! window of time its least and greatest values are those at the window's edges and the peaks
//! inside. The sums of these bound the sum of the moves: where all windows keep a limit, every
//! instant does. The velocity's bounds, added up, bound the position in the same way.
//!
//! A bound needs no 43 digits but little time: all this is in f32, whose +, -, * and / are the
//! same bits everywhere, with the limits lowered by more than that errs.

use super::beta::{Beta, PEAK_ACCELERATION, PEAK_JERK, PEAK_VELOCITY};
use super::fixed::square_root_f32;
use crate::limits::Limits;
use crate::time::{LONGEST_MOVE, TICKS_PER_SECOND, Tick, Ticks};
use crate::units::{Position, difference, sum};

/// Windows over what is left of the moves under way: more find a shorter duration, and cost more.
const WINDOWS: usize = 10;

/// How many times the asked duration is tried, in eighths: where not even the longest fits, the
/// others need not be looked at.
const STRETCHES: [u64; 2] = [8, 14];
const LONGEST_STRETCH: u64 = 24;

/// What a sum of fractions of a limit must stay below: 16 times 2^-22, where each of the few
/// operations behind a fraction errs by at most 2^-24.
const ALLOWED: f32 = 1.0 - 16.0 / (1u32 << 22) as f32;

/// Velocity, acceleration and jerk as fractions of their limits, or of their peaks.
#[derive(Clone, Copy, Default)]
struct Rates {
    velocity: f32,
    acceleration: f32,
    jerk: f32,
}

/// Where the unit curve's rates have their peaks, as parts of the duration: the jerk's, the
/// acceleration's, the velocity's with the jerk's of the other sign, and back. They are at
/// x = +-sqrt(3)/2, +-1/2 and 0.
const PEAKS: [f32; 5] = [
    (1.0 - HALF_ROOT_3) / 2.0,
    0.25,
    0.5,
    0.75,
    (1.0 + HALF_ROOT_3) / 2.0,
];

const HALF_ROOT_3: f32 = 0.866_025_4;

/// 16 / (3 sqrt 3): the reciprocal of the largest |x| (1 - x^2)^(3/2).
const ACCELERATION_SHAPE: f32 = 3.079_201_4;

/// The limits that fractions are taken of, in counts and seconds.
struct Scale {
    velocity: f32,
    acceleration: f32,
    jerk: f32,
}

impl Scale {
    fn of(limits: &Limits) -> Self {
        Self {
            velocity: limits.velocity().counts() as f32,
            acceleration: limits.slower_acceleration().counts() as f32,
            jerk: limits.jerk().counts() as f32,
        }
    }
}

/// A beta move on a clock of f32 ticks.
struct Curve {
    start: f32,
    duration: f32,
    /// 1 / duration.
    rate: f32,
    /// The signed peaks, and when they are.
    peaks: Rates,
    times: [f32; 5],
}

impl Curve {
    fn new(start: f32, range: i64, duration: f32, scale: &Scale) -> Self {
        let per_second = TICKS_PER_SECOND as f32 / duration;
        let velocity = range as f32 * per_second;
        let acceleration = velocity * per_second;
        let jerk = acceleration * per_second;
        Self {
            start,
            duration,
            rate: 1.0 / duration,
            times: PEAKS.map(|part| start + part * duration),
            peaks: Rates {
                velocity: velocity * PEAK_VELOCITY as f32 / scale.velocity,
                acceleration: acceleration * PEAK_ACCELERATION as f32 / scale.acceleration,
                jerk: jerk * PEAK_JERK as f32 / scale.jerk,
            },
        }
    }

    #[inline(always)]
    fn at(&self, time: f32) -> Rates {
        let elapsed = time - self.start;
        let left = self.duration - elapsed;
        if elapsed <= 0.0 || left <= 0.0 {
            return Rates::default();
        }
        // Both parts of the duration are exact near their own end, and so is q = 1 - x^2.
        let (before, after) = (elapsed * self.rate, left * self.rate);
        let x = before - after;
        let q = 4.0 * before * after;
        let root = square_root_f32(q);
        let peaks = &self.peaks;
        Rates {
            velocity: peaks.velocity * (q * q * root),
            acceleration: peaks.acceleration * (-x * q * root * ACCELERATION_SHAPE),
            jerk: peaks.jerk * (root * (4.0 * x * x - 1.0)),
        }
    }

    /// The least and greatest values from `from` to `to`, with the values there.
    #[inline(always)]
    fn bounds(&self, from: f32, to: f32, first: &Rates, last: &Rates) -> Bounds {
        let mut bounds = Bounds {
            velocity: Range::of(first.velocity, last.velocity),
            acceleration: Range::of(first.acceleration, last.acceleration),
            jerk: Range::of(first.jerk, last.jerk),
        };
        // At each of them one rate has its peak; the others are a value of the window already elsewhere.
        let peaks = &self.peaks;
        let [early, quarter, middle, late, last] = self.times;
        let inside = |time: f32| from < time && time < to;
        if inside(middle) {
            bounds.velocity.include(peaks.velocity);
            bounds.jerk.include(-peaks.jerk);
        }
        if inside(quarter) {
            bounds.acceleration.include(peaks.acceleration);
        }
        if inside(late) {
            bounds.acceleration.include(-peaks.acceleration);
        }
        if inside(early) || inside(last) {
            bounds.jerk.include(peaks.jerk);
        }
        bounds
    }

    /// How many times as long it must last to keep the limits by itself.
    fn stretch(&self) -> f32 {
        let peaks = &self.peaks;
        let by_acceleration = square_root_f32(peaks.acceleration.abs() + f32::MIN_POSITIVE);
        let by_jerk = cube_root(peaks.jerk.abs());
        let mut stretch = 1.0;
        for by in [peaks.velocity.abs(), by_acceleration, by_jerk] {
            if by > stretch {
                stretch = by;
            }
        }
        stretch
    }
}

/// The cube root of a positive f32 to 20 bits or so: from its bits, and two Newton steps.
fn cube_root(value: f32) -> f32 {
    // A third of the exponent, with the constant that spreads the error evenly.
    let mut root = f32::from_bits(value.to_bits() / 3 + 0x2A51_19F2);
    for _ in 0..3 {
        root = (root + root + value / (root * root)) * (1.0 / 3.0);
    }
    root
}

/// The least and the greatest value of one rate.
#[derive(Clone, Copy, Default)]
struct Range {
    least: f32,
    greatest: f32,
}

impl Range {
    #[inline(always)]
    fn of(first: f32, last: f32) -> Self {
        let mut range = Self {
            least: first,
            greatest: first,
        };
        range.include(last);
        range
    }

    #[inline(always)]
    fn include(&mut self, value: f32) {
        if value < self.least {
            self.least = value;
        }
        if value > self.greatest {
            self.greatest = value;
        }
    }

    #[inline(always)]
    fn add(&mut self, other: &Self) {
        self.least += other.least;
        self.greatest += other.greatest;
    }

    #[inline(always)]
    fn is_allowed(&self) -> bool {
        self.least >= -ALLOWED && self.greatest <= ALLOWED
    }
}

/// The least and greatest values over a window.
#[derive(Clone, Copy, Default)]
struct Bounds {
    velocity: Range,
    acceleration: Range,
    jerk: Range,
}

impl Bounds {
    #[inline(always)]
    fn add(&mut self, other: &Self) {
        self.velocity.add(&other.velocity);
        self.acceleration.add(&other.acceleration);
        self.jerk.add(&other.jerk);
    }

    #[inline(always)]
    fn are_allowed(&self) -> bool {
        self.velocity.is_allowed() && self.acceleration.is_allowed() && self.jerk.is_allowed()
    }
}

/// How far the sum may go on each side of where it starts, in counts; infinite where the signs of
/// what is left already tell that it stays inside.
#[derive(Clone, Copy)]
struct Room {
    below: f32,
    above: f32,
}

impl Room {
    const ENDLESS: Self = Self {
        below: f32::INFINITY,
        above: f32::INFINITY,
    };

    /// The room at `place` for moves that have these ranges left.
    fn at(place: i64, left: impl Iterator<Item = i64>, limits: &Limits) -> Self {
        let (mut back, mut forth) = (0i64, 0i64);
        for range in left {
            back = sum(back, range.min(0));
            forth = sum(forth, range.max(0));
        }
        let to = |offset: i64| Position::from_counts(sum(place, offset));
        if limits.allow(to(back)) && limits.allow(to(forth)) {
            return Self::ENDLESS;
        }
        let distance = |from: i64, to: i64| difference(to, from) as f32 * ALLOWED;
        Self {
            below: distance(limits.position_minimum().counts(), place),
            above: distance(place, limits.position_maximum().counts()),
        }
    }
}

/// What is under way, from the start of a new move on: its bounds over each window.
struct UnderWay {
    windows: [Bounds; WINDOWS],
    /// Ticks in one window.
    width: f32,
}

impl UnderWay {
    #[inline(never)]
    fn new(betas: &[Beta], start: Tick, scale: &Scale) -> Self {
        let end = betas.iter().map(Beta::end).fold(start, Tick::max);
        let width = end.since(start).0 as f32 / WINDOWS as f32;
        let mut windows = [Bounds::default(); WINDOWS];
        for beta in betas {
            let begun = start.since(beta.start()).0 as f32;
            let curve = Curve::new(
                -begun,
                beta.range().counts(),
                beta.duration().0 as f32,
                scale,
            );
            let mut first = curve.at(0.0);
            for (index, window) in windows.iter_mut().enumerate() {
                let (from, to) = edges(index, width);
                let last = curve.at(to);
                window.add(&curve.bounds(from, to, &first, &last));
                first = last;
            }
        }
        Self { windows, width }
    }

    /// Whether the sum with `added`, which keeps the limits by itself, does.
    ///
    /// Once the added move has ended, what is left is what was under way, and was proven when that
    /// was taken on; but its place is a new one.
    #[inline(never)]
    fn keeps(&self, added: &Curve, room: Room, scale: &Scale) -> bool {
        let seconds = self.width / TICKS_PER_SECOND as f32;
        // How far a window leads at the velocity limit.
        let way = seconds * scale.velocity;
        let (mut lowest, mut highest) = (0.0, 0.0);
        let mut first = Rates::default();
        self.windows.iter().enumerate().all(|(index, window)| {
            let (from, to) = edges(index, self.width);
            let last = added.at(to);
            let mut sum = added.bounds(from, to, &first, &last);
            sum.add(window);
            first = last;
            // Inside the window as at its end: whichever is farther.
            let stays = |lowest: f32, highest: f32| lowest >= -room.below && highest <= room.above;
            let before = stays(lowest, highest);
            lowest += way * sum.velocity.least;
            highest += way * sum.velocity.greatest;
            before && stays(lowest, highest) && (from >= added.duration || sum.are_allowed())
        })
    }
}

/// The edges of a window.
#[inline(always)]
fn edges(index: usize, width: f32) -> (f32, f32) {
    (index as f32 * width, (index + 1) as f32 * width)
}

/// The beta move by `range` from `start` that lasts as asked, or the least of a few stretches of
/// that, such that its sum with `under_way`, which is at `place` then, keeps the limits.
///
/// `None` where none of the durations tried does.
pub(crate) fn overlay(
    place: i64,
    under_way: &[Beta],
    start: Tick,
    range: Position,
    asked: Ticks,
    limits: &Limits,
) -> Option<Beta> {
    let left = under_way
        .iter()
        .map(|beta| (beta.range() - beta.position(start)).counts());
    let room = Room::at(place, left.chain([range.counts()]), limits);
    let scale = Scale::of(limits);
    let least = at_least(range, asked, &scale);
    let others = UnderWay::new(under_way, start, &scale);
    let fitting = |eighths: u64| {
        let duration = (least * eighths).div_ceil(8);
        if duration > u64::from(LONGEST_MOVE.0) {
            return None;
        }
        let duration = duration as u32;
        let curve = Curve::new(0.0, range.counts(), duration as f32, &scale);
        if !others.keeps(&curve, room, &scale) {
            return None;
        }
        let added = Beta::new(start, range, Ticks(duration));
        added.keeps(limits).then_some(added)
    };
    let longest = fitting(LONGEST_STRETCH)?;
    STRETCHES.into_iter().find_map(fitting).or(Some(longest))
}

/// The duration in ticks, or what the limits ask for where that is longer, rounded up by more than
/// an f32 errs.
fn at_least(range: Position, asked: Ticks, scale: &Scale) -> u64 {
    let asked = asked.0.max(1) as f32;
    let alone = Curve::new(0.0, range.counts(), asked, scale).stretch();
    // What does not fit 32 bits is far too long, and needs no conversion to 64.
    u64::from((asked * alone / ALLOWED) as u32) + u64::from(alone > 1.0)
}

/// A duration in which a beta move by `range` keeps the limits: the one asked for, or the least that
/// does but for rounding.
pub(crate) fn long_enough(range: Position, asked: Ticks, limits: &Limits) -> Ticks {
    let least = at_least(range, asked, &Scale::of(limits));
    Ticks(u32::try_from(least).unwrap_or(u32::MAX))
}

/// Whether moves under way keep `limits` from `now` on.
pub(crate) fn keep(place: i64, under_way: &[Beta], now: Tick, limits: &Limits) -> bool {
    let left = under_way
        .iter()
        .map(|beta| (beta.range() - beta.position(now)).counts());
    let room = Room::at(place, left, limits);
    let scale = Scale::of(limits);
    let others = UnderWay::new(under_way, now, &scale);
    let nothing = Curve::new(0.0, 0, LONGEST_MOVE.0 as f32, &scale);
    others.keeps(&nothing, room, &scale)
}
