//! The servo drive behind an axis, as the axis sees it.
//!
//! A link speaks one drive's language. It is sans-IO like everything here: frames of the drives' bus go
//! in by `receive` and come out by `poll_transmit`, time is the count of `command`, which is called once
//! for each tick. It holds to three rules. A drive that was lost, faulted or dropped out while it was
//! enabled is not enabled again before the axis has taken the order back. A setpoint that the drive cannot
//! be told is a fault and never another place. And a drive that is found enabled without having been told
//! to be is disabled.
//!
//! | file | what it holds |
//! |---|---|
//! | `settings` | what a link must know of its drive |
//! | `scale` | from the axis's shaft to the drive's and back |
//! | `link` | the drive that the parameters choose |
//! | `simulated` | no drive at all: follows its setpoints as a good one would |
//! | `odrive` | ODrive: CANSimple of firmware 0.5 and 0.6 |
//! | `mit` | the mini-cheetah mode of bgkatz boards, CubeMars AK and the like |
//! | `cia402` | CANopen drives in cyclic synchronous position mode |

pub mod cia402;
pub mod link;
pub mod mit;
pub mod odrive;
pub mod scale;
pub mod settings;
pub mod simulated;

use crate::time::Tick;
use crate::units::{Acceleration, Position, Velocity};
use crate::wire::frame::Frame;
use settings::DriveSettings;

/// What an axis tells its drive at a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DriveCommand {
    /// Whether the drive shall hold torque and follow.
    pub enable: bool,
    /// Whether the drive shall forget a fault of its own; at one tick only.
    pub reset: bool,
    /// Where to be.
    pub position: Position,
    /// Feed-forward of the velocity.
    pub velocity: Velocity,
    /// Feed-forward of the acceleration.
    pub acceleration: Acceleration,
}

/// What a drive that has stopped by itself complains of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Trouble {
    /// Something that its protocol has no word for, or canter has none.
    Other,
    /// It or its motor is too hot.
    Temperature,
    /// Too much current.
    Current,
    /// Its supply is too high.
    Overvoltage,
    /// Its supply is too low.
    Undervoltage,
    /// Its encoder failed.
    Encoder,
    /// Its motor or its power stage failed.
    Motor,
    /// It heard nothing for too long.
    Starved,
    /// It or its load did not follow, or it passed a limit of its own.
    Following,
    /// It is, or shall go, where its protocol cannot tell.
    Range,
    /// It refused to be set up.
    Setup,
    /// It began anew by itself.
    Restart,
}

impl Trouble {
    /// Every one.
    pub const ALL: [Self; 12] = [
        Self::Other,
        Self::Temperature,
        Self::Current,
        Self::Overvoltage,
        Self::Undervoltage,
        Self::Encoder,
        Self::Motor,
        Self::Starved,
        Self::Following,
        Self::Range,
        Self::Setup,
        Self::Restart,
    ];
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
    Faulted(Trouble),
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

    /// Takes a frame of the drives' bus; `true` where it was this drive's.
    fn receive(&mut self, _frame: &Frame) -> bool {
        false
    }

    /// The next frame for the drives' bus, until there is none.
    fn poll_transmit(&mut self) -> Option<Frame> {
        None
    }

    /// Whether a SYNC is due on the drives' bus, after the frames of all drives; asked once.
    fn take_sync(&mut self) -> bool {
        false
    }

    /// The drive's parameters were changed, which happens without torque only: what was heard is forgotten.
    fn configure(&mut self, _settings: impl FnOnce() -> DriveSettings) {}
}
