//! Parameters on their way to the store, which is the owner's: a flash is slow.

use super::Node;
use crate::drive::Drive;
use crate::parameter::store::{Image, StoredAxis};
use crate::wire::reason::Reason;

impl<D: Drive, const AXES: usize> Node<D, AXES> {
    /// Says that what was saved could not be read: no axis may move with its defaults as if nothing
    /// had happened.
    pub fn lose_parameters(&mut self) {
        for slot in &mut self.slots {
            slot.axis.lose_parameters();
        }
    }

    /// Whether [`Self::take_save`] would give something.
    pub fn has_save(&self) -> bool {
        self.slots.iter().any(|slot| slot.axis.wants_save())
    }

    /// What is to be saved now, all axes as they are at this instant. Once it is written, or is not,
    /// the owner says so with [`Self::saved`]; until then nobody is answered.
    #[inline(never)]
    pub fn take_save(&mut self) -> Option<Image<AXES>> {
        self.refuse_saves_while_driving();
        if !self.has_save() {
            return None;
        }
        let mut image = Image::new();
        for slot in &mut self.slots {
            slot.axis.begin_save();
            // As many places as axes: there is always room.
            let _ = image.push(StoredAxis {
                axis: slot.axis.id().get(),
                values: *slot.axis.values(),
            });
        }
        Some(image)
    }

    /// Takes what came of a save, and answers all who asked before it was taken.
    #[inline(never)]
    pub fn saved(&mut self, image: &Image<AXES>, kept: bool) {
        // By their places: an axis may have got another id meanwhile.
        for (slot, stored) in self.slots.iter_mut().zip(image) {
            slot.axis.end_save(kept.then_some(&stored.values));
        }
    }

    /// A save is for a node that stands without torque: whatever it does to the processor's time
    /// then holds nobody up.
    #[inline(never)]
    pub(super) fn refuse_saves_while_driving(&mut self) {
        let mut states = self.slots.iter().map(|slot| slot.axis.state());
        if let Some(state) = states.find(|state| state.drives()) {
            for slot in &mut self.slots {
                if slot.axis.wants_save() {
                    let why = (Reason::NotDisabled, u8::from(state).into());
                    slot.axis.refuse_save(why);
                }
            }
        }
    }
}
