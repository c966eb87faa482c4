//! Why a profile cannot be had, in the words of the command line.

use super::Kind;
use crate::plot::PlotError;
use canter_shared::limits::LimitError;
use canter_shared::motion::PlanError as MotionError;
use canter_shared::motion::error::ProfileError;
use canter_shared::units::UnitError;
use thiserror::Error;

/// Why a profile cannot be had.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PlanError {
    /// Something was asked that this profile does not have.
    #[error("{flag} is not for profile {profile}: {cure}")]
    NotOfProfile {
        /// What was asked, as it is written.
        flag: &'static str,
        /// Of which profile.
        profile: Kind,
        /// What to do instead.
        cure: &'static str,
    },
    /// What was asked does not say how fast the move is to be.
    #[error("{subject} needs {flags}")]
    Missing {
        /// Who needs it.
        subject: String,
        /// What is missing, as it is written.
        flags: &'static str,
    },
    /// The profile cannot be made with these values.
    #[error("{}", in_flags(.0))]
    Profile(ProfileError),
    /// A polynomial of the chosen duration goes over a limit.
    #[error(
        "{flag}: a {profile} of this duration reaches {reached}, over the limit of {limit}: \
         name another --duration, or leave it out"
    )]
    BreaksLimit {
        /// Which profile.
        profile: Kind,
        /// The limit, as it is written.
        flag: &'static str,
        /// What the curve comes to.
        reached: f64,
        /// What was allowed.
        limit: f64,
    },
    /// A limit that no axis can have.
    #[error("--device: {0}")]
    Limit(LimitError),
    /// A place that no axis can count.
    #[error("--device: {0}")]
    Unit(UnitError),
    /// A move that an axis would refuse.
    #[error("--device: {0}")]
    Motion(MotionError),
    /// Times that a device has no setpoints for.
    #[error(
        "--dt {0} s is no step of a device: it sends a setpoint every 1 ms, so name a multiple"
    )]
    NotWholeTicks(f64),
    /// More rows than anybody wants.
    #[error(
        "--dt {step} s makes {rows:.0} rows of a move of {duration} s: name a step that makes at most {most}"
    )]
    TooManyRows {
        /// The step in seconds.
        step: f64,
        /// How long the move lasts, in seconds.
        duration: f64,
        /// How many rows that makes.
        rows: f64,
        /// How many there may be.
        most: usize,
    },
    /// The resonance is so high above the move that its swings cannot be added up.
    #[error(
        "--resonance: a move of {duration} s has {cycles:.0} cycles of {frequency} Hz; at most {most} can be followed"
    )]
    TooManyCycles {
        /// How long the move lasts, in seconds.
        duration: f64,
        /// The frequency in Hz.
        frequency: f64,
        /// How often it swings meanwhile.
        cycles: f64,
        /// How often it may.
        most: f64,
    },
    /// The picture cannot be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
}

impl PlanError {
    /// Whether the command line itself was wrong, rather than the values on it impossible.
    pub fn is_usage(&self) -> bool {
        matches!(
            self,
            Self::NotOfProfile { .. } | Self::Missing { .. } | Self::NotWholeTicks(_)
        )
    }
}

// By hand, and not as sources: the messages already say all that those say.
impl From<ProfileError> for PlanError {
    fn from(error: ProfileError) -> Self {
        Self::Profile(error)
    }
}

impl From<LimitError> for PlanError {
    fn from(error: LimitError) -> Self {
        Self::Limit(error)
    }
}

impl From<UnitError> for PlanError {
    fn from(error: UnitError) -> Self {
        Self::Unit(error)
    }
}

impl From<MotionError> for PlanError {
    fn from(error: MotionError) -> Self {
        Self::Motion(error)
    }
}

/// The flag that a field of the library is given by.
fn flag(field: &str) -> Option<&'static str> {
    Some(match field {
        "velocity limit" => "--vmax",
        "acceleration limit" => "--amax",
        "deceleration limit" => "--dmax",
        "jerk limit" => "--jmax",
        "start position" => "--from",
        "stop position" | "target" => "--to",
        "start velocity" => "--v0",
        "stop velocity" => "--v1",
        "start acceleration" => "--a0",
        "stop acceleration" => "--a1",
        "duration" => "--duration",
        _ => return None,
    })
}

/// What the library says, with the flag that it is about in front.
fn in_flags(error: &ProfileError) -> String {
    let flag = match error {
        ProfileError::Value { field, .. } => flag(field),
        ProfileError::StartTooFast { .. } => Some("--v0"),
        ProfileError::StopOutOfReach { .. } => Some("--v1"),
        ProfileError::TooShort { .. } => Some("--duration"),
    };
    match flag {
        Some(flag) => format!("{flag}: {error}"),
        None => error.to_string(),
    }
}
