//! What can be asked of several axes at once.

use canter_shared::wire::command::ProfileKind;
use canter_shared::wire::id::AxisId;

/// Where an axis is to go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target {
    /// To this angle, in rad.
    Absolute(f64),
    /// By this angle from where it is, in rad.
    Relative(f64),
}

/// One axis's part of a move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Which axis.
    pub axis: AxisId,
    /// Where to.
    pub target: Target,
}

/// Limits of one move, each at most the axis's own; in rad and seconds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Overrides {
    /// The largest velocity.
    pub velocity: Option<f64>,
    /// The largest acceleration.
    pub acceleration: Option<f64>,
    /// The largest deceleration.
    pub deceleration: Option<f64>,
    /// The largest jerk.
    pub jerk: Option<f64>,
}

/// A move of several axes.
#[derive(Debug, Clone, PartialEq)]
pub struct MoveRequest {
    /// Which axes go where.
    pub goals: Vec<Goal>,
    /// Along which profile.
    pub profile: ProfileKind,
    /// A duration in seconds for all; as quick as the limits allow where there is none.
    pub duration: Option<f64>,
    /// Limits of this move.
    pub limits: Overrides,
    /// Each axis as quick as it can be, instead of all arriving together.
    pub independent: bool,
}
