//! What an axis is asked to do, what it took on, and why it did not.

use crate::time::{LONGEST_MOVE, Tick, Ticks};
use crate::units::Position;
use core::fmt;

/// The shape of a move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// The beta S-curve.
    Beta,
    /// The trapezoid that cruises as slowly as its duration allows.
    Trapezoid,
    /// The s-curve of limited jerk, time-optimal but for a cruise as slow as its duration allows.
    SCurve,
    /// A trapezoid that accelerates and decelerates for these times.
    ShapedTrapezoid {
        /// How long it accelerates.
        acceleration: Ticks,
        /// How long it decelerates.
        deceleration: Ticks,
    },
}

/// A move that is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Move {
    /// Where to come to rest.
    pub target: Position,
    /// From leaving to rest.
    pub duration: Ticks,
    /// How to get there.
    pub profile: Profile,
}

impl Move {
    /// Whether its jerk is limited.
    pub(super) fn is_smooth(&self) -> bool {
        matches!(self.profile, Profile::Beta | Profile::SCurve)
    }
}

/// A move that was taken on: when it starts and when it has arrived.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Planned {
    /// The last tick at rest.
    pub start: Tick,
    /// The first tick at the target.
    pub end: Tick,
}

/// Why a move was not taken on. The motion is then as it was before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlanError {
    /// The target is outside the travel.
    OutsideTravel {
        /// What was asked for.
        target: Position,
        /// The nearest that is allowed.
        nearest: Position,
    },
    /// The duration is too short for the limits.
    TooFast {
        /// The least duration that the limits allow.
        shortest: Ticks,
    },
    /// The move would last longer than [`LONGEST_MOVE`].
    TooLong,
}

impl fmt::Display for PlanError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutsideTravel { target, nearest } => write!(
                formatter,
                "target {} rad is outside the travel, which ends at {} rad",
                target.radians(),
                nearest.radians()
            ),
            Self::TooFast { shortest } => write!(
                formatter,
                "duration is too short for the limits; it must be at least {} s",
                shortest.seconds()
            ),
            Self::TooLong => write!(
                formatter,
                "duration must be at most {} s",
                LONGEST_MOVE.seconds()
            ),
        }
    }
}

impl core::error::Error for PlanError {}
