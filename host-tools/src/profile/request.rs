//! What can be asked of a profile.

use std::fmt;

/// A profile, by the name that it has on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The beta S-curve.
    Beta,
    /// Constant acceleration, cruise, constant deceleration.
    Trapezoid,
    /// Constant jerk in seven pieces, time-optimal.
    SCurve,
    /// A polynomial of degree three: position and velocity at both ends.
    Cubic,
    /// A polynomial of degree five: acceleration too.
    Quintic,
    /// A polynomial of degree seven: no jerk at the ends either.
    Septic,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Trapezoid,
        Self::SCurve,
        Self::Beta,
        Self::Cubic,
        Self::Quintic,
        Self::Septic,
    ];

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Beta => "beta",
            Self::Trapezoid => "trapezoid",
            Self::SCurve => "s-curve",
            Self::Cubic => "cubic",
            Self::Quintic => "quintic",
            Self::Septic => "septic",
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// Limits that were named, per second, per second squared and per second cubed; one that was not
/// named does not limit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AskedLimits {
    /// The largest velocity.
    pub velocity: Option<f64>,
    /// The largest acceleration.
    pub acceleration: Option<f64>,
    /// The largest deceleration; as the acceleration where it was not named.
    pub deceleration: Option<f64>,
    /// The largest jerk.
    pub jerk: Option<f64>,
}

impl AskedLimits {
    /// The deceleration limit that is meant.
    pub fn meant_deceleration(&self) -> Option<f64> {
        self.deceleration.or(self.acceleration)
    }

    /// Whether none was named.
    pub fn are_none(&self) -> bool {
        *self == Self::default()
    }
}

/// One move of one profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// Which profile.
    pub kind: Kind,
    /// Where it starts.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// The velocity at the start.
    pub start_velocity: f64,
    /// The velocity at the end.
    pub stop_velocity: f64,
    /// The acceleration at the start.
    pub start_acceleration: f64,
    /// The acceleration at the end.
    pub stop_acceleration: f64,
    /// How fast it may be.
    pub limits: AskedLimits,
    /// How long it is to last, in seconds.
    pub duration: Option<f64>,
    /// The exponent p of a beta curve other than the product's 5/2.
    pub exponent: Option<f64>,
}

impl Request {
    /// A move from rest to rest, without limits or duration yet.
    pub fn rest_to_rest(kind: Kind, from: f64, to: f64) -> Self {
        Self {
            kind,
            from,
            to,
            start_velocity: 0.0,
            stop_velocity: 0.0,
            start_acceleration: 0.0,
            stop_acceleration: 0.0,
            limits: AskedLimits::default(),
            duration: None,
            exponent: None,
        }
    }
}
