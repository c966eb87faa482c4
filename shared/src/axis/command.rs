//! What each command does to an axis, and what is answered.

use super::answer::{Refusal, acknowledgement};
use super::fault::Fault;
use super::planning::{Leave, WantedMove};
use super::reaction::Stopping;
use super::state::State;
use super::supervision::sender_of;
use super::{Axis, Outcome, Reply, Request};
use crate::motion::Move;
use crate::time::{BusTime, LONGEST_MOVE, Tick, Ticks};
use crate::units::{Acceleration, Jerk, Velocity};
use crate::wire::command::{Action, Command, Session};
use crate::wire::frame::Frame;
use crate::wire::id::Function;
use crate::wire::layout::POSITION_STEP;
use crate::wire::reason::Reason;

/// How far ahead a trigger or a stream may name its start: 10 s. A start beyond that is a mistake, and would
/// keep the clock from being set meanwhile.
pub(super) const LONGEST_LEAD: Ticks = Ticks(10_000);

/// What became of a command that is in order.
#[derive(Debug, Clone, Copy)]
enum Done {
    /// Done, with the detail of its answer.
    Now(u32),
    /// The job of this number is to be planned.
    Planning(u32),
    /// The owner of the node is to save.
    Saving,
}

impl Axis {
    /// Takes a frame that arrived at bus time `now`. A report of this axis that comes from the bus is
    /// the fault duplicate_axis. Anything else that is not a command for this axis is ignored; SYNC
    /// and identity are the node's.
    pub fn handle_frame(&mut self, now: BusTime, frame: &Frame) -> Outcome {
        if let Some(sender) = sender_of(frame) {
            if sender == self.id {
                self.hear_double();
            }
            return Outcome::Ignored;
        }
        let Ok(Some((address, command))) = Command::decode(frame) else {
            return Outcome::Ignored;
        };
        if !address.includes(self.id) {
            return Outcome::Ignored;
        }
        self.handle_command(now, frame, command)
    }

    /// The same for a frame that its node has decoded already, and that is for this axis.
    #[inline(never)]
    pub(crate) fn handle_command(
        &mut self,
        now: BusTime,
        frame: &Frame,
        command: Command,
    ) -> Outcome {
        match command {
            Command::Sync { .. } | Command::IdentityRequest | Command::Assign(_) => {
                Outcome::Ignored
            }
            // Never held back by numbering: whoever says stop is obeyed.
            Command::EmergencyStop => {
                self.raise(Fault::EmergencyStop);
                Outcome::Accepted
            }
            Command::Stop { sequence } => {
                self.stop((Reason::Stopped, 0));
                self.answer(Function::Stop, sequence, Ok(0))
            }
            Command::HostHeartbeat { session } => {
                self.commander.hear(session, tick_of(now));
                Outcome::Accepted
            }
            Command::Trigger {
                group,
                session,
                start,
            } => self.trigger(frame, group, session, start),
            // Numbered for themselves: most are never answered.
            Command::Knot {
                position,
                velocity,
                number,
            } => self.take_knot(position, velocity, number),
            Command::ParameterRead { parameter, item } => self.read_parameter(parameter, item),
            Command::Control { sequence, .. }
            | Command::TrapezoidShape { sequence, .. }
            | Command::RampLimits { sequence, .. }
            | Command::PeakLimits { sequence, .. }
            | Command::StreamBegin { sequence, .. }
            | Command::ParameterWrite { sequence, .. }
            | Command::Move { sequence, .. } => {
                if let Some((last, reply)) = self.last_command
                    && last == *frame
                {
                    return self.repeat(reply);
                }
                let function = command.function();
                if let Err(refusal) = self.admit(&command, sequence) {
                    return self.answer(function, sequence, Err(refusal));
                }
                // Whatever was answered to a command of its own number, its repetition gets the
                // same: one that was refused must not be done when conditions have changed.
                let (reply, outcome) = self.reply(function, sequence, |axis| axis.execute(command));
                self.last_command = Some((*frame, reply));
                outcome
            }
        }
    }

    /// Whether a command comes from the session that holds the axis, under a new number, which
    /// is then used up. A hold is itself the way to become that session.
    #[inline(never)]
    fn admit(&mut self, command: &Command, sequence: u8) -> Result<(), Refusal> {
        match *command {
            Command::Control {
                action: Action::Hold,
                session,
                ..
            } => self.hold(session, sequence),
            Command::Control { session, .. } => {
                self.held_by(session)?;
                self.number(sequence)
            }
            _ => {
                self.held()?;
                self.number(sequence)
            }
        }
    }

    /// Does what a command says, and answers it unless it is to be planned.
    fn reply(
        &mut self,
        function: Function,
        sequence: u8,
        execute: impl FnOnce(&mut Self) -> Result<Done, Refusal>,
    ) -> (Reply, Outcome) {
        let answer = match execute(self) {
            Ok(Done::Planning(number)) => return (Reply::Waits(number), Outcome::Planning),
            Ok(Done::Saving) => return (Reply::Saves(sequence), Outcome::Accepted),
            Ok(Done::Now(detail)) => Ok(detail),
            Err(refusal) => Err(refusal),
        };
        let report = acknowledgement(function, sequence, answer);
        let outcome = self.answer(function, sequence, answer);
        (Reply::Given(report), outcome)
    }

    /// The first answer again; where that is still to come, it will do for both.
    fn repeat(&mut self, reply: Reply) -> Outcome {
        if let Reply::Given(report) = reply {
            self.telemetry.answer(report);
        }
        Outcome::Repeated
    }

    pub(crate) fn answer(
        &mut self,
        function: Function,
        sequence: u8,
        answer: Result<u32, Refusal>,
    ) -> Outcome {
        self.telemetry
            .answer(acknowledgement(function, sequence, answer));
        match answer {
            Ok(_) => Outcome::Accepted,
            Err((reason, _)) => {
                self.counters.rejected = self.counters.rejected.wrapping_add(1);
                Outcome::Rejected(reason)
            }
        }
    }

    fn execute(&mut self, command: Command) -> Result<Done, Refusal> {
        let function = command.function();
        match command {
            Command::Control {
                action: Action::Save,
                sequence,
                ..
            } => self.want_save(sequence).map(|()| Done::Saving),
            Command::Control { action, .. } => self.control(action).map(Done::Now),
            Command::TrapezoidShape {
                acceleration,
                deceleration,
                ..
            } => {
                let whole = acceleration.0.saturating_add(deceleration.0);
                if acceleration.0 == 0 || deceleration.0 == 0 || whole > LONGEST_MOVE.0 {
                    return Err((Reason::BadValue, 0));
                }
                self.prepared.shape = Some((acceleration, deceleration));
                Ok(Done::Now(0))
            }
            Command::RampLimits {
                acceleration,
                deceleration,
                ..
            } => {
                if acceleration <= Acceleration::ZERO || deceleration <= Acceleration::ZERO {
                    return Err((Reason::BadValue, 0));
                }
                self.prepared.ramps = Some((acceleration, deceleration));
                Ok(Done::Now(0))
            }
            Command::PeakLimits { velocity, jerk, .. } => {
                if velocity <= Velocity::ZERO || jerk <= Jerk::ZERO {
                    return Err((Reason::BadValue, 0));
                }
                self.prepared.peaks = Some((velocity, jerk));
                Ok(Done::Now(0))
            }
            Command::Move {
                profile,
                staged,
                target,
                duration,
                sequence,
            } => {
                self.ready()?;
                let asked = Move {
                    target: self.settings.limits.snap(target, POSITION_STEP),
                    duration,
                    profile: self.prepared.profile(profile),
                };
                let leave = if staged {
                    Leave::WhenTriggered
                } else {
                    Leave::Now
                };
                let mut left = self.prepared;
                let number = self.want_move(WantedMove {
                    asked,
                    prepared: left.take(profile),
                    leave,
                    sequence,
                    function,
                })?;
                self.prepared = left;
                Ok(Done::Planning(number))
            }
            Command::StreamBegin {
                start,
                period,
                number,
                sequence,
            } => self
                .begin_stream(start, period, number, sequence)
                .map(Done::Now),
            Command::ParameterWrite {
                parameter, value, ..
            } => self.write_parameter(parameter, value).map(Done::Now),
            // The others never come here.
            _ => Err((Reason::BadValue, 0)),
        }
    }

    fn hold(&mut self, session: Session, sequence: u8) -> Result<(), Refusal> {
        if session == 0 {
            return Err((Reason::BadValue, 0));
        }
        let anew = self
            .commander
            .hold(session, sequence, self.tick)
            .map_err(|holder| (Reason::HeldByOther, holder.into()))?;
        if anew {
            // Numbers begin anew, so a group that was staged has lost its name.
            self.forget_moves((Reason::StaleSequence, sequence.into()));
            self.last_trigger = None;
        }
        Ok(())
    }

    fn held(&self) -> Result<Session, Refusal> {
        self.commander.session().ok_or((Reason::NotHeld, 0))
    }

    fn held_by(&self, session: Session) -> Result<(), Refusal> {
        match self.held()? {
            holder if holder == session => Ok(()),
            holder => Err((Reason::HeldByOther, holder.into())),
        }
    }

    fn number(&mut self, sequence: u8) -> Result<(), Refusal> {
        self.commander
            .advance(sequence)
            .map_err(|last| (Reason::StaleSequence, last.into()))
    }

    /// Whether the axis takes moves.
    pub(super) fn ready(&self) -> Result<(), Refusal> {
        match (self.state, self.fault) {
            (State::OperationEnabled, _) if self.request.is_none() => Ok(()),
            (_, Some(fault)) => Err((Reason::FaultLatched, u8::from(fault).into())),
            (state, None) => Err((Reason::NotEnabled, u8::from(state).into())),
        }
    }

    fn control(&mut self, action: Action) -> Result<u32, Refusal> {
        match action {
            Action::Hold => {}
            Action::Release => {
                // Motion without anybody who watches over it is what the time-out is there for.
                if self.is_moving() {
                    return Err((Reason::Moving, 0));
                }
                self.commander.release();
                self.forget_moves((Reason::NotHeld, 0));
                self.telemetry.hasten();
            }
            Action::Enable => match self.state {
                State::Fault | State::FaultReactionActive => {
                    let fault = self.fault.map_or(0, u8::from);
                    return Err((Reason::FaultLatched, fault.into()));
                }
                _ if !self.drive_is_ready() => return Err((Reason::DriveNotReady, 0)),
                _ if self.request == Some(Request::Disable) => return Err((Reason::Moving, 0)),
                State::QuickStopActive => return Err((Reason::Moving, 0)),
                State::NotReadyToSwitchOn | State::SwitchOnDisabled => {
                    self.request = Some(Request::Enable);
                    self.commander.configure(false);
                }
                State::ReadyToSwitchOn | State::SwitchedOn | State::OperationEnabled => {
                    self.commander.configure(false);
                }
            },
            Action::Disable => match self.state {
                State::OperationEnabled => {
                    self.stop(self.disabled());
                    self.request = Some(Request::Disable);
                }
                State::ReadyToSwitchOn | State::SwitchedOn => {
                    self.forget_moves(self.disabled());
                    self.request = None;
                    self.enter(State::SwitchOnDisabled);
                }
                // Also one that was to be enabled as soon as its drive is there.
                State::NotReadyToSwitchOn | State::SwitchOnDisabled => self.request = None,
                _ => {}
            },
            Action::Clear => match self.state {
                State::FaultReactionActive => return Err((Reason::Moving, 0)),
                State::Fault => {
                    self.fault = None;
                    self.request = None;
                    self.wants_reset = true;
                    // From there it goes on by itself once the drive is there and well.
                    self.enter(State::NotReadyToSwitchOn);
                }
                // A drive may have had its fault before anybody enabled it.
                State::NotReadyToSwitchOn => self.wants_reset = true,
                _ => {}
            },
            // That one has been taken care of: its answer comes later.
            Action::Save => {}
            Action::Restore => self.restore_parameters()?,
            Action::Configure => self.commander.configure(true),
        }
        Ok(0)
    }

    fn trigger(&mut self, frame: &Frame, group: u8, session: Session, start: Tick) -> Outcome {
        if let Some((last, reply)) = self.last_trigger
            && last == *frame
        {
            return self.repeat(reply);
        }
        // One that is still being checked is not staged yet: who triggers it did not wait.
        let Some(staged) = self
            .staged
            .filter(|staged| staged.sequence == group && self.held_by(session).is_ok())
        else {
            return Outcome::Ignored;
        };
        self.staged = None;
        let (reply, outcome) = self.reply(Function::Trigger, group, |axis| {
            if start < axis.tick {
                return Err((Reason::TooLate, axis.tick.since(start).0));
            }
            if start.since(axis.tick) > LONGEST_LEAD {
                return Err((Reason::BadValue, 0));
            }
            axis.ready()?;
            let number = axis.want_move(WantedMove {
                asked: staged.asked,
                prepared: staged.prepared,
                leave: Leave::At(start),
                sequence: staged.sequence,
                function: Function::Trigger,
            })?;
            Ok(Done::Planning(number))
        });
        self.last_trigger = Some((*frame, reply));
        outcome
    }

    /// Comes to rest as quickly as the limits allow, and forgets what was to come: `why` is told
    /// to those whose moves are called off.
    fn stop(&mut self, why: Refusal) {
        self.forget_moves(why);
        if self.state.drives() {
            self.call_off_moves(why);
            self.want_stop(Stopping::Controlled);
            self.telemetry.hasten();
        }
    }

    fn disabled(&self) -> Refusal {
        let next = State::SwitchOnDisabled;
        (Reason::NotEnabled, u8::from(next).into())
    }
}

fn tick_of(now: BusTime) -> Tick {
    Tick(now.0 / crate::time::MICROSECONDS_PER_TICK)
}
