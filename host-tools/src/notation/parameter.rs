//! Values of parameters: numbers in the parameter's unit, angles as everywhere, choices by name.

use super::quantity::{QuantityError, angle_or_rate, seconds};
use canter_shared::parameter::{Kind, Parameter, ParameterError};

/// Why a text is no value of a parameter.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ParameterTextError {
    /// No parameter has this name.
    #[error(
        "`{text}` is no parameter: `canter param list --axis 1` lists them{}",
        near(text)
    )]
    Name {
        /// What was written.
        text: String,
    },
    /// It is not one of the choices.
    #[error("`{text}` is no {name}: write {}", .choices.join(", "))]
    Choice {
        /// What was written.
        text: String,
        /// The parameter.
        name: &'static str,
        /// What can be chosen.
        choices: &'static [&'static str],
    },
    /// It is no quantity.
    #[error("{name}: {source}")]
    Quantity {
        /// The parameter.
        name: &'static str,
        /// What is wrong with it.
        source: QuantityError,
    },
    /// It is no number.
    #[error("{name}: `{text}` is no number{} that it can have", in_unit(unit))]
    Number {
        /// What was written.
        text: String,
        /// The parameter.
        name: &'static str,
        /// Its unit.
        unit: &'static str,
    },
    /// It is outside the range.
    #[error(
        "{name} must be from {minimum} to {maximum}{}, but it is {value}",
        in_unit(unit)
    )]
    Range {
        /// The parameter.
        name: &'static str,
        /// What was written, in the unit.
        value: f64,
        /// The least value.
        minimum: f64,
        /// The greatest value.
        maximum: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// It contradicts another one.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

fn in_unit(unit: &str) -> String {
    if unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    }
}

/// A hint where the name is only a part of one: `velocity` for `limits.velocity`.
fn near(text: &str) -> String {
    let names = Parameter::ALL.map(|parameter| parameter.entry().name);
    let mut alike = names.iter().filter(|name| {
        let part = name.rsplit('.').next().unwrap_or(name);
        !text.is_empty() && (name.contains(text) || text.contains(part))
    });
    alike
        .next()
        .map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

/// The parameter of this name.
///
/// # Errors
/// There is none.
pub fn parameter_named(text: &str) -> Result<Parameter, ParameterTextError> {
    Parameter::named(text).ok_or_else(|| ParameterTextError::Name {
        text: text.to_owned(),
    })
}

/// The raw value that is meant by a text.
///
/// # Errors
/// What the text is not, or the range that its value is outside of.
pub fn parameter_raw(parameter: Parameter, text: &str) -> Result<i64, ParameterTextError> {
    let entry = parameter.entry();
    let name = entry.name;
    let text = text.trim();
    if let Kind::Choice(choices) = entry.kind {
        return parameter
            .choice(text)
            .ok_or_else(|| ParameterTextError::Choice {
                text: text.to_owned(),
                name,
                choices,
            });
    }
    let quantity = |source| ParameterTextError::Quantity { name, source };
    let value = if let Some(ending) = entry.unit.strip_prefix("rad") {
        angle_or_rate(text, ending).map_err(quantity)?
    } else if entry.unit == "s" {
        seconds(text).map_err(quantity)?
    } else {
        let bare = text.strip_suffix(entry.unit).unwrap_or(text).trim_end();
        let is_whole = entry.kind == (Kind::Number { per_unit: 1 });
        let number: Option<f64> = bare.parse().ok();
        let number =
            number.filter(|value| value.is_finite() && (!is_whole || value.fract() == 0.0));
        number.ok_or_else(|| ParameterTextError::Number {
            text: text.to_owned(),
            name,
            unit: entry.unit,
        })?
    };
    parameter
        .nearest(value)
        .ok_or_else(|| ParameterTextError::Range {
            name,
            value,
            minimum: parameter.in_unit(entry.minimum),
            maximum: parameter.in_unit(entry.maximum),
            unit: entry.unit,
        })
}

/// A raw value as a person reads it, and as it reads back: at most 15 digits, which f64 keeps.
pub fn parameter_text(parameter: Parameter, raw: i64) -> String {
    match parameter.entry().kind {
        Kind::Choice(names) => usize::try_from(raw)
            .ok()
            .and_then(|place| names.get(place))
            .map_or_else(|| raw.to_string(), ToString::to_string),
        Kind::Number { .. } => parameter.in_unit(raw).to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_written_in_many_ways() {
        for (parameter, text, raw) in [
            (Parameter::VelocityLimit, "20", 20_000_000_000),
            (Parameter::VelocityLimit, "180deg/s", 3_141_592_654),
            (Parameter::JerkLimit, "1e3rad/s^3", 10_000_000),
            (Parameter::PositionMinimum, "-90deg", -1_570_796_327),
            (Parameter::PositionMaximum, "0.25turn", 1_570_796_327),
            (Parameter::HostTimeout, "250ms", 250),
            (Parameter::FollowingError, "0", 0),
            (Parameter::ShaperFrequency, "12.5Hz", 12_500_000),
            (Parameter::ShaperDamping, "0.02", 20_000_000),
            (Parameter::DriveNode, "7", 7),
            (Parameter::BusReaction, "quick_stop", 1),
        ] {
            assert_eq!(parameter_raw(parameter, text), Ok(raw), "{text}");
        }
    }

    #[test]
    fn what_is_no_value_says_what_it_must_be() {
        for (parameter, text, words) in [
            (Parameter::VelocityLimit, "fast", "`fast` is no value"),
            (Parameter::VelocityLimit, "-1", "from 0.0001 to 10000 rad/s"),
            (Parameter::VelocityLimit, "nan", "finite"),
            (Parameter::VelocityLimit, "1e300", "but it is 1"),
            (Parameter::HostTimeout, "0.05", "from 0.1 to 60 s"),
            (Parameter::HostTimeout, "-1", "more than 0"),
            (Parameter::DriveNode, "128", "from 0 to 127, but it is 128"),
            (Parameter::DriveNode, "x", "`x` is no number"),
            (Parameter::DriveNode, "7.5", "`7.5` is no number"),
            (Parameter::ShaperDamping, "nan", "`nan` is no number"),
            (Parameter::BusReaction, "brake", "quick_stop, disable"),
        ] {
            let error = parameter_raw(parameter, text).expect_err(text).to_string();
            assert!(error.contains(words), "{error}");
            assert!(error.contains(parameter.entry().name), "{error}");
        }
        let error = parameter_named("velocity").expect_err("a part").to_string();
        assert!(error.contains("did you mean `limits.velocity`?"), "{error}");
    }

    #[test]
    fn every_end_and_default_reads_back_as_it_is_written() {
        for parameter in Parameter::ALL {
            let entry = parameter.entry();
            for raw in [entry.minimum, entry.maximum, parameter.default_raw(1)] {
                for raw in [raw, raw + 1, raw - 1] {
                    if !(entry.minimum..=entry.maximum).contains(&raw) {
                        continue;
                    }
                    let text = parameter_text(parameter, raw);
                    assert_eq!(parameter_raw(parameter, &text), Ok(raw), "{text}");
                }
            }
        }
        assert_eq!(
            parameter_text(Parameter::VelocityLimit, 20_000_000_000),
            "20"
        );
        assert_eq!(parameter_text(Parameter::HostTimeout, 250), "0.25");
    }
}
