//! The root of a smooth curve between two places.

/// A curve's value and first two derivatives.
#[derive(Debug, Clone, Copy)]
pub(super) struct Curve {
    pub value: f64,
    pub slope: f64,
    pub curvature: f64,
}

/// Steps after which the search ends, whatever the curve: halving alone would have found all bits.
const MOST_STEPS: usize = 80;

/// The step, in relation to the place, after which there is no need for another one where the
/// curve is smooth: each cubes the error.
pub(super) const SMOOTH: f64 = 1e-6;
/// The same where the curve has corners: down to the last bits.
pub(super) const CORNERED: f64 = 4.0 * f64::EPSILON;

/// Where `curve`, which is not above zero at `low` and not below zero at `high`, passes zero
/// upwards; beginning at `guess` and ending after a step smaller than `last_step` in relation.
///
/// Each step goes to the root of the parabola that touches the curve, which also finds a double
/// root quickly (Halley's irrational method); where that leaves the interval, to its middle.
pub(super) fn root(
    low: f64,
    high: f64,
    guess: f64,
    last_step: f64,
    curve: impl Fn(f64) -> Curve,
) -> f64 {
    let (mut low, mut high) = (low, high);
    let mut at = if guess > low && guess < high {
        guess
    } else {
        high
    };
    for _ in 0..MOST_STEPS {
        let Curve {
            value,
            slope,
            curvature,
        } = curve(at);
        if value > 0.0 {
            high = at;
        } else if value < 0.0 {
            low = at;
        } else {
            break;
        }
        let turn = libm::sqrt((slope * slope - 2.0 * value * curvature).max(0.0));
        let step = if slope > 0.0 {
            -2.0 * value / (slope + turn)
        } else {
            (turn - slope) / curvature
        };
        let next = at + step;
        if step.abs() <= last_step * at.abs() {
            return next.max(low).min(high);
        }
        at = if next > low && next < high {
            next
        } else {
            low + (high - low) / 2.0
        };
        if at <= low || at >= high {
            break;
        }
    }
    at
}

/// The cube root of a positive number within 7 %, to begin a search at.
pub(super) fn rough_cube_root(value: f64) -> f64 {
    // An f64's bits are about its logarithm by two, from a bias of 1023 on and times 2^52: a
    // third of them lacks two thirds of the bias.
    const BIAS: u64 = (1023 * 2 / 3) << 52;
    f64::from_bits(value.to_bits() / 3 + BIAS)
}
