//! The best SYNCs of the last seconds, and the line through them.
//!
//! Points come often at first, so that there is a line soon, and the more seldom the farther the
//! history reaches back. When it is full, one of the two points that are nearest to each other
//! goes. So 12 of them soon span a tenth of a second, and some seconds in the end.

use super::LARGEST_RATE;
use crate::time::{BusTime, LocalTime};
use heapless::Vec;

/// Points that are kept.
const POINTS: usize = 12;

/// The shortest and the longest time that a point is chosen in, in microseconds: two SYNCs of
/// a host that sends them quickly, every 4 ms, and 16 of one that sends them every 20 ms.
const SHORTEST_WINDOW: u32 = 7_000;
const LONGEST_WINDOW: u32 = 320_000;

/// Points older than this do not count, in microseconds: over 8 s a crystal's own rate may change
/// with its temperature, and the sums below fit into 64 bits.
const OLDEST: u32 = 8_000_000;

/// Time is counted in 2^8 us for the line's slope: 100 ppm of that are 0.03 us.
const COARSE: u32 = 8;

/// The furthest that a point can be from its history's first rate, in microseconds: 700 ppm of
/// [`OLDEST`].
const FARTHEST: i32 = 5_600;

/// How much the rate is held to the one that the history began with: as much as by points with
/// this sum of squares, 5 us of jitter by 60 ppm of a usual crystal, (83 ms)^2, or by the 5 ppm of
/// one that has been learned, (1 s)^2. In the square of 2^8 us.
const INERTIA: i64 = 83_000 * 83_000 / (1 << (2 * COARSE));
const LEARNED_INERTIA: i64 = 1_000_000 * 1_000_000 / (1 << (2 * COARSE));

/// Points that a rate can be known from.
const RATE_POINTS: usize = 4;

/// A rate has been learned if it was taken over a second, in microseconds.
const LEARNED: u32 = 1_000_000;

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

/// A sample in half the room: differences of two points fit, as none is older than [`OLDEST`].
#[derive(Debug, Clone, Copy)]
struct Point {
    /// The low bits of when it arrived, in microseconds.
    received: u32,
    /// The low bits of bus time minus local time, in microseconds.
    lead: u32,
}

impl Point {
    const fn new(sample: Sample) -> Self {
        let lead = sample.sent.0.wrapping_sub(sample.received.0);
        Self {
            received: sample.received.0 as u32,
            lead: lead as u32,
        }
    }

    /// Microseconds from here to `later`.
    const fn age(self, later: Self) -> u32 {
        later.received.wrapping_sub(self.received)
    }

    /// By how many microseconds it is ahead of a line of this rate through a later point.
    const fn ahead(self, later: Self, rate: i64) -> i32 {
        // Rates are below 2^22, ages below 2^24, so this is a few thousand.
        let gained = (self.age(later) as i64 * rate + (1 << 31)) >> 32;
        (self.lead.wrapping_sub(later.lead) as i32).saturating_add(gained as i32)
    }
}

#[derive(Debug, Clone)]
pub(super) struct History {
    points: Vec<Point, POINTS>,
    /// The last point in full.
    newest: Option<Sample>,
    /// The rate that was known when it began, in units of 2^-32, and how much it counts.
    rate: i64,
    inertia: i64,
}

impl History {
    pub(super) const fn new() -> Self {
        Self {
            points: Vec::new(),
            newest: None,
            rate: 0,
            inertia: INERTIA,
        }
    }

    /// How far it reaches back, in microseconds.
    fn span(&self) -> u32 {
        match (self.points.first(), self.points.last()) {
            (Some(first), Some(last)) => first.age(*last),
            _ => 0,
        }
    }

    /// How long the next point is to be chosen for, in microseconds.
    pub(super) fn window(&self) -> u64 {
        let part = self.span() / POINTS as u32;
        part.clamp(SHORTEST_WINDOW, LONGEST_WINDOW).into()
    }

    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    pub(super) fn newest(&self) -> Option<LocalTime> {
        self.newest.map(|newest| newest.received)
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        *self = Self::new();
    }

    /// Begins anew with what has been learned of the rate: `rate` as known so far, if there are
    /// points enough to know it from, else the one that this history began with. One that does not
    /// last again and again is forgotten.
    pub(super) fn begin(&mut self, rate: i64) {
        if self.span() >= LEARNED {
            self.inertia = LEARNED_INERTIA;
        }
        if self.len() >= RATE_POINTS {
            self.rate = rate;
        } else {
            self.inertia /= 2;
        }
        if self.inertia < INERTIA {
            self.clear();
        }
        self.points.clear();
        self.newest = None;
    }

    /// Adds a point; `rate` is the rate as known so far.
    pub(super) fn add(&mut self, sample: Sample, rate: i64) {
        let silence = self.newest.map(|last| sample.received.since(last.received));
        if silence.is_some_and(|silence| silence > u64::from(OLDEST)) {
            self.begin(rate);
        }
        let point = Point::new(sample);
        let is_old = |old: &Point| old.age(point) > OLDEST;
        if self.points.first().is_some_and(is_old) {
            self.points.retain(|old| !is_old(old));
        }
        if self.points.is_full() {
            self.thin(rate);
        }
        // There is room now.
        let _ = self.points.push(point);
        self.newest = Some(sample);
    }

    /// Leaves the more delayed one of the two neighbours out that are nearest to each other.
    fn thin(&mut self, rate: i64) {
        let pairs = self.points.iter().zip(self.points.iter().skip(1));
        let nearest = pairs
            .enumerate()
            .min_by_key(|(_, (first, second))| first.age(**second));
        let Some((place, (first, second))) = nearest else {
            return;
        };
        let worse = place + usize::from(first.ahead(*second, rate) > 0);
        let mut place = 0..;
        self.points.retain(|_| place.next() != Some(worse));
    }

    /// The line with the least squares of distances from the points; none without points.
    pub(super) fn line(&self) -> Option<Line> {
        let last = *self.points.last()?;
        let count = self.points.len().max(1) as i64;
        let (mut x_sum, mut y_sum, mut xx_sum, mut xy_sum) = (0, 0, 0i64, 0i64);
        for point in &self.points {
            // Below 2^15, as OLDEST is below 2^23, and below 2^13.
            let x = -((point.age(last) >> COARSE) as i32);
            let y = point.ahead(last, self.rate).clamp(-FARTHEST, FARTHEST);
            x_sum += x;
            y_sum += y;
            xx_sum += i64::from(x) * i64::from(x);
            xy_sum += i64::from(x) * i64::from(y);
        }
        let (x_sum, y_sum) = (i64::from(x_sum), i64::from(y_sum));
        // Below 2 * 16^2 * 2^15 * 2^13 = 2^37, so that 24 bits more still fit. The quotient needs
        // no more than the bits of an f32, and a long division of integers costs far more.
        let slope = (count * xy_sum - x_sum * y_sum) << (32 - COARSE);
        let weight = count * (xx_sum + self.inertia) - x_sum * x_sum;
        let rate = self.rate + i64::from((slope as f32 / weight as f32) as i32);
        let rate = rate.clamp(-LARGEST_RATE, LARGEST_RATE);
        // Below 2^23 * 2^19 * 2^8.
        let gained = ((rate - self.rate) * x_sum) << COARSE;
        // Their means without another one; of `gained` one part in 2^12 is lost.
        let part = i64::from(u32::MAX / count as u32);
        Some(Line {
            through: self.newest?,
            ahead: y_sum * part - (gained >> 16) * (part >> 16),
            rate,
        })
    }
}
