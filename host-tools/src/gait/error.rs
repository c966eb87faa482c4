//! What a gait cannot be, and the cure.

use crate::foot::FootError;
use crate::leg::LegError;
use crate::notation::OutOfRange;
use crate::plot::PlotError;
use thiserror::Error;

/// Why a gait cannot be planned or walked.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum GaitError {
    /// A number out of its range.
    #[error(transparent)]
    Value(#[from] OutOfRange),
    /// A gait whose steps would be too short or too long to be made.
    #[error(
        "a foot would be {swing} s in the air in each cycle: it must be from {least} to {most} s; \
         choose another period, duty or overlay"
    )]
    Swing {
        /// How long a foot would be in the air, in s.
        swing: f64,
        /// The least.
        least: f64,
        /// The most.
        most: f64,
    },
    /// A leg cannot do what the gait asks.
    #[error(
        "leg {leg} at {time:.3} s: {cause}; or ask for less speed, a shorter period, a lower swing \
         or another height"
    )]
    Leg {
        /// Which.
        leg: &'static str,
        /// When, in s.
        time: f64,
        /// What it cannot do, and by how much.
        cause: LegError,
    },
    /// A joint would break a limit of its axis.
    #[error(
        "axis {axis} ({leg}) would come to {what} of {value:.3} {unit} at {time:.3} s, and its limit \
         is {limit:.3} {unit}: ask for less speed, a longer period or a lower swing, or raise \
         the limit in the robot file"
    )]
    Limit {
        /// The axis.
        axis: u8,
        /// Its leg.
        leg: &'static str,
        /// Position, velocity or acceleration.
        what: &'static str,
        /// The worst of it.
        value: f64,
        /// Where the limit is.
        limit: f64,
        /// Their unit.
        unit: &'static str,
        /// When, in s.
        time: f64,
    },
    /// A robot that is no quadruped.
    #[error(
        "a gait needs one leg in each corner of the body, and this robot has {legs} {corner}: name \
         four [[leg]] in the robot file, with x and y of their places other than 0"
    )]
    Legs {
        /// Which corner.
        corner: &'static str,
        /// How many are there.
        legs: usize,
    },
    /// A leg names an axis that the robot has not.
    #[error("the robot has no axis {axis}, which a leg names: name it in the robot file")]
    Axis {
        /// Which.
        axis: u8,
    },
    /// Time went back, or far ahead in one go.
    #[error(
        "the planner is at {now} s and cannot give {asked} s: ask from then up to {most} s later"
    )]
    Time {
        /// Where the planner is, in s.
        now: f64,
        /// What was asked for, in s.
        asked: f64,
        /// How far ahead it goes in one go, in s.
        most: f64,
    },
    /// Standing that is to go somewhere, or to have cycles.
    #[error(
        "stand goes nowhere and has no cycle: leave out --vx, --vy, --yaw-rate and --steady, or choose a gait"
    )]
    Standing,
    /// More rows than anybody reads.
    #[error(
        "this makes {rows} rows, where {most} are the most: choose a longer --dt or fewer --cycles"
    )]
    Rows {
        /// How many.
        rows: f64,
        /// The most.
        most: usize,
    },
    /// A step that cannot be made.
    #[error(transparent)]
    Step(#[from] FootError),
    /// It cannot be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
}

impl GaitError {
    /// Whether it says that the question was wrong, rather than that the robot cannot do it.
    pub fn is_usage(&self) -> bool {
        matches!(
            self,
            Self::Value(_) | Self::Swing { .. } | Self::Rows { .. } | Self::Standing
        )
    }
}
