//! What an axis watches at every tick, and the way from state to state.

use super::fault::Fault;
use super::state::State;
use super::{Axis, HOST_TIMEOUT, Request};
use crate::drive::Condition;
use crate::motion::{Motion, Setpoint};
use crate::time::Ticks;
use crate::wire::report::Report;

/// How long a drive may take to enable: 1 s, time for the brake of a large one.
const ENABLE_TIMEOUT: Ticks = Ticks(1_000);

impl Axis {
    /// Once a tick, before its setpoint: the host, the drive, then the state machine.
    pub(super) fn supervise(&mut self) {
        if self.commander.is_silent(self.tick, HOST_TIMEOUT) {
            self.lose_commander();
            if self.state.drives() {
                self.raise(Fault::HostTimeout);
            }
        }
        let condition = self.drive.map(|report| report.condition);
        match condition {
            Some(Condition::Faulted) if self.state.drives() => self.raise(Fault::DriveFault),
            Some(Condition::Lost) if self.state.drives() => self.raise(Fault::DriveLost),
            // It has enabled before, so it has dropped out by itself.
            Some(Condition::Disabled) if self.state == State::OperationEnabled => {
                self.raise(Fault::DriveFault);
            }
            _ => {}
        }
        self.advance();
    }

    /// Forgets the session and all that only it could have meant.
    pub(super) fn lose_commander(&mut self) {
        self.commander.release();
        self.staged = None;
        self.shape = None;
        self.last_command = None;
    }

    /// Latches a fault, the first one only: what follows from it would hide the cause.
    pub(super) fn raise(&mut self, fault: Fault) {
        if self.fault.is_some() {
            return;
        }
        self.fault = Some(fault);
        self.request = None;
        self.staged = None;
        self.shape = None;
        self.telemetry.answer(Report::Fault {
            fault: fault.into(),
            time: self.handed_over,
        });
        let gone = matches!(fault, Fault::DriveFault | Fault::DriveLost);
        if self.state.drives() && !gone {
            self.motion.stop(self.tick, &self.limits);
            self.enter(State::FaultReactionActive);
        } else {
            // A drive that no longer follows cannot be led to rest.
            self.freeze();
            self.enter(State::Fault);
        }
    }

    pub(super) fn enter(&mut self, state: State) {
        if self.state != state {
            self.state = state;
            self.since = self.tick;
            self.telemetry.hasten();
        }
    }

    /// Ends all motion where the setpoint is; nothing follows setpoints any more.
    fn freeze(&mut self) {
        self.motion = Motion::at_rest(self.setpoint.position);
        self.departure = None;
        self.setpoint = Setpoint {
            position: self.setpoint.position,
            ..Setpoint::default()
        };
    }

    fn advance(&mut self) {
        let at_rest = !self.motion.is_moving(self.tick);
        match self.state {
            State::NotReadyToSwitchOn => {
                if let Some(report) = self.drive {
                    self.setpoint.position = report.position;
                    self.enter(State::SwitchOnDisabled);
                }
            }
            State::SwitchOnDisabled => {
                if self.request == Some(Request::Enable) {
                    self.follow_drive();
                    self.enter(State::ReadyToSwitchOn);
                }
            }
            State::ReadyToSwitchOn => {
                // The drive may be moved by hand until it holds torque.
                self.follow_drive();
                if self.drive_is_enabled() {
                    self.enter(State::SwitchedOn);
                } else if self.tick.since(self.since) > ENABLE_TIMEOUT {
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
            State::QuickStopActive if at_rest => {
                self.request = None;
                self.freeze();
                self.enter(State::SwitchOnDisabled);
            }
            State::FaultReactionActive if at_rest => {
                self.freeze();
                self.enter(State::Fault);
            }
            State::QuickStopActive | State::FaultReactionActive | State::Fault => {}
        }
    }

    /// Sets the setpoint to where the drive is, at rest.
    fn follow_drive(&mut self) {
        if let Some(report) = self.drive {
            self.motion = Motion::at_rest(report.position);
        }
    }
}
