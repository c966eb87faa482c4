//! Bezier curves of one coordinate over time, of degree 1 to 16, by de Casteljau's algorithm.
//!
//! With n + 1 points b_0 .. b_n and u = t / T the position is the sum over i of
//! binomial(n, i) u^i (1 - u)^(n-i) b_i. Each level of the algorithm divides the lines between
//! neighbouring points at u; what is left after n levels is the position, and the differences of
//! the k + 1 points that are left after n - k levels give derivative k (Farin, Curves and Surfaces
//! for CAGD, chapters 4 and 5).

use super::bounds::{LARGEST, SMALLEST, checked_position};
use super::error::{ProfileError, checked};
use super::polynomial::peaks;
use super::trajectory::{Peaks, Sample, Trajectory};
use heapless::Vec;

/// The highest degree.
pub const HIGHEST_DEGREE: usize = peaks::HIGHEST_DEGREE;
/// The most points, one more than the degree.
pub const MOST_POINTS: usize = HIGHEST_DEGREE + 1;

/// The points of one level of de Casteljau's algorithm.
type Points = Vec<f64, MOST_POINTS>;

/// A Bezier curve over a duration. It passes the first and the last of its points.
#[derive(Debug, Clone, PartialEq)]
pub struct Bezier {
    points: Points,
    duration: f64,
}

impl Bezier {
    /// The curve with these control points, from the start to the end, over `duration` seconds.
    ///
    /// # Errors
    /// [`ProfileError::Value`] for fewer than 2 or more than 17 points, for a point that is not a
    /// number or beyond 1e15, and for a duration that is not from 1e-15 to 1e15 s.
    pub fn new(points: &[f64], duration: f64) -> Result<Self, ProfileError> {
        let count = points.len() as f64;
        checked("number of control points", count, 2.0, MOST_POINTS as f64)?;
        for &point in points {
            checked_position("control point", point)?;
        }
        checked("duration", duration, SMALLEST, LARGEST)?;
        Ok(Self {
            points: points.iter().copied().collect(),
            duration,
        })
    }

    /// The control points, from the start to the end.
    pub fn points(&self) -> &[f64] {
        &self.points
    }

    /// One less than the points.
    pub fn degree(&self) -> usize {
        self.points.len().saturating_sub(1)
    }

    /// Position and derivatives by u, at u and with `rest` = 1 - u.
    fn unit(&self, u: f64, rest: f64) -> Sample {
        let mut at = Sample::default();
        let mut points = self.points.clone();
        let degree = self.degree();
        // n (n - 1) .. (n - k + 1)
        let falling = |order: usize| {
            let factors = (0..order).map(|step| degree.saturating_sub(step) as f64);
            factors.product::<f64>()
        };
        loop {
            match points.as_slice() {
                [a, b, c, d] => at.jerk = falling(3) * (d - 3.0 * c + 3.0 * b - a),
                [a, b, c] => at.acceleration = falling(2) * ((c - b) - (b - a)),
                [a, b] => at.velocity = falling(1) * (b - a),
                [a] => {
                    at.position = *a;
                    return at;
                }
                [] => return at,
                _ => {}
            }
            divide(&mut points, u, rest);
        }
    }

    /// The points of the derivative of `order`, over the degree's falling factorial.
    fn differences(&self, order: usize) -> Points {
        let mut points = self.points.clone();
        for _ in 0..order {
            let neighbours = points.iter().zip(points.iter().skip(1));
            points = neighbours.map(|(a, b)| b - a).collect();
        }
        points
    }
}

/// The next level: each point goes to where the line to its neighbour is divided at u, and the
/// last, which has none, goes away.
fn divide(points: &mut Points, u: f64, rest: f64) {
    let mut left = points.as_mut_slice();
    while let [point, others @ ..] = left {
        if let Some(next) = others.first() {
            *point = rest * *point + u * next;
        }
        left = others;
    }
    points.pop();
}

/// The curve of these points at u.
fn value(points: &Points, u: f64) -> f64 {
    let mut points = points.clone();
    while points.len() > 1 {
        divide(&mut points, u, 1.0 - u);
    }
    points.first().copied().unwrap_or(0.0)
}

impl Trajectory for Bezier {
    fn duration(&self) -> f64 {
        self.duration
    }

    /// At both ends themselves acceleration and jerk are the curve's; beyond, zero.
    fn at(&self, time: f64) -> Sample {
        let left = self.duration - time;
        let first_half = time < left;
        let since = if first_half { time } else { left };
        // Not `max`, which would hide a NaN.
        let near = if since < 0.0 { 0.0 } else { since } / self.duration;
        let unit = if first_half {
            self.unit(near, 1.0 - near)
        } else {
            self.unit(1.0 - near, near)
        };
        let rate = 1.0 / self.duration;
        let at = Sample {
            position: unit.position,
            velocity: unit.velocity * rate,
            acceleration: unit.acceleration * (rate * rate),
            jerk: unit.jerk * (rate * rate) * rate,
        };
        if since >= 0.0 || since.is_nan() {
            return at;
        }
        let beyond = if first_half { since } else { -since };
        Sample::coasting(at.position, at.velocity).after(beyond)
    }

    /// Found between the roots of the derivatives, all the way down from the highest.
    fn peaks(&self) -> Peaks {
        let degree = self.degree();
        let unit = peaks::of(degree, |order| {
            let points = self.differences(order);
            move |u| value(&points, u)
        });
        let [first, second, third] =
            [0, 1, 2].map(|step| degree.saturating_sub(step) as f64 / self.duration);
        Peaks {
            velocity: unit.velocity * first,
            acceleration: unit.acceleration * first * second,
            jerk: unit.jerk * first * second * third,
        }
    }
}
