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
    /// Where the axis is when the drive reads zero.
    zero: Position,
    /// Ticks for which it was told to be enabled, up to [`ENABLE_TICKS`].
    enabling: u8,
}

impl Simulated {
    /// A disabled drive at rest at `position`.
    pub const fn new(position: Position) -> Self {
        Self {
            position,
            velocity: Velocity::ZERO,
            zero: Position::ZERO,
            enabling: 0,
        }
    }

    /// The same drive, in the same place of the axis, which reads zero elsewhere.
    pub(super) const fn with_zero(self, zero: Position) -> Self {
        Self { zero, ..self }
    }

    /// From now on it reads zero there: nothing has moved, but the axis is elsewhere.
    pub(super) fn set_zero(&mut self, zero: Position) {
        self.position = self.position + (zero - self.zero);
        self.zero = zero;
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
