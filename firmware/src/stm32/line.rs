//! What belongs to one CAN bus, whatever its controller.

use canter_shared::node::bus_off::BusOffRecovery;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::channel::Channel;

use crate::port::{BusCounts, CanReceive, Received, Tally};

/// Frames that may wait for the receive task. That is held off by a tick and by what it does about the
/// frames before, together far under 1 ms, in which 1 Mbit/s brings at most 21 frames: the shortest, of
/// 11 bits' id and no data, takes 44 bits and 3 between frames, 47 us.
const WAITING: usize = 24;

/// What interrupts leave for the tasks of one bus.
pub struct Line {
    frames: Channel<CriticalSectionRawMutex, Received, WAITING>,
    /// Frames that came and could not be kept.
    pub lost: Tally,
    /// Times that the controller went off the bus.
    pub bus_off: Tally,
    /// Error frames, where the controller does not count them.
    pub error_frames: Tally,
}

impl Line {
    /// Nothing has happened.
    pub const fn new() -> Self {
        Self {
            frames: Channel::new(),
            lost: Tally::new(),
            bus_off: Tally::new(),
            error_frames: Tally::new(),
        }
    }

    /// Keeps a frame for the receive task, or counts it as lost.
    pub fn keep(&self, received: Received) {
        if self.frames.try_send(received).is_err() {
            self.lost.raise();
        }
    }

    /// What happened since the last call; `recover` is called when the controller may ask to come
    /// back after bus-off.
    pub(super) fn take(&self, recovery: &mut BusOffRecovery, recover: impl FnOnce()) -> BusCounts {
        let counts = BusCounts {
            bus_off: self.bus_off.take(),
            error_frames: self.error_frames.take(),
            lost_receptions: self.lost.take(),
        };
        if recovery.tick(counts.bus_off > 0) {
            recover();
        }
        counts
    }
}

impl Default for Line {
    fn default() -> Self {
        Self::new()
    }
}

/// The receive task's end of a line.
pub struct Queue(pub &'static Line);

impl CanReceive for Queue {
    async fn receive(&mut self) -> Received {
        self.0.frames.receive().await
    }
}
