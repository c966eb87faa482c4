//! Why a path cannot be had.

use super::waypoints::{MOST_AXES, MOST_WAYPOINTS};
use crate::notation::QuantityError;
use crate::plot::PlotError;
use canter_shared::motion::bounds::{LARGEST, SMALLEST};
use canter_shared::motion::error::ProfileError;

/// A path that is not possible, or a file that holds none.
#[derive(Debug, thiserror::Error)]
pub enum PathError {
    /// The file is not TOML, or not of the shape that is known.
    #[error("not valid as TOML: {0}")]
    Toml(Box<toml::de::Error>),
    /// A line of the CSV is none.
    #[error("line {line}: {what}")]
    Line {
        /// Which line, from 1.
        line: usize,
        /// What is wrong, and what to write.
        what: String,
    },
    /// An angle of the TOML is none.
    #[error("waypoint {waypoint}: {source}")]
    Angle {
        /// Which waypoint, from 1.
        waypoint: usize,
        /// What is wrong with it.
        source: QuantityError,
    },
    /// The axes cannot be those of a path.
    #[error("a path has 1 to {MOST_AXES} axes, ids from 1 to 63, each once, but here: {0}")]
    Axes(String),
    /// Too few or too many waypoints.
    #[error("a path has 2 to {MOST_WAYPOINTS} waypoints, but here are {0}")]
    WaypointCount(usize),
    /// A waypoint that has not one number for each axis.
    #[error("waypoint {waypoint}: {field} has {count} numbers, but the path has {axes} axes")]
    Count {
        /// Which waypoint, from 1.
        waypoint: usize,
        /// `at` or `heading`.
        field: &'static str,
        /// How many it has.
        count: usize,
        /// How many it should have.
        axes: usize,
    },
    /// A number out of its range.
    #[error(
        "waypoint {waypoint}: {field} must be a number from {minimum} to {maximum}, but it is {value}"
    )]
    Value {
        /// Which waypoint, from 1.
        waypoint: usize,
        /// Which of its values.
        field: &'static str,
        /// What it is.
        value: f64,
        /// The least that is accepted.
        minimum: f64,
        /// The most that is accepted.
        maximum: f64,
    },
    /// A heading that points nowhere.
    #[error("waypoint {0}: the heading is zero in every axis: give a direction, or leave it out")]
    NoDirection(usize),
    /// Two waypoints in one place.
    #[error("waypoint {0} is where the one before it is: leave one of them out")]
    Doubled(usize),
    /// Waypoints so unevenly apart that no curve can be computed.
    #[error(
        "the waypoints are too unevenly spread to compute a curve through them: bring them to similar distances"
    )]
    Uneven,
    /// A limit that is none.
    #[error("{field} must be a number from {SMALLEST:e} to {LARGEST:e}, but it is {value}")]
    Limit {
        /// Which limit, and of which axis.
        field: String,
        /// What it is.
        value: f64,
    },
    /// The curve leaves an axis's travel.
    #[error(
        "axis {axis}: the path goes to {position} rad near waypoint {waypoint}, but the travel is from {minimum} to {maximum} rad: move the waypoints or widen the axis's position limits"
    )]
    OutsideTravel {
        /// The axis.
        axis: u8,
        /// The position that is outside.
        position: f64,
        /// The waypoint before it, from 1.
        waypoint: usize,
        /// The axis's least position.
        minimum: f64,
        /// Its greatest position.
        maximum: f64,
    },
    /// A start or end speed that is no speed.
    #[error("{field} must be a number from 0 to {LARGEST:e}, but it is {value}")]
    Speed {
        /// Which one.
        field: &'static str,
        /// What it is.
        value: f64,
    },
    /// A start speed from which the path cannot be kept to.
    #[error(
        "the start speed {speed} is too high for this path and its limits: start with at most {fastest}"
    )]
    StartTooFast {
        /// What was asked.
        speed: f64,
        /// The most that is possible.
        fastest: f64,
    },
    /// An end speed that is not reached.
    #[error(
        "the end speed {speed} cannot be reached on this path within its limits: end with at most {fastest}"
    )]
    EndOutOfReach {
        /// What was asked.
        speed: f64,
        /// The most that is possible.
        fastest: f64,
    },
    /// No timing was found.
    #[error(
        "no timing keeps every limit on this path: lower the start and end speeds, or give headings that turn less sharply"
    )]
    NoTiming,
    /// The shape of the segment in the plane, or the s-curve, refuses a value.
    #[error("{0}")]
    Profile(ProfileError),
    /// A duration that was searched for and not found.
    #[error(
        "no duration from {step} to {longest} s keeps the limits: it takes {needed} s, so allow as long, raise the limits or go less far"
    )]
    NoDuration {
        /// From one duration that is tried to the next, in seconds.
        step: f64,
        /// The longest that was allowed, in seconds.
        longest: f64,
        /// The shortest one that would do, in seconds.
        needed: f64,
    },
    /// No duration at all keeps the limits, such as with an end that itself breaks them.
    #[error(
        "no duration up to {longest} s keeps the limits: lower the accelerations asked for at the ends, or raise the limits"
    )]
    NoDurationAtAll {
        /// The longest that was tried, in seconds.
        longest: f64,
    },
    /// The axes' limits are too low to stream at this pace.
    #[error(
        "a path sent as a knot every {period} s cannot keep the limits of axis {axis}: raise its limits, or give waypoints that are farther apart"
    )]
    NoKnots {
        /// The axis.
        axis: u8,
        /// From knot to knot, in seconds.
        period: f64,
    },
    /// More rows than anybody wants.
    #[error(
        "--dt {step} s makes {rows:.0} rows of a path of {duration} s: name a step that makes at most {most}"
    )]
    TooManyRows {
        /// The step in seconds.
        step: f64,
        /// How long the path lasts, in seconds.
        duration: f64,
        /// How many rows that makes.
        rows: f64,
        /// How many there may be.
        most: usize,
    },
    /// The picture cannot be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
}

// By hand, and not as a source: the message already says all that it says.
impl From<ProfileError> for PathError {
    fn from(error: ProfileError) -> Self {
        Self::Profile(error)
    }
}
