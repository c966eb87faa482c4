//! Time as integers: the bus clock in microseconds, and the tick of 1 ms that setpoints live on.
//!
//! Two clocks are told apart by type. [`LocalTime`] is what a device's own crystal shows;
//! [`BusTime`] is what all devices on a bus agree on, carried by SYNC. [`bus_clock::BusClock`]
//! maps one to the other. A [`Tick`] is a whole millisecond of bus time, so every node that
//! evaluates a trajectory at tick k evaluates it at the same instant.

use crate::units::floor;
pub mod bus_clock;

/// Microseconds in one tick: setpoints leave at 1 kHz.
pub const MICROSECONDS_PER_TICK: u64 = 1_000;

/// Ticks in one second.
pub const TICKS_PER_SECOND: u64 = 1_000_000 / MICROSECONDS_PER_TICK;

/// The longest duration of one move, in ticks: 22 bits, about 70 minutes.
pub const LONGEST_MOVE: Ticks = Ticks((1 << 22) - 1);

/// A device's own monotonic clock, in microseconds from any origin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct LocalTime(pub u64);

/// The clock that all devices on a bus agree on, in microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct BusTime(pub u64);

/// A whole millisecond of bus time, counted from bus time zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Tick(pub u64);

/// A duration in ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Ticks(pub u32);

impl LocalTime {
    /// Microseconds from `earlier` to here; zero where `earlier` is later.
    #[inline(never)]
    pub const fn since(self, earlier: Self) -> u64 {
        self.0.saturating_sub(earlier.0)
    }
}

impl BusTime {
    /// The first tick that is not before this instant.
    #[inline(never)]
    pub const fn next_tick(self) -> Tick {
        Tick(self.0.div_ceil(MICROSECONDS_PER_TICK))
    }
}

impl Tick {
    /// The instant of the tick.
    #[inline(never)]
    pub const fn time(self) -> BusTime {
        BusTime(self.0.saturating_mul(MICROSECONDS_PER_TICK))
    }

    /// The tick `ticks` later.
    #[inline(never)]
    pub const fn after(self, ticks: Ticks) -> Self {
        Self(self.0.saturating_add(ticks.0 as u64))
    }

    /// Ticks from `earlier` to here; zero where `earlier` is later, and at most `u32::MAX`.
    #[inline(never)]
    pub const fn since(self, earlier: Self) -> Ticks {
        let ticks = self.0.saturating_sub(earlier.0);
        let fits = ticks >> 32 == 0;
        Ticks(if fits { ticks as u32 } else { u32::MAX })
    }
}

impl Ticks {
    /// In seconds.
    pub fn seconds(self) -> f64 {
        f64::from(self.0) / TICKS_PER_SECOND as f64
    }

    /// The least whole number of ticks that lasts at least `seconds`; `None` for a negative
    /// value, for one that is not a number, and for one beyond [`LONGEST_MOVE`].
    pub fn from_seconds_ceil(seconds: f64) -> Option<Self> {
        let ticks = seconds * TICKS_PER_SECOND as f64;
        let fits = ticks > -1.0 && ticks <= f64::from(LONGEST_MOVE.0);
        fits.then(|| Self(-floor(-ticks) as u32))
    }
}
