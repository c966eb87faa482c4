//! Angles and their rates: rad unless `deg` or `turn` stands behind.

use std::f64::consts::{PI, TAU};

/// Why a text is no quantity.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum QuantityError {
    /// It is no number with a known unit.
    #[error("`{text}` is no {what}: write {example}")]
    NotANumber {
        /// What was written.
        text: String,
        /// What was expected.
        what: &'static str,
        /// How it is written.
        example: &'static str,
    },
    /// It is infinite or not a number.
    #[error("`{text}` is no {what}: it must be finite")]
    NotFinite {
        /// What was written.
        text: String,
        /// What was expected.
        what: &'static str,
    },
    /// It must be more than zero.
    #[error("`{text}` is no {what}: it must be more than 0")]
    NotPositive {
        /// What was written.
        text: String,
        /// What was expected.
        what: &'static str,
    },
}

fn finite(text: &str, what: &'static str, value: f64) -> Result<f64, QuantityError> {
    if value.is_finite() {
        Ok(value)
    } else {
        let text = text.to_owned();
        Err(QuantityError::NotFinite { text, what })
    }
}

fn parse(
    text: &str,
    bare: &str,
    what: &'static str,
    example: &'static str,
) -> Result<f64, QuantityError> {
    let units = [("deg", PI / 180.0), ("turn", TAU), ("rad", 1.0)];
    let (number, factor) = units
        .iter()
        .find_map(|(unit, factor)| Some((bare.strip_suffix(unit)?.trim_end(), *factor)))
        .unwrap_or((bare, 1.0));
    let value: f64 = number.parse().map_err(|_| QuantityError::NotANumber {
        text: text.to_owned(),
        what,
        example,
    })?;
    finite(text, what, value * factor)
}

/// An angle in rad.
///
/// # Errors
/// No number, an unknown unit, or not finite.
pub fn angle(text: &str) -> Result<f64, QuantityError> {
    parse(
        text,
        text,
        "angle",
        "`1.5`, `1.5rad`, `90deg` or `0.25turn`",
    )
}

/// A limit of velocity, acceleration or jerk in rad and seconds, more than zero; `/s`, `/s^2` or
/// `/s^3` may stand behind the unit.
///
/// # Errors
/// No number, an unknown unit, not finite, or not more than zero.
pub fn rate(text: &str) -> Result<f64, QuantityError> {
    let bare = ["/s^3", "/s^2", "/s"]
        .iter()
        .find_map(|suffix| text.strip_suffix(suffix))
        .unwrap_or(text);
    let what = "limit";
    let value = parse(
        text,
        bare,
        what,
        "`2`, `2rad/s`, `90deg/s` or `0.5turn/s^2`",
    )?;
    positive(text, what, value)
}

/// The same of any sign, with the unit's own ending such as `/s^2` or none behind it.
pub(super) fn angle_or_rate(text: &str, ending: &str) -> Result<f64, QuantityError> {
    let bare = text.strip_suffix(ending).unwrap_or(text);
    parse(text, bare, "value", "`1.5`, `90deg` or `0.25turn`")
}

/// A duration in seconds, more than zero; `s` or `ms` may stand behind.
///
/// # Errors
/// No number, an unknown unit, not finite, or not more than zero.
pub fn seconds(text: &str) -> Result<f64, QuantityError> {
    let what = "duration";
    let (number, factor) = match (text.strip_suffix("ms"), text.strip_suffix('s')) {
        (Some(number), _) => (number, 1e-3),
        (None, Some(number)) => (number, 1.0),
        (None, None) => (text, 1.0),
    };
    let value: f64 = number.parse().map_err(|_| QuantityError::NotANumber {
        text: text.to_owned(),
        what,
        example: "`1.5`, `1.5s` or `250ms`",
    })?;
    let value = finite(text, what, value * factor)?;
    positive(text, what, value)
}

fn positive(text: &str, what: &'static str, value: f64) -> Result<f64, QuantityError> {
    if value > 0.0 {
        Ok(value)
    } else {
        let text = text.to_owned();
        Err(QuantityError::NotPositive { text, what })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles() {
        assert_eq!(angle("90deg"), Ok(PI / 2.0));
        assert_eq!(angle("-0.5turn"), Ok(-PI));
        assert_eq!(angle("1.5rad"), Ok(1.5));
        assert_eq!(angle("1e-3"), Ok(1e-3));
        for bad in [
            "", "deg", "1 m", "1,5", "90°", "nan", "inf", "NaNdeg", "1e999",
        ] {
            assert!(angle(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn rates_and_durations_are_positive() {
        assert_eq!(rate("180deg/s"), Ok(PI));
        assert_eq!(rate("2rad/s^2"), Ok(2.0));
        assert_eq!(seconds("250ms"), Ok(0.25));
        for bad in ["0", "-1", "nan", "inf", "x"] {
            assert!(rate(bad).is_err(), "{bad}");
            assert!(seconds(bad).is_err(), "{bad}");
        }
    }
}
