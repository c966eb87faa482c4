//! Why a node had to begin anew, and the words that tell it over the reset.

use super::Node;
use crate::axis::fault::Fault;
use crate::drive::Drive;

/// Why a node began anew without having been asked to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Restart {
    /// Its program found something that cannot be.
    Panic,
    /// The processor could not go on: a hard fault, or an interrupt that nobody waits for.
    HardFault,
    /// The watchdog was not fed.
    Watchdog,
}

impl Restart {
    /// The fault that every axis of the node then has.
    pub const fn fault(self) -> Fault {
        match self {
            Self::Panic => Fault::NodePanic,
            Self::HardFault => Fault::NodeHardFault,
            Self::Watchdog => Fault::WatchdogReset,
        }
    }
}

/// How a run of the node ended, as it is kept in memory that a reset leaves alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crash {
    /// Why.
    pub restart: Restart,
    /// Where: the address that a panic was called from, a hard fault's program counter, or the number of an
    /// interrupt; where the stack was, if it was full.
    pub place: u32,
}

/// What kept words begin with: "cnt!".
const MAGIC: u32 = u32::from_le_bytes(*b"cnt!");

impl Crash {
    /// The words to keep: magic, cause, place, check.
    ///
    /// Memory holds anything after power-on, and passes for a crash with a chance of 2^-64: the magic
    /// and the check. A CRC would find no more, because a reset tears no word that has been written.
    pub const fn words(self) -> [u32; 4] {
        let cause = match self.restart {
            Restart::Panic => 1,
            Restart::HardFault => 2,
            Restart::Watchdog => 3,
        };
        [MAGIC, cause, self.place, check(cause, self.place)]
    }

    /// What was kept; `None` where nothing was.
    pub const fn from_words(words: [u32; 4]) -> Option<Self> {
        let [magic, cause, place, kept] = words;
        let restart = match cause {
            1 => Restart::Panic,
            2 => Restart::HardFault,
            3 => Restart::Watchdog,
            _ => return None,
        };
        if magic == MAGIC && kept == check(cause, place) {
            Some(Self { restart, place })
        } else {
            None
        }
    }
}

const fn check(cause: u32, place: u32) -> u32 {
    !(MAGIC.rotate_left(7) ^ cause.rotate_left(16) ^ place)
}

impl<D: Drive, const AXES: usize> Node<D, AXES> {
    /// Says that the node began anew by itself: no axis may move as if nothing had happened.
    pub fn restart_after(&mut self, restart: Restart) {
        for slot in &mut self.slots {
            slot.axis.raise(restart.fault());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crash_comes_back_as_it_was_kept() {
        for restart in [Restart::Panic, Restart::HardFault, Restart::Watchdog] {
            for place in [0, 401, 0x0800_1234, u32::MAX] {
                let crash = Crash { restart, place };
                assert_eq!(Crash::from_words(crash.words()), Some(crash));
            }
        }
    }

    #[test]
    fn memory_that_holds_anything_else_is_no_crash() {
        let words = Crash {
            restart: Restart::Panic,
            place: 7,
        }
        .words();
        for word in 0..4 {
            for bit in 0..32 {
                let mut other = words;
                other[word] ^= 1 << bit;
                assert_eq!(Crash::from_words(other), None, "word {word}, bit {bit}");
            }
        }
        for same in [0, u32::MAX, MAGIC] {
            assert_eq!(Crash::from_words([same; 4]), None);
        }
    }
}
