//! The beta S-curve in f64, for planning and for study on the host: units are the caller's own.
//!
//! With u = t / T in the first half and w = u (1 - u), and the second half as its mirror image:
//!
//! ```text
//! position      R F(u)  = R u^(7/2) P(u)
//! velocity      1024 / (5 pi)  w^(5/2)               R / T
//! acceleration  512 / pi       w^(3/2) (1 - 2 u)     R / T^2
//! jerk          256 / pi       w^(1/2) (3 - 16 w)    R / T^3
//! ```

use super::{PEAK_ACCELERATION, PEAK_JERK, PEAK_VELOCITY};
use crate::motion::bounds::{Bounds, checked_duration, checked_position};
use crate::motion::error::ProfileError;
use crate::motion::trajectory::{Peaks, Sample, Trajectory};
use core::f64::consts::PI;

/// P from the lowest power up, on u in [0, 1/2].
///
/// Near-minimax for the relative error of F (Remez exchange, 60 digits): the largest is 9.1e-17,
/// below what rounding adds. The closed form with the arc sine loses its digits near the ends and
/// takes longer.
const SHAPE: [f64; 15] = [
    18.625_675_625_840_092,
    -36.216_591_494_687_7,
    22.223_817_507_918_167,
    -3.134_128_100_046_001,
    -0.339_530_831_232_132_3,
    -0.089_870_832_408_342_01,
    -0.033_561_114_043_425_1,
    -0.014_738_103_863_277_712,
    -0.010_042_596_116_712_106,
    0.004_274_014_666_055_081,
    -0.026_192_667_810_754_3,
    0.043_123_233_237_036_02,
    -0.058_106_352_728_660_22,
    0.043_505_605_353_000_3,
    -0.017_040_572_031_534_987,
];

/// F at u in [0, 1/2], the fraction of the duration since the nearer end: relative error a few
/// 1e-16.
#[inline(always)]
fn from_end(u: f64, square_root: impl Fn(f64) -> f64) -> f64 {
    // Four chains, every fourth power each, that a processor works on at once.
    let square = u * u;
    let [
        c0,
        c1,
        c2,
        c3,
        c4,
        c5,
        c6,
        c7,
        c8,
        c9,
        c10,
        c11,
        c12,
        c13,
        c14,
    ] = SHAPE;
    let fourth = square * square;
    let first = ((c12 * fourth + c8) * fourth + c4) * fourth + c0;
    let second = ((c13 * fourth + c9) * fourth + c5) * fourth + c1;
    let third = ((c14 * fourth + c10) * fourth + c6) * fourth + c2;
    let last = (c11 * fourth + c7) * fourth + c3;
    let polynomial = (first + u * second) + square * (third + u * last);
    polynomial * (u * u * u) * square_root(u)
}

/// The derivatives of F by u, as those at the start; at the end the second changes its sign.
#[derive(Debug, Clone, Copy)]
struct Rates {
    first: f64,
    second: f64,
    third: f64,
}

impl Rates {
    fn at(u: f64) -> Self {
        let w = u * (1.0 - u);
        let root = libm::sqrt(w);
        Self {
            first: 1024.0 / (5.0 * PI) * (w * w) * root,
            second: 512.0 / PI * w * root * (1.0 - 2.0 * u),
            third: 256.0 / PI * root * (3.0 - 16.0 * w),
        }
    }
}

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

/// F and its derivatives at x; x outside [-1, 1] gives the rest at the nearer end.
///
/// The absolute error is a few 1e-16, and before the middle the relative one too. A NaN gives NaN.
pub fn shape(x: f64) -> Shape {
    let outside = x <= -1.0 || x >= 1.0;
    let u = if outside { 0.0 } else { 0.5 * (1.0 - x.abs()) };
    let rates = Rates::at(u);
    Shape {
        value: if x < 0.0 {
            from_end(u, libm::sqrt)
        } else {
            1.0 - from_end(u, libm::sqrt)
        },
        // x = 2 u - 1
        first: rates.first / 2.0,
        second: if x < 0.0 {
            rates.second / 4.0
        } else {
            -rates.second / 4.0
        },
        third: rates.third / 8.0,
    }
}

/// A beta move in f64 from `from` to `to`, starting at t = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    from: f64,
    to: f64,
    range: f64,
    duration: f64,
    /// 1 / duration; zero for a duration of zero.
    rate: f64,
}

impl Profile {
    /// The quickest beta move within the limits; the lesser of acceleration and deceleration
    /// counts, because the curve is symmetric.
    ///
    /// T is the greatest of 32 / (5 pi) R / v, sqrt(12 sqrt(3) / pi R / a) and
    /// cbrt(128 / pi R / j); without a range it is zero.
    ///
    /// # Errors
    /// [`ProfileError::Value`] for a position that is not a number or beyond 1e15.
    pub fn within(from: f64, to: f64, bounds: &Bounds) -> Result<Self, ProfileError> {
        let range = (checked_position("stop position", to)?
            - checked_position("start position", from)?)
        .abs();
        let by_velocity = PEAK_VELOCITY * range / bounds.velocity();
        let by_acceleration = libm::sqrt(PEAK_ACCELERATION * range / bounds.slower_acceleration());
        let by_jerk = libm::cbrt(PEAK_JERK * range / bounds.jerk());
        let duration = by_velocity.max(by_acceleration).max(by_jerk);
        Ok(Self::new(from, to, duration))
    }

    /// A beta move of a chosen duration in seconds, whatever its peaks are.
    ///
    /// # Errors
    /// [`ProfileError::Value`] for a position that is not a number or beyond 1e15, and for a
    /// duration that is not from 1e-15 to 1e15 s; without a range it may be zero.
    pub fn lasting(from: f64, to: f64, duration: f64) -> Result<Self, ProfileError> {
        checked_position("start position", from)?;
        checked_position("stop position", to)?;
        checked_duration(duration, from == to)?;
        Ok(Self::new(from, to, duration))
    }

    fn new(from: f64, to: f64, duration: f64) -> Self {
        // A duration so short that it has no reciprocal is that of a range that is nothing.
        let rate = 1.0 / duration;
        let (duration, rate) = if rate.is_finite() {
            (duration, rate)
        } else {
            (0.0, 0.0)
        };
        Self {
            from,
            to,
            range: to - from,
            duration,
            rate,
        }
    }

    /// Seconds since the nearer end, not negative, and whether that is the start.
    #[inline(always)]
    fn nearer_end(&self, time: f64) -> (f64, bool) {
        let left = self.duration - time;
        let first_half = time < left;
        let since = if first_half { time } else { left };
        // Not `max`, which would hide a NaN.
        (if since < 0.0 { 0.0 } else { since }, first_half)
    }

    /// The position alone at `time` seconds, the same bits as [`Trajectory::at`] gives.
    #[inline]
    pub fn position_at(&self, time: f64) -> f64 {
        self.position_with(time, libm::sqrt)
    }

    /// The same with the caller's own square root, which must be correctly rounded for the same
    /// bits. A host that hands in the compiler's own gets a loop over many times vectorised, which
    /// `libm`'s stands in the way of.
    #[inline(always)]
    pub fn position_with(&self, time: f64, square_root: impl Fn(f64) -> f64) -> f64 {
        let (since, first_half) = self.nearer_end(time);
        let way = self.range * from_end(since * self.rate, square_root);
        if first_half {
            self.from + way
        } else {
            self.to - way
        }
    }
}

impl Trajectory for Profile {
    fn duration(&self) -> f64 {
        self.duration
    }

    fn at(&self, time: f64) -> Sample {
        let (since, first_half) = self.nearer_end(time);
        let rates = Rates::at(since * self.rate);
        let velocity = self.range * self.rate;
        let acceleration = velocity * self.rate;
        Sample {
            position: self.position_at(time),
            velocity: velocity * rates.first,
            acceleration: if first_half {
                acceleration * rates.second
            } else {
                -acceleration * rates.second
            },
            jerk: acceleration * self.rate * rates.third,
        }
    }

    fn peaks(&self) -> Peaks {
        let velocity = self.range.abs() * self.rate;
        let acceleration = velocity * self.rate;
        Peaks {
            velocity: PEAK_VELOCITY * velocity,
            acceleration: PEAK_ACCELERATION * acceleration,
            jerk: PEAK_JERK * acceleration * self.rate,
        }
    }
}
