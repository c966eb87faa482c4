//! What an axis may answer, and how often a command may be carried out.

use canter_shared::wire::command::Command;
use canter_shared::wire::id::Function;
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;

use super::{Finding, Verdict};
use crate::soak::invariant::Invariant;

/// Commands whose answers may still be on their way: more than an axis and its controller can keep.
const RECENT: usize = 64;

/// The eye on the answers of an axis.
#[derive(Debug)]
pub(super) struct Answers {
    /// Commands that are answered, less the answers so far.
    owed: u64,
    /// What was last taken from who may: function and number.
    recent: [(u8, u8); RECENT],
    next: usize,
    /// By number: whether moves were staged with it, and moves that may still begin.
    staged: [bool; 256],
    may_start: [u8; 256],
}

impl Default for Answers {
    fn default() -> Self {
        Self {
            owed: 0,
            recent: [(0, 0); RECENT],
            next: 0,
            staged: [false; 256],
            may_start: [0; 256],
        }
    }
}

impl Answers {
    /// The axis got a command, which was `admitted` or not.
    pub(super) fn command(&mut self, command: &Command, admitted: bool) {
        let number = match *command {
            Command::EmergencyStop
            | Command::Sync { .. }
            | Command::HostHeartbeat { .. }
            | Command::IdentityRequest
            | Command::Assign(_) => return,
            Command::Trigger { group, .. } => group,
            Command::Knot { number, .. } => number,
            Command::ParameterRead { parameter, .. } => parameter,
            Command::Stop { sequence }
            | Command::Control { sequence, .. }
            | Command::TrapezoidShape { sequence, .. }
            | Command::RampLimits { sequence, .. }
            | Command::PeakLimits { sequence, .. }
            | Command::StreamBegin { sequence, .. }
            | Command::ParameterWrite { sequence, .. }
            | Command::Move { sequence, .. } => sequence,
        };
        self.owed += 1;
        if !admitted {
            return;
        }
        self.recent[self.next] = (command.function().into(), number);
        self.next = (self.next + 1) % RECENT;
        let place = usize::from(number);
        let begins = match command {
            Command::Move { staged: true, .. } => {
                self.staged[place] = true;
                false
            }
            Command::Trigger { .. } => std::mem::take(&mut self.staged[place]),
            Command::Move { .. } | Command::StreamBegin { .. } => true,
            _ => false,
        };
        let credit = &mut self.may_start[place];
        *credit = credit.saturating_add(u8::from(begins));
    }

    /// The axis said something.
    pub(super) fn report(&mut self, report: &Report) -> Verdict {
        let wrong = |words: String| Err(Finding(Invariant::Answers, words));
        match *report {
            Report::Acknowledgement {
                function: Function::Assign,
                ..
            } => Ok(()),
            Report::Acknowledgement {
                sequence,
                function,
                reason,
                ..
            } => {
                if self.owed == 0 {
                    return wrong(format!(
                        "{function:?} number {sequence} was answered {reason:?}, but every command has its answer"
                    ));
                }
                self.owed -= 1;
                let known = self.recent.contains(&(function.into(), sequence));
                if reason == Reason::Accepted && !known {
                    return wrong(format!(
                        "{function:?} number {sequence} was accepted, but came from nobody who may"
                    ));
                }
                Ok(())
            }
            Report::Started { sequence, .. } => {
                let credit = &mut self.may_start[usize::from(sequence)];
                if *credit == 0 {
                    return wrong(format!(
                        "a move of number {sequence} began, but each that was commanded has begun before"
                    ));
                }
                *credit -= 1;
                Ok(())
            }
            _ => Ok(()),
        }
    }
}
