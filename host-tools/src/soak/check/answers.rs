//! What an axis may answer, and how often a command may be carried out.

use canter_shared::wire::command::Command;
use canter_shared::wire::id::Function;
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;

use super::believed::Admission;
use super::{Finding, Verdict};
use crate::soak::invariant::Invariant;

/// Functions that there can be.
const FUNCTIONS: usize = 32;

/// The eye on the answers of an axis.
#[derive(Debug)]
pub(super) struct Answers {
    /// Commands that are answered, less the answers so far.
    owed: u64,
    /// By function and number: commands from who may that have not been accepted yet. Answers may
    /// be seconds late on a bus that is full.
    from_holder: Vec<[u8; 256]>,
    /// By number: whether moves were staged with it, and moves that may still begin.
    staged: [bool; 256],
    may_start: [u8; 256],
}

impl Default for Answers {
    fn default() -> Self {
        Self {
            owed: 0,
            from_holder: vec![[0; 256]; FUNCTIONS],
            staged: [false; 256],
            may_start: [0; 256],
        }
    }
}

impl Answers {
    /// The axis got a command.
    pub(super) fn command(&mut self, command: &Command, admission: Admission) {
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
        if admission == Admission::No {
            return;
        }
        let place = usize::from(number);
        let accepted = &mut self.from_holder[usize::from(u8::from(command.function()))][place];
        *accepted = accepted.saturating_add(1);
        if admission == Admission::Again {
            return;
        }
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
                if reason != Reason::Accepted {
                    return Ok(());
                }
                let place = usize::from(sequence);
                let accepted = &mut self.from_holder[usize::from(u8::from(function))][place];
                if *accepted == 0 {
                    return wrong(format!(
                        "{function:?} number {sequence} was accepted, but came from nobody who may"
                    ));
                }
                *accepted -= 1;
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
