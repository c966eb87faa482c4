//! Why a knot is refused, and what to do about it.

use super::{LONGEST_GAP, LOOK_AHEAD};
use crate::time::Tick;
use crate::units::{Acceleration, Position, Velocity};
use core::fmt;

/// Why a knot is refused. The stream is then as it was before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KnotError {
    /// The last knot has passed: the stream has run dry.
    TooLate {
        /// The tick of the last knot.
        ended: Tick,
    },
    /// There is no room for one more piece.
    Full {
        /// The first tick at which there is.
        room: Tick,
    },
    /// More knots are missing than one piece may bridge.
    TooManyMissing {
        /// Knots whose numbers were left out.
        missing: u8,
    },
    /// The knot, or the curve that leads there, is outside the travel.
    OutsideTravel {
        /// The position that is outside.
        position: Position,
        /// The nearest that is allowed.
        nearest: Position,
    },
    /// From the knot, no stop ends inside the travel.
    CannotStop {
        /// The knot's velocity.
        velocity: Velocity,
        /// The end of the travel that it leads to.
        edge: Position,
    },
    /// The curve to the knot breaks the velocity limit.
    TooFast {
        /// A velocity that it would have.
        velocity: Velocity,
        /// The largest that is allowed, either way.
        limit: Velocity,
    },
    /// The curve to the knot breaks the acceleration or deceleration limit.
    TooStrong {
        /// An acceleration that it would have.
        acceleration: Acceleration,
        /// The lesser of the two limits.
        limit: Acceleration,
    },
}

impl fmt::Display for KnotError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLate { ended } => write!(
                formatter,
                "knot comes after the stream has ended at tick {}: \
                 send knots earlier, then start again",
                ended.0
            ),
            Self::Full { room } => write!(
                formatter,
                "knot finds {LOOK_AHEAD} pieces waiting: send it again from tick {} on",
                room.0
            ),
            Self::TooManyMissing { missing } => write!(
                formatter,
                "knot comes after {missing} missing ones, where at most {} can be bridged: \
                 send those first",
                LONGEST_GAP - 1
            ),
            Self::OutsideTravel { position, nearest } => write!(
                formatter,
                "knot leads to {} rad outside the travel, which ends at {} rad",
                position.radians(),
                nearest.radians()
            ),
            Self::CannotStop { velocity, edge } => write!(
                formatter,
                "knot's velocity {} rad/s is too high to stop before the travel ends at {} rad: \
                 slow down earlier",
                velocity.radians(),
                edge.radians()
            ),
            Self::TooFast { velocity, limit } => write!(
                formatter,
                "curve to the knot would reach {} rad/s, where at most {} rad/s are allowed: \
                 go slower or stay farther below the limit",
                velocity.radians(),
                limit.radians()
            ),
            Self::TooStrong {
                acceleration,
                limit,
            } => write!(
                formatter,
                "curve to the knot would reach {} rad/s^2, where at most {} rad/s^2 are sure to be \
                 allowed: change the velocity more gently",
                acceleration.radians(),
                limit.radians()
            ),
        }
    }
}

impl core::error::Error for KnotError {}
