//! What a number may be, and what to say where it is something else.

use thiserror::Error;

/// A value that is outside of its range, or no number.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("{} is {value} {}: it must be from {} to {} {}; {}", .range.field, .range.unit, .range.least, .range.most, .range.unit, .range.cure)]
pub struct OutOfRange {
    /// What it is.
    pub value: f64,
    /// What it may be.
    pub range: Range,
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
    /// Whether a value is in the range.
    ///
    /// # Errors
    /// It is outside, or no number.
    pub fn check(&self, value: f64) -> Result<(), OutOfRange> {
        // A NaN is in no range.
        if (self.least..=self.most).contains(&value) {
            Ok(())
        } else {
            let range = *self;
            Err(OutOfRange { value, range })
        }
    }
}
