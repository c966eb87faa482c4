//! A whole log, line by line, so that one that is still being written can be read as well.

use std::io::{self, BufRead};

use canter_shared::time::BusTime;
use canter_shared::wire::frame::Frame;
use thiserror::Error;

use super::candump::{self, LineError};

/// What a line of a log holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Entry {
    /// A frame of canter's kind.
    Frame {
        /// When, in microseconds.
        time: BusTime,
        /// On which interface.
        interface: String,
        /// What.
        frame: Frame,
    },
    /// A frame that canter's protocol has no use for: its kind.
    Foreign(&'static str),
}

/// Why a line could not be read.
#[derive(Debug, Error)]
pub enum ReadError {
    /// It is not of the format.
    #[error("line {line}: {source}")]
    Line {
        /// Which, from 1 on.
        line: u64,
        /// What is wrong with it.
        source: LineError,
    },
    /// The file can't be read on.
    #[error("after line {line}: {source}")]
    File {
        /// The last one that was read.
        line: u64,
        /// What the system says.
        source: io::Error,
    },
}

/// Reads a log of `candump -L`. Empty lines are passed over, and so are those that begin with `#`, which
/// `canter soak` writes.
#[derive(Debug)]
pub struct Reader<R> {
    input: R,
    line: u64,
    ended: bool,
}

impl<R: BufRead> Reader<R> {
    /// Reads `input` from where it is.
    pub const fn new(input: R) -> Self {
        Self {
            input,
            line: 0,
            ended: false,
        }
    }
}

impl<R: BufRead> Iterator for Reader<R> {
    type Item = Result<Entry, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        let mut bytes = Vec::new();
        while !self.ended {
            bytes.clear();
            match self.input.read_until(b'\n', &mut bytes) {
                Ok(0) => break,
                Ok(_) => self.line += 1,
                Err(source) => {
                    self.ended = true;
                    let line = self.line;
                    return Some(Err(ReadError::File { line, source }));
                }
            }
            let text = String::from_utf8_lossy(&bytes);
            let text = text.trim();
            if text.is_empty() || text.starts_with('#') {
                continue;
            }
            return Some(match candump::parse(text) {
                Ok(line) => Ok(Entry::Frame {
                    time: line.time,
                    interface: line.interface.to_owned(),
                    frame: line.frame,
                }),
                Err(LineError::Foreign { kind }) => Ok(Entry::Foreign(kind)),
                Err(source) => Err(ReadError::Line {
                    line: self.line,
                    source,
                }),
            });
        }
        self.ended = true;
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_frames_or_errors_with_their_number() {
        let log = "# canter soak --seed 1\n\n(1.000002) can0 042#01\r\nnonsense\n(1.5) can0 042#\n\
                   (2.000000) can1 1FFFFFFF#00\n\u{fffd}(2.000000";
        let read: Vec<_> = Reader::new(log.as_bytes())
            .map(|entry| entry.map_err(|error| error.to_string()))
            .collect();
        let frame = Frame::new(0x42, &[1]).expect("a frame");
        let first = Entry::Frame {
            time: BusTime(1_000_002),
            interface: "can0".to_owned(),
            frame,
        };
        assert_eq!(read.len(), 5);
        assert_eq!(read[0], Ok(first));
        for (entry, line) in [
            (&read[1], "line 4: "),
            (&read[2], "line 5: "),
            (&read[4], "line 7: "),
        ] {
            assert!(
                entry.as_ref().is_err_and(|words| words.starts_with(line)),
                "{entry:?}"
            );
        }
        assert_eq!(read[3], Ok(Entry::Foreign("29-bit")));
    }
}
