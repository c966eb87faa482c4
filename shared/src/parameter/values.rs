//! The raw values of one axis's parameters.

use super::settings::Settings;
use super::table::{Kind, Parameter};
use crate::limits::Limits;
use crate::motion::shaping::{ShaperKind, Shaping, ShapingError};
use crate::units::{COUNTS_PER_RADIAN, floor};
use core::fmt;
use core::ops::Range;

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
                let in_unit = |raw| parameter.in_unit(raw);
                let (minimum, maximum) = (in_unit(entry.minimum), in_unit(entry.maximum));
                write!(
                    formatter,
                    "{} must be from {minimum} to {maximum}",
                    entry.name
                )?;
                if !entry.unit.is_empty() {
                    write!(formatter, " {}", entry.unit)?;
                }
                write!(formatter, ", but it is {}", in_unit(*raw))
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

/// Bytes of a raw value, on the wire and in flash.
pub(super) const RAW_BYTES: usize = 6;

/// A raw value in 48 bits, which hold every range of the table (a test holds that).
pub(super) fn to_bytes(raw: i64) -> [u8; RAW_BYTES] {
    let [a, b, c, d, e, f, _, _] = raw.to_le_bytes();
    [a, b, c, d, e, f]
}

pub(super) fn from_bytes(bytes: [u8; RAW_BYTES]) -> i64 {
    let [a, b, c, d, e, f] = bytes;
    // Raised to the top and down again, so that the sign comes along.
    i64::from_le_bytes([0, 0, a, b, c, d, e, f]) >> 16
}

/// Where each parameter's bytes begin in [`Values`]: as many as hold its range, from the least value on.
const PLACES: [u8; Parameter::COUNT + 1] = {
    let mut places = [0; Parameter::COUNT + 1];
    let mut index = 0;
    while index < Parameter::COUNT {
        let (minimum, maximum) = Parameter::ALL[index].range();
        let mut bytes = 1;
        while (maximum - minimum) >> (8 * bytes) > 0 {
            bytes += 1;
        }
        places[index + 1] = places[index] + bytes;
        index += 1;
    }
    places
};

/// One raw value for each parameter. Each is in its range, and together they make [`Settings`].
///
/// Packed: an axis keeps those that hold and those that are saved, and memory is short.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Values([u8; PLACES[Parameter::COUNT] as usize]);

impl Values {
    /// The defaults for the axis of this id.
    #[inline(never)]
    pub fn defaults(axis: u8) -> Self {
        let mut values = Self([0; _]);
        for parameter in Parameter::ALL {
            values.put(parameter, parameter.default_raw(axis));
        }
        values
    }

    /// The defaults for the axis of this id but for the limits: these, or inside of them by less
    /// than a step. A rate below the least that a parameter takes becomes the least.
    pub fn of_limits(axis: u8, limits: &Limits) -> Self {
        let mut values = Self::defaults(axis);
        let mut put =
            |parameter: Parameter, raw: i64| values.put(parameter, parameter.clamped(raw));
        for (parameter, counts) in [
            (Parameter::VelocityLimit, limits.velocity().counts()),
            (Parameter::AccelerationLimit, limits.acceleration().counts()),
            (Parameter::DecelerationLimit, limits.deceleration().counts()),
            (Parameter::JerkLimit, limits.jerk().counts()),
        ] {
            put(parameter, steps_within(parameter, counts));
        }
        let [minimum, maximum] = [Parameter::PositionMinimum, Parameter::PositionMaximum];
        let least = -steps_within(minimum, -limits.position_minimum().counts());
        put(minimum, least);
        // A travel of a single point must not turn inside out.
        put(
            maximum,
            steps_within(maximum, limits.position_maximum().counts()).max(least),
        );
        values
    }

    /// The raw value of a parameter.
    pub fn get(&self, parameter: Parameter) -> i64 {
        let bytes = self.0.get(bytes_of(parameter)).unwrap_or_default();
        let above = bytes
            .iter()
            .rev()
            .fold(0, |value, byte| value << 8 | i64::from(*byte));
        above + parameter.range().0
    }

    /// `raw` is in the parameter's range.
    fn put(&mut self, parameter: Parameter, raw: i64) {
        let above = raw.saturating_sub(parameter.range().0).to_le_bytes();
        let bytes = self.0.get_mut(bytes_of(parameter)).unwrap_or_default();
        for (byte, from) in bytes.iter_mut().zip(above) {
            *byte = from;
        }
    }

    /// What the values mean.
    #[inline(never)]
    pub fn settings(&self) -> Settings {
        Settings::of_valid(self)
    }

    /// The same values but for one, and what they now mean.
    ///
    /// # Errors
    /// A value outside its range, or one that contradicts another parameter.
    pub fn with(&self, parameter: Parameter, raw: i64) -> Result<(Self, Settings), ParameterError> {
        let changed = self.in_range(parameter, raw)?;
        let settings = Settings::of(&changed, parameter)?;
        Ok((changed, settings))
    }

    /// The same for who has the settings that these values mean: it is quicker.
    ///
    /// # Errors
    /// Those of [`Self::with`].
    pub fn with_settings(
        &self,
        settings: &Settings,
        parameter: Parameter,
        raw: i64,
    ) -> Result<(Self, Settings), ParameterError> {
        let changed = self.in_range(parameter, raw)?;
        let settings = settings.after(&changed, parameter)?;
        Ok((changed, settings))
    }

    fn in_range(&self, parameter: Parameter, raw: i64) -> Result<Self, ParameterError> {
        let (minimum, maximum) = parameter.range();
        if !(minimum..=maximum).contains(&raw) {
            return Err(ParameterError::OutOfRange { parameter, raw });
        }
        let mut changed = *self;
        changed.put(parameter, raw);
        Ok(changed)
    }

    /// The same values with this shaper, to the nearest steps of its parameters, or with none.
    ///
    /// # Errors
    /// A shaper at the edge of what is possible, which rounding puts beyond it.
    pub fn shaped(&self, shaping: Option<&Shaping>) -> Result<Self, ShapingError> {
        let mut changed = *self;
        let Some(shaping) = shaping else {
            changed.put(Parameter::ShaperKind, 0);
            return Ok(changed);
        };
        for (parameter, value) in [
            (Parameter::ShaperFrequency, shaping.frequency()),
            (Parameter::ShaperDamping, shaping.damping()),
        ] {
            changed.put(parameter, parameter.clamped(parameter.rounded(value)));
        }
        let kind = match shaping.kind() {
            ShaperKind::Zv => 1,
            ShaperKind::Zvd => 2,
            ShaperKind::Ei => 3,
        };
        changed.put(Parameter::ShaperKind, kind);
        let in_unit = |parameter: Parameter| parameter.in_unit(changed.get(parameter));
        Shaping::new(
            shaping.kind(),
            in_unit(Parameter::ShaperFrequency),
            in_unit(Parameter::ShaperDamping),
        )?;
        Ok(changed)
    }
}

/// Where a parameter's bytes are.
fn bytes_of(parameter: Parameter) -> Range<usize> {
    let place = |index: usize| usize::from(PLACES.get(index).copied().unwrap_or(0));
    let index = usize::from(u8::from(parameter));
    place(index)..place(index + 1)
}

/// The most steps of a parameter in rad that are not above `counts`, as limits count them.
fn steps_within(parameter: Parameter, counts: i64) -> i64 {
    let down = |raw: i64| floor(parameter.in_unit(raw) * COUNTS_PER_RADIAN);
    // A step is 0.7 counts at least, so the last one is a step or two from where f64 puts it.
    let mut raw = parameter
        .rounded(counts as f64 / COUNTS_PER_RADIAN)
        .saturating_add(3);
    while down(raw) > counts {
        raw = raw.saturating_sub(1);
    }
    raw
}

impl Parameter {
    /// A raw value in the parameter's unit; of a choice, its place.
    pub fn in_unit(self, raw: i64) -> f64 {
        raw as f64 / self.steps_per_unit() as f64
    }

    /// The nearest raw value to one in the parameter's unit. What is outside the range by less than
    /// a step is the end of the range; `None` is farther out, or no number.
    pub fn nearest(self, value: f64) -> Option<i64> {
        let raw = self.clamped(self.rounded(value));
        // A NaN is near nothing.
        let away = libm::fabs(value * self.steps_per_unit() as f64 - raw as f64);
        (away < 1.0).then_some(raw)
    }

    /// The raw value of a choice by its name.
    pub fn choice(self, name: &str) -> Option<i64> {
        let Kind::Choice(names) = self.entry().kind else {
            return None;
        };
        let place = names.iter().position(|choice| *choice == name)?;
        i64::try_from(place).ok()
    }

    fn rounded(self, value: f64) -> i64 {
        libm::round(value * self.steps_per_unit() as f64) as i64
    }

    fn clamped(self, raw: i64) -> i64 {
        let (minimum, maximum) = self.range();
        raw.max(minimum).min(maximum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::{DEFAULT_VALUES, LimitValues};
    use proptest::prelude::*;

    #[test]
    fn a_raw_value_comes_back_from_48_bits() {
        for raw in [0, 1, -1, (1 << 47) - 1, -(1 << 47)] {
            assert_eq!(from_bytes(to_bytes(raw)), raw);
        }
    }

    #[test]
    fn the_default_limits_are_the_defaults() {
        let values = Values::of_limits(5, &Limits::default());
        assert_eq!(values, Values::defaults(5));
    }

    #[test]
    fn a_value_is_the_nearest_step_and_what_is_outside_is_none() {
        let minimum = Parameter::PositionMinimum;
        assert_eq!(minimum.nearest(-1.000_000_000_6), Some(-1_000_000_001));
        // A thousand turns in rad are half a step beyond what a parameter takes.
        let farthest = DEFAULT_VALUES.position_minimum;
        assert_eq!(minimum.nearest(farthest), Some(minimum.entry().minimum));
        for outside in [farthest - 1e-6, f64::NAN, f64::INFINITY, -1e300] {
            assert_eq!(minimum.nearest(outside), None, "{outside}");
        }
        assert_eq!(Parameter::BusReaction.choice("disable"), Some(2));
        assert_eq!(Parameter::BusReaction.choice("brake"), None);
        assert_eq!(Parameter::JerkLimit.choice("none"), None);
    }

    proptest! {
        /// The quick way to the settings is no other way.
        #[test]
        fn settings_after_a_change_are_those_of_the_values(
            changes in prop::collection::vec((0..Parameter::COUNT, 0.0..=1.0f64), 1..60),
        ) {
            let mut values = Values::defaults(1);
            let mut settings = values.settings();
            for (place, part) in changes {
                let parameter = Parameter::ALL[place];
                let entry = parameter.entry();
                let length = (entry.maximum - entry.minimum) as f64;
                let raw = entry.minimum + (length * part * part * part) as i64;
                let quick = values.with_settings(&settings, parameter, raw);
                prop_assert_eq!(quick, values.with(parameter, raw));
                if let Ok(changed) = quick {
                    (values, settings) = changed;
                }
                prop_assert_eq!(values.settings(), settings);
            }
        }
    }

    fn limits() -> impl Strategy<Value = LimitValues> {
        let rate = |top: f64| (-4.0..top).prop_map(|exponent: f64| 10f64.powf(exponent));
        let place = -6_283.0..6_283.0f64;
        (
            rate(4.0),
            rate(6.0),
            rate(6.0),
            rate(9.0),
            place.clone(),
            place,
        )
            .prop_map(|(velocity, up, down, jerk, a, b)| LimitValues {
                velocity,
                acceleration: up,
                deceleration: down,
                jerk,
                position_minimum: a.min(b),
                position_maximum: a.max(b),
            })
    }

    proptest! {
        #[test]
        fn limits_become_values_inside_of_them(wanted in limits()) {
            let limits = Limits::new(&wanted).expect("in range");
            let settings = Values::of_limits(1, &limits).settings();
            let own = settings.limits;
            // Less than a step inside: 10^-9, 10^-6 and 10^-4 rad, and a count.
            for (asked, got, step) in [
                (limits.velocity().radians(), own.velocity().radians(), 1e-9),
                (limits.acceleration().radians(), own.acceleration().radians(), 1e-6),
                (limits.deceleration().radians(), own.deceleration().radians(), 1e-6),
                (limits.jerk().radians(), own.jerk().radians(), 1e-4),
                (limits.position_maximum().radians(), own.position_maximum().radians(), 1e-9),
                (-limits.position_minimum().radians(), -own.position_minimum().radians(), 1e-9),
            ] {
                prop_assert!(got <= asked && asked - got <= step + 1.5e-9, "{asked} {got}");
            }
            // What came from values is those values again.
            let again = Values::of_limits(1, &own).settings();
            prop_assert_eq!(again, settings);
        }
    }
}
