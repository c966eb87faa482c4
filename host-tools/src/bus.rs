//! CAN buses: SocketCAN interfaces and SLCAN adapters behind one trait.
//!
//! | address | what it is |
//! |---|---|
//! | `vcan0`, `socketcan:vcan0` | a CAN interface of this machine's kernel |
//! | `slcan:/dev/ttyACM0` | a USB or serial adapter that speaks SLCAN |
//! | `slcan:tcp:HOST:PORT` | the same over TCP, such as an emulated node |
//! | `sim` | the simulated robot, which has a bus of its own and is not opened here |
//!
//! A bus is used from one thread: [`Bus::receive`] is the only place that waits, and it waits
//! until an instant of the bus's own clock, so the same code runs in real and in virtual time.

mod address;
mod error;
mod slcan;
mod socketcan;
mod wait;

use canter_shared::time::BusTime;
use canter_shared::wire::frame::Frame;

pub use address::{Address, AddressError, Bitrate, SlcanTarget};
pub use error::BusError;
pub use slcan::Slcan;
pub use socketcan::SocketCan;
pub use wait::monotonic_time;

/// A CAN bus that frames can be sent on and received from.
pub trait Bus {
    /// The bus's clock, in microseconds; it never goes back.
    ///
    /// For real buses this is the machine's CLOCK_MONOTONIC, so that processes that follow each
    /// other (or run side by side) on one machine agree. A simulated bus has virtual time.
    fn now(&self) -> BusTime;

    /// Hands `frame` to the bus; it may go out a little later, in order.
    ///
    /// A full send queue is waited for, for a limited time.
    ///
    /// # Errors
    /// [`BusError::SendQueueFull`] where the queue stayed full: the frame will not be sent.
    /// Otherwise the bus is down, gone or closed.
    fn send(&mut self, frame: &Frame) -> Result<(), BusError>;

    /// The next thing that arrives, in order; `None` where nothing did by `until`.
    ///
    /// An `until` that has passed asks without waiting.
    ///
    /// # Errors
    /// The bus is down, gone or closed.
    fn receive(&mut self, until: BusTime) -> Result<Option<Received>, BusError>;

    /// What this bus is, for messages: `socketcan vcan0`, `slcan /dev/ttyACM0`.
    fn description(&self) -> String;
}

/// Something that arrived from a bus.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Received {
    /// When it arrived, as early as can be known: SocketCAN says when the kernel got it, SLCAN
    /// when its last byte was read.
    pub time: BusTime,
    /// What arrived.
    pub event: Event,
}

/// What can arrive from a bus.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event {
    /// A data frame that somebody else sent. Remote, 29-bit and CAN FD frames are left out.
    Frame(Frame),
    /// Something is wrong with the bus, and yet it may go on.
    Error(ErrorEvent),
}

/// Something wrong that a bus reports while it is open.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ErrorEvent {
    /// The controller left the bus after too many errors; nothing is sent or received.
    BusOff,
    /// The controller counts so many errors that it may no longer signal them.
    ErrorPassive,
    /// The controller was restarted after bus-off.
    Restarted,
    /// Frames were received and then lost before they could be read, at this point of the
    /// stream; how many, where that is known.
    LostReception(Option<u32>),
    /// Anything else, in words.
    Other(String),
}

impl std::fmt::Display for ErrorEvent {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::BusOff => formatter.write_str("bus-off: the CAN controller left the bus"),
            Self::ErrorPassive => formatter.write_str("the CAN controller is error passive"),
            Self::Restarted => formatter.write_str("the CAN controller was restarted"),
            Self::LostReception(Some(count)) => write!(formatter, "{count} received frames lost"),
            Self::LostReception(None) => formatter.write_str("received frames lost"),
            Self::Other(words) => formatter.write_str(words),
        }
    }
}

/// Opens the bus at `address`; see the table of the [module](self).
///
/// # Errors
/// [`BusError::Address`] where `address` is none, [`BusError::Simulated`] for `sim`, otherwise
/// why the bus could not be opened and what to do about it.
pub fn open(address: &str) -> Result<Box<dyn Bus>, BusError> {
    address.parse::<Address>()?.open()
}

impl<B: Bus + ?Sized> Bus for Box<B> {
    fn now(&self) -> BusTime {
        (**self).now()
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        (**self).send(frame)
    }

    fn receive(&mut self, until: BusTime) -> Result<Option<Received>, BusError> {
        (**self).receive(until)
    }

    fn description(&self) -> String {
        (**self).description()
    }
}
