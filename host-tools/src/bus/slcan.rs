//! An adapter that speaks SLCAN, on a serial line or behind TCP.

mod connect;

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::os::fd::AsFd;
use std::time::Duration;

use canter_shared::time::BusTime;
use canter_shared::wire::frame::Frame;
use canter_shared::wire::slcan::{Decoder, Line, SlcanError, encode};
use nix::poll::PollFlags;

use super::wait::{monotonic_time, wait};
use super::{Bitrate, Bus, BusError, ErrorEvent, Event, Received};

/// How long an adapter may take to answer a command while the bus is opened. Some never answer,
/// so this much is lost with each of four commands on them, and nothing else.
const ANSWER_LIMIT: Duration = Duration::from_millis(100);

/// How often an adapter is told to close before it is set up.
const CLOSINGS: usize = 2;

/// How long the other end may refuse bytes; a line of 115 200 baud takes 2 ms for one frame.
const SEND_LIMIT: Duration = Duration::from_millis(100);

/// What the adapter's BEL becomes once the bus is open.
const REFUSED: &str = "the adapter refused a frame (its send queue is full or it is bus-off)";

/// What an adapter is connected by: bytes in, bytes out, never blocking.
trait Connection: Read + Write + AsFd + Send {}

impl<C: Read + Write + AsFd + Send> Connection for C {}

/// A CAN bus behind an adapter that speaks SLCAN.
///
/// The protocol has no word for frames that the adapter lost, nor for bus-off: those go unseen,
/// unlike with SocketCAN.
pub struct Slcan {
    connection: Box<dyn Connection>,
    description: String,
    decoder: Decoder,
    pending: VecDeque<Received>,
    /// Bytes of lines that the other end has not taken yet.
    outgoing: Vec<u8>,
    /// Answers so far, those that do not matter included.
    answers: usize,
    /// Answers that were refusals and that matter.
    refusals: usize,
}

impl Slcan {
    fn new(connection: Box<dyn Connection>, description: String) -> Self {
        Self {
            connection,
            description,
            decoder: Decoder::new(),
            pending: VecDeque::new(),
            outgoing: Vec::new(),
            answers: 0,
            refusals: 0,
        }
    }

    /// Tells the adapter at the other end to take part in the bus; it may take `limit` to
    /// answer each command.
    fn start(mut self, bitrate: Bitrate, limit: Duration) -> Result<Self, BusError> {
        let bus = &mut self;
        // The first ends what a program before this one may have left half written; only the
        // second is then sure to be understood.
        bus.command("C", CLOSINGS - 1, limit)?;
        bus.command("C", CLOSINGS, limit)?;
        let rate = format!("S{}", bitrate.number());
        bus.command(&rate, CLOSINGS + 1, limit)?;
        if bus.refusals > 0 {
            return Err(bus.refused(rate, "set the bitrate"));
        }
        // What the adapter heard before it was set up is from another time, perhaps at another
        // bitrate.
        bus.pending.clear();
        bus.command("O", CLOSINGS + 2, limit)?;
        if bus.refusals > 0 {
            return Err(bus.refused("O".to_owned(), "take part in the bus"));
        }
        Ok(self)
    }

    /// Sends a command and waits until `answers` have come in all, or `limit` is over.
    fn command(&mut self, command: &str, answers: usize, limit: Duration) -> Result<(), BusError> {
        self.write_line(format!("{command}\r").as_bytes())?;
        let until = later(limit);
        // An adapter that is still open may send frames without end.
        while self.answers < answers && monotonic_time() < until {
            if !self.read()? && self.wait(PollFlags::POLLIN, until)?.is_empty() {
                break;
            }
        }
        Ok(())
    }

    /// Takes in what has arrived; gives whether anything had.
    fn read(&mut self) -> Result<bool, BusError> {
        let mut bytes = [0; 4096];
        let count = match self.connection.read(&mut bytes) {
            Ok(0) => return Err(self.closed()),
            Ok(count) => count,
            Err(cause) if is_temporary(&cause) => return Ok(false),
            Err(cause) => return Err(self.failed("receive", cause)),
        };
        let time = monotonic_time();
        for byte in bytes.iter().take(count) {
            let Some(decoded) = self.decoder.push(*byte) else {
                continue;
            };
            let event = self.event(decoded);
            self.pending
                .extend(event.map(|event| Received { time, event }));
        }
        Ok(true)
    }

    /// What a line from the adapter means to those who use the bus.
    fn event(&mut self, decoded: Result<Line, SlcanError>) -> Option<Event> {
        let error = match decoded {
            Ok(Line::Frame(frame)) => return Some(Event::Frame(frame)),
            Ok(Line::Acknowledged) => {
                self.answers += 1;
                return None;
            }
            Ok(Line::Refused) => {
                self.answers += 1;
                // An adapter that is closed need not close again.
                if self.answers <= CLOSINGS {
                    return None;
                }
                self.refusals += 1;
                REFUSED.to_owned()
            }
            Ok(_) => return None,
            Err(error) => format!("from the adapter: {error}"),
        };
        Some(Event::Error(ErrorEvent::Other(error)))
    }

    /// Hands `line` to the other end, reading meanwhile: an adapter that cannot get rid of what
    /// it received may take nothing either.
    fn write_line(&mut self, line: &[u8]) -> Result<(), BusError> {
        let older = self.outgoing.len();
        self.outgoing.extend_from_slice(line);
        let until = later(SEND_LIMIT);
        let mut taken = 0;
        while taken < self.outgoing.len() {
            match self.connection.write(&self.outgoing[taken..]) {
                Ok(count) => taken += count,
                Err(cause) if is_temporary(&cause) => {
                    let ready = self.wait(PollFlags::POLLIN | PollFlags::POLLOUT, until)?;
                    if ready.is_empty() {
                        self.give_up(older, taken);
                        return Err(BusError::SendQueueFull {
                            bus: self.description.clone(),
                            waited: SEND_LIMIT,
                            advice: "the adapter takes nothing more: is it alive, and is its line \
                                     fast enough?",
                        });
                    }
                    if ready.contains(PollFlags::POLLIN) {
                        self.read()?;
                    }
                }
                Err(cause) => return Err(self.failed("send", cause)),
            }
        }
        self.outgoing.clear();
        Ok(())
    }

    /// Forgets the line behind the first `older` bytes, of all of which `taken` are gone: it
    /// must not go out later, when nobody means it any more. One that is half out is cut short,
    /// which the other end takes for no line at all.
    fn give_up(&mut self, older: usize, taken: usize) {
        self.outgoing.truncate(older);
        self.outgoing.drain(..taken.min(older));
        if taken > older {
            self.outgoing.push(b'\r');
        }
    }

    fn wait(&self, interest: PollFlags, until: BusTime) -> Result<PollFlags, BusError> {
        wait(self.connection.as_fd(), interest, until)
            .map_err(|cause| self.failed("wait for frames", cause))
    }

    fn closed(&self) -> BusError {
        BusError::Closed {
            bus: self.description.clone(),
        }
    }

    fn refused(&self, command: String, purpose: &'static str) -> BusError {
        BusError::AdapterRefused {
            bus: self.description.clone(),
            command,
            purpose,
        }
    }

    fn failed(&self, doing: &'static str, cause: io::Error) -> BusError {
        use nix::libc::EIO;
        match cause.kind() {
            ErrorKind::BrokenPipe
            | ErrorKind::ConnectionReset
            | ErrorKind::ConnectionAborted
            | ErrorKind::NotConnected => self.closed(),
            // What a serial device says that was unplugged.
            _ if cause.raw_os_error() == Some(EIO) => self.closed(),
            _ => BusError::System {
                bus: self.description.clone(),
                doing,
                cause,
            },
        }
    }
}

impl Bus for Slcan {
    fn now(&self) -> BusTime {
        monotonic_time()
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        self.write_line(&encode(frame))
    }

    fn receive(&mut self, until: BusTime) -> Result<Option<Received>, BusError> {
        loop {
            if let Some(received) = self.pending.pop_front() {
                return Ok(Some(received));
            }
            // Answers alone may also come, even without end, and are nothing to give.
            let over = if self.read()? {
                self.pending.is_empty() && monotonic_time() >= until
            } else {
                self.wait(PollFlags::POLLIN, until)?.is_empty()
            };
            if over {
                return Ok(None);
            }
        }
    }

    fn description(&self) -> String {
        self.description.clone()
    }
}

impl Drop for Slcan {
    /// Tells the adapter to leave the bus, as far as it can be told without waiting.
    fn drop(&mut self) {
        self.outgoing.extend_from_slice(b"C\r");
        let _ = self.connection.write(&self.outgoing);
    }
}

fn is_temporary(cause: &io::Error) -> bool {
    matches!(cause.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

fn later(limit: Duration) -> BusTime {
    BusTime(monotonic_time().0 + limit.as_micros() as u64)
}

#[cfg(test)]
mod tests;
