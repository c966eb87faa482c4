//! An axis gets another id. The chip's id says whose axis is meant, because the axis's own may be
//! that of another node too: that is what this is there to cure.

use super::{Node, half};
use crate::axis::Outcome;
use crate::drive::Drive;
use crate::wire::command::AssignPart;
use crate::wire::id::{AxisId, Function};
use crate::wire::reason::Reason;

/// How far an assignment has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Assignment {
    /// How many parts in a row have named this node's chip.
    named: u8,
    /// The last one that was done, to know its repetition.
    done: Option<AssignPart>,
}

impl<D: Drive, const AXES: usize> Node<D, AXES> {
    #[inline(never)]
    pub(super) fn assign(&mut self, part: AssignPart) {
        let named = core::mem::take(&mut self.assignment.named);
        let chip = &self.identity.chip;
        match part {
            AssignPart::ChipFirst(first) if first == half(chip, 0) => self.assignment.named = 1,
            AssignPart::ChipLast(last) if named == 1 && last == half(chip, 6) => {
                self.assignment.named = 2;
            }
            AssignPart::ChipFirst(_) | AssignPart::ChipLast(_) => {}
            AssignPart::Axis {
                axis,
                new_axis,
                sequence,
            } if named == 2 => {
                let repeated = self.assignment.done == Some(part);
                let (from, answer) = self.rename(axis, new_axis, repeated);
                if answer.is_ok() {
                    self.assignment.done = Some(part);
                }
                if let Some(slot) = self.slots.get_mut(from) {
                    let _: Outcome = slot.axis.answer(Function::Assign, sequence, answer);
                }
            }
            AssignPart::Axis { .. } => {}
        }
    }

    /// The place of the axis that answers, and what: the one of the old id, which has the new one by
    /// then, or the first one where this node has no such axis. It must not speak under an id that
    /// is not its own.
    fn rename(
        &mut self,
        axis: u8,
        new_axis: u8,
        repeated: bool,
    ) -> (usize, Result<u32, (Reason, u32)>) {
        let place = |id: u8| {
            let mut slots = self.slots.iter();
            slots.position(|slot| slot.axis.id().get() == id)
        };
        if let Some(renamed) = place(new_axis).filter(|_| repeated) {
            return (renamed, Ok(0));
        }
        let Some(old) = place(axis) else {
            return (0, Err((Reason::IdTaken, axis.into())));
        };
        let Some(new) = AxisId::new(new_axis) else {
            return (old, Err((Reason::BadValue, 0)));
        };
        if place(new_axis).is_some_and(|other| other != old) {
            return (old, Err((Reason::IdTaken, new_axis.into())));
        }
        let renamed = self.slots.get_mut(old).map(|slot| slot.axis.assign(new));
        (old, renamed.unwrap_or(Ok(())).map(|()| 0))
    }
}
