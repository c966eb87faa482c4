//! The beta S-curve in f64, for planning and for study on the host: units are the caller's own.

use super::{PEAK_ACCELERATION, PEAK_JERK, PEAK_VELOCITY};
use crate::motion::trajectory::Sample;
use core::f64::consts::PI;

/// The unit curve and its first three derivatives by x, for x in [-1, 1].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// F(x), from 0 to 1.
    pub value: f64,
    /// F'(x).
    pub first: f64,
    /// F''(x).
    pub second: f64,
    /// F'''(x).
    pub third: f64,
}

/// Below this u the closed form cancels; the series in u takes over there.
const SERIES_BELOW: f64 = 0.04;

/// F and its derivatives at x; x outside [-1, 1] gives the rest at the nearer end.
///
/// The absolute error is a few 1e-16; near the ends a series keeps the relative error as low. A
/// NaN gives NaN.
pub fn shape(x: f64) -> Shape {
    if x <= -1.0 || x >= 1.0 {
        return Shape {
            value: if x >= 1.0 { 1.0 } else { 0.0 },
            first: 0.0,
            second: 0.0,
            third: 0.0,
        };
    }
    // (1 - x)(1 + x) keeps its digits near the ends, where 1 - x^2 loses them.
    let q = (1.0 - x) * (1.0 + x);
    let root = libm::sqrt(q);
    Shape {
        value: value(x, q, root),
        first: 16.0 / (5.0 * PI) * q * q * root,
        second: -16.0 / PI * x * q * root,
        third: -16.0 / PI * root * (1.0 - 4.0 * x * x),
    }
}

fn value(x: f64, q: f64, root: f64) -> f64 {
    let near_end = 0.5 * (1.0 - libm::fabs(x));
    if near_end < SERIES_BELOW {
        let from_end = series(near_end);
        return if x < 0.0 { from_end } else { 1.0 - from_end };
    }
    // 33 - 26 x^2 + 8 x^4 with x^2 = 1 - q.
    let polynomial = 15.0 + q * (10.0 + 8.0 * q);
    0.5 + (libm::asin(x) + x * root * polynomial / 15.0) / PI
}

/// F = 1024 / (5 pi) u^(7/2) sum over k of binomial(5/2, k) (-u)^k / (7/2 + k), for small u.
fn series(u: f64) -> f64 {
    let mut power = 1.0;
    let mut sum = 0.0;
    for k in 0..12 {
        let k = f64::from(k);
        sum += power / (3.5 + k);
        power *= -u * (2.5 - k) / (k + 1.0);
    }
    1024.0 / (5.0 * PI) * u * u * u * libm::sqrt(u) * sum
}

/// A beta move in f64 from `from` to `to`, starting at t = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    from: f64,
    to: f64,
    duration: f64,
}

impl Profile {
    /// A move of a chosen duration in seconds; `None` unless all three are finite and the
    /// duration is positive.
    pub fn with_duration(from: f64, to: f64, duration: f64) -> Option<Self> {
        let valid = from.is_finite() && (to - from).is_finite() && duration.is_finite();
        (valid && duration > 0.0).then_some(Self { from, to, duration })
    }

    /// The least duration in seconds for a range within positive limits of velocity, acceleration
    /// and, where it is finite, jerk.
    pub fn shortest(range: f64, velocity: f64, acceleration: f64, jerk: f64) -> f64 {
        let range = libm::fabs(range);
        (PEAK_VELOCITY * range / velocity)
            .max(libm::sqrt(PEAK_ACCELERATION * range / acceleration))
            .max(libm::cbrt(PEAK_JERK * range / jerk))
    }

    /// Seconds from start to rest.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// The move at `time` seconds: at rest at either end before 0 and after the duration.
    pub fn at(&self, time: f64) -> Sample {
        let range = self.to - self.from;
        let rate = 2.0 / self.duration;
        let unit = shape(rate * time - 1.0);
        Sample {
            // From the nearer end, so that the end itself is exact.
            position: if unit.value < 0.5 {
                self.from + range * unit.value
            } else {
                self.to - range * shape(1.0 - rate * time).value
            },
            velocity: range * rate * unit.first,
            acceleration: range * rate * rate * unit.second,
            jerk: range * rate * rate * rate * unit.third,
        }
    }
}
