//! Error counters and error states of a CAN controller.
//!
//! The rules are those of Bosch's CAN specification 2.0 (1991), part B, chapter 8, numbered there
//! from 1 to 12; ISO 11898-1 has taken them over. What they leave open, or what no test of ours
//! can see, is decided where it is needed, in `medium`.

/// How far a controller takes part in the bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum ErrorState {
    /// In full: an error that it sees is made known by six dominant bits, which destroy the frame.
    #[default]
    ErrorActive,
    /// It sends and receives, but makes an error known by recessive bits, which disturb nobody, and
    /// waits for 8 more bits after a frame of its own.
    ErrorPassive,
    /// Not at all, until 11 recessive bits have passed 128 times.
    BusOff,
}

/// Counts from which on a controller is error passive (rule 9).
const PASSIVE: u16 = 128;

/// Transmit errors from which on a controller is bus-off (rule 11).
const BUS_OFF: u16 = 256;

/// The receive error count after a good frame where it was above 127 (rule 8 leaves 119 to 127).
const BACK_FROM_PASSIVE: u16 = 127;

/// The two counters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ErrorCounters {
    transmit: u16,
    receive: u16,
}

impl ErrorCounters {
    /// The transmit error counter, 0 to 256 and a little.
    pub const fn transmit(self) -> u16 {
        self.transmit
    }

    /// The receive error counter; above 128 only the next good frame matters, so it stays below 256.
    pub const fn receive(self) -> u16 {
        self.receive
    }

    /// What the counters make of the controller (rules 9 to 11).
    pub const fn state(self) -> ErrorState {
        if self.transmit >= BUS_OFF {
            ErrorState::BusOff
        } else if self.transmit >= PASSIVE || self.receive >= PASSIVE {
            ErrorState::ErrorPassive
        } else {
            ErrorState::ErrorActive
        }
    }
}
