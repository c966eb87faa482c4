//! What a move leaves swinging: a mass on a spring, carried along by the axis.
//!
//! The mass at x hangs on the axis at q by a spring and a damper:
//! `x'' + 2 z w (x' - q') + w^2 (x - q) = 0`, with w = 2 pi times the frequency and z the damping
//! ratio (as in Singer and Seering, Preshaping Command Inputs to Reduce System Vibration, 1990).
//! How far it is off, y = x - q, is driven by the axis's acceleration alone:
//! `y'' + 2 z w y' + w^2 y = -q''`. After the end of the move y swings freely, and the height of
//! that swing at the end is `|A| / wd` with `A = integral of q''(t) exp(s (T - t)) dt`, where
//! s = -z w + i wd is the pole and wd = w sqrt(1 - z^2).
//!
//! Over pieces of constant jerk that integral has a closed form. Over smooth curves it is added up
//! by Gauss's rule of eight points in panels no longer than the swing can be followed, after the
//! substitution t = T (1 - cos phi) / 2, which makes the beta curve's ends smooth.

use super::curve::Curve;
use super::error::PlanError;
use canter_shared::motion::segments::Segments;
use canter_shared::motion::trajectory::Trajectory;
use std::f64::consts::{PI, TAU};

/// A mass on a spring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonance {
    /// In Hz, undamped, positive.
    pub frequency: f64,
    /// From 0 (swings for ever) to just below 1 (does not swing at all).
    pub damping: f64,
}

/// Swings within one move that are followed at most.
pub const MOST_CYCLES: f64 = 100_000.0;

/// Nodes and weights of Gauss's rule of eight points on [-1, 1], the positive half.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

impl Resonance {
    fn pole(&self) -> Complex {
        let omega = TAU * self.frequency;
        Complex {
            re: -self.damping * omega,
            im: omega * ((1.0 - self.damping) * (1.0 + self.damping)).sqrt(),
        }
    }

    /// How far the mass swings to each side right after the end of the move, in the unit of the
    /// position.
    ///
    /// # Errors
    /// A move so long, or a frequency so high, that there are too many swings within it.
    pub fn residual(&self, curve: &Curve) -> Result<f64, PlanError> {
        let pole = self.pole();
        let duration = curve.duration();
        let integral = match curve {
            Curve::Pieces(segments) => over_pieces(segments, pole),
            smooth => {
                let cycles = self.frequency * duration;
                if cycles > MOST_CYCLES {
                    return Err(PlanError::TooManyCycles {
                        duration,
                        frequency: self.frequency,
                        cycles,
                        most: MOST_CYCLES,
                    });
                }
                over_curve(smooth, duration, pole)
            }
        };
        Ok(integral.size() / pole.im)
    }

    /// What impulses (seconds after the first, share of the move) leave of the swing of a move that
    /// is made of them, from 0 to 1: each leaves its share, as old as it is at the last one's time.
    pub fn left_by(&self, impulses: &[(f64, f64)]) -> f64 {
        let pole = self.pole();
        let last = impulses
            .iter()
            .fold(0.0, |last: f64, (time, _)| last.max(*time));
        let parts = impulses
            .iter()
            .map(|(time, share)| pole.times(last - time).exp().times(*share));
        parts.fold(Complex::ZERO, Complex::plus).size()
    }
}

fn over_pieces(segments: &Segments, pole: Complex) -> Complex {
    let duration = segments.duration();
    segments
        .segments()
        .iter()
        .map(|segment| {
            let length = segment.duration;
            let z = pole.times(length);
            let (first, second) = divided_exponentials(z);
            let own = first
                .times(segment.entry.acceleration * length)
                .plus(second.times(segment.entry.jerk * length * length));
            let since = duration - (segment.start + length);
            own.by(pole.times(since).exp())
        })
        .fold(Complex::ZERO, Complex::plus)
}

/// (e^z - 1) / z and (e^z - 1 - z) / z^2.
fn divided_exponentials(z: Complex) -> (Complex, Complex) {
    if z.size() < 0.5 {
        // The sums of z^k / (k + 1)! and z^k / (k + 2)!, where the quotients would cancel.
        let (mut first, mut second) = (Complex::ZERO, Complex::ZERO);
        for k in (0..16).rev() {
            let k = f64::from(k);
            // Horner, with the factorials divided out: 1 / (k + 1)! = (1 / (k + 1)) / k!.
            first = Complex::ONE.plus(first.by(z).times(1.0 / (k + 2.0)));
            second = Complex::ONE.plus(second.by(z).times(1.0 / (k + 3.0)));
        }
        return (first, second.times(0.5));
    }
    let less_one = z.exp().plus(Complex { re: -1.0, im: 0.0 });
    let first = less_one.over(z);
    let second = first.plus(Complex { re: -1.0, im: 0.0 }).over(z);
    (first, second)
}

fn over_curve(curve: &Curve, duration: f64, pole: Complex) -> Complex {
    // The phase turns by at most 1 rad in a panel, and a curve that hardly swings gets a few.
    let panels = 8.0 + (PI / 2.0 * pole.size() * duration).ceil();
    let half = PI / (2.0 * panels);
    let mut sum = Complex::ZERO;
    for panel in 0..panels as u64 {
        let middle = (2.0 * panel as f64 + 1.0) * half;
        for (node, weight) in GAUSS {
            for phi in [middle - half * node, middle + half * node] {
                let (sine, cosine) = phi.sin_cos();
                let acceleration = curve.at(duration * (1.0 - cosine) / 2.0).acceleration;
                let swing = pole.times(duration * (1.0 + cosine) / 2.0).exp();
                sum = sum.plus(swing.times(weight * half * acceleration * sine * duration / 2.0));
            }
        }
    }
    sum
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Complex {
    re: f64,
    im: f64,
}

impl Complex {
    const ZERO: Self = Self { re: 0.0, im: 0.0 };
    const ONE: Self = Self { re: 1.0, im: 0.0 };

    fn plus(self, other: Self) -> Self {
        Self {
            re: self.re + other.re,
            im: self.im + other.im,
        }
    }

    fn times(self, factor: f64) -> Self {
        Self {
            re: self.re * factor,
            im: self.im * factor,
        }
    }

    fn by(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }

    fn over(self, other: Self) -> Self {
        let conjugate = Self {
            im: -other.im,
            ..other
        };
        let size = other.size();
        self.by(conjugate.times(1.0 / size)).times(1.0 / size)
    }

    fn exp(self) -> Self {
        let (sine, cosine) = self.im.sin_cos();
        let size = self.re.exp();
        Self {
            re: size * cosine,
            im: size * sine,
        }
    }

    fn size(self) -> f64 {
        self.re.hypot(self.im)
    }
}
