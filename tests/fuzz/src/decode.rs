//! Frames to meaning: whatever decodes means the same when it is encoded and decoded again.

use canter_shared::wire::command::Command;
use canter_shared::wire::frame::Frame;
use canter_shared::wire::report::Report;

/// Takes the bytes as one frame: two of its id, and the rest its data.
pub fn run(data: &[u8]) {
    let [low, high, data @ ..] = data else {
        return;
    };
    let Some(frame) = Frame::new(u16::from_le_bytes([*low, *high]), data) else {
        return;
    };
    match Command::decode(&frame) {
        Ok(Some((address, command))) => {
            let again = command.encode(address).expect("what was decoded fits");
            assert_eq!(Command::decode(&again), Ok(Some((address, command))));
        }
        Ok(None) => {}
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    match Report::decode(&frame) {
        Ok(Some((axis, report))) => {
            let again = report.encode(axis);
            assert_eq!(Report::decode(&again), Ok(Some((axis, report))));
        }
        Ok(None) => {}
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
