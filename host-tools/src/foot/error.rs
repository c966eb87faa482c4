//! Why a foot trajectory cannot be had.

use canter_shared::motion::error::ProfileError;
use thiserror::Error;

/// Why a foot trajectory cannot be had.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FootError {
    /// A value that is outside of its range, or no number.
    #[error("{field} is {value} {unit}, but it must be from {least} to {most} {unit}: {cure}")]
    Value {
        /// Which one.
        field: &'static str,
        /// What it is.
        value: f64,
        /// Its unit.
        unit: &'static str,
        /// The least that it may be.
        least: f64,
        /// The most that it may be.
        most: f64,
        /// What to do.
        cure: &'static str,
    },
    /// A curve that the motion library refuses.
    #[error(transparent)]
    Curve(#[from] ProfileError),
}

/// What may be asked for: a field with its unit and range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Whose range.
    pub field: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The least that it may be.
    pub least: f64,
    /// The most that it may be.
    pub most: f64,
    /// What to do where it is outside.
    pub cure: &'static str,
}

impl Range {
    /// The value, where it is in the range.
    ///
    /// # Errors
    /// [`FootError::Value`] where it is outside, or no number.
    pub fn check(&self, value: f64) -> Result<f64, FootError> {
        // A NaN is in no range.
        if (self.least..=self.most).contains(&value) {
            return Ok(value);
        }
        Err(FootError::Value {
            field: self.field,
            value,
            unit: self.unit,
            least: self.least,
            most: self.most,
            cure: self.cure,
        })
    }
}
