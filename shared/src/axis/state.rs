//! The states of an axis, with the names of CiA 402 (IEC 61800-7-201, drive state machine).

use core::fmt;
use num_enum::{IntoPrimitive, TryFromPrimitive};

/// The state of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, IntoPrimitive, TryFromPrimitive)]
#[repr(u8)]
pub enum State {
    /// Before the first word from the drive.
    NotReadyToSwitchOn = 0,
    /// No torque; may be enabled.
    SwitchOnDisabled = 1,
    /// The drive is being told to enable.
    ReadyToSwitchOn = 2,
    /// The drive has enabled; setpoints follow from its own position.
    SwitchedOn = 3,
    /// Follows commands.
    OperationEnabled = 4,
    /// Comes to rest, then goes to switch on disabled.
    QuickStopActive = 5,
    /// Comes to rest because of a fault.
    FaultReactionActive = 6,
    /// No torque; a fault is latched.
    Fault = 7,
}

impl State {
    /// Every state, in the order of their codes.
    pub const ALL: [Self; 8] = [
        Self::NotReadyToSwitchOn,
        Self::SwitchOnDisabled,
        Self::ReadyToSwitchOn,
        Self::SwitchedOn,
        Self::OperationEnabled,
        Self::QuickStopActive,
        Self::FaultReactionActive,
        Self::Fault,
    ];

    /// The name in CiA 402's words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NotReadyToSwitchOn => "not ready to switch on",
            Self::SwitchOnDisabled => "switch on disabled",
            Self::ReadyToSwitchOn => "ready to switch on",
            Self::SwitchedOn => "switched on",
            Self::OperationEnabled => "operation enabled",
            Self::QuickStopActive => "quick stop active",
            Self::FaultReactionActive => "fault reaction active",
            Self::Fault => "fault",
        }
    }

    /// Whether the drive shall hold torque and follow setpoints.
    pub const fn drives(self) -> bool {
        matches!(
            self,
            Self::ReadyToSwitchOn
                | Self::SwitchedOn
                | Self::OperationEnabled
                | Self::QuickStopActive
                | Self::FaultReactionActive
        )
    }
}

impl fmt::Display for State {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}
