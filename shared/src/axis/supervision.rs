//! What an axis watches at every tick, and the way from state to state.

use super::answer::Refusal;
use super::fault::Fault;
use super::prepared::Prepared;
use super::state::State;
use super::{Axis, Request};
use crate::drive::Condition;
use crate::motion::Setpoint;
use crate::time::Ticks;
use crate::units::Position;
use crate::wire::reason::Reason;

/// How long a drive may take to enable: 1 s, time for the brake of a large one.
const ENABLE_TIMEOUT: Ticks = Ticks(1_000);

impl Axis {
    /// Once a tick, before its setpoint: the host, the drive, then the state machine.
    pub(super) fn supervise(&mut self) {
        if self
            .commander
            .is_silent(self.tick, self.settings.host_timeout)
        {
            self.lose_commander();
            if self.state.drives() {
                self.raise(Fault::HostTimeout);
            }
        }
        self.watch_drive();
        self.watch_stream();
        self.advance();
    }

    /// A drive that drops out while it should follow cannot be led any more: whatever the axis
    /// was about to do ends here.
    fn watch_drive(&mut self) {
        // A drive that has not enabled yet is waited for.
        let enabling = matches!(self.state, State::ReadyToSwitchOn | State::SwitchedOn);
        let fault = match self.condition() {
            _ if !self.state.drives() => return,
            Some(Condition::Enabled) => return,
            Some(Condition::Disabled) if enabling => return,
            None | Some(Condition::Lost) => Fault::DriveLost,
            Some(Condition::Disabled | Condition::Faulted) => Fault::DriveFault,
        };
        self.raise(fault);
        // With an earlier fault latched, that one stays the cause.
        self.freeze();
        self.enter(State::Fault);
    }

    /// Forgets the session and all that only it could have meant.
    pub(super) fn lose_commander(&mut self) {
        self.commander.release();
        self.forget_moves((Reason::NotHeld, 0));
        self.last_command = None;
        // What it asked for last, nobody wants any more.
        self.request = None;
    }

    /// Forgets what was prepared for later; `why` is the answer to what is still being checked.
    pub(super) fn forget_moves(&mut self, why: Refusal) {
        self.call_off_stages(why);
        self.course.call_off_stream();
        self.forget_prepared();
    }

    fn forget_prepared(&mut self) {
        self.staged = None;
        self.prepared = Prepared::default();
    }

    /// Latches a fault, the first one only: what follows from it would hide the cause.
    pub(super) fn raise(&mut self, fault: Fault) {
        if self.fault.is_some() {
            return;
        }
        self.fault = Some(fault);
        self.request = None;
        let latched = (Reason::FaultLatched, u8::from(fault).into());
        self.forget_prepared();
        // It calls off the moves that were only to be checked, too.
        self.want_stop(latched);
        // No answer from before the fault is true any more.
        self.last_command = None;
        self.telemetry.fault(fault.into(), self.handed_over);
        let gone = matches!(
            fault,
            Fault::DriveFault | Fault::DriveLost | Fault::EnableTimeout
        );
        if self.state.drives() && !gone {
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
        self.planning.clear();
        self.stand(self.setpoint.position);
        self.departure = None;
        self.setpoint = Setpoint {
            position: self.setpoint.position,
            ..Setpoint::default()
        };
    }

    /// Ends a motion that has come to its end, at that end.
    fn rest(&mut self) {
        self.setpoint = self.course.at(self.tick);
        self.freeze();
    }

    fn advance(&mut self) {
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
    fn stand(&mut self, position: Position) {
        self.course.rest(position);
        if self.shapes() {
            self.shaper.reset(position);
        }
    }
}
