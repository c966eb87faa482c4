//! The log format of can-utils, which `candump -L` writes and `canplayer` and python-can read.
//!
//! ```text
//! (0000000012.345678) can0 12F#00112233
//! ```

use std::io::{self, Write};

use canter_shared::time::BusTime;
use canter_shared::wire::frame::{Frame, MAXIMUM_LENGTH};
use thiserror::Error;

/// The interface that logs name: other tools want one, and a simulated bus has none.
pub const INTERFACE: &str = "can0";

const MICROSECONDS_PER_SECOND: u64 = 1_000_000;

/// Writes one frame as a line.
///
/// # Errors
/// What `out` says.
pub fn write(out: &mut impl Write, time: BusTime, frame: &Frame) -> io::Result<()> {
    write_on(out, INTERFACE, time, frame)
}

/// Writes one frame of another interface as a line.
///
/// # Errors
/// What `out` says.
pub fn write_on(
    out: &mut impl Write,
    interface: &str,
    time: BusTime,
    frame: &Frame,
) -> io::Result<()> {
    let (seconds, rest) = (
        time.0 / MICROSECONDS_PER_SECOND,
        time.0 % MICROSECONDS_PER_SECOND,
    );
    write!(
        out,
        "({seconds:010}.{rest:06}) {interface} {:03X}#",
        frame.id()
    )?;
    for byte in frame.data() {
        write!(out, "{byte:02X}")?;
    }
    writeln!(out)
}

/// A line of a log that holds a frame of canter's kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line<'a> {
    /// When, in microseconds.
    pub time: BusTime,
    /// On which interface.
    pub interface: &'a str,
    /// What.
    pub frame: Frame,
}

/// Why a line is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum LineError {
    /// It is not of the format at all.
    #[error(
        "not a line of a candump log: {part} is missing or wrong; expected `(12.345678) can0 12F#0011`"
    )]
    Malformed {
        /// What was looked for.
        part: &'static str,
    },
    /// A frame that canter's protocol has no use for, and that a reader may pass over.
    #[error("a {kind} frame, which canter does not use")]
    Foreign {
        /// Its kind.
        kind: &'static str,
    },
}

/// Reads one line, with or without its end; the direction that `candump -x` appends is allowed.
///
/// # Errors
/// It is no line of such a log, or one with another kind of frame.
pub fn parse(line: &str) -> Result<Line<'_>, LineError> {
    let malformed = |part| LineError::Malformed { part };
    let mut words = line.split_whitespace();
    let time = words.next().and_then(time).ok_or(malformed("the time"))?;
    let interface = words.next().ok_or(malformed("the interface"))?;
    let (id, data) = words
        .next()
        .and_then(|word| word.split_once('#'))
        .ok_or(malformed("the frame"))?;
    match (words.next(), words.next()) {
        (None | Some("R" | "T"), None) => {}
        _ => return Err(malformed("the end")),
    }
    let number = hex(id).ok_or(malformed("the identifier"))?;
    let foreign = |kind| LineError::Foreign { kind };
    match id.len() {
        3 => {}
        // An error frame has a flag above the 29 bits.
        8 if number >> 29 != 0 => return Err(foreign("error")),
        8 => return Err(foreign("29-bit")),
        _ => return Err(malformed("the identifier")),
    }
    if data.starts_with('R') {
        return Err(foreign("remote"));
    }
    if data.starts_with('#') {
        return Err(foreign("CAN FD"));
    }
    let mut bytes = [0; MAXIMUM_LENGTH];
    let length = payload(data, &mut bytes).ok_or(malformed("the data"))?;
    let frame = u16::try_from(number)
        .ok()
        .and_then(|id| Frame::new(id, bytes.get(..length)?))
        .ok_or(malformed("the identifier"))?;
    Ok(Line {
        time,
        interface,
        frame,
    })
}

fn time(word: &str) -> Option<BusTime> {
    let (seconds, rest) = word.strip_prefix('(')?.strip_suffix(')')?.split_once('.')?;
    let seconds = digits(seconds)?.checked_mul(MICROSECONDS_PER_SECOND)?;
    let rest = digits(rest).filter(|_| rest.len() == 6)?;
    seconds.checked_add(rest).map(BusTime)
}

/// A decimal number without a sign, which `parse` alone would allow.
fn digits(text: &str) -> Option<u64> {
    text.parse()
        .ok()
        .filter(|_| text.bytes().all(|digit| digit.is_ascii_digit()))
}

fn hex(text: &str) -> Option<u32> {
    u32::from_str_radix(text, 16)
        .ok()
        .filter(|_| text.bytes().all(|digit| digit.is_ascii_hexdigit()))
}

/// Fills `bytes` from pairs of digits; candump may put a dot between two.
fn payload(text: &str, bytes: &mut [u8; MAXIMUM_LENGTH]) -> Option<usize> {
    let mut rest = text;
    let mut length = 0;
    while !rest.is_empty() {
        let (pair, after) = rest.split_at_checked(2)?;
        *bytes.get_mut(length)? = u8::try_from(hex(pair)?).ok()?;
        length += 1;
        rest = after.strip_prefix('.').unwrap_or(after);
    }
    Some(length)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(id: u16, data: &[u8]) -> Frame {
        Frame::new(id, data).expect("a valid frame")
    }

    fn written(time: u64, frame: &Frame) -> String {
        let mut bytes = Vec::new();
        write(&mut bytes, BusTime(time), frame).expect("a vector takes everything");
        String::from_utf8(bytes).expect("ASCII")
    }

    #[test]
    fn lines_look_like_those_of_candump() {
        assert_eq!(
            written(1_436_509_052_249_713, &frame(0x44, &[0x2A, 0x36, 0x6C])),
            "(1436509052.249713) can0 044#2A366C\n"
        );
        assert_eq!(
            written(7, &frame(0, &[])),
            "(0000000000.000007) can0 000#\n"
        );
    }

    #[test]
    fn what_was_written_is_read_back() {
        for length in 0..=8 {
            for id in [0, 0x12F, 0x7FF] {
                let data: Vec<u8> = (0..length).map(|byte| byte * 31).collect();
                let frame = frame(id, &data);
                let text = written(12_000_001, &frame);
                let line = parse(&text).expect("our own line");
                assert_eq!((line.time, line.frame), (BusTime(12_000_001), frame));
                assert_eq!(line.interface, INTERFACE);
            }
        }
        let directed = parse("(1.000000) vcan0 001#AB.cd T").expect("candump -x");
        assert_eq!(directed.frame, frame(1, &[0xAB, 0xCD]));
    }

    #[test]
    fn other_frames_are_told_from_nonsense() {
        for (line, kind) in [
            ("(0.000001) can0 1FFFFFFF#", "29-bit"),
            ("(0.000001) can0 20000004#0004000000000000", "error"),
            ("(0.000001) can0 7FF#R4", "remote"),
            ("(0.000001) can0 044##1112233", "CAN FD"),
        ] {
            assert_eq!(parse(line), Err(LineError::Foreign { kind }), "{line}");
        }
        for (line, part) in [
            ("", "the time"),
            ("(1.5) can0 044#00", "the time"),
            ("(+1.000000) can0 044#00", "the time"),
            ("(99999999999999999999.000000) can0 044#00", "the time"),
            ("(18446744073709551.999999) can0 044#00 R R", "the time"),
            ("(1.000000)", "the interface"),
            ("(1.000000) can0", "the frame"),
            ("(1.000000) can0 044", "the frame"),
            ("(1.000000) can0 44#00", "the identifier"),
            ("(1.000000) can0 +44#00", "the identifier"),
            ("(1.000000) can0 FFF#00", "the identifier"),
            ("(1.000000) can0 044#2", "the data"),
            ("(1.000000) can0 044#2é", "the data"),
            ("(1.000000) can0 044#112233445566778899", "the data"),
            ("(1.000000) can0 044#00 X", "the end"),
        ] {
            assert_eq!(parse(line), Err(LineError::Malformed { part }), "{line}");
        }
    }
}
