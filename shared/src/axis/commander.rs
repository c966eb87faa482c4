//! Who commands an axis: one session at a time, alive as long as it beats.

use crate::time::{Tick, Ticks};
use crate::wire::command::Session;

/// Half of the sequence numbers: one that is ahead by no more than this is new.
const AHEAD: u8 = 127;

/// The session that holds the axis, if any, and the number of its last command.
#[derive(Debug, Clone, Default)]
pub(super) struct Commander {
    session: Option<Session>,
    heard: Tick,
    sequence: u8,
    /// Whether it may change parameters.
    configures: bool,
}

impl Commander {
    pub(super) fn session(&self) -> Option<Session> {
        self.session
    }

    /// Takes the axis for `session` where it is free or held by the same; numbers begin anew.
    /// Says whether they do: the repetition of a hold must not make old numbers new.
    pub(super) fn hold(
        &mut self,
        session: Session,
        sequence: u8,
        now: Tick,
    ) -> Result<bool, Session> {
        match self.session {
            Some(holder) if holder != session => Err(holder),
            // As any other command of its: an old hold must not make old numbers new either.
            Some(_) => {
                let ahead = self.advance(sequence).is_ok();
                Ok(ahead)
            }
            None => {
                self.session = Some(session);
                self.heard = now;
                self.sequence = sequence;
                self.configures = false;
                Ok(true)
            }
        }
    }

    pub(super) fn release(&mut self) {
        self.session = None;
    }

    /// Whether the session may change parameters. A write has no room for the session that sends it,
    /// so a frame that does name it must have come before.
    pub(super) fn configures(&self) -> bool {
        self.session.is_some() && self.configures
    }

    pub(super) fn configure(&mut self, may: bool) {
        self.configures = may;
    }

    /// Takes a heartbeat that arrived at `then`, which may be some ticks ago: a node that is busy
    /// does not give its host more time.
    pub(super) fn hear(&mut self, session: Session, then: Tick) {
        let later = then.0.wrapping_sub(self.heard.0) as i64 > 0;
        if self.session == Some(session) && later {
            self.heard = then;
        }
    }

    /// Whether the session has been silent for longer than `timeout`.
    pub(super) fn is_silent(&self, now: Tick, timeout: Ticks) -> bool {
        self.session.is_some() && now.0.wrapping_sub(self.heard.0) as i64 > i64::from(timeout.0)
    }

    /// Takes the next command's number, or gives the last one where this is not ahead of it.
    pub(super) fn advance(&mut self, sequence: u8) -> Result<(), u8> {
        let ahead = sequence.wrapping_sub(self.sequence);
        if (1..=AHEAD).contains(&ahead) {
            self.sequence = sequence;
            Ok(())
        } else {
            Err(self.sequence)
        }
    }

    /// Follows a step of the bus clock by `ticks`: silence goes on being counted.
    pub(super) fn rebase(&mut self, ticks: i64) {
        // Before the beginning of bus time where that is nearer than the last word.
        self.heard = Tick(self.heard.0.wrapping_add_signed(ticks));
    }
}
