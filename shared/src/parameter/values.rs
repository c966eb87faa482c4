//! The raw values of one axis's parameters.

use super::settings::Settings;
use super::table::Parameter;
use core::fmt;

/// Why a value is refused. Nothing has changed then.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterError {
    /// The value is outside the parameter's range, in raw values.
    OutOfRange {
        /// Which parameter.
        parameter: Parameter,
        /// The raw value that was refused.
        raw: i64,
    },
    /// The value is in range, but contradicts that of another parameter.
    Contradiction {
        /// Which parameter.
        parameter: Parameter,
        /// The other one.
        other: Parameter,
    },
}

impl fmt::Display for ParameterError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange { parameter, raw } => {
                let entry = parameter.entry();
                write!(
                    formatter,
                    "{} must be from {} to {} {}, but is {}",
                    entry.name,
                    parameter.in_unit(entry.minimum),
                    parameter.in_unit(entry.maximum),
                    entry.unit,
                    parameter.in_unit(*raw),
                )
            }
            Self::Contradiction { parameter, other } => write!(
                formatter,
                "{} does not fit {}: change that one first",
                parameter.entry().name,
                other.entry().name,
            ),
        }
    }
}

impl core::error::Error for ParameterError {}

/// One raw value for each parameter. Each is in its range, and together they make [`Settings`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Values([i64; Parameter::COUNT]);

impl Values {
    /// The defaults for the axis of this id.
    pub fn defaults(axis: u8) -> Self {
        Self(Parameter::ALL.map(|parameter| parameter.default_raw(axis)))
    }

    /// The raw value of a parameter.
    pub fn get(&self, parameter: Parameter) -> i64 {
        // As many places as parameters: there is always one.
        self.0
            .get(usize::from(u8::from(parameter)))
            .copied()
            .unwrap_or_default()
    }

    /// The same values but for one, and what they now mean.
    ///
    /// # Errors
    /// A value outside its range, or one that contradicts another parameter.
    pub fn with(&self, parameter: Parameter, raw: i64) -> Result<(Self, Settings), ParameterError> {
        let entry = parameter.entry();
        if !(entry.minimum..=entry.maximum).contains(&raw) {
            return Err(ParameterError::OutOfRange { parameter, raw });
        }
        let mut changed = *self;
        if let Some(value) = changed.0.get_mut(usize::from(u8::from(parameter))) {
            *value = raw;
        }
        let settings = Settings::of(&changed, parameter)?;
        Ok((changed, settings))
    }
}

impl Parameter {
    /// A raw value in the parameter's unit; of a choice, its place.
    pub fn in_unit(self, raw: i64) -> f64 {
        match self.entry().kind {
            super::Kind::Number { per_unit } => raw as f64 / per_unit as f64,
            super::Kind::Choice(_) => raw as f64,
        }
    }
}
