//! A CAN controller: what it has to send, and how far it takes part in the bus.

use std::collections::VecDeque;

use canter_shared::wire::frame::Frame;

use super::clock::TrueTime;
use super::fault_confinement::{ErrorCounters, ErrorState, RECOVERY_BITS, RECOVERY_SEQUENCES};

/// The identifier of nothing: above all that there are.
pub(super) const NOTHING: u16 = u16::MAX;

/// A controller that is off the bus and counts itself back.
#[derive(Debug, Clone, Copy)]
struct Recovery {
    /// From when on it counts.
    from: TrueTime,
    /// Sequences of 11 recessive bits that are still to pass.
    sequences: u64,
}

/// The controller of one station.
#[derive(Debug)]
pub(super) struct Controller {
    /// Frames to send, in order. The first is the one that takes part in arbitration.
    queue: VecDeque<Frame>,
    capacity: usize,
    powered: bool,
    counters: ErrorCounters,
    recovery: Option<Recovery>,
    /// It takes frames that begin from here on.
    joined: TrueTime,
    /// It may begin a frame from here on.
    suspended: TrueTime,
    /// Frames that it is to misread, to make double, to lose.
    pub(super) misreads: u32,
    pub(super) doubles: u32,
    pub(super) losses: u32,
}

impl Controller {
    /// One with room for `capacity` frames to send.
    pub(super) fn new(capacity: usize) -> Self {
        Self {
            queue: VecDeque::with_capacity(capacity),
            capacity,
            powered: true,
            counters: ErrorCounters::default(),
            recovery: None,
            joined: TrueTime::default(),
            suspended: TrueTime::default(),
            misreads: 0,
            doubles: 0,
            losses: 0,
        }
    }

    pub(super) fn has_room(&self) -> bool {
        self.queue.len() < self.capacity
    }

    pub(super) fn is_empty(&self) -> bool {
        self.queue.is_empty()
    }

    pub(super) fn push(&mut self, frame: Frame) {
        self.queue.push_back(frame);
    }

    /// The frame that it wants to send next.
    pub(super) fn first(&self) -> Option<&Frame> {
        self.queue.front()
    }

    /// The identifier that it sends once the bus is free, [`NOTHING`] where it sends none.
    pub(super) fn wanted(&self) -> u16 {
        match self.queue.front() {
            Some(frame) if self.is_on_bus() => frame.id(),
            _ => NOTHING,
        }
    }

    pub(super) fn counters(&self) -> ErrorCounters {
        self.counters
    }

    pub(super) fn state(&self) -> ErrorState {
        self.counters.state()
    }

    /// Whether it sends, acknowledges and signals errors.
    pub(super) fn is_on_bus(&self) -> bool {
        self.powered && self.recovery.is_none()
    }

    /// Whether it takes a frame that began at `start`.
    pub(super) fn listens(&self, start: TrueTime) -> bool {
        self.is_on_bus() && self.joined <= start
    }

    pub(super) fn is_powered(&self) -> bool {
        self.powered
    }

    pub(super) fn power_off(&mut self) {
        self.queue.clear();
        self.powered = false;
        self.counters = ErrorCounters::default();
        self.recovery = None;
    }

    pub(super) fn power_on(&mut self, now: TrueTime) {
        self.powered = true;
        self.joined = now;
        self.suspended = now;
    }

    /// Its frame is through.
    pub(super) fn sent(&mut self) {
        self.queue.pop_front();
        self.counters.sent();
    }

    /// Changes the counters; says whether the state changed with them.
    pub(super) fn count(&mut self, event: impl FnOnce(&mut ErrorCounters)) -> bool {
        let before = self.counters.state();
        event(&mut self.counters);
        before != self.counters.state()
    }

    /// An error passive sender lets others go first.
    pub(super) fn suspend_until(&mut self, time: TrueTime) {
        self.suspended = time;
    }

    pub(super) fn suspended(&self) -> TrueTime {
        self.suspended
    }

    /// It is bus-off, and begins to count at `from`.
    pub(super) fn leave(&mut self, from: TrueTime) {
        self.recovery = Some(Recovery {
            from,
            sequences: RECOVERY_SEQUENCES,
        });
    }

    /// When it is back if the bus, recessive since `since`, stays so; `bit` in nanoseconds.
    pub(super) fn back(&self, since: TrueTime, bit: u64) -> Option<TrueTime> {
        let recovery = self.recovery?;
        let from = since.max(recovery.from);
        Some(from.after(recovery.sequences * RECOVERY_BITS * bit))
    }

    /// The bus was recessive from `since` to `until`.
    pub(super) fn count_recessive(&mut self, since: TrueTime, until: TrueTime, bit: u64) {
        if let Some(recovery) = &mut self.recovery {
            let from = since.max(recovery.from);
            let sequences = until.0.saturating_sub(from.0) / (RECOVERY_BITS * bit);
            recovery.sequences = recovery.sequences.saturating_sub(sequences).max(1);
        }
    }

    /// It is back, with counters at zero (rule 12).
    pub(super) fn rejoin(&mut self, now: TrueTime) {
        self.recovery = None;
        self.counters = ErrorCounters::default();
        self.joined = now;
        self.suspended = now;
    }
}
