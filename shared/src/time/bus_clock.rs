//! A device's estimate of bus time, disciplined by SYNC.
//!
//! Each SYNC carries the bus time at which it was sent. It can arrive late, on a host with an
//! ordinary kernel by milliseconds, but never early. So of each window of SYNCs only the one with
//! the least delay counts; and where even that one seems late, the clock gives way no faster than
//! two crystals can part. A proportional and integral correction sets offset and rate. What delay
//! is left, the frame's own length on the bus among it, is the same for all nodes and so does not
//! move them against each other.

use super::{BusTime, LocalTime, MICROSECONDS_PER_TICK};

/// SYNCs of which the least delayed one counts: at the host's 50 Hz a correction every 160 ms.
const WINDOW: u8 = 8;

/// An error beyond this cannot be drift, so the clock is set anew, in microseconds: crystals of
/// +-100 ppm part by 200 us in a second, and a reception is late by some milliseconds at most.
const STEP: i64 = 50_000;

/// The largest rate correction: 500 ppm in units of 2^-32.
const LARGEST_RATE: i64 = (1 << 32) / 2_000;

/// Two crystals part by at most 1 / 5000, 200 ppm: an error beyond that is delay, not drift.
const DRIFT: i64 = 5_000;

/// A window's drift moves the offset by half of itself.
const PROPORTIONAL_SHIFT: u32 = 1;

/// A window's drift, taken over the window's length, moves the rate by an eighth of itself.
const INTEGRAL_SHIFT: u32 = 3;

/// What a SYNC did to the clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Discipline {
    /// The sample was kept for its window.
    Sampled,
    /// The window is full; offset and rate were corrected by at most some milliseconds.
    Corrected,
    /// The clock was far off, or was never set, and now shows another time.
    Stepped,
    /// The clock is far off, but must not be set while axes move.
    Refused,
}

/// Maps a device's own clock to bus time.
#[derive(Debug, Clone)]
pub struct BusClock {
    local: LocalTime,
    bus: BusTime,
    /// How much faster than the local clock the bus runs, in units of 2^-32.
    rate: i64,
    synchronised: bool,
    samples: u8,
    /// The greatest bus time minus estimate in the window, and when it was seen.
    best: i64,
    window_start: LocalTime,
}

impl Default for BusClock {
    fn default() -> Self {
        Self::new()
    }
}

impl BusClock {
    /// A clock that shows the local time until the first SYNC.
    pub const fn new() -> Self {
        Self {
            local: LocalTime(0),
            bus: BusTime(0),
            rate: 0,
            synchronised: false,
            samples: 0,
            best: i64::MIN,
            window_start: LocalTime(0),
        }
    }

    /// Whether a SYNC has set the clock.
    pub const fn is_synchronised(&self) -> bool {
        self.synchronised
    }

    /// Bus time at a local time.
    pub fn bus_time(&self, local: LocalTime) -> BusTime {
        let elapsed = local.0.wrapping_sub(self.local.0) as i64;
        let corrected = elapsed.saturating_add(self.correction(elapsed));
        BusTime(self.bus.0.saturating_add_signed(corrected))
    }

    /// The least local time at which [`Self::bus_time`] shows at least `bus`, give or take 1 us.
    pub fn local_time(&self, bus: BusTime) -> LocalTime {
        let elapsed = bus.0.wrapping_sub(self.bus.0) as i64;
        let corrected = elapsed.saturating_sub(self.correction(elapsed));
        LocalTime(self.local.0.saturating_add_signed(corrected))
    }

    fn correction(&self, elapsed: i64) -> i64 {
        // The rate is below 2^22 and the time since the last SYNC below 2^41 us, 25 days.
        let bounded = elapsed.clamp(-(1 << 41), 1 << 41);
        (bounded * self.rate) >> 32
    }

    /// Takes a SYNC that was sent at `sent` and arrived at `received`; `may_step` says that
    /// nothing moves, so that the clock may jump.
    pub fn synchronise(
        &mut self,
        received: LocalTime,
        sent: BusTime,
        may_step: bool,
    ) -> Discipline {
        let error = sent.0.wrapping_sub(self.bus_time(received).0) as i64;
        if !self.synchronised || error.saturating_abs() > STEP {
            if !may_step {
                return Discipline::Refused;
            }
            self.synchronised = true;
            self.local = received;
            self.bus = sent;
            self.rate = 0;
            self.begin_window(received);
            return Discipline::Stepped;
        }
        self.best = self.best.max(error);
        self.samples += 1;
        if self.samples < WINDOW {
            return Discipline::Sampled;
        }
        let length = received.since(self.window_start).max(MICROSECONDS_PER_TICK) as i64;
        let drift = self.best.clamp(-length / DRIFT, length / DRIFT);
        // A clock that is behind by more than drift was set by a SYNC that came late.
        let offset = if self.best > drift {
            self.best
        } else {
            drift >> PROPORTIONAL_SHIFT
        };
        // The drift is a 5000th of the length, so the quotient is below 2^32 / 5000.
        let rate = ((drift << 32) / length) >> INTEGRAL_SHIFT;
        self.bus = BusTime(self.bus_time(received).0.saturating_add_signed(offset));
        self.local = received;
        self.rate = (self.rate + rate).clamp(-LARGEST_RATE, LARGEST_RATE);
        self.begin_window(received);
        Discipline::Corrected
    }

    fn begin_window(&mut self, now: LocalTime) {
        self.samples = 0;
        self.best = i64::MIN;
        self.window_start = now;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A crystal 100 ppm fast, an offset of an hour, receptions late by up to 5 ms.
    #[test]
    fn follows_a_crystal_through_jitter() {
        let mut clock = BusClock::new();
        let mut seed = 1u64;
        let mut worst = 0i64;
        for step in 0..3_000u64 {
            let bus = 3_600_000_000 + step * 20_000;
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            // One in four arrives at once.
            let late = if seed >> 62 == 0 { 0 } else { (seed >> 33) % 5_000 };
            let local = |bus: u64| LocalTime(1_000 + (bus - 3_600_000_000) * 10_001 / 10_000);
            clock.synchronise(local(bus + late), BusTime(bus), true);
            if step > 1_000 {
                let shown = clock.bus_time(local(bus));
                worst = worst.max((shown.0 as i64 - bus as i64).abs());
            }
        }
        assert!(worst <= 150, "off by {worst} us");
    }

    #[test]
    fn never_steps_while_axes_move() {
        let mut clock = BusClock::new();
        clock.synchronise(LocalTime(0), BusTime(1_000_000), true);
        let before = clock.bus_time(LocalTime(10));
        for wild in [0, 5_000_000, u64::MAX] {
            assert_eq!(
                clock.synchronise(LocalTime(10), BusTime(wild), false),
                Discipline::Refused
            );
            assert_eq!(clock.bus_time(LocalTime(10)), before);
        }
    }

    #[test]
    fn local_and_bus_time_are_inverse() {
        let mut clock = BusClock::new();
        clock.synchronise(LocalTime(7), BusTime(1_000_000), true);
        clock.rate = 429_496; // 100 ppm
        for bus in (1_000_000..50_000_000).step_by(999_983) {
            let back = clock.bus_time(clock.local_time(BusTime(bus)));
            assert!(back.0.abs_diff(bus) <= 1, "{back:?} for {bus}");
        }
    }
}
