//! CAN frames as lines of ASCII, the LAWICEL protocol that USB adapters call SLCAN.
//!
//! One line is one command or one frame, and CR ends it. `t1232ABCD` is the frame with id 0x123
//! and the bytes AB CD. The side with the CAN controller answers a command that it carried out
//! with an empty line (or with `z` where the command was a frame) and one that it did not with
//! BEL. Both sides decode with [`Decoder`]: the lines of the two directions do not collide.
//!
//! Adapters differ in whether they answer at all, in the case of their digits and in whether a
//! time stamp follows a received frame, so all of that is accepted here and none of it needed.

use core::fmt;

use heapless::Vec;

use super::frame::{Frame, MAXIMUM_LENGTH};

/// Bytes in the longest line: a 29-bit frame with 8 bytes and a time stamp, CR included.
///
/// canter drops 29-bit frames, but must read past those of others.
pub const LONGEST_LINE: usize = 1 + 8 + 1 + 2 * MAXIMUM_LENGTH + TIMESTAMP_DIGITS + 1;

/// Hex digits of the time stamp (milliseconds) that an adapter may put after a frame.
const TIMESTAMP_DIGITS: usize = 4;

/// Hex digits of an 11-bit id.
const ID_DIGITS: usize = 3;

/// The highest bitrate number, `S8`: 1 Mbit/s.
const HIGHEST_BITRATE: u8 = 8;

const CR: u8 = b'\r';
const LF: u8 = b'\n';
const BEL: u8 = 0x07;

/// A line that is not SLCAN. It has been dropped whole, and the next line is read afresh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SlcanError {
    /// No CR within [`LONGEST_LINE`] bytes.
    LineTooLong,
    /// The line starts with a byte that is no command's letter.
    UnknownCommand(u8),
    /// A byte stands where a digit must; in a frame the digits are hexadecimal.
    BadDigit(u8),
    /// The line of this command has too few or too many characters.
    BadLength {
        /// The command's letter.
        command: u8,
        /// Characters in the line, without CR.
        characters: usize,
    },
    /// A frame names an id wider than 11 bits.
    IdOutOfRange(u16),
    /// A frame announces more than 8 bytes.
    TooManyBytes(u8),
    /// A bitrate number over 8.
    UnknownBitrate(u8),
}

impl fmt::Display for SlcanError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::LineTooLong => write!(formatter, "no CR within {LONGEST_LINE} bytes"),
            Self::UnknownCommand(byte) => {
                write!(formatter, "no command starts with byte 0x{byte:02X}")
            }
            Self::BadDigit(byte) => write!(formatter, "byte 0x{byte:02X} where a digit must be"),
            Self::BadLength {
                command,
                characters,
            } => write!(
                formatter,
                "a line of {characters} characters is not a whole `{}` command",
                char::from(command)
            ),
            Self::IdOutOfRange(id) => {
                write!(
                    formatter,
                    "id 0x{id:X} is over 0x7FF, the highest of 11 bits"
                )
            }
            Self::TooManyBytes(count) => {
                write!(formatter, "a frame of {count} bytes; classic CAN carries 8")
            }
            Self::UnknownBitrate(number) => write!(
                formatter,
                "bitrate number {number}; the numbers are 0 to {HIGHEST_BITRATE}"
            ),
        }
    }
}

impl core::error::Error for SlcanError {}

/// What one line says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Line {
    /// `t`: a data frame with an 11-bit id.
    Frame(Frame),
    /// `O`: take part in the bus.
    Open,
    /// `C`: leave the bus.
    Close,
    /// `S0` to `S8`: the bitrate to use from the next `O` on; see [`bits_per_second`].
    Bitrate(u8),
    /// `V`: the question for the adapter's version.
    Version,
    /// `N`: the question for the adapter's serial number.
    SerialNumber,
    /// `F`: the question for the adapter's error flags.
    Status,
    /// `Z0`, `Z1`: whether received frames shall carry a time stamp.
    Timestamp(bool),
    /// `L`: take part in the bus without ever sending, not even acknowledgements.
    ListenOnly,
    /// An empty line, `z` or `Z`: the last command was carried out.
    Acknowledged,
    /// BEL: the last command was not carried out.
    Refused,
    /// A line that is well known and that canter has no use for: 29-bit and remote frames,
    /// filters, bit timings, and an adapter's answers to `V`, `N` and `F`.
    Unsupported,
}

/// The bitrate behind a number of [`Line::Bitrate`], in bit/s; `None` over 8.
pub const fn bits_per_second(number: u8) -> Option<u32> {
    Some(match number {
        0 => 10_000,
        1 => 20_000,
        2 => 50_000,
        3 => 100_000,
        4 => 125_000,
        5 => 250_000,
        6 => 500_000,
        7 => 800_000,
        8 => 1_000_000,
        _ => return None,
    })
}

/// Puts lines together from bytes as they arrive.
#[derive(Debug, Clone)]
pub struct Decoder {
    line: Vec<u8, LONGEST_LINE>,
    /// The rest of an overlong line is being thrown away.
    skipping: bool,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// At the start of a line.
    pub const fn new() -> Self {
        Self {
            line: Vec::new(),
            skipping: false,
        }
    }

    /// Takes the next byte; gives a line when `byte` ends one.
    ///
    /// CR ends a line and LF is ignored. BEL is an answer of its own wherever it comes: what was
    /// gathered of a line before it is dropped.
    ///
    /// # Errors
    /// The line is not SLCAN. It is dropped, and decoding goes on with the next byte. An overlong
    /// line gives its one error as soon as it is too long.
    pub fn push(&mut self, byte: u8) -> Option<Result<Line, SlcanError>> {
        match byte {
            LF => None,
            BEL => {
                self.restart();
                Some(Ok(Line::Refused))
            }
            CR => {
                let decoded = (!self.skipping).then(|| decode(&self.line));
                self.restart();
                decoded
            }
            _ if self.skipping => None,
            // The last place is CR's.
            _ if self.line.len() + 1 < LONGEST_LINE && self.line.push(byte).is_ok() => None,
            _ => {
                self.skipping = true;
                Some(Err(SlcanError::LineTooLong))
            }
        }
    }

    fn restart(&mut self) {
        self.line.clear();
        self.skipping = false;
    }
}

/// The line that carries `frame`, CR included.
pub fn encode(frame: &Frame) -> Vec<u8, LONGEST_LINE> {
    let mut line = Vec::new();
    let mut put = |byte: u8| {
        // Cannot fail: 22 bytes at most are put into a line of LONGEST_LINE.
        let _ = line.push(byte);
    };
    put(b't');
    for shift in [8, 4, 0] {
        put(upper_case_digit((frame.id() >> shift) as u8));
    }
    put(upper_case_digit(frame.data().len() as u8));
    for byte in frame.data() {
        put(upper_case_digit(byte >> 4));
        put(upper_case_digit(*byte));
    }
    put(CR);
    line
}

/// The hexadecimal digit of the low four bits.
const fn upper_case_digit(value: u8) -> u8 {
    match value & 0x0F {
        low @ 0..=9 => b'0' + low,
        high => b'A' + (high - 10),
    }
}

/// Decodes a line that stands here without its CR.
fn decode(line: &[u8]) -> Result<Line, SlcanError> {
    let Some((&command, rest)) = line.split_first() else {
        return Ok(Line::Acknowledged);
    };
    let bad_length = SlcanError::BadLength {
        command,
        characters: line.len(),
    };
    match (command, rest) {
        (b't', _) => decode_frame(rest, bad_length).map(Line::Frame),
        (b'z' | b'Z', []) => Ok(Line::Acknowledged),
        (b'Z', [b'0']) => Ok(Line::Timestamp(false)),
        (b'Z', [b'1']) => Ok(Line::Timestamp(true)),
        (b'Z', [byte]) => Err(SlcanError::BadDigit(*byte)),
        (b'S', [digit @ b'0'..=b'9']) => match digit - b'0' {
            number @ 0..=HIGHEST_BITRATE => Ok(Line::Bitrate(number)),
            number => Err(SlcanError::UnknownBitrate(number)),
        },
        (b'S', [byte]) => Err(SlcanError::BadDigit(*byte)),
        (b'O', []) => Ok(Line::Open),
        (b'C', []) => Ok(Line::Close),
        (b'L', []) => Ok(Line::ListenOnly),
        (b'V', []) => Ok(Line::Version),
        (b'N', []) => Ok(Line::SerialNumber),
        (b'F', []) => Ok(Line::Status),
        (b'O' | b'C' | b'L' | b'S' | b'z' | b'Z', _) => Err(bad_length),
        _ if command.is_ascii_alphabetic() => Ok(Line::Unsupported),
        _ => Err(SlcanError::UnknownCommand(command)),
    }
}

/// Decodes what follows `t`: id, number of bytes, the bytes, perhaps a time stamp.
fn decode_frame(text: &[u8], bad_length: SlcanError) -> Result<Frame, SlcanError> {
    let (id, text) = text.split_at_checked(ID_DIGITS).ok_or(bad_length)?;
    let (&count, text) = text.split_first().ok_or(bad_length)?;
    let id = number(id)?;
    let count = digit(count)?;
    if usize::from(count) > MAXIMUM_LENGTH {
        return Err(SlcanError::TooManyBytes(count));
    }
    let (pairs, timestamp) = text
        .split_at_checked(2 * usize::from(count))
        .ok_or(bad_length)?;
    if !matches!(timestamp.len(), 0 | TIMESTAMP_DIGITS) {
        return Err(bad_length);
    }
    number(timestamp)?;

    let mut data = Vec::<u8, MAXIMUM_LENGTH>::new();
    for pair in pairs.chunks_exact(2) {
        // Cannot fail: there are at most eight pairs.
        let _ = data.push(number(pair)? as u8);
    }
    Frame::new(id, &data).ok_or(SlcanError::IdOutOfRange(id))
}

/// The value of up to four hexadecimal digits.
fn number(digits: &[u8]) -> Result<u16, SlcanError> {
    digits.iter().try_fold(0, |value: u16, &character| {
        Ok((value << 4) | u16::from(digit(character)?))
    })
}

fn digit(character: u8) -> Result<u8, SlcanError> {
    match character {
        b'0'..=b'9' => Ok(character - b'0'),
        b'A'..=b'F' => Ok(character - b'A' + 10),
        b'a'..=b'f' => Ok(character - b'a' + 10),
        _ => Err(SlcanError::BadDigit(character)),
    }
}

#[cfg(test)]
mod tests;
