//! Lines to frames: whatever arrives, a line is a frame, a command or an error, and the next line is
//! read afresh.

use canter_shared::wire::frame::Frame;
use canter_shared::wire::slcan::{Decoder, Line, encode};

/// Takes the bytes as they arrive; then a good line must be understood.
pub fn run(data: &[u8]) {
    let mut decoder = Decoder::new();
    for byte in data {
        match decoder.push(*byte) {
            None => {}
            Some(Ok(Line::Frame(frame))) => assert_eq!(reads(&mut Decoder::new(), &frame), 1),
            Some(Ok(_)) => {}
            Some(Err(error)) => assert!(!error.to_string().is_empty()),
        }
    }
    // What was begun ends here, one way or another.
    let _ = decoder.push(b'\r');
    let frame = Frame::new(0x123, &[0xAB, 0xCD]).expect("a frame");
    assert_eq!(reads(&mut decoder, &frame), 1, "it no longer reads");
}

/// How often the frame comes out of its own line, and nothing else.
fn reads(decoder: &mut Decoder, frame: &Frame) -> usize {
    let lines = encode(frame)
        .into_iter()
        .filter_map(|byte| decoder.push(byte));
    lines
        .map(|line| assert_eq!(line, Ok(Line::Frame(*frame))))
        .count()
}
