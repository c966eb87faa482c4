//! The servo drive behind an axis, as the axis sees it.
//!
//! | file | the drive |
//! |---|---|
//! | `simulated` | none at all: follows its setpoints as a good drive would |

pub mod simulated;

use crate::time::Tick;
use crate::units::{Acceleration, Position, Velocity};

/// What an axis tells its drive at a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DriveCommand {
    /// Whether the drive shall hold torque and follow.
    pub enable: bool,
    /// Where to be.
    pub position: Position,
    /// Feed-forward of the velocity.
    pub velocity: Velocity,
    /// Feed-forward of the acceleration.
    pub acceleration: Acceleration,
}

/// Whether a drive follows its setpoints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Condition {
    /// Nothing has been heard of it for too long.
    Lost,
    /// Alive, without torque.
    Disabled,
    /// Follows its setpoints.
    Enabled,
    /// Stopped by a fault of its own.
    Faulted,
}

/// What a drive last said.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DriveReport {
    /// Whether it follows.
    pub condition: Condition,
    /// Where it is.
    pub position: Position,
    /// How fast it is.
    pub velocity: Velocity,
}

/// A servo drive, whatever its language.
pub trait Drive {
    /// Takes what the axis wants of the drive at `tick`; called once for each tick.
    fn command(&mut self, tick: Tick, command: DriveCommand);

    /// What the drive last said.
    fn report(&self) -> DriveReport;
}
