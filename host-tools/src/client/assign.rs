//! Ids given out by chip id.

use super::link::{ANSWER_TIME, ATTEMPTS, after};
use super::{Client, ClientError};
use crate::bus::Bus;
use canter_shared::wire::command::{AssignPart, Command};
use canter_shared::wire::id::{Address, AxisId, Function};
use canter_shared::wire::reason::Reason;
use std::fmt;
use std::str::FromStr;

/// A chip's own 96-bit id, written as 24 hexadecimal digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChipId {
    pub(super) first: [u8; 6],
    pub(super) last: [u8; 6],
}

/// A text that is no chip id.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is no chip id: write the 24 hexadecimal digits that `canter scan` shows")]
pub struct ChipIdError {
    text: String,
}

impl FromStr for ChipId {
    type Err = ChipIdError;

    fn from_str(text: &str) -> Result<Self, ChipIdError> {
        let error = || ChipIdError {
            text: text.to_owned(),
        };
        if text.len() != 24 || !text.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            return Err(error());
        }
        let digits = |from: usize| u8::from_str_radix(&text[from..from + 2], 16);
        let mut chip = Self {
            first: [0; 6],
            last: [0; 6],
        };
        let bytes = chip.first.iter_mut().chain(&mut chip.last);
        for (place, byte) in bytes.enumerate() {
            *byte = digits(2 * place).map_err(|_| error())?;
        }
        Ok(chip)
    }
}

impl fmt::Display for ChipId {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut bytes = self.first.iter().chain(&self.last);
        bytes.try_for_each(|byte| write!(formatter, "{byte:02x}"))
    }
}

impl<B: Bus> Client<B> {
    /// Gives the axis `old` of a chip, or its only axis, the id `new`. Nobody may hold it, and it
    /// must be disabled; a fault does not matter. It is not saved by that.
    ///
    /// # Errors
    /// No such chip, several axes of it, an id that is in use, or the node's refusal.
    pub fn assign(
        &mut self,
        chip: ChipId,
        old: Option<AxisId>,
        new: AxisId,
    ) -> Result<(), ClientError> {
        let nodes = self.scan()?;
        let its: Vec<AxisId> = nodes
            .iter()
            .filter(|node| node.chips().contains(&chip))
            .map(|node| node.axis)
            .collect();
        let no_chip = |client: &Self| ClientError::NoChip {
            chip,
            bus: client.bus.description(),
        };
        let old = match (old, &its[..]) {
            (Some(old), _) => old,
            (None, [only]) => *only,
            (None, []) => return Err(no_chip(self)),
            (None, several) => {
                let axes: Vec<_> = several.iter().map(ToString::to_string).collect();
                let axes = axes.join(", ");
                return Err(ClientError::WhichAxis { chip, axes });
            }
        };
        if new != old && nodes.iter().any(|node| node.axis == new) {
            return Err(ClientError::IdInUse { axis: new });
        }
        self.give_id(chip, old, new)?.ok_or_else(|| no_chip(self))
    }

    /// Sends the three parts until they are answered; `None` where they are not.
    fn give_id(
        &mut self,
        chip: ChipId,
        old: AxisId,
        new: AxisId,
    ) -> Result<Option<()>, ClientError> {
        let sequence = self.next_sequence();
        for known in self.axes.values_mut() {
            known.answers.clear();
        }
        for _ in 0..ATTEMPTS {
            // In a row: a part of somebody else's between them calls it off, and it is tried again.
            for part in [
                AssignPart::ChipFirst(chip.first),
                AssignPart::ChipLast(chip.last),
                AssignPart::Axis {
                    axis: old.get(),
                    new_axis: new.get(),
                    sequence,
                },
            ] {
                self.tell(Address::All, Command::Assign(part))?;
            }
            let mut answer = None;
            let until = after(self.bus.now(), ANSWER_TIME);
            self.wait(until, |axes| {
                // From its new id, or from another where it refuses.
                answer = axes.iter().find_map(|(axis, known)| {
                    let mut answers = known.answers.iter();
                    let answer = answers.find(|answer| {
                        answer.function == Function::Assign && answer.sequence == sequence
                    })?;
                    Some((*axis, answer.reason, answer.detail))
                });
                answer.is_some()
            })?;
            match answer {
                None => {}
                Some((_, Reason::Accepted, _)) => {
                    // The old id may be another node's, and is to be learnt anew.
                    self.axes.remove(&old);
                    return Ok(Some(()));
                }
                Some((axis, reason, detail)) => {
                    return Err(ClientError::Refused {
                        axis,
                        function: Function::Assign,
                        reason,
                        detail,
                    });
                }
            }
        }
        Ok(None)
    }
}
