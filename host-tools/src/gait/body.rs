//! What the body is asked to do.

use super::error::GaitError;
use crate::notation::Range;

/// What the body is asked to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Forward, in m/s.
    pub vx: f64,
    /// To the left, in m/s.
    pub vy: f64,
    /// Turning to the left, in rad/s.
    pub yaw_rate: f64,
    /// The hips above the ground, in m.
    pub height: f64,
    /// The left side up, in rad.
    pub roll: f64,
    /// The nose down, in rad.
    pub pitch: f64,
}

impl Body {
    /// Standing level at a height in m.
    pub const fn standing(height: f64) -> Self {
        Self {
            vx: 0.0,
            vy: 0.0,
            yaw_rate: 0.0,
            height,
            roll: 0.0,
            pitch: 0.0,
        }
    }

    /// The same without going anywhere.
    pub const fn at_rest(self) -> Self {
        Self {
            vx: 0.0,
            vy: 0.0,
            yaw_rate: 0.0,
            ..self
        }
    }

    /// Whether the numbers make sense.
    ///
    /// # Errors
    /// The field that is out of its range: velocities up to 10 m/s, turning up to 10 rad/s, a
    /// height from 0.01 to 5 m, roll and pitch up to 1 rad.
    pub fn check(&self) -> Result<(), GaitError> {
        let around = |field, unit, most: f64, cure| Range {
            field,
            unit,
            least: -most,
            most,
            cure,
        };
        around("vx", "m/s", 10.0, "go slower").check(self.vx)?;
        around("vy", "m/s", 10.0, "go slower").check(self.vy)?;
        around("the yaw rate", "rad/s", 10.0, "turn slower").check(self.yaw_rate)?;
        around("roll", "rad", 1.0, "lean less").check(self.roll)?;
        around("pitch", "rad", 1.0, "lean less").check(self.pitch)?;
        let height = Range {
            field: "the height",
            unit: "m",
            least: 0.01,
            most: 5.0,
            cure: "give it in m, such as 0.3",
        };
        Ok(height.check(self.height)?)
    }

    pub(super) fn values(&self) -> [f64; 6] {
        [
            self.vx,
            self.vy,
            self.yaw_rate,
            self.height,
            self.roll,
            self.pitch,
        ]
    }
}
