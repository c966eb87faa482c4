//! The clock of the legs, and from one gait to the next.

use super::blend::{rise, risen};
use super::pattern::{Gait, LEGS};

/// A change of gait takes so many of the longer cycle. With three, each leg's clock goes forward
/// at more than a tenth of its pace, whatever the change: offsets go half a cycle and
/// the duty 0.85 at most, each at up to 15/8 of their mean rate.
const CYCLES_OF_A_CHANGE: f64 = 3.0;

/// The legs' clocks: where each is in its cycle, in cycles, counted up.
#[derive(Debug, Clone)]
pub struct Rhythm {
    from: Numbers,
    to: Numbers,
    start: f64,
    duration: f64,
    settles: f64,
    /// The common clock at the start, in cycles.
    clock: f64,
    target: Gait,
}

#[derive(Debug, Clone, Copy)]
struct Numbers {
    offsets: [f64; LEGS],
    frequency: f64,
    share: f64,
    swing: f64,
    stance: f64,
}

impl Numbers {
    fn of(gait: &Gait) -> Self {
        Self {
            offsets: gait.offsets,
            frequency: 1.0 / gait.period,
            share: gait.ground_share(),
            swing: gait.swing,
            stance: gait.stance,
        }
    }
}

fn mix(from: f64, to: f64, share: f64) -> f64 {
    from + (to - from) * share
}

impl Rhythm {
    /// A gait from a time on, at which the first leg is about to lift.
    pub fn new(gait: &Gait, time: f64) -> Self {
        let numbers = Numbers::of(gait);
        let lifts = numbers
            .offsets
            .map(|offset| (offset + numbers.share).rem_euclid(1.0));
        Self {
            from: numbers,
            to: numbers,
            start: time,
            duration: 1.0,
            settles: time,
            clock: lifts.into_iter().fold(f64::INFINITY, f64::min),
            target: *gait,
        }
    }

    /// The gait that it is, or goes to.
    pub fn target(&self) -> &Gait {
        &self.target
    }

    /// When the last change is over.
    pub fn settles(&self) -> f64 {
        self.settles
    }

    /// Goes over to another gait; not before [`Self::settles`].
    pub fn change(&mut self, gait: &Gait, time: f64) {
        let clock = self.clock(time);
        self.from = self.to;
        self.to = Numbers::of(gait);
        for (to, from) in self.to.offsets.iter_mut().zip(self.from.offsets) {
            // The shorter way round.
            let way = *to - from;
            *to = from + way - way.round();
        }
        self.start = time;
        self.clock = clock;
        self.duration = CYCLES_OF_A_CHANGE / self.from.frequency.min(self.to.frequency);
        self.settles = time + self.duration;
        self.target = *gait;
    }

    fn gone(&self, time: f64) -> f64 {
        (time - self.start) / self.duration
    }

    /// The common clock, in cycles.
    pub fn clock(&self, time: f64) -> f64 {
        let more = self.to.frequency - self.from.frequency;
        let passed = self.from.frequency * (time - self.start);
        self.clock + passed + more * self.duration * risen(self.gone(time))
    }

    /// A leg's clock: at each whole number its foot is to come down.
    pub fn of_leg(&self, leg: usize, time: f64) -> f64 {
        let share = rise(self.gone(time))[0];
        self.clock(time) - mix(self.from.offsets[leg], self.to.offsets[leg], share)
    }

    /// A leg's clock less the share of the ground: at each whole number its foot is to go up.
    pub fn of_lift(&self, leg: usize, time: f64) -> f64 {
        let share = rise(self.gone(time))[0];
        self.of_leg(leg, time) - mix(self.from.share, self.to.share, share)
    }

    /// How high to lift and how deep to push, in m.
    pub fn heights(&self, time: f64) -> [f64; 2] {
        let share = rise(self.gone(time))[0];
        [
            mix(self.from.swing, self.to.swing, share),
            mix(self.from.stance, self.to.stance, share),
        ]
    }

    /// How long a foot is in the air, in s, as it is now.
    pub fn air(&self, time: f64) -> f64 {
        let share = rise(self.gone(time))[0];
        (1.0 - mix(self.from.share, self.to.share, share))
            / mix(self.from.frequency, self.to.frequency, share)
    }
}

/// When a clock that goes forward comes to a number, not before `from`.
///
/// The clock goes forward, and `ahead` is a guess of how long it takes, in s.
pub fn when(clock: impl Fn(f64) -> f64, number: f64, from: f64, ahead: f64) -> f64 {
    if clock(from) >= number {
        return from;
    }
    let mut early = from;
    let mut ahead = ahead.max(1e-6);
    let mut late = from + ahead;
    // Doubled so often, a guess of a microsecond becomes a day.
    for _ in 0..40 {
        if clock(late) >= number {
            break;
        }
        early = late;
        ahead *= 2.0;
        late += ahead;
    }
    for _ in 0..60 {
        let middle = early + (late - early) * 0.5;
        if middle <= early || middle >= late {
            break;
        }
        if clock(middle) >= number {
            late = middle;
        } else {
            early = middle;
        }
    }
    late
}
