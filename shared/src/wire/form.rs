//! What a receiver checks of a frame: the table of frames without its names and units, which a device has
//! no flash for.

use super::id::{FUNCTION_BITS, Function};
use super::layout::{Addressing, LAYOUTS, Sender};

/// A frame's sender, addresses and length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Form {
    /// Who sends it.
    pub sender: Sender,
    /// Which addresses it may carry.
    pub addressing: Addressing,
    /// Bytes of payload.
    pub length: u8,
}

/// By the number of the function.
static FORMS: [Option<Form>; 1 << FUNCTION_BITS] = {
    let mut forms = [None; 1 << FUNCTION_BITS];
    let mut index = 0;
    while index < LAYOUTS.len() {
        let layout = &LAYOUTS[index];
        forms[layout.function as usize] = Some(Form {
            sender: layout.sender,
            addressing: layout.addressing,
            length: layout.length,
        });
        index += 1;
    }
    forms
};

impl Form {
    /// The form of a function.
    pub fn of(function: Function) -> Option<Self> {
        FORMS.get(usize::from(u8::from(function))).copied()?
    }
}
