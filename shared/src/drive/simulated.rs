//! A drive that is not there: it takes two ticks to enable, then follows its setpoints closely.

use super::{Condition, Drive, DriveCommand, DriveReport};
use crate::time::Tick;
use crate::units::{Position, Velocity, over_power_of_two};

/// Ticks between the order to enable and following.
const ENABLE_TICKS: u8 = 2;

/// At each tick the following error falls to a fourth (2 bits): a loop of about 220 Hz.
const FOLLOWING_SHIFT: u32 = 2;

/// A simulated drive with its axis at some position.
#[derive(Debug, Clone)]
pub struct Simulated {
    position: Position,
    velocity: Velocity,
    /// Ticks for which it was told to be enabled, up to [`ENABLE_TICKS`].
    enabling: u8,
}

impl Simulated {
    /// A disabled drive at rest at `position`.
    pub const fn new(position: Position) -> Self {
        Self {
            position,
            velocity: Velocity::ZERO,
            enabling: 0,
        }
    }
}

impl Simulated {
    /// The axis is so much further along from now on, though nothing has moved: its zero is elsewhere.
    pub(super) fn shift(&mut self, by: Position) {
        self.position = self.position + by;
    }
}

impl Drive for Simulated {
    fn command(&mut self, _tick: Tick, command: DriveCommand) {
        if !command.enable {
            self.enabling = 0;
            self.velocity = Velocity::ZERO;
            return;
        }
        if self.enabling < ENABLE_TICKS {
            self.enabling += 1;
            return;
        }
        // Far from the ends of an i64, where both are in a travel.
        let error = self
            .position
            .counts()
            .wrapping_sub(command.position.counts());
        // Division rounds towards zero, so that the error does reach it.
        let left = over_power_of_two(error, FOLLOWING_SHIFT);
        self.position = Position::from_counts(command.position.counts().wrapping_add(left));
        self.velocity = command.velocity;
    }

    fn report(&self) -> DriveReport {
        let following = self.enabling >= ENABLE_TICKS;
        DriveReport {
            condition: if following {
                Condition::Enabled
            } else {
                Condition::Disabled
            },
            position: self.position,
            velocity: self.velocity,
        }
    }
}
