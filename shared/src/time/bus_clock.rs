//! A device's estimate of bus time, disciplined by SYNC.
//!
//! Each SYNC carries the bus time at which it was sent. It can arrive late, on a host with an
//! ordinary kernel by milliseconds, but never early. So of each window of SYNCs only the one with
//! the least delay counts, and a line through the last of these gives offset and rate. What seems
//! late beyond what crystals and receivers can do is not believed. What delay is left, the frame's
//! own length on the bus among it, is the same for all nodes and so does not move them against
//! each other.
//!
//! | file | what it holds |
//! |---|---|
//! | `source` | whose SYNCs count, where there is more than one host |
//! | `history` | the best SYNCs of the last seconds, and the line through them |

mod history;
mod source;
#[cfg(test)]
mod tests;

use super::{BusTime, LocalTime};
use history::{History, Line, Sample};
use source::Source;

/// An error beyond this cannot be drift, so the clock is set anew, in microseconds: crystals of
/// +-100 ppm part by 200 us in a second, and a reception is late by some milliseconds at most.
const STEP: i64 = 50_000;

/// The largest rate correction: 500 ppm in units of 2^-32.
const LARGEST_RATE: i64 = (1 << 32) / 2_000;

/// What the clock makes up for while axes move: 200 ppm, as two crystals part by, in units of
/// 2^-32.
const SLEW: i64 = (1 << 32) / 5_000;

/// The least delay in a window varies by this much on a quiet bus, in microseconds: an error
/// beyond it and drift together is delay.
const JITTER: i64 = 20;

/// A point that is farther off than this is not on one line with those before, in microseconds.
const FITTING: i64 = 2 * JITTER;

/// While the rate is not known the clock may part from the bus by 1 / 5000, 200 ppm; once it is
/// known, by 50 ppm, which leaves room for a crystal that warms up.
const UNKNOWN_DRIFT: u32 = 5_000;
const KNOWN_DRIFT: u32 = 20_000;

/// Points of the history from which on the rate counts as known.
const KNOWN_POINTS: usize = 8;

/// Up to this, in microseconds, a step at rest leaves out no tick and runs none twice, it only
/// moves the next one: half a tick.
const SMALL_STEP: i64 = 500;

/// SYNCs that the best one is chosen from at least.
const LEAST_SAMPLES: u8 = 2;

/// Windows in a row that cannot all have come late: then it is the clock that is wrong.
const DOUBTS: u8 = 8;

/// The longest time that rates are reckoned over, in microseconds, so that products fit: 12 days.
const LONGEST: i64 = 1 << 40;

/// The largest error that is told, in microseconds, so that it fits: 18 minutes.
const FARTHEST: i64 = 1 << 30;

/// One microsecond, as the clock reckons inside: in units of 2^-32.
const FINE: u32 = 32;

/// What a SYNC did to the clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Discipline {
    /// Another host's, or one that came twice: it did nothing.
    Ignored,
    /// The sample was kept for its window.
    Sampled,
    /// The window is full and offset and rate were corrected; at rest by less than a tick.
    Corrected,
    /// The clock was far off, or was never set, and now shows another time.
    Stepped,
    /// The clock is far off, but must not be set while axes move.
    Refused,
}

/// Maps a device's own clock to bus time.
#[derive(Debug, Clone)]
pub struct BusClock {
    /// One instant on both clocks, the bus's with a fraction in 2^-32 us.
    local: LocalTime,
    bus: BusTime,
    fraction: i64,
    /// How much faster than the local clock the bus runs, in units of 2^-32.
    rate: i64,
    /// What is being made up for: in which direction, in units of 2^-32, and for how many
    /// microseconds from `local` on.
    slew: i64,
    slew_time: i64,
    synchronised: bool,
    source: Source,
    /// The least delayed SYNC of the window, when the window began, and how many SYNCs it has.
    best: Option<(Sample, i64)>,
    window_start: LocalTime,
    samples: u8,
    /// Windows in a row whose best SYNC was not believed.
    doubts: u8,
    history: History,
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
            fraction: 0,
            rate: 0,
            slew: 0,
            slew_time: 0,
            synchronised: false,
            source: Source::new(),
            best: None,
            window_start: LocalTime(0),
            samples: 0,
            doubts: 0,
            history: History::new(),
        }
    }

    /// Whether a SYNC has set the clock.
    pub const fn is_synchronised(&self) -> bool {
        self.synchronised
    }

    /// Bus time at a local time.
    #[inline(never)]
    pub fn bus_time(&self, local: LocalTime) -> BusTime {
        // A SYNC carries 56 bits and a device's own clock does not come to more: no sum here wraps.
        let elapsed = local.0.wrapping_sub(self.local.0) as i64;
        let passed = elapsed.wrapping_add(self.correction(elapsed) >> FINE);
        BusTime(self.bus.0.saturating_add_signed(passed))
    }

    /// The least local time at which [`Self::bus_time`] shows at least `bus`, give or take 1 us.
    #[inline(never)]
    pub fn local_time(&self, bus: BusTime) -> LocalTime {
        let elapsed = bus.0.wrapping_sub(self.bus.0) as i64;
        // The correction belongs to the local time; the first guess of that is off by a 1000th.
        let guess = elapsed.wrapping_sub(self.correction(elapsed) >> FINE);
        let corrected = elapsed.wrapping_sub(self.correction(guess) >> FINE);
        LocalTime(self.local.0.saturating_add_signed(corrected))
    }

    /// Bus time gained on the local clock some time after `local`, in 2^-32 us.
    #[inline(never)]
    fn correction(&self, elapsed: i64) -> i64 {
        let bounded = elapsed.clamp(-LONGEST, LONGEST);
        // Below 2^40 * 2^22 and 2^28 * 2^20.
        let slewing = if bounded >= self.slew_time {
            self.slew_time
        } else {
            bounded.max(0)
        };
        bounded * self.rate + slewing * self.slew + self.fraction
    }

    /// How far a SYNC is ahead of where the clock is or slowly goes to, in 2^-32 us, by at most
    /// [`FARTHEST`].
    fn error(&self, sample: Sample) -> i64 {
        let elapsed = sample.received.0.wrapping_sub(self.local.0) as i64;
        let bounded = elapsed.clamp(-LONGEST, LONGEST);
        let gained = bounded * self.rate + self.slew_time * self.slew + self.fraction;
        let error = (sample.sent.0.wrapping_sub(self.bus.0) as i64)
            .saturating_sub(elapsed)
            .saturating_sub(gained >> FINE);
        // What the shift cut off is subtracted here.
        (error.clamp(-FARTHEST, FARTHEST) << FINE) - (gained & ((1 << FINE) - 1))
    }

    /// Takes the SYNC of number `counter` that was sent at `sent` and arrived at `received`;
    /// `may_step` says that nothing moves, so that the clock may jump. Otherwise it runs at most
    /// 200 ppm faster or slower than its rate, however many SYNCs come and whatever they say.
    pub fn synchronise(
        &mut self,
        received: LocalTime,
        counter: u8,
        sent: BusTime,
        may_step: bool,
    ) -> Discipline {
        // Local time does not go back; ages of points below rely on it.
        let received = received.max(self.source.heard());
        let sample = Sample { received, sent };
        let error = self.error(sample);
        if self.synchronised && !self.source.is_followed(received, counter, error >> FINE) {
            return Discipline::Ignored;
        }
        if !self.synchronised || (error >> FINE).abs() > STEP {
            if !may_step {
                return Discipline::Refused;
            }
            self.source.follow(received, counter);
            self.set(sample);
            return Discipline::Stepped;
        }
        // After a silence the old ones tell nothing, and rare ones count each for itself.
        let alone = self.source.is_silent(received);
        self.source.follow(received, counter);
        let best = match self.best {
            Some(best) if best.1 >= error && !alone => best,
            _ => (sample, error),
        };
        self.best = Some(best);
        self.samples = self.samples.saturating_add(1);
        let length = received.since(self.window_start);
        let full = self.samples >= LEAST_SAMPLES && length >= self.history.window();
        if !full && !alone {
            return Discipline::Sampled;
        }
        self.begin_window(received);
        self.correct(received, best, may_step)
    }

    /// Shows the time of one SYNC; nothing is known of the rate.
    fn set(&mut self, sample: Sample) {
        self.synchronised = true;
        self.local = sample.received;
        self.bus = sample.sent;
        self.fraction = 0;
        self.slew_time = 0;
        self.rate = 0;
        self.doubts = 0;
        self.history.clear();
        self.begin_window(sample.received);
    }

    fn begin_window(&mut self, now: LocalTime) {
        self.samples = 0;
        self.best = None;
        self.window_start = now;
    }

    /// Corrects offset and rate at the end of a window with its best sample.
    fn correct(
        &mut self,
        now: LocalTime,
        (best, error): (Sample, i64),
        may_step: bool,
    ) -> Discipline {
        let drift = if self.history.len() >= KNOWN_POINTS {
            KNOWN_DRIFT
        } else {
            UNKNOWN_DRIFT
        };
        let last = self.history.newest().unwrap_or(self.local);
        let since = u32::try_from(best.received.since(last)).unwrap_or(u32::MAX);
        let bound = (JITTER + i64::from(since / drift)) << FINE;
        if error < -bound {
            self.doubts += 1;
            if self.doubts < DOUBTS {
                return Discipline::Corrected;
            }
        }
        self.doubts = 0;
        if error.abs() > bound.min(FITTING << FINE) {
            // The clock was set by a SYNC that came late, has run alone, or the host's clock has
            // moved.
            self.history.begin(self.rate);
        }
        self.history.add(best, self.rate);
        match self.history.line() {
            Some(line) => self.follow(now, line, may_step),
            None => Discipline::Corrected,
        }
    }

    /// Goes to `line`: at once at rest, else slowly, as ticks follow the clock, and the speed of
    /// axes follows the ticks.
    fn follow(&mut self, now: LocalTime, line: Line, may_step: bool) -> Discipline {
        self.rebase(now);
        self.rate = line.rate;
        self.slew_time = 0;
        let missing = self.error(line.through) + line.ahead;
        let missing = missing.clamp(-STEP << FINE, STEP << FINE);
        if !may_step {
            self.slew = SLEW * missing.signum();
            self.slew_time = missing.abs() / SLEW;
            return Discipline::Corrected;
        }
        let shown = self.fraction + missing;
        self.bus = BusTime(self.bus.0.saturating_add_signed(shown >> FINE));
        self.fraction = shown & ((1 << FINE) - 1);
        if missing.abs() >> FINE < SMALL_STEP {
            Discipline::Corrected
        } else {
            Discipline::Stepped
        }
    }

    /// Reckons from `now` on and shows the same.
    fn rebase(&mut self, now: LocalTime) {
        let elapsed = now.0.wrapping_sub(self.local.0) as i64;
        let gained = self.correction(elapsed);
        let passed = elapsed.saturating_add(gained >> FINE);
        self.bus = BusTime(self.bus.0.saturating_add_signed(passed));
        self.fraction = gained & ((1 << FINE) - 1);
        self.local = now;
    }
}
