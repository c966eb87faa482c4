//! The largest derivatives of a polynomial over u in [0, 1].
//!
//! Between two neighbouring roots of its derivative a function is monotone, so it has at most one
//! root there, which halving the interval finds whatever the polynomial. From the highest
//! derivative, which is constant, this leads down to the roots of each.

use crate::motion::trajectory::Peaks;
use heapless::Vec;

/// The highest degree that is looked at.
pub const HIGHEST_DEGREE: usize = 16;
/// Roots in (0, 1), and the ends 0 and 1.
type Points = Vec<f64, { HIGHEST_DEGREE + 2 }>;

/// Halvings of an interval of [0, 1]: 2^-32 beside its place a peak is 2^-64 lower in relation, times
/// a curvature that is of the order of the degree squared.
const HALVINGS: usize = 32;

/// The derivative of `order`, at u.
fn derivative(coefficients: &[f64], order: usize, u: f64) -> f64 {
    let mut sum = 0.0;
    for (power, coefficient) in coefficients.iter().enumerate().skip(order).rev() {
        // power! / (power - order)!
        let mut factor = 1.0;
        for step in 0..order {
            factor *= (power - step) as f64;
        }
        sum = sum * u + coefficient * factor;
    }
    sum
}

/// 0, where `at` changes its sign, and 1; between two `turns` it is monotone.
fn roots(at: impl Fn(f64) -> f64, turns: &Points) -> Points {
    let mut points = Points::new();
    // A polynomial has no more roots than there is room for.
    let mut add = |point| points.push(point).is_ok();
    add(0.0);
    for (&low, &high) in turns.iter().zip(turns.iter().skip(1)) {
        let (mut low, mut high) = (low, high);
        let rises_above = at(high) > 0.0;
        if (at(low) > 0.0) == rises_above {
            continue;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if (at(middle) > 0.0) == rises_above {
                high = middle;
            } else {
                low = middle;
            }
        }
        add(0.5 * (low + high));
    }
    add(1.0);
    points
}

/// The largest first, second and third derivative over [0, 1], without their sign, of a polynomial
/// of a `degree` up to [`HIGHEST_DEGREE`]; `derivative` gives its derivative of an order, by u.
pub fn of<D: Fn(f64) -> f64>(degree: usize, derivative: impl Fn(usize) -> D) -> Peaks {
    let mut turns = Points::new();
    turns.extend([0.0, 1.0]);
    let mut peaks = Peaks::default();
    // From the highest derivative down; `turns` are the roots of the one before.
    for order in (1..=degree).rev() {
        let at = derivative(order);
        let largest = turns.iter().map(|&u| at(u).abs()).fold(0.0, f64::max);
        match order {
            1 => peaks.velocity = largest,
            2 => peaks.acceleration = largest,
            3 => peaks.jerk = largest,
            _ => {}
        }
        if order > 1 {
            turns = roots(at, &turns);
        }
    }
    peaks
}

/// The same of a polynomial with these coefficients, from the lowest power up.
pub fn unit(coefficients: &[f64]) -> Peaks {
    let degree = coefficients.len().saturating_sub(1);
    of(degree, |order| move |u| derivative(coefficients, order, u))
}
