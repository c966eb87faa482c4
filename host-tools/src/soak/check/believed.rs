//! Who holds an axis and what it was asked for, from the frames that it got and nothing else.
//!
//! Where frames alone do not tell (whether a release came while the axis was still moving) the
//! axis has the benefit of the doubt until its next tick shows what became of it.

use canter_shared::time::Ticks;
use canter_shared::wire::command::{Action, Command, Session};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{AxisId, Function};
use canter_shared::wire::report::Report;

use super::{Finding, Glance, Verdict};
use crate::sim::TrueTime;
use crate::soak::invariant::Invariant;

/// A number is new when it is ahead of the last one by no more than this.
const AHEAD: u8 = 127;

/// Commands that are remembered, and triggers: of what came in doubt, any may be the last.
const REMEMBERED: usize = 8;

/// Nanoseconds by which an axis's idea of silence may differ from the truth: whole ticks at both
/// ends, and the tick that it takes to notice.
const ROUNDING: u64 = 3_000_000;

/// Nanoseconds between two ticks.
const TICK: u64 = 1_000_000;

/// A tick that comes early or late by more than so many nanoseconds comes by a clock that was set.
const STEP: u64 = 10_000;

/// A node's clock differs from true time by no more than one part of so many: its crystal, what it
/// has learned of it, and what it makes up for.
const DRIFT: u64 = 1_000;

/// Whether an axis may do what a command says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Admission {
    No,
    /// It has the number of the command before: it may be that command again.
    Again,
    Yes,
}

impl From<bool> for Admission {
    fn from(may: bool) -> Self {
        if may { Self::Yes } else { Self::No }
    }
}

/// What came between two ticks.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Asked {
    pub(super) clear: bool,
    pub(super) emergency_stop: bool,
    pub(super) motion: bool,
}

/// What an axis must believe.
#[derive(Debug)]
pub(super) struct Believed {
    axis: AxisId,
    host_timeout: u64,
    holder: Option<Session>,
    /// The number of the holder's last command; none where doubt has made it unknown.
    number: Option<u8>,
    /// The last commands and triggers; of each the axis remembers the last one that it answered,
    /// also when it has been released.
    commands: [Option<Frame>; REMEMBERED],
    triggers: [Option<Frame>; REMEMBERED],
    /// The last trigger that the axis has answered, however many it has passed over since.
    answered: Option<Frame>,
    /// When the holder was last heard; and where doubt leaves two answers, the earlier one.
    heard: TrueTime,
    heard_for_certain: TrueTime,
    /// Times since then that the node's clock was set anew: each may round to the next tick.
    steps: u64,
    /// A release may have come too early, and the session may still hold the axis.
    doubt: bool,
    numbered_in_doubt: bool,
    asked: Asked,
    /// Its holder has asked for it to be enabled.
    pub(super) enable: bool,
    /// Its holder has commanded a motion that may not be over yet.
    pub(super) motion: bool,
}

impl Believed {
    pub(super) fn new(axis: AxisId, host_timeout: Ticks) -> Self {
        Self {
            axis,
            host_timeout: u64::from(host_timeout.0) * TICK,
            holder: None,
            number: None,
            commands: [None; REMEMBERED],
            triggers: [None; REMEMBERED],
            answered: None,
            heard: TrueTime(0),
            heard_for_certain: TrueTime(0),
            steps: 0,
            doubt: false,
            numbered_in_doubt: false,
            asked: Asked::default(),
            enable: false,
            motion: false,
        }
    }

    pub(super) fn asked(&self) -> Asked {
        self.asked
    }

    /// A tick is over.
    pub(super) fn forget_asked(&mut self) {
        self.asked = Asked::default();
    }

    /// Its parameter has been changed.
    pub(super) fn set_timeout(&mut self, host_timeout: Ticks) {
        self.host_timeout = u64::from(host_timeout.0) * TICK;
    }

    /// Whether a motion was commanded since the last tick.
    pub(super) fn was_asked_to_move(&self) -> bool {
        self.asked.motion
    }

    /// Nanoseconds for which the holder has been silent.
    pub(super) fn silence(&self, now: TrueTime) -> u64 {
        now.0.saturating_sub(self.heard.0)
    }

    fn hear(&mut self, now: TrueTime) {
        (self.heard, self.heard_for_certain, self.steps) = (now, now, 0);
    }

    /// Nanoseconds by which an axis may count a silence of the time-out wrongly.
    fn inexact(&self) -> u64 {
        self.host_timeout / DRIFT + ROUNDING + self.steps * TICK
    }

    /// The longest silence that an axis can overlook.
    pub(super) fn longest_silence(&self) -> u64 {
        self.host_timeout + self.inexact()
    }

    /// Takes a command that the axis got; says whether it comes from who may command it, under a
    /// new number where it needs one.
    pub(super) fn take(
        &mut self,
        now: TrueTime,
        frame: &Frame,
        command: &Command,
        last: Option<&Glance>,
    ) -> Admission {
        let admission = match self.admit(now, frame, command) {
            // Its answer outlives the session.
            Admission::No if self.commands.contains(&Some(*frame)) => Admission::Again,
            admission => admission,
        };
        if admission != Admission::Yes {
            return admission;
        }
        let is_unnumbered = matches!(
            command,
            Command::EmergencyStop
                | Command::Stop { .. }
                | Command::ParameterRead { .. }
                | Command::Trigger { .. }
                | Command::Knot { .. }
        );
        if !is_unnumbered {
            self.commands.rotate_right(1);
            self.commands[0] = Some(*frame);
        }
        match command {
            Command::Move { staged: false, .. }
            | Command::Trigger { .. }
            | Command::StreamBegin { .. }
            | Command::Knot { .. } => {
                self.asked.motion = true;
                self.motion = true;
            }
            Command::Control { action, .. } => self.control(*action, last),
            Command::EmergencyStop => self.asked.emergency_stop = true,
            _ => {}
        }
        admission
    }

    fn control(&mut self, action: Action, last: Option<&Glance>) {
        match action {
            Action::Enable => self.enable = true,
            Action::Disable => self.enable = false,
            Action::Clear => self.asked.clear = true,
            Action::Release => {
                let moves = self.asked.motion || last.is_some_and(|last| last.moving);
                if moves || self.doubt || self.number.is_none() {
                    self.doubt = true;
                } else {
                    self.holder = None;
                }
            }
            _ => {}
        }
    }

    /// The axis said something.
    pub(super) fn report(&mut self, report: &Report) {
        if let Report::Acknowledgement {
            function: Function::Trigger,
            sequence,
            ..
        } = *report
        {
            let is_answered = |frame: &&Frame| matches!(Command::decode(frame), Ok(Some((_, Command::Trigger { group, .. }))) if group == sequence);
            let answered = self.triggers.iter().flatten().find(is_answered);
            self.answered = answered.copied().or(self.answered);
        }
    }

    fn admit(&mut self, now: TrueTime, frame: &Frame, command: &Command) -> Admission {
        let is_held = self.holder.is_some() || self.doubt;
        let by = |session: Session| self.holder == Some(session) || self.doubt;
        match *command {
            Command::EmergencyStop | Command::Stop { .. } | Command::ParameterRead { .. } => {
                Admission::Yes
            }
            Command::Sync { .. } | Command::IdentityRequest | Command::Assign(_) => Admission::No,
            Command::HostHeartbeat { session } => {
                if self.holder == Some(session) {
                    self.hear(now);
                }
                Admission::No
            }
            Command::Trigger { session, .. } if by(session) => {
                self.triggers.rotate_right(1);
                self.triggers[0] = Some(*frame);
                Admission::Yes
            }
            // Its answer outlives the session.
            Command::Trigger { .. }
                if self.triggers.contains(&Some(*frame)) || self.answered == Some(*frame) =>
            {
                Admission::Again
            }
            Command::Knot { .. } => is_held.into(),
            Command::Control {
                action: Action::Hold,
                session,
                sequence,
            } => self.hold(now, session, sequence).into(),
            Command::Control {
                session, sequence, ..
            } if by(session) => self.advance(sequence),
            Command::TrapezoidShape { sequence, .. }
            | Command::RampLimits { sequence, .. }
            | Command::PeakLimits { sequence, .. }
            | Command::StreamBegin { sequence, .. }
            | Command::ParameterWrite { sequence, .. }
            | Command::Move { sequence, .. }
                if is_held =>
            {
                self.advance(sequence)
            }
            _ => Admission::No,
        }
    }

    fn hold(&mut self, now: TrueTime, session: Session, sequence: u8) -> bool {
        if session == 0 {
            return false;
        }
        match self.holder {
            Some(holder) if holder == session && !self.doubt => {
                // Accepted even where the number is not ahead; it changes nothing then.
                self.advance(sequence);
                true
            }
            Some(_) if !self.doubt => false,
            _ => {
                self.number = Some(sequence);
                if self.doubt {
                    // Whoever holds the axis may have been released before, or may refuse this.
                    self.numbered_in_doubt = true;
                    self.heard = now;
                } else {
                    self.holder = Some(session);
                    self.hear(now);
                }
                true
            }
        }
    }

    fn advance(&mut self, sequence: u8) -> Admission {
        if self.doubt {
            self.numbered_in_doubt = true;
            return Admission::Yes;
        }
        let Some(number) = self.number else {
            return Admission::Yes;
        };
        match sequence.wrapping_sub(number) {
            1..=AHEAD => {
                self.number = Some(sequence);
                Admission::Yes
            }
            0 => Admission::Again,
            _ => Admission::No,
        }
    }

    /// What the axis says of its holder needs a reason.
    pub(super) fn tick(&mut self, last: Option<&Glance>, now: &Glance) -> Verdict {
        if let Some(last) = last {
            let passed = now.time.0.saturating_sub(last.time.0);
            let in_turn = now.tick.0 == last.tick.0.wrapping_add(1);
            self.steps += u64::from(!in_turn || passed.abs_diff(TICK) > STEP);
        }
        if self.doubt {
            self.doubt = false;
            if self.numbered_in_doubt {
                self.number = None;
            }
            self.numbered_in_doubt = false;
            self.holder = now.session;
        }
        let silence = self.silence(now.time);
        match (self.holder, now.session) {
            (Some(holder), Some(session)) if holder == session => {
                if silence > self.longest_silence() {
                    return Err(Finding(
                        Invariant::Commander,
                        format!(
                            "axis {} is still held by session {session:04X}, which has been silent for {:.1} ms of {:.1} ms",
                            self.axis,
                            silence as f64 / 1e6,
                            self.host_timeout as f64 / 1e6
                        ),
                    ));
                }
                Ok(())
            }
            (Some(_), None)
                if now.time.0.saturating_sub(self.heard_for_certain.0) + self.inexact()
                    >= self.host_timeout =>
            {
                self.holder = None;
                self.enable = false;
                Ok(())
            }
            (None, None) => Ok(()),
            (believed, claimed) => {
                let word = |session: Option<Session>| match session {
                    Some(session) => format!("session {session:04X}"),
                    None => "nobody".to_owned(),
                };
                Err(Finding(
                    Invariant::Commander,
                    format!(
                        "axis {} says that {} holds it; by the frames that it got {} does, heard {:.1} ms ago",
                        self.axis,
                        word(claimed),
                        word(believed),
                        silence as f64 / 1e6
                    ),
                ))
            }
        }
    }
}
