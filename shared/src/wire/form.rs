//! What a receiver checks of a frame: the table of frames without its names and units, which a device has
//! no flash for.

use super::id::Function;
use super::layout::{Addressing, LAYOUTS, Sender};

/// A frame's sender, addresses and length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Form {
    /// What it is for.
    function: Function,
    /// Who sends it.
    pub sender: Sender,
    /// Which addresses it may carry.
    pub addressing: Addressing,
    /// Bytes of payload.
    pub length: u8,
}

static FORMS: [Form; LAYOUTS.len()] = {
    let mut forms = [Form {
        function: LAYOUTS[0].function,
        sender: LAYOUTS[0].sender,
        addressing: LAYOUTS[0].addressing,
        length: LAYOUTS[0].length,
    }; LAYOUTS.len()];
    let mut index = 1;
    while index < LAYOUTS.len() {
        forms[index] = Form {
            function: LAYOUTS[index].function,
            sender: LAYOUTS[index].sender,
            addressing: LAYOUTS[index].addressing,
            length: LAYOUTS[index].length,
        };
        index += 1;
    }
    forms
};

impl Form {
    /// The form of a function.
    pub fn of(function: Function) -> Option<&'static Self> {
        FORMS.iter().find(|form| form.function == function)
    }
}
