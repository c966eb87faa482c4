//! True time, and the crystals that do not quite show it.

use canter_shared::time::{BusTime, LocalTime};

use super::random::SplitMix64;

const PER_SECOND: u64 = 1_000_000_000;
const PER_MICROSECOND: u64 = 1_000;

/// How long before the host a node may have been switched on, in nanoseconds: 10 s.
const EARLIEST_START: u64 = 10 * PER_SECOND;

/// The worst crystal, in ppm: no node could follow a bus with one.
const WORST: u32 = 10_000;

/// The time of the simulation in nanoseconds, from 0 at its start. The host's clock shows it
/// exactly, so it is what bus time should be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct TrueTime(pub u64);

/// After all that happens.
pub(super) const NEVER: TrueTime = TrueTime(u64::MAX);

impl TrueTime {
    /// As the host sees it: whole microseconds that have passed.
    pub const fn bus_time(self) -> BusTime {
        BusTime(self.0 / PER_MICROSECOND)
    }

    /// The least true time at which the host sees `time`.
    pub const fn of(time: BusTime) -> Self {
        Self(time.0.saturating_mul(PER_MICROSECOND))
    }

    pub(super) const fn after(self, nanoseconds: u64) -> Self {
        Self(self.0.saturating_add(nanoseconds))
    }
}

/// A node's own clock: it started before the host's and runs a little fast or slow.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crystal {
    /// True time from which on it counts.
    origin: TrueTime,
    /// What it shows then, in nanoseconds.
    offset: u64,
    /// How much it runs fast, in parts per 10^9.
    error: i64,
}

impl Crystal {
    /// One whose error is at most `spread` ppm, or [`WORST`] if that is less.
    pub(super) fn new(random: &mut SplitMix64, spread: u32) -> Self {
        let spread = u64::from(spread.min(WORST)) * 1_000;
        Self {
            origin: TrueTime::default(),
            offset: random.up_to(EARLIEST_START),
            error: random.up_to(2 * spread) as i64 - spread as i64,
        }
    }

    /// Begins at zero, after a reset at `now`.
    pub(super) fn restart(&mut self, now: TrueTime) {
        self.origin = now;
        self.offset = 0;
    }

    /// A number that no other node has.
    pub(super) fn seed(&self) -> u64 {
        self.offset
    }

    pub(super) fn local(&self, time: TrueTime) -> LocalTime {
        LocalTime(self.shown(time) / PER_MICROSECOND)
    }

    fn shown(&self, time: TrueTime) -> u64 {
        // Seconds and rest apart: their products fit in 64 bits for as long as the time does.
        let time = time.0.saturating_sub(self.origin.0);
        let (seconds, rest) = (time / PER_SECOND, time % PER_SECOND);
        let gained = (seconds as i64).saturating_mul(self.error)
            + (rest as i64 * self.error).div_euclid(PER_SECOND as i64);
        self.offset
            .saturating_add(time)
            .saturating_add_signed(gained)
    }

    /// The least true time at which the clock shows `local`; its beginning where it always has.
    pub(super) fn when(&self, local: LocalTime) -> TrueTime {
        let wanted = local.0.saturating_mul(PER_MICROSECOND);
        let since_start = wanted.saturating_sub(self.offset);
        let rate = PER_SECOND.saturating_add_signed(self.error);
        let estimate = u128::from(since_start) * u128::from(PER_SECOND) / u128::from(rate);
        // Rounding makes the estimate wrong by a nanosecond or two.
        let mut time = u64::try_from(estimate)
            .unwrap_or(u64::MAX)
            .saturating_sub(2)
            .saturating_add(self.origin.0);
        while self.shown(TrueTime(time)) < wanted && time < u64::MAX {
            time += 1;
        }
        TrueTime(time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_moment_at_which_a_clock_shows_a_time_is_the_first() {
        for error in [-100_000, -1, 0, 1, 77_777, 100_000] {
            let crystal = Crystal {
                origin: TrueTime(98_765),
                offset: 123_456_789,
                error,
            };
            for step in 0..2_000 {
                let local = LocalTime(123_457 + step * 777_777_777);
                let time = crystal.when(local);
                assert!(crystal.local(time) >= local);
                assert!(time == crystal.origin || crystal.local(TrueTime(time.0 - 1)) < local);
            }
            assert_eq!(crystal.when(LocalTime(0)), crystal.origin);
        }
    }
}
