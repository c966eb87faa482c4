//! What a board must bring.

use core::sync::atomic::{AtomicU32, Ordering};

use canter_shared::node::AxisSetpoint;
use canter_shared::time::LocalTime;
use canter_shared::wire::frame::Frame;

/// A frame, and when it came.
#[derive(Debug, Clone, Copy)]
pub struct Received {
    /// The frame.
    pub frame: Frame,
    /// When the interrupt or the highest task saw it: the clock's discipline starts from here.
    pub at: LocalTime,
}

/// The receiving half of a CAN bus.
///
/// What goes wrong on the bus is not a result of `receive`: it would have to queue behind frames,
/// and a full queue is one of the things that go wrong. See [`BusMonitor`].
#[expect(
    async_fn_in_trait,
    reason = "the executors here never move a task between threads"
)]
pub trait CanReceive {
    /// The next frame, in the order of arrival.
    async fn receive(&mut self) -> Received;
}

/// The transmitting half of a CAN bus.
#[expect(
    async_fn_in_trait,
    reason = "the executors here never move a task between threads"
)]
pub trait CanTransmit {
    /// Ends when the hardware has taken the frame, which can be never on a bus without a peer.
    async fn transmit(&mut self, frame: &Frame);
}

/// How often something went wrong on the bus since the last look.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BusCounts {
    /// The controller left the bus.
    pub bus_off: u32,
    /// Frames that somebody destroyed with an error flag.
    pub error_frames: u32,
    /// Frames that came and could not be kept.
    pub lost_receptions: u32,
}

/// Watches a bus for faults; the 1 kHz task asks at every tick.
pub trait BusMonitor {
    /// What happened since the last call.
    fn take(&mut self) -> BusCounts;
}

/// Where setpoints go: the drive port.
pub trait SetpointSink {
    /// Called once for each tick with the setpoints of all axes, outside of the node's lock.
    fn put(&mut self, setpoints: &[AxisSetpoint]);
}

/// Resets the chip unless it is fed.
pub trait Watchdog {
    /// Buys another period.
    fn feed(&mut self);
}

/// For a board whose host can end it from outside.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoWatchdog;

impl Watchdog for NoWatchdog {
    fn feed(&mut self) {}
}

/// A counter that interrupts raise and one task empties.
#[derive(Debug, Default)]
pub struct Tally(AtomicU32);

impl Tally {
    /// An empty counter.
    pub const fn new() -> Self {
        Self(AtomicU32::new(0))
    }

    /// One more.
    pub fn raise(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    /// How many since the last call.
    pub fn take(&self) -> u32 {
        self.0.swap(0, Ordering::Relaxed)
    }
}
