//! How a foot gets from rest to rest with little acceleration and without a step in it.
//!
//! Both laws hold one acceleration for as long as they can and change it along a sine: the modified
//! trapezoid of cam design (Neklutin 1952; Norton, Cam Design and Manufacturing Handbook, chapter 3).
//! A way of 1 in a time of 1 needs 4.888, where a polynomial of degree 5 needs 5.774 with the same
//! jerk, and the least of all, which steps, 4. The same idea up and down again needs 18.4 for
//! a height of 1, where 64 u^3 (1 - u)^3 needs 24, and the least 16.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

/// From 0 to 1: the modified trapezoid, with ramps of an eighth.
pub(crate) static WAY: LazyLock<Law> = LazyLock::new(Law::way);

/// From 0 up to 1 at u = 1/2 and back, the same in both directions.
pub(crate) static BUMP: LazyLock<Law> = LazyLock::new(Law::bump);

/// Value, first and second derivative by u.
pub(crate) type Derivatives = [f64; 3];

/// A stretch of a law: the acceleration is `middle * cos(rate * (u - start) + phase)`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    start: f64,
    entry: [f64; 2],
    amplitude: f64,
    rate: f64,
    phase: f64,
}

impl Piece {
    fn at(&self, u: f64) -> Derivatives {
        let elapsed = u - self.start;
        let [position, velocity] = self.entry;
        if self.rate == 0.0 {
            let acceleration = self.amplitude;
            return [
                position + elapsed * (velocity + 0.5 * acceleration * elapsed),
                velocity + acceleration * elapsed,
                acceleration,
            ];
        }
        let (sine, cosine) = (self.rate * elapsed + self.phase).sin_cos();
        let (first_sine, first_cosine) = self.phase.sin_cos();
        let by_rate = self.amplitude / self.rate;
        let drift = velocity - by_rate * first_sine;
        [
            position + drift * elapsed - by_rate / self.rate * (cosine - first_cosine),
            drift + by_rate * sine,
            self.amplitude * cosine,
        ]
    }
}

/// A law over u from 0 to 1, at rest and without acceleration at both ends.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Law {
    pieces: Vec<Piece>,
    /// What makes the pieces' extent 1.
    scale: f64,
    /// What the law comes to at its end.
    end: f64,
}

impl Law {
    fn way() -> Self {
        const RAMP: f64 = 0.125;
        let hold = 0.5 - 2.0 * RAMP;
        let mut law = Self::empty();
        law.begin(RAMP);
        law.hold(1.0, hold);
        law.swap(1.0, 2.0 * RAMP);
        law.hold(-1.0, hold);
        law.finish(-1.0, RAMP);
        let extent = law.raw(1.0)[0];
        law.scale = 1.0 / extent;
        law.end = 1.0;
        law
    }

    fn bump() -> Self {
        const RAMP: f64 = 1.0 / 16.0;
        // Up to the middle: ramp, hold, ramp to the other side in two, hold. The velocity is 0 in the
        // middle where the areas of both signs are equal, and a ramp has 2 / pi of a hold's area.
        let difference = 2.0 * RAMP / PI;
        let together = 0.5 - 3.0 * RAMP;
        let outer = 0.5 * (together - difference);
        let inner = together + difference;
        let mut law = Self::empty();
        law.begin(RAMP);
        law.hold(1.0, outer);
        law.swap(1.0, 2.0 * RAMP);
        law.hold(-1.0, inner);
        law.swap(-1.0, 2.0 * RAMP);
        law.hold(1.0, outer);
        law.finish(1.0, RAMP);
        let extent = law.raw(0.5)[0];
        law.scale = 1.0 / extent;
        law
    }

    fn empty() -> Self {
        Self {
            pieces: Vec::new(),
            scale: 1.0,
            end: 0.0,
        }
    }

    fn begin(&mut self, length: f64) {
        self.put(1.0, FRAC_PI_2 / length, -FRAC_PI_2, length);
    }

    fn hold(&mut self, acceleration: f64, length: f64) {
        self.put(acceleration, 0.0, 0.0, length);
    }

    fn swap(&mut self, from: f64, length: f64) {
        self.put(from, PI / length, 0.0, length);
    }

    fn finish(&mut self, from: f64, length: f64) {
        self.put(from, FRAC_PI_2 / length, 0.0, length);
    }

    /// Adds a piece after the last, whose length is kept as the next one's start.
    fn put(&mut self, amplitude: f64, rate: f64, phase: f64, length: f64) {
        let (start, entry) = match self.pieces.last() {
            // The last piece is the open one, which holds the state at its own end.
            Some(open) => (open.start, open.entry),
            None => (0.0, [0.0, 0.0]),
        };
        self.pieces.pop();
        let piece = Piece {
            start,
            entry,
            amplitude,
            rate,
            phase,
        };
        let [position, velocity, _] = piece.at(start + length);
        self.pieces.push(piece);
        self.pieces.push(Piece {
            start: start + length,
            entry: [position, velocity],
            amplitude: 0.0,
            rate: 0.0,
            phase: 0.0,
        });
    }

    fn raw(&self, u: f64) -> Derivatives {
        let piece = self.pieces.iter().rev().find(|piece| piece.start <= u);
        piece.map_or([0.0; 3], |piece| piece.at(u))
    }

    /// Value, velocity and acceleration by u; before 0 and after 1 the law rests.
    pub(crate) fn at(&self, u: f64) -> Derivatives {
        if u <= 0.0 {
            return [0.0; 3];
        }
        if u >= 1.0 {
            return [self.end, 0.0, 0.0];
        }
        self.raw(u).map(|value| value * self.scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peaks(law: &Law) -> Derivatives {
        let mut peaks = [0.0f64; 3];
        for at in 0..=100_000 {
            for (peak, value) in peaks.iter_mut().zip(law.at(f64::from(at) / 1e5)) {
                *peak = peak.max(value.abs());
            }
        }
        peaks
    }

    #[test]
    fn the_laws_are_smooth_and_gentle() {
        for (law, end, most) in [(Law::way(), 1.0, 4.889), (Law::bump(), 0.0, 18.5)] {
            let step = 1e-6;
            for at in 0..=100_000 {
                let u = f64::from(at) / 1e5;
                let (before, here, after) = (law.at(u - step), law.at(u), law.at(u + step));
                for order in 0..2 {
                    let slope = (after[order] - before[order]) / (2.0 * step);
                    assert!((slope - here[order + 1]).abs() < 2e-3, "{order} at {u}");
                }
                assert!((after[2] - here[2]).abs() < 1e-3, "jump at {u}");
            }
            assert!((law.raw(1.0)[0] * law.scale - end).abs() < 1e-14);
            assert!(law.raw(1.0)[1].abs() < 1e-14);
            let [way, _, acceleration] = peaks(&law);
            assert!((way - 1.0).abs() < 1e-12, "{way}");
            assert!(acceleration < most, "{acceleration}");
        }
        assert!((Law::bump().at(0.5)[0] - 1.0).abs() < 1e-15);
    }
}
