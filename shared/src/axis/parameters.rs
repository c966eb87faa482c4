//! What is set about an axis: read by anybody, written by the session that holds it.

use super::answer::Refusal;
use super::{Axis, Outcome};
use crate::wire::command::Item;
use crate::wire::reason::Reason;

impl Axis {
    pub(super) fn read_parameter(&mut self, _parameter: u8, _item: Item) -> Outcome {
        Outcome::Ignored
    }

    pub(super) fn write_parameter(&mut self, _parameter: u8, _raw: i64) -> Result<u32, Refusal> {
        let _ = &self.values;
        Err((Reason::BadValue, 0))
    }

    pub(super) fn save_parameters(&mut self) -> Result<u32, Refusal> {
        Err((Reason::BadValue, 0))
    }

    pub(super) fn restore_parameters(&mut self) -> Result<u32, Refusal> {
        Err((Reason::BadValue, 0))
    }
}
