//! Limits by sign rather than by sense, which is what the solver needs.

use super::super::bounds::{Bounds, LARGEST, SMALLEST};
use super::super::error::{ProfileError, checked};

/// How fast an s-curve may be in each direction. Only valid values can be held: each magnitude
/// from [`SMALLEST`] to [`LARGEST`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignedBounds {
    velocity_max: f64,
    velocity_min: f64,
    acceleration_max: f64,
    acceleration_min: f64,
    jerk: f64,
}

impl SignedBounds {
    /// The largest velocity and acceleration, both positive; the smallest ones, both negative;
    /// and the largest magnitude of the jerk.
    ///
    /// # Errors
    /// The first value that is outside its range, by name. An infinite jerk is one: without a
    /// limit of jerk the profile is a trapezoid.
    pub fn new(
        velocity_max: f64,
        velocity_min: f64,
        acceleration_max: f64,
        acceleration_min: f64,
        jerk: f64,
    ) -> Result<Self, ProfileError> {
        let above = |field, value| checked(field, value, SMALLEST, LARGEST);
        let below = |field, value| checked(field, value, -LARGEST, -SMALLEST);
        Ok(Self {
            velocity_max: above("velocity limit", velocity_max)?,
            velocity_min: below("velocity limit below zero", velocity_min)?,
            acceleration_max: above("acceleration limit", acceleration_max)?,
            acceleration_min: below("acceleration limit below zero", acceleration_min)?,
            jerk: above("jerk limit", jerk)?,
        })
    }

    /// For a move towards greater positions: accelerates upwards and decelerates downwards.
    ///
    /// # Errors
    /// An infinite jerk limit.
    pub fn forward(bounds: &Bounds) -> Result<Self, ProfileError> {
        Self::new(
            bounds.velocity(),
            -bounds.velocity(),
            bounds.acceleration(),
            -bounds.deceleration(),
            bounds.jerk(),
        )
    }

    /// For a move towards smaller positions: accelerates downwards and decelerates upwards.
    ///
    /// # Errors
    /// An infinite jerk limit.
    pub fn backward(bounds: &Bounds) -> Result<Self, ProfileError> {
        Self::new(
            bounds.velocity(),
            -bounds.velocity(),
            bounds.deceleration(),
            -bounds.acceleration(),
            bounds.jerk(),
        )
    }

    /// The largest velocity, positive.
    pub const fn velocity_max(&self) -> f64 {
        self.velocity_max
    }

    /// The smallest velocity, negative.
    pub const fn velocity_min(&self) -> f64 {
        self.velocity_min
    }

    /// The largest acceleration, positive.
    pub const fn acceleration_max(&self) -> f64 {
        self.acceleration_max
    }

    /// The smallest acceleration, negative.
    pub const fn acceleration_min(&self) -> f64 {
        self.acceleration_min
    }

    /// The largest magnitude of the jerk.
    pub const fn jerk(&self) -> f64 {
        self.jerk
    }
}
