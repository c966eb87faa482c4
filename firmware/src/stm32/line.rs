//! What belongs to one CAN bus, whatever its controller.

use core::sync::atomic::{AtomicU32, Ordering};

use canter_shared::node::bus_off::BusOffRecovery;
use canter_shared::time::LocalTime;
use canter_shared::wire::frame::Frame;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::channel::Channel;

use crate::now;
use crate::port::{BusCounts, BusMonitor, CanReceive, Received, Tally};

/// What interrupts and tasks of one bus leave for each other.
pub struct Line {
    /// Frames that came and could not be kept.
    pub lost: Tally,
    /// Times that the controller went off the bus.
    pub bus_off: Tally,
    /// Error frames, where the controller does not count them.
    pub error_frames: Tally,
    /// Frames that the hardware has taken.
    sent: AtomicU32,
}

impl Line {
    /// Nothing has happened.
    pub const fn new() -> Self {
        Self {
            lost: Tally::new(),
            bus_off: Tally::new(),
            error_frames: Tally::new(),
            sent: AtomicU32::new(0),
        }
    }

    /// The hardware has taken a frame.
    pub(super) fn count_sent(&self) {
        self.sent.fetch_add(1, Ordering::Relaxed);
    }
}

impl Default for Line {
    fn default() -> Self {
        Self::new()
    }
}

/// What a monitor does to its controller.
pub trait Controller {
    /// Lets it back onto the bus: the hardware then waits for 128 times 11 recessive bits.
    fn recover(&mut self);

    /// Error frames that the hardware has counted since the last call.
    fn error_frames(&mut self) -> u32;

    /// Whether frames wait in the hardware to be sent.
    fn is_sending(&self) -> bool;

    /// Throws away what waits in the hardware, and wakes whoever waits for room there.
    fn discard(&mut self);
}

/// Watches one bus, once a tick.
pub struct Monitor<C> {
    controller: C,
    line: &'static Line,
    recovery: BusOffRecovery,
    /// How many ticks old a frame may become in the hardware, and what is known of that.
    staleness: Option<Staleness>,
}

/// Ticks that a setpoint may wait in the hardware: so many that a slow bus gets its frames sent, and far
/// fewer than a drive's own time-out. A drive that is plugged in again must not be told an old place.
const STALE: u8 = 5;

#[derive(Default)]
struct Staleness {
    sent: u32,
    ticks: u8,
}

impl<C: Controller> Monitor<C> {
    /// Watches the host's bus: an old report is still true.
    pub(super) const fn of_host(controller: C, line: &'static Line) -> Self {
        Self {
            controller,
            line,
            recovery: BusOffRecovery::new(),
            staleness: None,
        }
    }

    /// Watches the drives' bus: an old setpoint is not.
    pub(super) fn of_drives(controller: C, line: &'static Line) -> Self {
        Self {
            staleness: Some(Staleness::default()),
            ..Self::of_host(controller, line)
        }
    }

    fn discard_stale(&mut self) {
        let Some(staleness) = &mut self.staleness else {
            return;
        };
        let sent = self.line.sent.load(Ordering::Relaxed);
        if sent != staleness.sent || !self.controller.is_sending() {
            *staleness = Staleness { sent, ticks: 0 };
            return;
        }
        staleness.ticks += 1;
        if staleness.ticks >= STALE {
            staleness.ticks = 0;
            self.controller.discard();
        }
    }
}

impl<C: Controller> BusMonitor for Monitor<C> {
    fn take(&mut self) -> BusCounts {
        let bus_off = self.line.bus_off.take();
        if self.recovery.tick(bus_off > 0) {
            self.controller.recover();
        }
        self.discard_stale();
        BusCounts {
            bus_off,
            error_frames: self.line.error_frames.take() + self.controller.error_frames(),
            lost_receptions: self.line.lost.take(),
        }
    }
}

/// Both buses. A drives' bus that fails is as bad as the host's: nothing can be led to rest over it.
pub struct Both<C>(pub Monitor<C>, pub Monitor<C>);

impl<C: Controller> BusMonitor for &mut Both<C> {
    fn take(&mut self) -> BusCounts {
        let [host, drives] = [self.0.take(), self.1.take()];
        BusCounts {
            bus_off: host.bus_off + drives.bus_off,
            error_frames: host.error_frames + drives.error_frames,
            lost_receptions: host.lost_receptions + drives.lost_receptions,
        }
    }
}

/// Frames that may wait for the receive task. It is held off by
///
/// ```text
/// a tick, its setpoints and the drives' frames      3 x 3 000 instructions = 0.07 ms
/// a plan that is taken or put back                      4 000 instructions = 0.03 ms
///                                                                            0.10 ms
/// ```
///
/// at 170 MHz and 1.3 cycles each, in which 1 Mbit/s brings 3 frames: the shortest, of 11 bits' id and no
/// data, takes 44 bits and 3 between frames, 47 us. What it does about a frame takes less than that, so
/// the queue empties again; 10 are three times as much.
const WAITING: usize = 10;

/// Frames between the task that takes them out of the hardware and the one that hands them to the node.
///
/// They are kept with the lower half of their time only, which is enough for an hour: RAM is short.
pub struct Queue(Channel<CriticalSectionRawMutex, (Frame, u32), WAITING>);

impl Queue {
    /// Empty.
    pub const fn new() -> Self {
        Self(Channel::new())
    }

    /// Takes frames out of the hardware, as fast as they come. What there is no room for is counted.
    pub async fn fill(&self, mut hardware: impl CanReceive, line: &Line) -> ! {
        loop {
            let Received { frame, at } = hardware.receive().await;
            if self.0.try_send((frame, at.0 as u32)).is_err() {
                line.lost.raise();
            }
        }
    }
}

impl Default for Queue {
    fn default() -> Self {
        Self::new()
    }
}

impl CanReceive for &Queue {
    async fn receive(&mut self) -> Received {
        let (frame, at) = self.0.receive().await;
        let now = now();
        let age = (now.0 as u32).wrapping_sub(at);
        let at = LocalTime(now.0.saturating_sub(age.into()));
        Received { frame, at }
    }
}
