//! When a controller that went off its bus may come back.
//!
//! ISO 11898-1 lets it join again once it has seen 128 times 11 recessive bits, 1.4 ms at 1 Mbit/s, which
//! the hardware waits for by itself. On a bus that is broken it would then be off again within
//! 32 frames, and disturb whoever is left with their error flags, some hundred times in a second. So it
//! is made to wait before it asks, longer each time.

/// Ticks to wait after the first time.
pub const SHORTEST_WAIT: u16 = 10;

/// The longest wait in ticks: a cable that is put right is noticed before anybody wonders.
pub const LONGEST_WAIT: u16 = 1_280;

/// On the bus for so many ticks, the next time counts as the first.
pub const CALM: u16 = 10_000;

/// Counts the ticks of one controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BusOffRecovery {
    /// Ticks until it may ask to come back; 0 while it is not waiting.
    left: u16,
    /// The next wait.
    wait: u16,
    /// Ticks since it asked last.
    calm: u16,
}

impl BusOffRecovery {
    /// On the bus, and never off it.
    pub const fn new() -> Self {
        Self {
            left: 0,
            wait: SHORTEST_WAIT,
            calm: 0,
        }
    }

    /// Once a tick, with whether the controller went off the bus since the last one. `true` is the
    /// moment to let it join again.
    pub fn tick(&mut self, went_off: bool) -> bool {
        if went_off && self.left == 0 {
            self.left = self.wait;
            self.wait = self.wait.saturating_mul(2).min(LONGEST_WAIT);
            self.calm = 0;
            return false;
        }
        if self.left > 0 {
            self.left -= 1;
            return self.left == 0;
        }
        self.calm = self.calm.saturating_add(1);
        if self.calm >= CALM {
            self.wait = SHORTEST_WAIT;
        }
        false
    }
}

impl Default for BusOffRecovery {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ticks from going off to asking.
    fn wait(recovery: &mut BusOffRecovery) -> u32 {
        assert!(!recovery.tick(true));
        let mut ticks = 1;
        while !recovery.tick(false) {
            ticks += 1;
        }
        ticks
    }

    #[test]
    fn it_waits_longer_each_time_and_never_too_long() {
        let mut recovery = BusOffRecovery::new();
        let waits: [u32; 10] = core::array::from_fn(|_| wait(&mut recovery));
        assert_eq!(waits, [10, 20, 40, 80, 160, 320, 640, 1_280, 1_280, 1_280]);
    }

    #[test]
    fn after_a_calm_time_the_next_wait_is_short_again() {
        let mut recovery = BusOffRecovery::new();
        wait(&mut recovery);
        wait(&mut recovery);
        for _ in 0..CALM - 1 {
            assert!(!recovery.tick(false));
        }
        assert_eq!(wait(&mut recovery), 40);
        for _ in 0..CALM {
            assert!(!recovery.tick(false));
        }
        assert_eq!(wait(&mut recovery), 10);
    }

    #[test]
    fn it_asks_once_and_only_after_going_off() {
        let mut recovery = BusOffRecovery::new();
        assert!((0..100).all(|_| !recovery.tick(false)));
        // Still told to be off while it waits: that is the same time.
        let asked = (0..20).filter(|_| recovery.tick(true)).count();
        assert_eq!(asked, 1);
    }
}
