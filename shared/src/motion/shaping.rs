//! Input shaping: setpoints that leave a mode of the machine at rest.
//!
//! A mass on a spring swings on after a move. A shaper hands over each setpoint in a few parts that
//! are so far apart that the swings they excite cancel. What comes out is a mean of setpoints of a
//! moment ago: it stays inside every range that those keep (position, velocity, acceleration and
//! jerk), and once the motion rests it is exactly at the target, later by the last part's delay.
//! Only what depends on the direction of motion is not preserved: where the acceleration and the
//! deceleration limit differ, the shaped acceleration keeps the greater of them.
//!
//! | file | what it holds |
//! |---|---|
//! | `design` | from frequency and damping to impulses |
//! | `trajectory` | what a shaper makes of a trajectory in f64 |

mod design;
mod trajectory;

pub use design::{
    HIGHEST_FREQUENCY, Impulse, Impulses, LARGEST_DAMPING, MOST_IMPULSES, ShaperKind, Shaping,
    ShapingError, TOLERANCE,
};
pub use trajectory::Shaped;

use super::Setpoint;
use super::fixed::scale;
use crate::time::Ticks;
use crate::units::{Acceleration, Position, Velocity};
use heapless::Vec;

/// Past setpoints that a shaper keeps, 3 KiB of 16 bytes each: the longest delay in ticks. Half a
/// period of 192 ms is 2.6 Hz for ZV, a whole one 5.2 Hz for ZVD and EI.
pub const CAPACITY: usize = 192;

/// Bits behind the point of a sum. Each of five products is at most 3 units too low, together 15 of
/// 256: rounded to the nearest, a mean of integers stays between the least and the greatest of them.
const SUM_BITS: u32 = 8;

/// The largest magnitude that is kept as it is, far beyond any travel and any limit: a difference of
/// two, raised, is at most 2^62.
const LARGEST: i64 = 1 << 53;

/// A rate in 27 bits with its sign and an exponent of 5: exact below 2^26, and rounded towards zero
/// by less than 2^-25 of its value up to [`LARGEST`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Short(i32);

impl Short {
    const DIGITS: u32 = 26;
    const EXPONENT_BITS: u32 = 5;

    fn new(value: i64) -> Self {
        let magnitude = value.unsigned_abs().min(LARGEST.unsigned_abs());
        let bits = u64::BITS - magnitude.leading_zeros();
        let exponent = bits.saturating_sub(Self::DIGITS);
        let digits = (magnitude >> exponent) as i32;
        let digits = if value < 0 { -digits } else { digits };
        Self(digits << Self::EXPONENT_BITS | exponent as i32)
    }

    fn value(self) -> i64 {
        let exponent = self.0 & ((1 << Self::EXPONENT_BITS) - 1);
        i64::from(self.0 >> Self::EXPONENT_BITS) << exponent
    }
}

/// A setpoint in 16 bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Entry {
    position: i64,
    velocity: Short,
    acceleration: Short,
}

impl Entry {
    fn new(setpoint: &Setpoint) -> Self {
        Self {
            position: setpoint.position.counts().clamp(-LARGEST, LARGEST),
            velocity: Short::new(setpoint.velocity.counts()),
            acceleration: Short::new(setpoint.acceleration.counts()),
        }
    }

    fn rests(&self) -> bool {
        (self.velocity, self.acceleration) == Default::default()
    }
}

/// What a past setpoint counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Tap {
    ticks: u32,
    /// A Q64 fraction; what is left of one belongs to the setpoint of now.
    weight: u64,
}

/// A shaper on a device: takes a setpoint each tick and gives the shaped one.
#[derive(Debug, Clone)]
pub struct Shaper {
    taps: Vec<Tap, { MOST_IMPULSES - 1 }>,
    past: [Entry; CAPACITY],
    /// Where the next setpoint is kept, over the oldest.
    next: usize,
    last: Entry,
    /// For how many ticks the setpoint has been the same.
    unchanged: u32,
}

impl Shaper {
    /// A shaper that passes setpoints through as they are.
    pub const fn none() -> Self {
        let rest = Entry {
            position: 0,
            velocity: Short(0),
            acceleration: Short(0),
        };
        Self {
            taps: Vec::new(),
            past: [rest; CAPACITY],
            next: 0,
            last: rest,
            unchanged: u32::MAX,
        }
    }

    /// A shaper for a mode of this natural frequency in Hz and this damping ratio, at rest at
    /// position zero: see [`Shaping::new`] and [`Self::reset`].
    ///
    /// # Errors
    /// Those of [`Shaping::new`].
    pub fn new(kind: ShaperKind, frequency: f64, damping: f64) -> Result<Self, ShapingError> {
        let shaping = Shaping::new(kind, frequency, damping)?;
        let mut shaper = Self::none();
        shaper.change(Some(&shaping))?;
        Ok(shaper)
    }

    /// Shapes for another mode from now on, or no longer.
    ///
    /// # Errors
    /// [`ShapingError::Moving`] unless the axis stands: a jump would come of it.
    pub fn change(&mut self, shaping: Option<&Shaping>) -> Result<(), ShapingError> {
        if !(self.is_settled() && self.last.rests()) {
            return Err(ShapingError::Moving);
        }
        self.taps.clear();
        let taps = shaping.map(Shaping::taps).unwrap_or_default();
        for (ticks, part) in taps.into_iter().skip(1) {
            // 2^64 times what is below one.
            let weight = (part * (u64::MAX as f64)) as u64;
            // Room for all but the first: there is no error to look at.
            let _ = self.taps.push(Tap { ticks, weight });
        }
        self.past = [self.last; CAPACITY];
        self.unchanged = u32::MAX;
        Ok(())
    }

    /// Forgets the past: the axis stands at `position`, and has for long.
    pub fn reset(&mut self, position: Position) {
        self.last = Entry::new(&Setpoint {
            position,
            ..Setpoint::default()
        });
        self.past = [self.last; CAPACITY];
        self.unchanged = u32::MAX;
    }

    /// The shaped setpoint of a tick. To be called once for each tick, in order: ticks that are
    /// left out delay the rest.
    ///
    /// Velocity and acceleration are a mean of values that are rounded towards zero to 26 bits.
    /// What is beyond 2^53 counts, where no limit is, counts as 2^53.
    pub fn shape(&mut self, setpoint: Setpoint) -> Setpoint {
        let now = Entry::new(&setpoint);
        self.unchanged = if now == self.last {
            self.unchanged.saturating_add(1)
        } else {
            0
        };
        self.last = now;
        if self.taps.is_empty() {
            return setpoint;
        }
        let (velocity, acceleration) = (now.velocity.value(), now.acceleration.value());
        let mut sum = [0i64; 3];
        for tap in &self.taps {
            // No tap is longer than the past, so one of the two is in it.
            let ticks = tap.ticks as usize;
            let place = match self.next.checked_sub(ticks) {
                Some(place) => place,
                None => (self.next + CAPACITY).saturating_sub(ticks),
            };
            let then = self.past.get(place).unwrap_or(&now);
            let differences = [
                then.position - now.position,
                then.velocity.value() - velocity,
                then.acceleration.value() - acceleration,
            ];
            for (sum, difference) in sum.iter_mut().zip(differences) {
                *sum += scale(difference << SUM_BITS, tap.weight);
            }
        }
        if let Some(oldest) = self.past.get_mut(self.next) {
            *oldest = now;
        }
        self.next = if self.next + 1 < CAPACITY {
            self.next + 1
        } else {
            0
        };
        let half = 1 << (SUM_BITS - 1);
        let [position_sum, velocity_sum, acceleration_sum] =
            sum.map(|sum| (sum + half) >> SUM_BITS);
        Setpoint {
            position: Position::from_counts(now.position + position_sum),
            velocity: Velocity::from_counts(velocity + velocity_sum),
            acceleration: Acceleration::from_counts(acceleration + acceleration_sum),
        }
    }

    /// How much later the shaped motion arrives: the longest delay of a part.
    pub fn delay(&self) -> Ticks {
        Ticks(self.taps.last().map_or(0, |tap| tap.ticks))
    }

    /// Whether the shaped setpoint has caught up: it is the one that was given last, and stays so
    /// as long as that stays the same.
    pub fn is_settled(&self) -> bool {
        self.unchanged >= self.delay().0
    }
}

impl Default for Shaper {
    /// One that passes setpoints through.
    fn default() -> Self {
        Self::none()
    }
}
