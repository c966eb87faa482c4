//! What a plant is made of.

use canter_shared::limits::Limits;

/// What a plant is made of, not yet looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlantValues {
    /// Inertia at the joint, motor included, in kg m^2; above 0.
    pub inertia: f64,
    /// Viscous friction in N m s/rad.
    pub viscous: f64,
    /// Coulomb friction in N m: what it takes to get the shaft going.
    pub coulomb: f64,
    /// The most that the motor can do, in N m; above `coulomb`.
    pub torque: f64,
    /// The part of both frictions that the drive has been told of, 0 to 1.
    pub compensation: f64,
    /// Counts of the encoder in one turn of the joint, 2^8 to 2^26.
    pub encoder: u32,
}

/// A plant that is possible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlantModel(PlantValues);

/// A value of a plant that is not possible.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the plant's {field} must be a number from {minimum} to {maximum}, but it is {value}")]
pub struct PlantError {
    /// Which field of [`PlantValues`].
    pub field: &'static str,
    /// What it was to be.
    pub value: f64,
    /// The least that is possible.
    pub minimum: f64,
    /// The most that is possible.
    pub maximum: f64,
}

impl PlantModel {
    /// The plant of these values.
    ///
    /// # Errors
    /// The first value that is out of its range.
    pub fn new(values: PlantValues) -> Result<Self, PlantError> {
        let most = 1e9;
        for (field, value, minimum, maximum) in [
            ("inertia in kg m^2", values.inertia, 1e-9, most),
            ("viscous friction in N m s/rad", values.viscous, 0.0, most),
            ("Coulomb friction in N m", values.coulomb, 0.0, most),
            ("torque in N m", values.torque, values.coulomb, most),
            ("compensation", values.compensation, 0.0, 1.0),
            (
                "encoder in counts per turn",
                f64::from(values.encoder),
                f64::from(1 << 8),
                f64::from(1 << 26),
            ),
        ] {
            // A NaN is in no range.
            if !(minimum..=maximum).contains(&value) {
                return Err(PlantError {
                    field,
                    value,
                    minimum,
                    maximum,
                });
            }
        }
        Ok(Self(values))
    }

    /// A plant that was chosen for an axis with these limits: the joint of a leg, and a motor that
    /// can do twice what they ask for, well known to its drive. The encoder has 23 bits, as fine as
    /// the wire.
    pub fn fitting(limits: &Limits) -> Self {
        let (inertia, viscous, coulomb) = (0.01, 0.02, 0.2);
        let accelerating = inertia
            * limits
                .acceleration()
                .radians()
                .max(limits.deceleration().radians());
        let turning = viscous * limits.velocity().radians();
        Self(PlantValues {
            inertia,
            viscous,
            coulomb,
            torque: 2.0 * (accelerating + turning + coulomb),
            compensation: 1.0,
            encoder: 1 << 23,
        })
    }

    /// What it is made of.
    pub const fn values(&self) -> &PlantValues {
        &self.0
    }
}
