//! Error counters and error states of a CAN controller.
//!
//! The rules are those of Bosch's CAN specification 2.0 (1991), part B, chapter 8, where they are
//! numbered 1 to 12; ISO 11898-1 has taken them over. Of rule 3 the first exception is here; the
//! second (a stuff error within arbitration) cannot happen, as the bits of ours are never late.
//! Rules 4 to 6, errors within error flags, are left out: the wire is disturbed in frames only.

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

/// What an error of the sender, or a dominant bit after a receiver's flag, counts (rules 2 and 3).
const HEAVY: u16 = 8;

/// Where a receiver that was error passive begins again after a good frame: rule 8 leaves it
/// anything from 119 to 127.
const BACK_FROM_PASSIVE: u16 = 127;

/// Times that 11 recessive bits must pass until a controller that was bus-off is back (rule 12).
pub(super) const RECOVERY_SEQUENCES: u64 = 128;

/// Recessive bits that count once for that.
pub(super) const RECOVERY_BITS: u64 = 11;

/// The two counters of a controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ErrorCounters {
    transmit: u16,
    receive: u16,
}

impl ErrorCounters {
    /// The transmit error counter; it is not counted on above 256.
    pub const fn transmit(self) -> u16 {
        self.transmit
    }

    /// The receive error counter.
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

    /// A frame of its own came to its end (rule 7).
    pub(super) const fn sent(&mut self) {
        self.transmit = self.transmit.saturating_sub(1);
    }

    /// A frame of another came to its end (rule 8).
    pub(super) const fn received(&mut self) {
        self.receive = if self.receive >= PASSIVE {
            BACK_FROM_PASSIVE
        } else {
            self.receive.saturating_sub(1)
        };
    }

    /// It sent, and sends an error flag (rule 3).
    pub(super) const fn transmit_error(&mut self) {
        self.transmit = self.transmit.saturating_add(HEAVY);
    }

    /// Nobody acknowledged what it sent (rule 3): an error passive controller, which may only be
    /// the first to be switched on, does not count that.
    pub(super) const fn not_acknowledged(&mut self) {
        if matches!(self.state(), ErrorState::ErrorActive) {
            self.transmit_error();
        }
    }

    /// It received, and saw an error (rule 1).
    pub(super) const fn receive_error(&mut self) {
        self.receive = self.receive.saturating_add(1);
    }

    /// Others go on with their flags after its own: it was the first to see an error (rule 2).
    pub(super) const fn dominant_after_flag(&mut self) {
        self.receive = self.receive.saturating_add(HEAVY);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(events: impl IntoIterator<Item = fn(&mut ErrorCounters)>) -> ErrorCounters {
        let mut counters = ErrorCounters::default();
        for event in events {
            event(&mut counters);
        }
        counters
    }

    #[test]
    fn sixteen_failures_make_a_sender_passive_and_thirty_two_take_it_off_the_bus() {
        for (failures, state) in [
            (15, ErrorState::ErrorActive),
            (16, ErrorState::ErrorPassive),
            (31, ErrorState::ErrorPassive),
            (32, ErrorState::BusOff),
        ] {
            let counters =
                after((0..failures).map(|_| ErrorCounters::transmit_error as fn(&mut _)));
            assert_eq!(counters.transmit(), 8 * failures);
            assert_eq!(counters.state(), state, "{failures}");
        }
    }

    #[test]
    fn each_good_frame_takes_one_back() {
        let mut counters = after([ErrorCounters::transmit_error, ErrorCounters::receive_error]);
        counters.sent();
        counters.received();
        assert_eq!((counters.transmit(), counters.receive()), (7, 0));
        let mut counters = ErrorCounters::default();
        counters.sent();
        counters.received();
        assert_eq!(counters, ErrorCounters::default());
    }

    #[test]
    fn a_receiver_is_never_off_the_bus_and_is_back_after_one_good_frame() {
        let mut counters = ErrorCounters::default();
        for _ in 0..1_000 {
            counters.receive_error();
            counters.dominant_after_flag();
        }
        assert_eq!(counters.state(), ErrorState::ErrorPassive);
        counters.received();
        assert_eq!(counters.receive(), 127);
        assert_eq!(counters.state(), ErrorState::ErrorActive);
    }

    #[test]
    fn a_sender_without_an_audience_stays_passive() {
        let counters = after((0..1_000).map(|_| ErrorCounters::not_acknowledged as fn(&mut _)));
        assert_eq!(counters.transmit(), 128);
        assert_eq!(counters.state(), ErrorState::ErrorPassive);
    }
}
