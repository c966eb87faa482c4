//! What each command does to an axis, and what is answered.

use super::fault::Fault;
use super::state::State;
use super::{Axis, Departure, Outcome, Request, Staged};
use crate::motion::{Move, PlanError, Profile};
use crate::time::{BusTime, LONGEST_MOVE, Tick, Ticks};
use crate::wire::command::{Action, Command, ProfileKind, Session};
use crate::wire::frame::Frame;
use crate::wire::id::Function;
use crate::wire::layout::POSITION_STEP;
use crate::wire::reason::Reason;
use crate::wire::report::Report;

/// How far ahead a trigger may name its start: 10 s. A start beyond that is a mistake, and would
/// keep the clock from being set meanwhile.
const LONGEST_LEAD: Ticks = Ticks(10_000);

/// A refusal: its reason, and the detail that the reason's table promises.
type Refusal = (Reason, u32);

impl Axis {
    /// Takes a frame that arrived at bus time `now`. Anything that is not a command for this axis
    /// is ignored; SYNC and identity are the node's.
    pub fn handle_frame(&mut self, now: BusTime, frame: &Frame) -> Outcome {
        let Ok(Some((address, command))) = Command::decode(frame) else {
            return Outcome::Ignored;
        };
        if !address.includes(self.id) {
            return Outcome::Ignored;
        }
        self.handle_command(now, frame, command)
    }

    /// The same for a frame that its node has decoded already, and that is for this axis.
    pub(crate) fn handle_command(
        &mut self,
        now: BusTime,
        frame: &Frame,
        command: Command,
    ) -> Outcome {
        match command {
            Command::Sync { .. } | Command::IdentityRequest => Outcome::Ignored,
            // Never held back by numbering: whoever says stop is obeyed.
            Command::EmergencyStop => {
                self.raise(Fault::EmergencyStop);
                Outcome::Accepted
            }
            Command::Stop { sequence } => {
                self.forget_moves();
                self.stop();
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
            Command::Control { sequence, .. }
            | Command::TrapezoidShape { sequence, .. }
            | Command::Move { sequence, .. } => {
                if let Some((last, report)) = self.last_command
                    && last == *frame
                {
                    self.telemetry.answer(report);
                    return Outcome::Repeated;
                }
                let admitted = self.admit(&command, sequence);
                let answer = match admitted {
                    Ok(()) => self.execute(command),
                    Err(refusal) => Err(refusal),
                };
                // Whatever was answered to a command of its own number, its repetition gets the
                // same: one that was refused must not be done when conditions have changed.
                if admitted.is_ok() {
                    let report = acknowledgement(command.function(), sequence, answer);
                    self.last_command = Some((*frame, report));
                }
                self.answer(command.function(), sequence, answer)
            }
        }
    }

    /// Whether a command comes from the session that holds the axis, under a new number, which
    /// is then used up. A hold is itself the way to become that session.
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

    fn answer(
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

    fn execute(&mut self, command: Command) -> Result<u32, Refusal> {
        match command {
            Command::Control { action, .. } => self.control(action),
            Command::TrapezoidShape {
                acceleration,
                deceleration,
                ..
            } => {
                let whole = acceleration.0.saturating_add(deceleration.0);
                if acceleration.0 == 0 || deceleration.0 == 0 || whole > LONGEST_MOVE.0 {
                    return Err((Reason::BadValue, 0));
                }
                self.shape = Some((acceleration, deceleration));
                Ok(0)
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
                    target: self.limits.snap(target, POSITION_STEP),
                    duration,
                    profile: self.profile(profile),
                };
                let detail = if staged {
                    self.stage(sequence, asked)?
                } else {
                    self.depart(sequence, asked, self.tick)?
                };
                // Used up by the trapezoid that it was meant for, and by nothing else.
                if profile == ProfileKind::Trapezoid {
                    self.shape = None;
                }
                Ok(detail)
            }
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
            self.forget_moves();
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
    fn ready(&self) -> Result<(), Refusal> {
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
                self.forget_moves();
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
                }
                State::ReadyToSwitchOn | State::SwitchedOn | State::OperationEnabled => {}
            },
            Action::Disable => match self.state {
                State::OperationEnabled => {
                    self.forget_moves();
                    self.stop();
                    self.request = Some(Request::Disable);
                }
                State::ReadyToSwitchOn | State::SwitchedOn => {
                    self.forget_moves();
                    self.request = None;
                    self.enter(State::SwitchOnDisabled);
                }
                State::SwitchOnDisabled => self.request = None,
                _ => {}
            },
            Action::Clear => match self.state {
                State::FaultReactionActive => return Err((Reason::Moving, 0)),
                State::Fault => {
                    self.fault = None;
                    self.request = None;
                    // From there it goes on by itself once the drive is there and well.
                    self.enter(State::NotReadyToSwitchOn);
                }
                _ => {}
            },
        }
        Ok(0)
    }

    fn profile(&self, kind: ProfileKind) -> Profile {
        match (kind, self.shape) {
            (ProfileKind::Beta, _) => Profile::Beta,
            (ProfileKind::Trapezoid, None) => Profile::Trapezoid,
            (ProfileKind::Trapezoid, Some((acceleration, deceleration))) => {
                Profile::ShapedTrapezoid {
                    acceleration,
                    deceleration,
                }
            }
        }
    }

    /// Checks a move as if it left now, and keeps it for the trigger.
    fn stage(&mut self, sequence: u8, asked: Move) -> Result<u32, Refusal> {
        let mut trial = self.motion.clone();
        let planned = trial
            .start(self.tick, self.tick, asked, &self.limits)
            .map_err(refusal)?;
        self.staged = Some(Staged { sequence, asked });
        Ok(planned.end.since(planned.start).0)
    }

    fn depart(&mut self, sequence: u8, asked: Move, start: Tick) -> Result<u32, Refusal> {
        let planned = self
            .motion
            .start(self.tick, start, asked, &self.limits)
            .map_err(refusal)?;
        self.staged = None;
        self.departure = Some(Departure {
            sequence,
            start: planned.start,
        });
        self.telemetry.hasten();
        Ok(planned.end.since(self.tick).0)
    }

    fn trigger(&mut self, frame: &Frame, group: u8, session: Session, start: Tick) -> Outcome {
        if let Some((last, report)) = self.last_trigger
            && last == *frame
        {
            self.telemetry.answer(report);
            return Outcome::Repeated;
        }
        let Some(staged) = self
            .staged
            .filter(|staged| staged.sequence == group && self.held_by(session).is_ok())
        else {
            return Outcome::Ignored;
        };
        self.staged = None;
        let answer = if start < self.tick {
            Err((Reason::TooLate, self.tick.since(start).0))
        } else if start.since(self.tick) > LONGEST_LEAD {
            Err((Reason::BadValue, 0))
        } else {
            self.ready()
                .and_then(|()| self.depart(staged.sequence, staged.asked, start))
        };
        let report = acknowledgement(Function::Trigger, group, answer);
        self.last_trigger = Some((*frame, report));
        self.answer(Function::Trigger, group, answer)
    }

    /// Comes to rest as quickly as the limits allow.
    fn stop(&mut self) {
        if self.state.drives() {
            self.motion.stop(self.tick, &self.limits);
            self.departure = None;
            self.telemetry.hasten();
        }
    }
}

fn acknowledgement(function: Function, sequence: u8, answer: Result<u32, Refusal>) -> Report {
    let (reason, detail) = match answer {
        Ok(detail) => (Reason::Accepted, detail),
        Err(refusal) => refusal,
    };
    Report::Acknowledgement {
        sequence,
        function,
        reason,
        detail,
    }
}

fn tick_of(now: BusTime) -> Tick {
    Tick(now.0 / crate::time::MICROSECONDS_PER_TICK)
}

fn refusal(error: PlanError) -> Refusal {
    match error {
        PlanError::OutsideTravel { .. } => (Reason::OutsideTravel, 0),
        PlanError::TooFast { shortest } => (Reason::TooFast, shortest.0),
        PlanError::TooLong => (Reason::TooLong, 0),
    }
}
