//! Whose SYNCs count.
//!
//! A bus has one clock, so a node follows one host. Its SYNCs are known by their counter, which
//! goes on from one to the next, and by their time, which is near the one that the node's clock
//! shows. Another host's are ignored for as long as the followed one is heard.

use super::STEP;
use crate::time::LocalTime;

/// The followed host may lose as many SYNCs in a row but one: 0.3 s of them.
const LARGEST_GAP: u8 = 16;

/// A SYNC of the followed host that is ahead by up to this, in microseconds, says that those before
/// were late by as much: a host's process, or an emulated node, can be held up for a second.
const LATEST: i64 = 1_000_000;

/// Silence after which the next SYNC is followed, whosever it is, in microseconds: 25 SYNCs at the
/// usual 50 Hz.
const SILENCE: u64 = 500_000;

/// A SYNC that tells the same time within this, in microseconds, is as good as the followed host's:
/// the next program on the same machine has the same clock, and counts from anywhere. What it is
/// late by is seen to as for every SYNC.
const AGREEMENT: i64 = 1_000;

/// The host that a clock follows.
#[derive(Debug, Clone)]
pub(super) struct Source {
    counter: u8,
    heard: LocalTime,
}

impl Source {
    pub(super) const fn new() -> Self {
        Self {
            counter: 0,
            heard: LocalTime(0),
        }
    }

    /// When its last SYNC arrived.
    pub(super) const fn heard(&self) -> LocalTime {
        self.heard
    }

    /// Whether it has been silent for so long that it counts as gone.
    pub(super) fn is_silent(&self, now: LocalTime) -> bool {
        now.since(self.heard) >= SILENCE
    }

    /// Whether a SYNC counts that is off by `error` microseconds.
    pub(super) fn is_followed(&self, received: LocalTime, counter: u8, error: i64) -> bool {
        if self.is_silent(received) {
            return true;
        }
        match counter.wrapping_sub(self.counter) {
            // The same one twice.
            0 => false,
            1..=LARGEST_GAP => (-STEP..=LATEST).contains(&error),
            _ => error.abs() <= AGREEMENT,
        }
    }

    pub(super) fn follow(&mut self, received: LocalTime, counter: u8) {
        self.counter = counter;
        self.heard = received;
    }
}
