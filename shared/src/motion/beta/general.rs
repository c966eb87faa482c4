//! The beta S-curve with any p from 2 to 5 in f64, to study what p does; the product's is 5/2.
//!
//! F is the regularised incomplete beta function with both parameters p + 1 (NIST Digital Library
//! of Mathematical Functions, 8.17). With u = t / T, w = u (1 - u), x = 2 u - 1 and
//! c = 1 / B(p + 1, p + 1):
//!
//! ```text
//! position      R F(u) = R c u^(p+1) sum over k of binomial(p, k) (-u)^k / (p + 1 + k)
//! velocity      c w^p                                      R / T
//! acceleration  -c p w^(p-1) x                             R / T^2
//! jerk          c p w^(p-2) ((p - 1) x^2 - 2 w)            R / T^3
//! ```
//!
//! The velocity peaks in the middle, the acceleration at x^2 = 1 / (2 p - 1); the jerk in the middle
//! or at x^2 = 3 / (2 p - 1), which for p = 2 are the ends.

use crate::motion::bounds::{Bounds, checked_duration, checked_position};
use crate::motion::error::{ProfileError, checked};
use crate::motion::trajectory::{Peaks, Sample, Trajectory};

/// The least p: below, the jerk is infinite at the ends.
pub const LEAST_P: f64 = 2.0;
/// The greatest p.
pub const GREATEST_P: f64 = 5.0;

/// At u = 1/2 the terms of the series fall faster than 2^-k.
const MOST_TERMS: u32 = 64;

/// The unit curve for one p.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curve {
    p: f64,
    /// 1 / B(p + 1, p + 1)
    scale: f64,
}

impl Curve {
    /// The curve for `p`.
    ///
    /// # Errors
    /// [`ProfileError::Value`] for a p that is not from 2 to 5.
    pub fn new(p: f64) -> Result<Self, ProfileError> {
        let p = checked("p", p, LEAST_P, GREATEST_P)?;
        let half = Self { p, scale: 1.0 }.covered(0.5);
        // F(1/2) is 1/2, which makes up for the beta function.
        Ok(Self {
            p,
            scale: 0.5 / half,
        })
    }

    /// The largest rates of the curve over a range and a duration of one.
    pub fn peaks(&self) -> Peaks {
        let p = self.p;
        // 1 - x^2 = 4 w
        let w_at = |x_square: f64| 0.25 * (1.0 - x_square);
        let x_square = 1.0 / (2.0 * p - 1.0);
        let middle = self.rates(0.25, 0.0).third.abs();
        let side = 3.0 / (2.0 * p - 1.0);
        let beside = self.rates(w_at(side), libm::sqrt(side)).third.abs();
        Peaks {
            velocity: self.rates(0.25, 0.0).first,
            acceleration: self
                .rates(w_at(x_square), libm::sqrt(x_square))
                .second
                .abs(),
            jerk: middle.max(beside),
        }
    }

    /// F at u in [0, 1/2], the fraction of the duration since the nearer end.
    fn covered(&self, u: f64) -> f64 {
        let mut power = 1.0;
        let mut sum = 0.0;
        for k in 0..MOST_TERMS {
            let k = f64::from(k);
            let term = power / (self.p + 1.0 + k);
            sum += term;
            if term.abs() <= 0.1 * f64::EPSILON * sum.abs() {
                break;
            }
            power *= -u * (self.p - k) / (k + 1.0);
        }
        self.scale * libm::pow(u, self.p + 1.0) * sum
    }

    /// The derivatives by u where u (1 - u) is `w` and 2 u - 1 is `x`.
    fn rates(&self, w: f64, x: f64) -> Rates {
        let p = self.p;
        // Never negative, whatever rounding did to w.
        let power = self.scale * libm::pow(w.max(0.0), p - 2.0);
        Rates {
            first: power * w * w,
            second: -p * power * w * x,
            third: p * power * ((p - 1.0) * x * x - 2.0 * w),
        }
    }
}

struct Rates {
    first: f64,
    second: f64,
    third: f64,
}

/// A move along the curve of one p, starting at t = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    curve: Curve,
    from: f64,
    to: f64,
    duration: f64,
    /// 1 / duration; zero for a duration of zero.
    rate: f64,
}

impl Profile {
    /// The quickest move within the limits, as [`super::exact::Profile::within`].
    ///
    /// # Errors
    /// [`ProfileError::Value`] for a p that is not from 2 to 5 and for a position that is not a
    /// number or beyond 1e15.
    pub fn within(p: f64, from: f64, to: f64, bounds: &Bounds) -> Result<Self, ProfileError> {
        let curve = Curve::new(p)?;
        let range = (checked_position("stop position", to)?
            - checked_position("start position", from)?)
        .abs();
        let peaks = curve.peaks();
        let duration = (peaks.velocity * range / bounds.velocity())
            .max(libm::sqrt(
                peaks.acceleration * range / bounds.slower_acceleration(),
            ))
            .max(libm::cbrt(peaks.jerk * range / bounds.jerk()));
        Ok(Self::new(curve, from, to, duration))
    }

    /// A move of a chosen duration in seconds, as [`super::exact::Profile::lasting`].
    ///
    /// # Errors
    /// As [`Self::within`], and for a duration that is not from 1e-15 to 1e15 s; without a range it
    /// may be zero.
    pub fn lasting(p: f64, from: f64, to: f64, duration: f64) -> Result<Self, ProfileError> {
        let curve = Curve::new(p)?;
        checked_position("start position", from)?;
        checked_position("stop position", to)?;
        checked_duration(duration, from == to)?;
        Ok(Self::new(curve, from, to, duration))
    }

    fn new(curve: Curve, from: f64, to: f64, duration: f64) -> Self {
        // A duration so short that it has no reciprocal is that of a range that is nothing.
        let rate = 1.0 / duration;
        let (duration, rate) = if rate.is_finite() {
            (duration, rate)
        } else {
            (0.0, 0.0)
        };
        Self {
            curve,
            from,
            to,
            duration,
            rate,
        }
    }
}

impl Trajectory for Profile {
    fn duration(&self) -> f64 {
        self.duration
    }

    fn at(&self, time: f64) -> Sample {
        if time < 0.0 {
            return Sample::at_rest(self.from);
        }
        let left = self.duration - time;
        if left <= 0.0 {
            return Sample::at_rest(self.to);
        }
        let first_half = time < left;
        let u = self.rate * if first_half { time } else { left };
        let range = self.to - self.from;
        let way = range * self.curve.covered(u);
        let x = if first_half {
            2.0 * u - 1.0
        } else {
            1.0 - 2.0 * u
        };
        let rates = self.curve.rates(u * (1.0 - u), x);
        let velocity = range * self.rate;
        let acceleration = velocity * self.rate;
        Sample {
            position: if first_half {
                self.from + way
            } else {
                self.to - way
            },
            velocity: velocity * rates.first,
            acceleration: acceleration * rates.second,
            jerk: acceleration * self.rate * rates.third,
        }
    }

    fn peaks(&self) -> Peaks {
        let unit = self.curve.peaks();
        let velocity = (self.to - self.from).abs() * self.rate;
        let acceleration = velocity * self.rate;
        Peaks {
            velocity: unit.velocity * velocity,
            acceleration: unit.acceleration * acceleration,
            jerk: unit.jerk * (acceleration * self.rate),
        }
    }
}
