//! The state machine of a CiA 402 drive: what a statusword says, and what controlword leads on.
//!
//! ros2_canopen, canopen_402_driver/src/state.cpp and command.cpp; CiA 402-2, table of the statusword.

use crate::drive::Trouble;

/// The state of the drive itself, as its statusword says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Not ready to switch on: it begins.
    Beginning,
    /// Switch on disabled.
    SwitchOnDisabled,
    /// Ready to switch on.
    Ready,
    /// Switched on.
    SwitchedOn,
    /// Operation enabled.
    Enabled,
    /// Quick stop active.
    QuickStop,
    /// Fault reaction active.
    Reacting,
    /// Fault.
    Fault,
}

/// Takes torque away.
pub const DISABLE_VOLTAGE: u16 = 0x00;
/// Towards ready to switch on.
pub const SHUTDOWN: u16 = 0x06;
/// Towards switched on.
pub const SWITCH_ON: u16 = 0x07;
/// Towards operation enabled, and what keeps it.
pub const ENABLE_OPERATION: u16 = 0x0F;
/// Its rising edge forgets a fault.
pub const FAULT_RESET: u16 = 0x80;

/// In cyclic synchronous position mode: the drive follows its target.
const TARGET_USED: u16 = 1 << 12;
/// In cyclic synchronous position mode: it does not follow closely enough.
const FOLLOWING_ERROR: u16 = 1 << 13;

impl Status {
    /// The state that a statusword tells.
    pub fn of(word: u16) -> Self {
        match word & 0x6F {
            0x40 | 0x60 => Self::SwitchOnDisabled,
            0x21 => Self::Ready,
            0x23 => Self::SwitchedOn,
            0x27 => Self::Enabled,
            0x07 => Self::QuickStop,
            0x0F | 0x2F => Self::Reacting,
            0x08 | 0x28 => Self::Fault,
            _ => Self::Beginning,
        }
    }

    /// The controlword that leads one step on towards operation enabled.
    pub fn towards_enabled(self) -> u16 {
        match self {
            Self::SwitchOnDisabled => SHUTDOWN,
            Self::Ready => SWITCH_ON,
            Self::SwitchedOn | Self::Enabled => ENABLE_OPERATION,
            // A quick stop is left by way of switch on disabled; the others by themselves, or never.
            Self::QuickStop | Self::Beginning | Self::Reacting | Self::Fault => DISABLE_VOLTAGE,
        }
    }
}

/// Whether an enabled drive follows its target.
pub fn follows(word: u16) -> bool {
    Status::of(word) == Status::Enabled && word & TARGET_USED != 0
}

/// Whether it says that it does not follow closely enough.
pub fn strays(word: u16) -> bool {
    Status::of(word) == Status::Enabled && word & FOLLOWING_ERROR != 0
}

/// What an EMCY code complains of (CiA 301 table 26, CiA 402-2 error codes).
pub fn complaint(code: u16) -> Trouble {
    match code {
        0x7120..=0x712F => Trouble::Motor,
        0x8130..=0x814F | 0x8100..=0x811F | 0x8200..=0x82FF => Trouble::Starved,
        0x8400..=0x86FF => Trouble::Following,
        _ => match code >> 8 {
            0x20..=0x2F => Trouble::Current,
            0x31 | 0x32 if code & 0xF0 == 0x10 => Trouble::Overvoltage,
            0x31 | 0x32 if code & 0xF0 == 0x20 => Trouble::Undervoltage,
            0x40..=0x4F => Trouble::Temperature,
            0x54 | 0x71 => Trouble::Motor,
            0x63 => Trouble::Setup,
            0x73 => Trouble::Encoder,
            _ => Trouble::Other,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_up_is_as_the_state_machine_says() {
        let way = [
            (0x0250, Status::SwitchOnDisabled, SHUTDOWN),
            (0x0231, Status::Ready, SWITCH_ON),
            (0x0233, Status::SwitchedOn, ENABLE_OPERATION),
            (0x1237, Status::Enabled, ENABLE_OPERATION),
            (0x0017, Status::QuickStop, DISABLE_VOLTAGE),
            (0x000F, Status::Reacting, DISABLE_VOLTAGE),
            (0x0218, Status::Fault, DISABLE_VOLTAGE),
            (0x0028, Status::Fault, DISABLE_VOLTAGE),
            (0x0000, Status::Beginning, DISABLE_VOLTAGE),
        ];
        for (word, status, next) in way {
            assert_eq!(Status::of(word), status, "{word:#06x}");
            assert_eq!(status.towards_enabled(), next, "{word:#06x}");
        }
        assert!(follows(0x1237) && !follows(0x0237) && !follows(0x1233));
        assert!(strays(0x3237) && !strays(0x1237));
    }

    #[test]
    fn complaints_have_a_meaning() {
        for (code, trouble) in [
            (0x2310, Trouble::Current),
            (0x3210, Trouble::Overvoltage),
            (0x3220, Trouble::Undervoltage),
            (0x4310, Trouble::Temperature),
            (0x7121, Trouble::Motor),
            (0x7305, Trouble::Encoder),
            (0x8130, Trouble::Starved),
            (0x8611, Trouble::Following),
            (0x6320, Trouble::Setup),
            (0xFF01, Trouble::Other),
        ] {
            assert_eq!(complaint(code), trouble, "{code:#06x}");
        }
    }
}
