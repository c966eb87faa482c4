//! Hermite pieces in f64, and random ones that a machine could be asked for.

use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::Setpoint;
use canter_shared::motion::stream::{Knot, LONGEST_GAP};
use canter_shared::units::{Acceleration, Position, Velocity};
use proptest::prelude::*;

/// Position, velocity and acceleration of a Hermite piece in f64, from its control points.
#[derive(Debug, Clone, Copy)]
pub struct Hermite {
    /// Of the position, less that of the first knot.
    control: [f64; 6],
    seconds: f64,
}

impl Hermite {
    pub fn new(from: Setpoint, to: &Knot, ticks: u32) -> Self {
        let seconds = f64::from(ticks) / 1e3;
        let end = (to.position.counts() - from.position.counts()) as f64;
        let first = from.velocity.counts() as f64 * seconds;
        let last = to.velocity.counts() as f64 * seconds;
        let control = match to.acceleration {
            Some(acceleration) => {
                let bend = from.acceleration.counts() as f64 * seconds * seconds / 20.0;
                let end_bend = acceleration.counts() as f64 * seconds * seconds / 20.0;
                [
                    0.0,
                    first / 5.0,
                    2.0 * first / 5.0 + bend,
                    end - 2.0 * last / 5.0 + end_bend,
                    end - last / 5.0,
                    end,
                ]
            }
            None => {
                // The cubic's control points b0 to b3, raised twice.
                let (b1, b2) = (first / 3.0, end - last / 3.0);
                [
                    0.0,
                    3.0 * b1 / 5.0,
                    (6.0 * b1 + 3.0 * b2) / 10.0,
                    (end + 6.0 * b2 + 3.0 * b1) / 10.0,
                    (2.0 * end + 3.0 * b2) / 5.0,
                    end,
                ]
            }
        };
        Self { control, seconds }
    }

    fn casteljau(control: &[f64], u: f64) -> f64 {
        let mut values = control.to_vec();
        while values.len() > 1 {
            values = values
                .windows(2)
                .map(|pair| pair[0] * (1.0 - u) + pair[1] * u)
                .collect();
        }
        values[0]
    }

    fn hodograph(&self, control: &[f64]) -> Vec<f64> {
        let degree = (control.len() - 1) as f64;
        control
            .windows(2)
            .map(|pair| degree * (pair[1] - pair[0]) / self.seconds)
            .collect()
    }

    pub fn at(&self, u: f64) -> [f64; 3] {
        let velocity = self.hodograph(&self.control);
        let acceleration = self.hodograph(&velocity);
        [&self.control[..], &velocity, &acceleration].map(|curve| Self::casteljau(curve, u))
    }
}

/// Limits, and two states that a piece of so many ticks can join.
pub fn pieces() -> impl Strategy<Value = (Limits, Setpoint, Knot, u8, u8)> {
    let rates = (-1.0..1.5f64, 0.0..5.0f64);
    let shape = [
        -1.2..1.2f64,
        -1.2..1.2f64,
        -1.2..1.2f64,
        -1.2..1.2f64,
        -1.2..1.2f64,
    ];
    let place = (
        -990.0..990.0f64,
        any::<bool>(),
        1u8..=255,
        1u8..=LONGEST_GAP,
    );
    (rates, shape, place).prop_map(|((velocity, acceleration), shape, place)| {
        let (velocity, acceleration) = (10f64.powf(velocity * 2.0), 10f64.powf(acceleration));
        let limits = Limits::new(&LimitValues {
            velocity,
            acceleration,
            deceleration: acceleration * 1.5,
            ..DEFAULT_VALUES
        })
        .expect("in range");
        let (turns, quintic, ticks, periods) = place;
        let seconds = f64::from(ticks) * f64::from(periods) / 1e3;
        let radians = |value: f64| Velocity::from_radians(value).expect("in range");
        let pull = |value: f64| Acceleration::from_radians(value * acceleration).expect("in range");
        let [first, last, mean, bend, end_bend] = shape;
        // Where the piece is too short to change its velocity by much, it does not.
        let change = velocity.min(acceleration * seconds);
        let first = first * velocity * 0.9;
        let last = first + (last * change).clamp(-velocity, velocity);
        let middle = (first + last) / 2.0 + mean * change / 8.0;
        let from = Setpoint {
            position: Position::from_counts((turns * 4_294_967_296.0) as i64),
            velocity: radians(first),
            acceleration: pull(bend),
        };
        let step = (middle * seconds).clamp(-60.0, 60.0);
        let to = Knot {
            position: from.position + Position::from_radians(step).expect("in range"),
            velocity: radians(last),
            acceleration: quintic.then_some(pull(end_bend)),
        };
        (limits, from, to, ticks, periods)
    })
}

/// What fraction of a limit the curve reaches at most; above one it is broken.
pub fn used(curve: &Hermite, limits: &Limits) -> f64 {
    let mut used = 0.0f64;
    for index in 0..=400 {
        let [_, velocity, acceleration] = curve.at(f64::from(index) / 4e2);
        let slowing = velocity * acceleration < 0.0;
        let limit = if slowing {
            limits.deceleration()
        } else {
            limits.acceleration()
        };
        used = used.max(velocity.abs() / limits.velocity().counts() as f64);
        used = used.max(acceleration.abs() / limit.counts() as f64);
    }
    used
}
