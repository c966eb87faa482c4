//! The best SYNCs of the last seconds, and the line through them.
//!
//! Points come often at first, so that there is a line soon, and the more seldom the farther the
//! history reaches back. When it is full, one of the two points that are nearest to each other
//! goes. So 16 of them soon span a quarter of a second, and some seconds in the end.

use super::LARGEST_RATE;
use crate::time::{BusTime, LocalTime};
use heapless::Vec;

/// Points that are kept.
const POINTS: usize = 16;

/// A new point for each such part of the time that the history spans.
const PARTS: u64 = POINTS as u64;

/// The shortest and the longest time that a point is chosen in, in microseconds: two SYNCs of
/// a host that sends them quickly, every 4 ms, and 16 of one that does every 20 ms.
const SHORTEST_WINDOW: u64 = 7_000;
const LONGEST_WINDOW: u64 = 320_000;

/// Points older than this do not count, in microseconds: over 8 s a crystal's own rate may change
/// with its temperature, and the sums below fit into 64 bits.
const OLDEST: u64 = 8_000_000;

/// Time is counted in 2^8 us for the line's slope: 100 ppm of that are 0.03 us.
const COARSE: u32 = 8;

/// The furthest that a point can be from its history's first rate, in microseconds: 700 ppm of
/// [`OLDEST`].
const FARTHEST: i64 = 5_600;

/// How much the rate is held to the one that the history began with: as much as by points with
/// this sum of squares, 5 us of jitter by 60 ppm of a usual crystal, (83 ms)^2, or by the 5 ppm of
/// one that has been learned, (1 s)^2. In the square of 2^8 us.
const INERTIA: i64 = 83_000 * 83_000 / (1 << (2 * COARSE));
const LEARNED_INERTIA: i64 = 1_000_000 * 1_000_000 / (1 << (2 * COARSE));

/// A rate has been learned if it was taken over a second, in microseconds.
const LEARNED: u64 = 1_000_000;

/// A SYNC: when it was sent and when it arrived.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub received: LocalTime,
    pub sent: BusTime,
}

/// Bus time as a line over local time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    /// The point that it passes nearby, and how far ahead of it, in 2^-32 us.
    pub through: Sample,
    pub ahead: i64,
    /// How much faster than the local clock the bus runs, in units of 2^-32.
    pub rate: i64,
}

#[derive(Debug, Clone)]
pub(super) struct History {
    points: Vec<Sample, POINTS>,
    /// The rate that was known when it began, in units of 2^-32, and how much it counts.
    rate: i64,
    inertia: i64,
}

impl History {
    pub(super) const fn new() -> Self {
        Self {
            points: Vec::new(),
            rate: 0,
            inertia: INERTIA,
        }
    }

    /// How far it reaches back, in microseconds.
    fn span(&self) -> u64 {
        match (self.points.first(), self.points.last()) {
            (Some(first), Some(last)) => last.received.since(first.received),
            _ => 0,
        }
    }

    /// How long the next point is to be chosen for, in microseconds.
    pub(super) fn window(&self) -> u64 {
        (self.span() / PARTS).clamp(SHORTEST_WINDOW, LONGEST_WINDOW)
    }

    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    pub(super) fn newest(&self) -> Option<LocalTime> {
        self.points.last().map(|point| point.received)
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        *self = Self::new();
    }

    /// Begins anew with what has been learned of the rate.
    pub(super) fn begin(&mut self, rate: i64) {
        if self.span() >= LEARNED {
            self.inertia = LEARNED_INERTIA;
        }
        self.rate = rate;
        self.points.clear();
    }

    /// Adds a point; `rate` is the rate as known so far.
    pub(super) fn add(&mut self, point: Sample, rate: i64) {
        let is_old = |old: &Sample| point.received.since(old.received) > OLDEST;
        if self.points.last().is_some_and(is_old) {
            self.begin(rate);
        }
        self.points.retain(|old| !is_old(old));
        if self.points.is_full() {
            self.thin(rate);
        }
        // There is room now.
        let _ = self.points.push(point);
    }

    /// Leaves the more delayed one of the two neighbours out that are nearest to each other.
    fn thin(&mut self, rate: i64) {
        let pairs = || self.points.iter().zip(self.points.iter().skip(1));
        let nearest = pairs()
            .enumerate()
            .min_by_key(|(_, (first, second))| second.received.since(first.received));
        let Some((place, (first, second))) = nearest else {
            return;
        };
        let worse = place + usize::from(ahead(*first, *second, rate) > 0);
        let mut places = 0..;
        self.points.retain(|_| places.next() != Some(worse));
    }

    /// The line with the least squares of distances from the points; none without points.
    pub(super) fn line(&self) -> Option<Line> {
        let through = *self.points.last()?;
        let count = self.points.len().max(1) as i64;
        let (mut x_sum, mut y_sum, mut xx_sum, mut xy_sum) = (0, 0, 0, 0);
        for point in &self.points {
            // At most OLDEST, 2^15 of it, and FARTHEST, below 2^13.
            let age = through.received.since(point.received).min(OLDEST) as i64;
            let x = -(age >> COARSE);
            let y = ahead(*point, through, self.rate).clamp(-FARTHEST, FARTHEST);
            x_sum += x;
            y_sum += y;
            xx_sum += x * x;
            xy_sum += x * y;
        }
        // Below 2 * 16^2 * 2^15 * 2^13 = 2^37, so that 24 bits more still fit.
        let slope = (count * xy_sum - x_sum * y_sum) << (32 - COARSE);
        let weight = count * (xx_sum + self.inertia) - x_sum * x_sum;
        let rate = self.rate + slope / weight.max(1);
        let rate = rate.clamp(-LARGEST_RATE, LARGEST_RATE);
        // Below 2^22 * 2^19 * 2^8.
        let gained = (rate - self.rate) * x_sum << COARSE;
        Some(Line {
            through,
            ahead: ((y_sum << 32) - gained) / count,
            rate,
        })
    }
}

/// By how many microseconds `point` is ahead of a line of this rate through `other`, which came
/// later.
fn ahead(point: Sample, other: Sample, rate: i64) -> i64 {
    let age = other.received.since(point.received).min(OLDEST) as i64;
    let sent = point.sent.0.wrapping_sub(other.sent.0) as i64;
    sent.saturating_add(age + ((age * rate + (1 << 31)) >> 32))
}
