//! A quantity together with how it changes in time.
//!
//! What is computed from such quantities carries its own first and second derivative along, by the
//! rules of calculus and without any difference quotient. So one formula gives a place, its velocity
//! and its acceleration, and they cannot disagree.

use std::ops::{Add, Mul, Neg, Sub};

/// A value with its first and second derivative by time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Varying {
    pub value: f64,
    pub rate: f64,
    pub acceleration: f64,
}

impl Varying {
    pub fn new(value: f64, rate: f64, acceleration: f64) -> Self {
        Self {
            value,
            rate,
            acceleration,
        }
    }

    pub fn constant(value: f64) -> Self {
        Self::new(value, 0.0, 0.0)
    }

    /// A function of it whose value and first two derivatives by it are known here.
    fn through(self, value: f64, first: f64, second: f64) -> Self {
        Self::new(
            value,
            first * self.rate,
            first * self.acceleration + second * self.rate * self.rate,
        )
    }

    pub fn sin(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        self.through(sin, cos, -sin)
    }

    pub fn cos(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        self.through(cos, -sin, -cos)
    }

    /// The root; at zero its derivatives are not finite.
    pub fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.through(root, 0.5 / root, -0.25 / (root * self.value))
    }

    /// The angle whose sine and cosine are as `self` to `cosine`.
    pub fn atan2(self, cosine: Self) -> Self {
        let (y, x) = (self, cosine);
        let square = x.value * x.value + y.value * y.value;
        let rate = (x.value * y.rate - y.value * x.rate) / square;
        let turning = x.value * y.acceleration - y.value * x.acceleration;
        let growing = 2.0 * (x.value * x.rate + y.value * y.rate);
        let acceleration = (turning - rate * growing) / square;
        Self::new(y.value.atan2(x.value), rate, acceleration)
    }

    /// The length of the vector of both.
    pub fn hypot(self, other: Self) -> Self {
        let sum = (self * self + other * other).sqrt();
        Self {
            value: self.value.hypot(other.value),
            ..sum
        }
    }

    pub fn reciprocal(self) -> Self {
        let reciprocal = 1.0 / self.value;
        let square = reciprocal * reciprocal;
        self.through(reciprocal, -square, 2.0 * square * reciprocal)
    }

    /// The same, but for a value below zero, which only rounding makes, zero.
    pub fn at_least_zero(self) -> Self {
        Self {
            value: self.value.max(0.0),
            ..self
        }
    }
}

impl Add for Varying {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(
            self.value + other.value,
            self.rate + other.rate,
            self.acceleration + other.acceleration,
        )
    }
}

impl Add<f64> for Varying {
    type Output = Self;

    fn add(self, other: f64) -> Self {
        Self {
            value: self.value + other,
            ..self
        }
    }
}

impl Sub for Varying {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Sub<f64> for Varying {
    type Output = Self;

    fn sub(self, other: f64) -> Self {
        self + -other
    }
}

impl Neg for Varying {
    type Output = Self;

    fn neg(self) -> Self {
        Self::new(-self.value, -self.rate, -self.acceleration)
    }
}

impl Mul for Varying {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self::new(
            self.value * other.value,
            self.rate * other.value + self.value * other.rate,
            self.acceleration * other.value
                + 2.0 * self.rate * other.rate
                + self.value * other.acceleration,
        )
    }
}

impl Mul<f64> for Varying {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self::new(
            self.value * factor,
            self.rate * factor,
            self.acceleration * factor,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each rule against a function of time whose derivatives are written out by hand.
    #[test]
    fn the_rules_of_calculus() {
        let time: f64 = 0.7;
        // 2 + t^2, and its derivatives.
        let inner = Varying::new(2.0 + time * time, 2.0 * time, 2.0);
        let (sin, cos) = inner.value.sin_cos();
        let expected = [
            (
                inner.sin(),
                [sin, 2.0 * time * cos, 2.0 * cos - 4.0 * time * time * sin],
            ),
            (
                inner.cos(),
                [cos, -2.0 * time * sin, -2.0 * sin - 4.0 * time * time * cos],
            ),
            (
                inner * inner,
                [
                    inner.value.powi(2),
                    8.0 * time + 4.0 * time.powi(3),
                    8.0 + 12.0 * time * time,
                ],
            ),
            (
                inner.sqrt(),
                [
                    inner.value.sqrt(),
                    time / inner.value.sqrt(),
                    2.0 / inner.value.powf(1.5),
                ],
            ),
            (
                inner.reciprocal(),
                [
                    1.0 / inner.value,
                    -2.0 * time / inner.value.powi(2),
                    (6.0 * time * time - 4.0) / inner.value.powi(3),
                ],
            ),
            // The angle of (cos, sin) of the inner is the inner.
            (
                (inner.sin() * 3.0).atan2(inner.cos() * 3.0),
                [2.49, 1.4, 2.0],
            ),
            (
                (inner.sin() * 3.0).hypot(inner.cos() * 3.0),
                [3.0, 0.0, 0.0],
            ),
        ];
        for (index, (got, expected)) in expected.into_iter().enumerate() {
            for (got, expected) in [got.value, got.rate, got.acceleration].iter().zip(expected) {
                assert!((got - expected).abs() < 1e-13, "{index}: {got}, {expected}");
            }
        }
    }
}
