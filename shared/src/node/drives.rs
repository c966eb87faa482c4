//! The bus of the drives, which is another one than the hosts'.

use super::Node;
use crate::drive::{Drive, cia402};
use crate::parameter::{Change, Parameter, Values};
use crate::wire::command::{Action, Command};
use crate::wire::frame::Frame;

impl<D: Drive, const AXES: usize> Node<D, AXES> {
    /// Takes a frame of the drives' bus.
    pub fn handle_drive_frame(&mut self, frame: &Frame) {
        let mut slots = self.slots.iter_mut();
        slots.any(|slot| slot.drive.receive(frame));
    }

    /// The next frame for the drives' bus, until there is none: setpoints wait from the tick on.
    ///
    /// The last axis comes first. Drives' ids usually go up with the axes', so the setpoint that waits
    /// longest has the lowest id, and no drive's answer to the ones before gets the bus before it.
    pub fn poll_drive_transmit(&mut self) -> Option<Frame> {
        let frame = self
            .slots
            .iter_mut()
            .rev()
            .find_map(|slot| slot.drive.poll_transmit());
        if frame.is_some() {
            return frame;
        }
        // One for all, after the last setpoint.
        let mut due = false;
        for slot in &mut self.slots {
            due |= slot.drive.take_sync();
        }
        due.then(cia402::sync)
    }
}

/// Whether a command, where it is accepted, may change what a link must know of its drive. A host that sets
/// all parameters anew changes nothing where they are the same.
pub(super) fn changes_drive(command: &Command, values: &Values) -> bool {
    match *command {
        Command::ParameterWrite {
            parameter, value, ..
        } => Parameter::try_from(parameter).is_ok_and(|parameter| {
            // All that is about drives is changed while they are disabled, and nothing else is.
            parameter.change() == Change::Disabled && values.get(parameter) != value
        }),
        Command::Control { action, .. } => action == Action::Restore,
        _ => false,
    }
}
