//! A device's estimate of bus time, disciplined by SYNC.
//!
//! Each SYNC carries the bus time at which it was sent. It can arrive late, on a host with an
//! ordinary kernel by milliseconds, but never early. So of each window of SYNCs only the one with
//! the least delay counts. It corrects the offset by half of its error; the rate comes from the
//! longest stretch of time between two such SYNCs, over which their delays matter least. Where even
//! the best one of a window seems late, it is not believed. What delay is left, the frame's own
//! length on the bus among it, is the same for all nodes and so does not move them against each
//! other.

use super::{BusTime, LocalTime, MICROSECONDS_PER_TICK};

/// SYNCs of which the least delayed one counts: at the host's 50 Hz a correction every 160 ms.
const WINDOW: u8 = 8;

/// An error beyond this cannot be drift, so the clock is set anew, in microseconds: crystals of
/// +-100 ppm part by 200 us in a second, and a reception is late by some milliseconds at most.
const STEP: i64 = 50_000;

/// The largest rate correction: 500 ppm in units of 2^-32.
const LARGEST_RATE: i64 = (1 << 32) / 2_000;

/// Two crystals part by at most 1 / 5000, 200 ppm: while axes move the clock gives way no faster.
const DRIFT: i64 = 5_000;

/// The least delay in a window varies by this much on a quiet bus, in microseconds: an error
/// beyond it and drift together is delay.
const JITTER: i64 = 20;

/// A window's error moves the offset by half of itself, a new rate the old one by half of their
/// difference.
const SHIFT: u32 = 1;

/// The least stretch that a rate is taken from, in microseconds: jitter over 25 ms is some 100 ppm.
const SHORTEST_STRETCH: u64 = 25_000;

/// The longest stretch: over 8 s a crystal's own rate may change with its temperature.
const LONGEST_STRETCH: u64 = 8_000_000;

/// Windows in a row that cannot all have come late: then it is the clock that is wrong.
const DOUBTS: u8 = 8;

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

/// A SYNC: when it was sent and when it arrived.
#[derive(Debug, Clone, Copy)]
struct Sample {
    received: LocalTime,
    sent: BusTime,
    /// Bus time minus the clock's estimate without its slew, in microseconds.
    error: i64,
}

/// Maps a device's own clock to bus time.
#[derive(Debug, Clone)]
pub struct BusClock {
    local: LocalTime,
    bus: BusTime,
    /// How much faster than the local clock the bus runs, in units of 2^-32.
    rate: i64,
    /// What is still to be made up for, at one microsecond in each [`DRIFT`].
    slew: i64,
    synchronised: bool,
    samples: u8,
    /// Windows in a row whose best SYNC was not believed.
    doubts: u8,
    /// The least delayed SYNC of the window, and when the window began.
    best: Option<Sample>,
    window_start: LocalTime,
    /// Where the stretch begins that the rate is taken from, and where the next one will.
    anchor: Option<Sample>,
    next_anchor: Option<Sample>,
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
            slew: 0,
            synchronised: false,
            samples: 0,
            doubts: 0,
            best: None,
            window_start: LocalTime(0),
            anchor: None,
            next_anchor: None,
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
        // The correction belongs to the local time; the first guess of that is off by a 1000th.
        let guess = elapsed.saturating_sub(self.correction(elapsed));
        let corrected = elapsed.saturating_sub(self.correction(guess));
        LocalTime(self.local.0.saturating_add_signed(corrected))
    }

    fn correction(&self, elapsed: i64) -> i64 {
        // The rate is below 2^22 and the time since the last SYNC below 2^41 us, 25 days.
        let bounded = elapsed.clamp(-(1 << 41), 1 << 41);
        ((bounded * self.rate) >> 32) + self.made_up(bounded)
    }

    /// How much of the slew is done after some time.
    fn made_up(&self, elapsed: i64) -> i64 {
        let slew = self.slew.unsigned_abs();
        let elapsed = elapsed.max(0).unsigned_abs();
        // Every tick asks, so the division is of 32 bits wherever there is anything to divide.
        let done = match u32::try_from(elapsed) {
            _ if elapsed >= slew.saturating_mul(DRIFT.unsigned_abs()) => slew,
            Ok(elapsed) => u64::from(elapsed / DRIFT as u32),
            Err(_) => elapsed / DRIFT.unsigned_abs(),
        };
        if self.slew < 0 {
            -(done as i64)
        } else {
            done as i64
        }
    }

    /// Takes a SYNC that was sent at `sent` and arrived at `received`; `may_step` says that
    /// nothing moves, so that the clock may jump. Otherwise it runs at most 200 ppm faster or
    /// slower than its rate, however many SYNCs come and whatever they say.
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
            self.slew = 0;
            self.anchor = None;
            self.next_anchor = None;
            self.begin_window(received);
            return Discipline::Stepped;
        }
        let elapsed = received.since(self.local) as i64;
        let sample = Sample {
            received,
            sent,
            error: error.saturating_add(self.made_up(elapsed)),
        };
        let best = match self.best {
            Some(best) if best.error >= sample.error => best,
            _ => sample,
        };
        self.best = Some(best);
        self.samples = self.samples.saturating_add(1);
        // A window that is too short to know anything from grows: its rounding would count.
        if self.samples < WINDOW || received.since(self.window_start) < SHORTEST_STRETCH {
            return Discipline::Sampled;
        }
        let discipline = self.correct(received, best, may_step);
        self.begin_window(received);
        discipline
    }

    /// Corrects offset and rate at the end of a window with its best sample.
    ///
    /// The offset is not set but made up for slowly: ticks follow the clock, and the speed of
    /// axes follows the ticks.
    fn correct(&mut self, now: LocalTime, best: Sample, may_step: bool) -> Discipline {
        let length = now.since(self.window_start).max(MICROSECONDS_PER_TICK) as i64;
        let drift = length / DRIFT;
        let bound = drift + JITTER;
        let error = best.error - self.made_up(now.since(self.local) as i64);
        let late = error > bound && may_step;
        self.bus = self.bus_time(now);
        self.local = now;
        if late {
            // The clock was set by a SYNC that came late; what is known of its rate is as wrong.
            self.anchor = None;
            self.next_anchor = None;
            self.bus = BusTime(self.bus.0.saturating_add_signed(error));
            self.slew = 0;
            return Discipline::Stepped;
        }
        self.slew = (error >> SHIFT).clamp(-drift, drift);
        if error.abs() <= bound {
            self.doubts = 0;
            self.learn_rate(best);
        } else if self.doubts < DOUBTS {
            self.doubts += 1;
        } else {
            self.doubts = 0;
            self.rate = 0;
            self.anchor = None;
            self.next_anchor = None;
            if may_step {
                self.bus = BusTime(self.bus.0.saturating_add_signed(error));
                self.slew = 0;
                return Discipline::Stepped;
            }
        }
        Discipline::Corrected
    }

    /// Takes the rate from the stretch between the anchor and this sample.
    fn learn_rate(&mut self, best: Sample) {
        let Some(anchor) = self.anchor else {
            self.anchor = Some(best);
            return;
        };
        let stretch = best.received.since(anchor.received);
        if stretch < SHORTEST_STRETCH {
            return;
        }
        let gained = (best.sent.0.wrapping_sub(anchor.sent.0) as i64).wrapping_sub(stretch as i64);
        // Both are within +-STEP of each other for each window: 2^16 << 32 fits with room.
        let bounded = gained.clamp(-STEP, STEP);
        let measured = ((bounded << 32) / stretch as i64).clamp(-LARGEST_RATE, LARGEST_RATE);
        self.rate += (measured - self.rate) >> SHIFT;
        if stretch >= LONGEST_STRETCH / 2 && self.next_anchor.is_none() {
            self.next_anchor = Some(best);
        }
        if stretch >= LONGEST_STRETCH {
            self.anchor = self.next_anchor.take();
        }
    }

    fn begin_window(&mut self, now: LocalTime) {
        self.samples = 0;
        self.best = None;
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
            let late = if seed >> 62 == 0 {
                0
            } else {
                (seed >> 33) % 5_000
            };
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
