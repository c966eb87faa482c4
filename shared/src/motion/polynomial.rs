//! One polynomial from boundary values to boundary values: cubic, quintic and septic Hermite.
//!
//! | type | given at both ends | peaks from rest to rest over R in T |
//! |---|---|---|
//! | [`Cubic`] | position, velocity | 3/2 R/T, 6 R/T^2; the acceleration steps at both ends |
//! | [`Quintic`] | and acceleration | 15/8 R/T, 10/sqrt(3) R/T^2, 60 R/T^3 |
//! | [`Septic`] | and jerk | 35/16 R/T, 84/(5 sqrt(5)) R/T^2, 105/2 R/T^3 |
//!
//! The coefficients follow from the linear equations that the boundary values are, solved once by
//! hand for a duration of one (Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines
//! and Robots, 2008, section 2.1). A polynomial is held twice, expanded about either end, and
//! evaluated from the nearer one, so that both ends are exact.

pub(super) mod peaks;
mod within;

use super::bounds::{checked_duration, checked_position, checked_rate};
use super::error::ProfileError;
use super::trajectory::{Peaks, Sample, Trajectory};

/// From position and velocity to position and velocity.
pub type Cubic = Polynomial<4>;
/// From position, velocity and acceleration to the same.
pub type Quintic = Polynomial<6>;
/// From position, velocity, acceleration and jerk to the same.
pub type Septic = Polynomial<8>;

/// What a time may be beyond an end by rounding, as a fraction of the duration.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A polynomial of N coefficients over a duration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polynomial<const N: usize> {
    from: Sample,
    to: Sample,
    duration: f64,
    /// 1 / duration; zero for a duration of zero.
    rate: f64,
    /// Displacement from `from` by powers of u = t / T.
    start: [f64; N],
    /// Displacement from `to` by powers of 1 - u.
    end: [f64; N],
}

/// Boundary values for a duration of one: velocity, acceleration and jerk.
#[derive(Debug, Clone, Copy)]
struct Rates {
    velocity: f64,
    acceleration: f64,
    jerk: f64,
}

impl Rates {
    /// `sample`'s, in units of `time`; a negative time sees it run backwards.
    fn scaled(sample: &Sample, time: f64) -> Self {
        let square = time * time;
        Self {
            velocity: sample.velocity * time,
            acceleration: sample.acceleration * square,
            jerk: sample.jerk * square * time,
        }
    }
}

/// The coefficients for a duration of one, from what is known at both ends.
type Hermite<const N: usize> = fn(distance: f64, start: Rates, stop: Rates) -> [f64; N];

fn cubic(distance: f64, start: Rates, stop: Rates) -> [f64; 4] {
    let (v0, v1) = (start.velocity, stop.velocity);
    [
        0.0,
        v0,
        3.0 * distance - 2.0 * v0 - v1,
        -2.0 * distance + v0 + v1,
    ]
}

fn quintic(distance: f64, start: Rates, stop: Rates) -> [f64; 6] {
    let (v0, v1) = (start.velocity, stop.velocity);
    let (a0, a1) = (start.acceleration, stop.acceleration);
    [
        0.0,
        v0,
        a0 / 2.0,
        10.0 * distance - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1,
        -15.0 * distance + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1,
        6.0 * distance - 3.0 * (v0 + v1) - 0.5 * (a0 - a1),
    ]
}

fn septic(distance: f64, start: Rates, stop: Rates) -> [f64; 8] {
    let (v0, v1) = (start.velocity, stop.velocity);
    let (a0, a1) = (start.acceleration, stop.acceleration);
    let (j0, j1) = (start.jerk, stop.jerk);
    [
        0.0,
        v0,
        a0 / 2.0,
        j0 / 6.0,
        35.0 * distance - 20.0 * v0 - 15.0 * v1 - 5.0 * a0 + 2.5 * a1 - (4.0 * j0 + j1) / 6.0,
        -84.0 * distance + 45.0 * v0 + 39.0 * v1 + 10.0 * a0 - 7.0 * a1 + j0 + 0.5 * j1,
        70.0 * distance - 36.0 * v0 - 34.0 * v1 - 7.5 * a0 + 6.5 * a1 - (4.0 * j0 + 3.0 * j1) / 6.0,
        -20.0 * distance + 10.0 * (v0 + v1) + 2.0 * (a0 - a1) + (j0 + j1) / 6.0,
    ]
}

impl Cubic {
    /// The cubic through position and velocity at both ends, over `duration` seconds.
    ///
    /// # Errors
    /// [`ProfileError::Value`] for a position or velocity that is not a number or beyond 1e15, and
    /// for a duration that is not from 1e-15 to 1e15 s; zero is allowed between equal ends.
    pub fn new(from: Sample, to: Sample, duration: f64) -> Result<Self, ProfileError> {
        let known = |sample: Sample| Sample::coasting(sample.position, sample.velocity);
        Self::hermite(known(from), known(to), duration, cubic)
    }
}

impl Quintic {
    /// The quintic through position, velocity and acceleration at both ends.
    ///
    /// # Errors
    /// As [`Cubic::new`], for accelerations too.
    pub fn new(from: Sample, to: Sample, duration: f64) -> Result<Self, ProfileError> {
        let known = |sample: Sample| Sample {
            jerk: 0.0,
            ..sample
        };
        Self::hermite(known(from), known(to), duration, quintic)
    }
}

impl Septic {
    /// The septic through position, velocity, acceleration and jerk at both ends.
    ///
    /// # Errors
    /// As [`Quintic::new`], for jerks too.
    pub fn new(from: Sample, to: Sample, duration: f64) -> Result<Self, ProfileError> {
        Self::hermite(from, to, duration, septic)
    }
}

/// `sample` where arithmetic can carry it.
fn checked_end(sample: &Sample, fields: [&'static str; 4]) -> Result<(), ProfileError> {
    let [position, velocity, acceleration, jerk] = fields;
    checked_position(position, sample.position)?;
    checked_rate(velocity, sample.velocity)?;
    checked_rate(acceleration, sample.acceleration)?;
    checked_rate(jerk, sample.jerk)?;
    Ok(())
}

fn checked_ends(from: &Sample, to: &Sample) -> Result<(), ProfileError> {
    checked_end(
        from,
        [
            "start position",
            "start velocity",
            "start acceleration",
            "start jerk",
        ],
    )?;
    checked_end(
        to,
        [
            "stop position",
            "stop velocity",
            "stop acceleration",
            "stop jerk",
        ],
    )
}

impl<const N: usize> Polynomial<N> {
    fn hermite(
        from: Sample,
        to: Sample,
        duration: f64,
        unit: Hermite<N>,
    ) -> Result<Self, ProfileError> {
        checked_ends(&from, &to)?;
        checked_duration(duration, from == to)?;
        let distance = to.position - from.position;
        let (start, stop) = (Rates::scaled(&from, duration), Rates::scaled(&to, duration));
        let back = (
            Rates::scaled(&to, -duration),
            Rates::scaled(&from, -duration),
        );
        Ok(Self {
            from,
            to,
            duration,
            rate: if duration > 0.0 { 1.0 / duration } else { 0.0 },
            start: unit(distance, start, stop),
            end: unit(-distance, back.0, back.1),
        })
    }

    /// The coefficients by powers of the time in seconds, from the lowest up.
    pub fn coefficients(&self) -> [f64; N] {
        let mut scale = 1.0;
        let mut coefficients = self.start;
        for coefficient in &mut coefficients {
            *coefficient *= scale;
            scale *= self.rate;
        }
        if let Some(first) = coefficients.first_mut() {
            *first = self.from.position;
        }
        coefficients
    }
}

/// Value and three derivatives of a polynomial at u, by Horner's rule.
fn horner(coefficients: &[f64], u: f64) -> Sample {
    let mut at = Sample::default();
    for coefficient in coefficients.iter().rev() {
        at.jerk = at.jerk * u + at.acceleration;
        at.acceleration = at.acceleration * u + at.velocity;
        at.velocity = at.velocity * u + at.position;
        at.position = at.position * u + coefficient;
    }
    // The chain gives the derivatives over 1, 2 and 6.
    at.acceleration *= 2.0;
    at.jerk *= 6.0;
    at
}

impl<const N: usize> Trajectory for Polynomial<N> {
    fn duration(&self) -> f64 {
        self.duration
    }

    /// At both ends themselves, and as near as a sum of steps comes to them, acceleration and jerk
    /// are the polynomial's; beyond, zero.
    fn at(&self, time: f64) -> Sample {
        let rounding = ROUNDING * self.duration;
        if time < -rounding {
            return Sample::coasting(self.from.position, self.from.velocity).after(time);
        }
        let left = self.duration - time;
        if left < -rounding {
            return Sample::coasting(self.to.position, self.to.velocity).after(-left);
        }
        let first_half = time < left;
        let (end, coefficients, since) = if first_half {
            (&self.from, &self.start, time)
        } else {
            (&self.to, &self.end, left)
        };
        let since = if since < 0.0 { 0.0 } else { since };
        // Backwards from the end the odd derivatives change their sign.
        let rate = if first_half { self.rate } else { -self.rate };
        let at = horner(coefficients, since * self.rate);
        Sample {
            position: end.position + at.position,
            velocity: if since == 0.0 {
                end.velocity
            } else {
                at.velocity * rate
            },
            acceleration: at.acceleration * (rate * rate),
            jerk: at.jerk * (rate * rate) * rate,
        }
    }

    /// The peaks of the polynomial, found between the roots of its derivatives. The jerk is
    /// infinite where a cubic begins or ends with an acceleration, which it cannot be told.
    fn peaks(&self) -> Peaks {
        let unit = peaks::unit(&self.start);
        let rate = self.rate;
        let ends = [self.at(0.0), self.at(self.duration)];
        let steps = N == 4 && ends.iter().any(|end| end.acceleration != 0.0);
        Peaks {
            velocity: unit.velocity * rate,
            acceleration: unit.acceleration * (rate * rate),
            jerk: if steps {
                f64::INFINITY
            } else {
                unit.jerk * (rate * rate) * rate
            },
        }
    }
}
