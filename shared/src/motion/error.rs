//! Why a profile cannot be made.

use core::fmt;

/// A profile that cannot be made from what was asked; nothing else happened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ProfileError {
    /// A value is not a number, or outside its range.
    Value {
        /// What was given, such as `acceleration`.
        field: &'static str,
        /// The value that was refused.
        value: f64,
        /// The smallest value that is accepted.
        minimum: f64,
        /// The largest value that is accepted.
        maximum: f64,
    },
    /// The start velocity is too high to come down to the stop velocity within the range.
    StartTooFast {
        /// The start velocity that was asked for.
        velocity: f64,
        /// The start velocity of the same sign from which the range is just enough.
        fastest: f64,
    },
    /// The stop velocity cannot be reached within the range.
    StopOutOfReach {
        /// The stop velocity that was asked for.
        velocity: f64,
        /// The stop velocity of the same sign that can just be reached.
        reachable: f64,
    },
    /// The duration is too short for the limits.
    TooShort {
        /// The duration that was asked for, in seconds.
        duration: f64,
        /// The least duration that the limits allow, in seconds.
        shortest: f64,
    },
}

impl fmt::Display for ProfileError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value {
                field,
                value,
                minimum,
                maximum,
            } => write!(
                formatter,
                "{field} must be a number from {minimum} to {maximum}, but it is {value}"
            ),
            Self::StartTooFast { velocity, fastest } => write!(
                formatter,
                "start velocity {velocity} is too high to slow down within the range: \
                 start with at most {fastest}, raise the deceleration limit or go farther"
            ),
            Self::StopOutOfReach {
                velocity,
                reachable,
            } => write!(
                formatter,
                "stop velocity {velocity} cannot be reached within the range: \
                 stop with at most {reachable}, raise the acceleration limit or go farther"
            ),
            Self::TooShort { duration, shortest } => write!(
                formatter,
                "duration {duration} s is too short for the limits; it must be at least {shortest} s"
            ),
        }
    }
}

impl core::error::Error for ProfileError {}

/// `value` where it is a number from `minimum` to `maximum`.
///
/// # Errors
/// [`ProfileError::Value`] with the field's name; a NaN is in no range.
#[inline(never)]
pub fn checked(
    field: &'static str,
    value: f64,
    minimum: f64,
    maximum: f64,
) -> Result<f64, ProfileError> {
    if (minimum..=maximum).contains(&value) {
        Ok(value)
    } else {
        Err(ProfileError::Value {
            field,
            value,
            minimum,
            maximum,
        })
    }
}
