//! What the axes, and the path as a whole, may do.

use super::error::PathError;
use crate::robot::Robot;
use canter_shared::limits::Limits;
use canter_shared::motion::bounds::{LARGEST, SMALLEST};
use canter_shared::wire::id::AxisId;

/// What one axis may do on a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisBounds {
    /// In rad/s, either way.
    pub velocity: f64,
    /// In rad/s^2, either way: the lesser of an axis's acceleration and deceleration, as its node
    /// keeps to for a stream.
    pub acceleration: f64,
    /// In rad/s^3, either way; counts for the jerk-limited timing only.
    pub jerk: f64,
    /// The least position in rad.
    pub minimum: f64,
    /// The greatest position in rad.
    pub maximum: f64,
}

impl AxisBounds {
    /// What a robot's axes may do, in this order.
    pub fn of(robot: &Robot, axes: &[AxisId]) -> Vec<Self> {
        let bounds = |axis: &AxisId| Self::of_limits(&robot.limits(*axis));
        axes.iter().map(bounds).collect()
    }

    /// What an axis of these limits may do.
    pub fn of_limits(limits: &Limits) -> Self {
        Self {
            velocity: limits.velocity().radians(),
            acceleration: limits.slower_acceleration().radians(),
            jerk: limits.jerk().radians(),
            minimum: limits.position_minimum().radians(),
            maximum: limits.position_maximum().radians(),
        }
    }

    /// The same travel with this share of the rates, above 0 to 1.
    #[must_use]
    pub fn scaled(&self, share: f64) -> Self {
        Self {
            velocity: self.velocity * share,
            acceleration: self.acceleration * share,
            jerk: self.jerk * share,
            ..*self
        }
    }

    pub(super) fn check(&self, axis: AxisId) -> Result<(), PathError> {
        check(&format!("axis {axis}: velocity limit"), self.velocity)?;
        check(
            &format!("axis {axis}: acceleration limit"),
            self.acceleration,
        )?;
        check(&format!("axis {axis}: jerk limit"), self.jerk)
    }
}

/// What the motion along the path may be: its speed is the length of the vector of the axes'
/// velocities. What is left out is bounded by the axes alone.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PathBounds {
    /// The most speed, in rad/s.
    pub velocity: Option<f64>,
    /// How fast the speed may rise, in rad/s^2.
    pub acceleration: Option<f64>,
    /// How fast it may fall, in rad/s^2; as the acceleration where it is left out.
    pub deceleration: Option<f64>,
    /// How fast the axes' accelerations may change together, in rad/s^3: the length of their vector. It
    /// counts for the jerk-limited timing only.
    pub jerk: Option<f64>,
}

impl PathBounds {
    pub(super) fn check(&self) -> Result<(), PathError> {
        for (field, value) in [
            ("the path's velocity limit", self.velocity),
            ("the path's acceleration limit", self.acceleration),
            ("the path's deceleration limit", self.deceleration),
            ("the path's jerk limit", self.jerk),
        ] {
            value.map_or(Ok(()), |value| check(field, value))?;
        }
        Ok(())
    }

    pub(super) fn meant_deceleration(&self) -> Option<f64> {
        self.deceleration.or(self.acceleration)
    }
}

fn check(field: &str, value: f64) -> Result<(), PathError> {
    if (SMALLEST..=LARGEST).contains(&value) {
        return Ok(());
    }
    let field = field.to_owned();
    Err(PathError::Limit { field, value })
}
