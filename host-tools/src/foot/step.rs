//! One step through the air.

use super::error::FootError;
use super::law::{BUMP, WAY};
use crate::leg::FootMotion;
use crate::notation::Range;
use canter_shared::motion::polynomial::Quintic;
use canter_shared::motion::trajectory::{Sample, Trajectory};

const POSITION: Range = Range {
    field: "a position at an end of a step",
    unit: "m",
    least: -1e3,
    most: 1e3,
    cure: "give it in m, as seen from the hip",
};
const VELOCITY: Range = Range {
    field: "a velocity at an end of a step",
    unit: "m/s",
    least: -1e3,
    most: 1e3,
    cure: "give it in m/s",
};
const ACCELERATION: Range = Range {
    field: "an acceleration at an end of a step",
    unit: "m/s^2",
    least: -1e6,
    most: 1e6,
    cure: "give it in m/s^2",
};
const CLEARANCE: Range = Range {
    field: "the clearance of a step",
    unit: "m",
    least: 0.0,
    most: 10.0,
    cure: "give it in m, upwards from the higher end",
};
const DURATION: Range = Range {
    field: "the duration of a step",
    unit: "s",
    least: 1e-3,
    most: 1e3,
    cure: "give it in s",
};

/// One step through the air in three dimensions: from a lift-off to a touch-down, with position,
/// velocity and acceleration met at both ends and the given clearance between them.
///
/// In the middle of its time the foot is the clearance above the higher end, or higher where the
/// velocities at the ends carry it there. The acceleration is continuous.
///
/// Each coordinate is a polynomial of degree 5 that meets velocities and accelerations at the ends,
/// plus a modified trapezoid for the way that is left, and upwards a bump of the same make.
/// Where both ends move alike, as on the ground, the polynomial is a straight line and the peak
/// acceleration 4.888 times the way that is left over the duration squared, and 18.4 times
/// the clearance upwards.
#[derive(Debug, Clone)]
pub struct Step {
    coordinates: [Coordinate; 3],
    height: f64,
    duration: f64,
}

#[derive(Debug, Clone)]
struct Coordinate {
    /// Where it is at lift-off.
    start: f64,
    /// What meets the ends' velocities and accelerations, from 0.
    ends: Quintic,
    /// What is left to go.
    rest: f64,
}

impl Step {
    /// The step of `duration` seconds between two motions, `clearance` m above the higher.
    ///
    /// # Errors
    /// [`FootError::Value`] for a position beyond 1 km, a velocity beyond 1 km/s, an acceleration
    /// beyond 10^6 m/s^2, a clearance outside of 0 to 10 m, a duration outside of 1 ms to 1000 s,
    /// and anything that is no number.
    pub fn new(
        from: &FootMotion,
        to: &FootMotion,
        clearance: f64,
        duration: f64,
    ) -> Result<Self, FootError> {
        CLEARANCE.check(clearance)?;
        DURATION.check(duration)?;
        let [x, y, z] = [0, 1, 2].map(|index| {
            let end = |motion: &FootMotion| [motion.position, motion.velocity, motion.acceleration];
            let of = |motion| end(motion).map(|value: [f64; 3]| value[index]);
            Coordinate::new(of(from), of(to), duration)
        });
        let mut step = Self {
            coordinates: [x?, y?, z?],
            height: 0.0,
            duration,
        };
        let top = from.position[2].max(to.position[2]) + clearance;
        let without = step.at(0.5 * duration).position[2];
        step.height = (top - without).max(0.0);
        Ok(step)
    }

    /// How long it lasts, in s.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Where the foot is `time` s after lift-off; before it and after touch-down as at those.
    pub fn at(&self, time: f64) -> FootMotion {
        let time = time.clamp(0.0, self.duration);
        let u = time / self.duration;
        let by_time = [
            1.0,
            self.duration.recip(),
            (self.duration * self.duration).recip(),
        ];
        let (way, bump) = (WAY.at(u), BUMP.at(u));
        let mut motion = FootMotion::default();
        let out = [
            &mut motion.position,
            &mut motion.velocity,
            &mut motion.acceleration,
        ];
        let heights = [0.0, 0.0, self.height];
        for (order, values) in out.into_iter().enumerate() {
            let parts = values.iter_mut().zip(&self.coordinates).zip(heights);
            for ((value, coordinate), height) in parts {
                let ends = coordinate.ends.at(time);
                let ends = [ends.position, ends.velocity, ends.acceleration];
                let start = if order == 0 { coordinate.start } else { 0.0 };
                let shape = coordinate.rest * way[order] + height * bump[order];
                *value = start + ends[order] + shape * by_time[order];
            }
        }
        motion
    }
}

impl Coordinate {
    fn new(from: [f64; 3], to: [f64; 3], duration: f64) -> Result<Self, FootError> {
        for [position, velocity, acceleration] in [from, to] {
            POSITION.check(position)?;
            VELOCITY.check(velocity)?;
            ACCELERATION.check(acceleration)?;
        }
        // As far as the ends' own velocities and accelerations carry: a line where they agree.
        let carried = duration * (0.5 * (from[1] + to[1]) + duration * (from[2] - to[2]) / 12.0);
        let state = |position, end: [f64; 3]| Sample {
            position,
            velocity: end[1],
            acceleration: end[2],
            jerk: 0.0,
        };
        let ends = Quintic::new(state(0.0, from), state(carried, to), duration)?;
        Ok(Self {
            start: from[0],
            ends,
            rest: to[0] - from[0] - carried,
        })
    }
}
