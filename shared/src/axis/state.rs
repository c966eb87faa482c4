//! The states of an axis, with the names of CiA 402 (IEC 61800-7-201, drive state machine), and the
//! way from one to the next.

use super::fault::Fault;
use super::{Axis, Request};
use crate::drive::Condition;
use crate::time::Ticks;
use crate::units::Position;
use core::fmt;
use num_enum::{IntoPrimitive, TryFromPrimitive};

/// How long a drive may take to enable: 1 s, time for the brake of a large one.
const ENABLE_TIMEOUT: Ticks = Ticks(1_000);

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

impl Axis {
    #[inline(never)]
    pub(super) fn enter(&mut self, state: State) {
        if self.state != state {
            self.state = state;
            self.since = self.tick;
            self.telemetry.hasten();
        }
    }

    /// Once a tick: goes on to the next state where it is time.
    pub(super) fn advance(&mut self) {
        match self.state {
            State::NotReadyToSwitchOn => {
                if let Some(report) = self.drive.filter(|_| self.drive_is_ready()) {
                    self.setpoint.position = report.position;
                    self.enter(State::SwitchOnDisabled);
                }
            }
            State::SwitchOnDisabled => {
                if !self.drive_is_ready() {
                    self.request = None;
                    self.enter(State::NotReadyToSwitchOn);
                } else if self.request == Some(Request::Enable) {
                    self.follow_drive();
                    self.enter(State::ReadyToSwitchOn);
                }
            }
            State::ReadyToSwitchOn => {
                // The drive may be moved by hand until it holds torque.
                self.follow_drive();
                if self.condition() == Some(Condition::Enabled) {
                    self.enter(State::SwitchedOn);
                } else if self.tick.0.wrapping_sub(self.since.0) > u64::from(ENABLE_TIMEOUT.0) {
                    self.raise(Fault::EnableTimeout);
                }
            }
            State::SwitchedOn => {
                self.request = None;
                self.enter(State::OperationEnabled);
            }
            State::OperationEnabled => {
                if self.request == Some(Request::Disable) {
                    self.enter(State::QuickStopActive);
                }
            }
            State::QuickStopActive if !self.is_moving() => {
                self.request = None;
                self.rest();
                self.enter(State::SwitchOnDisabled);
            }
            State::FaultReactionActive if !self.is_moving() => {
                self.rest();
                self.enter(State::Fault);
            }
            State::QuickStopActive | State::FaultReactionActive | State::Fault => {}
        }
    }

    /// Sets the setpoint to where the drive is, at rest.
    fn follow_drive(&mut self) {
        if let Some(report) = self.drive {
            self.stand(report.position);
        }
    }

    /// Forgets all motion, at rest at `position`.
    pub(super) fn stand(&mut self, position: Position) {
        self.course.rest(position);
        if self.shapes() {
            self.shaper.reset(position);
        }
    }
}
