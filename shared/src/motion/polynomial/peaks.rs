//! The largest derivatives of a polynomial over u in [0, 1].
//!
//! Between two neighbouring roots of its derivative a function is monotone, so it has at most one
//! root there, which halving the interval finds whatever the polynomial. From the highest
//! derivative, which is constant, this leads down to the roots of each.

use crate::motion::trajectory::Peaks;
use heapless::Vec;

/// Coefficients that a polynomial may have.
const MOST_COEFFICIENTS: usize = 8;
/// Roots in (0, 1), and the ends 0 and 1.
type Points = Vec<f64, { MOST_COEFFICIENTS + 2 }>;

/// Halvings that bring an interval of [0, 1] down to what an f64 tells apart near 1.
const HALVINGS: usize = 53;

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

/// 0, where the derivative of `order` changes its sign, and 1; `turns` are the same of the next
/// higher one.
fn roots(coefficients: &[f64], order: usize, turns: &Points) -> Points {
    let mut points = Points::new();
    // A polynomial of N coefficients has fewer roots than there is room for.
    let mut add = |point| points.push(point).is_ok();
    add(0.0);
    let at = |u| derivative(coefficients, order, u);
    for (&low, &high) in turns.iter().zip(turns.iter().skip(1)) {
        let (mut low, mut high) = (low, high);
        let rising = at(high) > at(low);
        if (at(low) > 0.0) == (at(high) > 0.0) {
            continue;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if (at(middle) > 0.0) == rising {
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

/// The largest first, second and third derivative over [0, 1], without their sign.
pub fn unit(coefficients: &[f64]) -> Peaks {
    let mut turns = Points::new();
    turns.extend([0.0, 1.0]);
    let mut peaks = Peaks::default();
    // From the highest derivative down; `turns` are those of the derivative below.
    for order in (1..coefficients.len()).rev() {
        let largest = turns
            .iter()
            .map(|&u| derivative(coefficients, order, u).abs())
            .fold(0.0, f64::max);
        match order {
            1 => peaks.velocity = largest,
            2 => peaks.acceleration = largest,
            3 => peaks.jerk = largest,
            _ => {}
        }
        turns = roots(coefficients, order, &turns);
    }
    peaks
}
