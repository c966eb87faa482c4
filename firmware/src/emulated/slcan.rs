//! The emulated board's CAN bus: USART1 speaks SLCAN, as a USB adapter does.
//!
//! Before the host has opened the channel, nobody is on the bus: what the node sends is dropped
//! and what the host sends is refused.

use core::cell::RefCell;
use core::sync::atomic::{AtomicBool, Ordering};

use canter_shared::time::LocalTime;
use canter_shared::wire::frame::Frame;
use canter_shared::wire::slcan::{Decoder, Line, SlcanError, encode};
use critical_section::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::channel::Channel;
use stm32_metapac::USART1;

use super::uart;
use crate::now;
use crate::port::{BusCounts, BusMonitor, CanReceive, CanTransmit, Received, Tally};

/// A line from the host, and when its last byte came.
type Arrival = (Result<Line, SlcanError>, LocalTime);

static LINES: Channel<CriticalSectionRawMutex, Arrival, 32> = Channel::new();
static DECODER: Mutex<RefCell<Decoder>> = Mutex::new(RefCell::new(Decoder::new()));
static OPEN: AtomicBool = AtomicBool::new(false);
static LOST: Tally = Tally::new();
static BAD_LINES: Tally = Tally::new();

const DONE: &[u8] = b"\r";
const FRAME_DONE: &[u8] = b"z\r";
const REFUSED: &[u8] = b"\x07";

/// Switches USART1 on.
pub fn start() -> (Receiver, Transmitter, Monitor) {
    uart::start(USART1, true);
    (Receiver(()), Transmitter(()), Monitor(()))
}

/// For the board's USART1 interrupt: decodes here so that a frame is stamped when it is complete.
pub fn on_interrupt() {
    critical_section::with(|cs| {
        let mut decoder = DECODER.borrow(cs).borrow_mut();
        while let Some(byte) = uart::read(USART1) {
            if let Some(line) = decoder.push(byte)
                && LINES.try_send((line, now())).is_err()
            {
                LOST.raise();
            }
        }
    });
}

/// The host's frames.
pub struct Receiver(());

impl CanReceive for Receiver {
    async fn receive(&mut self) -> Received {
        loop {
            let (line, at) = LINES.receive().await;
            if let Some(frame) = answer(line) {
                return Received { frame, at };
            }
        }
    }
}

/// Answers a line, and returns the frame that it carried for the node.
fn answer(line: Result<Line, SlcanError>) -> Option<Frame> {
    let open = OPEN.load(Ordering::Relaxed);
    let (reply, frame) = match line {
        Ok(Line::Frame(frame)) if open => (FRAME_DONE, Some(frame)),
        // The bit rate means nothing here, but adapters only take it while they are closed.
        Ok(Line::Bitrate(_)) if !open => (DONE, None),
        Ok(Line::Open | Line::Close) => {
            OPEN.store(matches!(line, Ok(Line::Open)), Ordering::Relaxed);
            (DONE, None)
        }
        Ok(Line::Timestamp(false)) => (DONE, None),
        Ok(Line::Version) => (&b"V0101\r"[..], None),
        Ok(Line::SerialNumber) => (&b"NQEMU\r"[..], None),
        Ok(Line::Status) => (&b"F00\r"[..], None),
        // Hosts send empty lines to flush what was left of an older session.
        Ok(Line::Acknowledged | Line::Refused) => (&b""[..], None),
        Ok(_) => (REFUSED, None),
        Err(_) => {
            BAD_LINES.raise();
            (REFUSED, None)
        }
    };
    uart::write(USART1, reply);
    frame
}

/// Frames to the host. It shares USART1 with the answers, line by line: both run in the bus
/// executor, and neither waits within a line.
pub struct Transmitter(());

impl CanTransmit for Transmitter {
    async fn transmit(&mut self, frame: &Frame) {
        if OPEN.load(Ordering::Relaxed) {
            uart::write(USART1, &encode(frame));
        }
    }
}

/// Counts a line that could not be read as an error frame, and one too many as a loss.
pub struct Monitor(());

impl BusMonitor for Monitor {
    fn take(&mut self) -> BusCounts {
        BusCounts {
            bus_off: 0,
            error_frames: BAD_LINES.take(),
            lost_receptions: LOST.take(),
        }
    }
}
