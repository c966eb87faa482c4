//! What was on a CAN bus, as seen by can-utils rather than by canter.

use std::process::Command;
use std::time::{Duration, Instant};

use crate::PATIENCE;
use crate::process::{Process, Stream};

/// The extended identifier of the frame that tells whether candump listens yet. canter only uses 11-bit identifiers.
const PROBE: u32 = 0x1FFF_FFFF;

/// One line of `candump -L`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Logged {
    /// When the kernel received it, in microseconds.
    pub time_us: u64,
    /// The interface.
    pub interface: String,
    /// The identifier, without flags.
    pub id: u32,
    /// Whether the identifier has 29 bits.
    pub extended: bool,
    /// Whether it asks for data instead of carrying some.
    pub remote: bool,
    /// Up to 8 bytes.
    pub data: Vec<u8>,
}

impl Logged {
    /// Reads a line such as `(1436509052.249713) vcan0 044#2A366C2BBA`.
    pub fn parse(line: &str) -> Option<Self> {
        let mut words = line.split_whitespace();
        let time = words.next()?.strip_prefix('(')?.strip_suffix(')')?;
        let (seconds, micros) = time
            .split_once('.')
            .filter(|(_, micros)| micros.len() == 6)?;
        let time_us = seconds.parse::<u64>().ok()? * 1_000_000 + micros.parse::<u64>().ok()?;
        let interface = words.next()?.to_owned();
        let (id, data) = words.next()?.split_once('#')?;
        // Three digits are a standard identifier, eight an extended one; an error frame has eight
        // and a flag above the identifier's bits.
        let extended = id.len() == 8;
        let digits = extended || id.len() == 3;
        let id = u32::from_str_radix(id, 16)
            .ok()
            .filter(|id| digits && *id <= 0x1FFF_FFFF)?;
        let remote = data.starts_with('R');
        let data = if remote { "" } else { data };
        let hex = data.len().is_multiple_of(2) && data.bytes().all(|c| c.is_ascii_hexdigit());
        let count = if hex && data.len() <= 16 {
            data.len() / 2
        } else {
            return None;
        };
        let byte = |at: usize| u8::from_str_radix(&data[2 * at..][..2], 16).ok();
        let data = (0..count).map(byte).collect::<Option<Vec<u8>>>()?;
        Some(Self {
            time_us,
            interface,
            id,
            extended,
            remote,
            data,
        })
    }

    fn is_probe(&self) -> bool {
        self.extended && self.id == PROBE
    }
}

/// A running `candump -L` on one interface.
#[derive(Debug)]
pub struct Candump(Process);

impl Candump {
    /// Starts to listen; every frame sent after this returns is seen.
    ///
    /// # Panics
    /// When candump or cansend is missing, or the interface is.
    #[track_caller]
    pub fn start(interface: &str) -> Self {
        Self::listen(interface, interface)
    }

    /// The same, for some 11-bit identifiers only: there may be very many frames.
    ///
    /// # Panics
    /// When candump or cansend is missing, or the interface is.
    #[track_caller]
    pub fn start_for(interface: &str, ids: &[u32]) -> Self {
        let filters: String = ids.iter().map(|id| format!(",{id:03X}:7FF")).collect();
        Self::listen(
            interface,
            &format!("{interface}{filters},{PROBE:08X}:{PROBE:08X}"),
        )
    }

    #[track_caller]
    fn listen(interface: &str, what: &str) -> Self {
        // A large receive buffer, and a count of what was lost in spite of it.
        let options = ["-L", "-d", "-r", "4000000", what];
        let mut candump = Self(Process::spawn(Command::new("candump").args(options)));
        // candump does not say when it listens: its first word is the first frame that it sees.
        let deadline = Instant::now() + PATIENCE;
        while Instant::now() < deadline {
            cansend(interface, &format!("{:08X}#", PROBE));
            if let Some(line) = candump.0.next_line(Duration::from_millis(20)) {
                candump.0.unread(line);
                return candump;
            }
        }
        panic!("candump on {interface} sees nothing: {candump:?}");
    }

    /// The next frame; None when `limit` has passed.
    ///
    /// # Panics
    /// When candump says anything but a frame: that it lost some, or that the interface is gone.
    #[track_caller]
    pub fn next(&mut self, limit: Duration) -> Option<Logged> {
        let deadline = Instant::now() + limit;
        loop {
            let line = self
                .0
                .next_line(deadline.saturating_duration_since(Instant::now()))?;
            match Logged::parse(&line.text).filter(|_| line.stream == Stream::Stdout) {
                Some(frame) if frame.is_probe() => {}
                Some(frame) => return Some(frame),
                None => panic!("candump: {}", line.text),
            }
        }
    }

    /// Waits for the next frame that `wanted` accepts, passing over the others.
    ///
    /// # Panics
    /// After [`PATIENCE`].
    #[track_caller]
    pub fn wait_for(&mut self, what: &str, mut wanted: impl FnMut(&Logged) -> bool) -> Logged {
        let deadline = Instant::now() + PATIENCE;
        loop {
            // A bus that is never silent is not waited for without an end either.
            let left = deadline.saturating_duration_since(Instant::now());
            match self.next(left) {
                Some(frame) if wanted(&frame) => return frame,
                Some(_) if !left.is_zero() => {}
                _ => panic!("no {what} on the bus in {PATIENCE:?}"),
            }
        }
    }
}

/// Sends one frame, written as `123#DEADBEEF`, with can-utils.
///
/// # Panics
/// When it cannot be sent.
#[track_caller]
pub fn cansend(interface: &str, frame: &str) {
    Process::spawn(Command::new("cansend").args([interface, frame]))
        .finish()
        .success();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_candump_are_read() {
        let frame =
            Logged::parse("(1436509052.249713) vcan0 044#2A366C2BBA").expect("a data frame");
        assert_eq!((frame.time_us, frame.id), (1_436_509_052_249_713, 0x44));
        assert_eq!(frame.data, [0x2A, 0x36, 0x6C, 0x2B, 0xBA]);
        assert_eq!(
            (&*frame.interface, frame.extended, frame.remote),
            ("vcan0", false, false)
        );
        let probe = Logged::parse("(0.000001) vcan7 1FFFFFFF#").expect("an empty extended frame");
        assert!(probe.is_probe());
        assert!(
            Logged::parse("(0.000001) can0 7FF#R4")
                .expect("a remote frame")
                .remote
        );
    }

    #[test]
    fn anything_else_is_refused() {
        for line in [
            "",
            "DROPCOUNT: dropped 3 CAN frames on 'vcan0' socket (total drops 3)",
            "(1.000000) vcan0 20000004#0004000000000000",
            "(1.000000) vcan0 044#2",
            "(1.000000) vcan0 044##1112233445566778899",
            "(1.000000) vcan0 044#112233445566778899",
            "(1.5) vcan0 044#00",
        ] {
            assert_eq!(Logged::parse(line), None, "{line}");
        }
    }
}
