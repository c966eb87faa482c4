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
use super::phase::fixed;
use crate::time::Ticks;
use crate::units::{Acceleration, Position, Velocity};
use heapless::Vec;

/// Past setpoints that a shaper keeps, 3 KiB of 16 bytes each: the longest delay in ticks. Half a
/// period of 192 ms is 2.6 Hz for ZV, a whole one 5.2 Hz for ZVD and EI.
pub const CAPACITY: usize = 192;

/// As many as are filled in with one copy.
const FEW: usize = 16;
const _: () = assert!(CAPACITY.is_multiple_of(FEW));

/// Bits behind the point of a sum of positions. Each of five products is at most 3 units too low,
/// together 15 of 256: rounded to the nearest, a mean of integers stays between the least and the
/// greatest of them.
const POSITION_BITS: u32 = 8;

/// The same for rates, whose six products are less than one unit too low each: 6 of 16.
const RATE_BITS: u32 = 4;

/// Bits behind the point of a rate's share.
const SHARE_BITS: u32 = 31;

/// The largest magnitude that is kept as it is, far beyond any travel and any limit: a difference of
/// two positions, raised, is below 2^62.
const LARGEST: i64 = (1 << 53) - 1;

/// A rate in 26 bits, a sign and an exponent: exact below 2^26, and rounded towards zero by less than
/// 2^-25 of its value up to [`LARGEST`].
///
/// The exponent is kept as what it leaves of the largest one, which is how far a share of the digits
/// has to be shifted back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Short(i32);

impl Short {
    const ZERO: Self = Self(Self::LARGEST_EXPONENT as i32);
    const DIGITS: u32 = 26;
    const EXPONENT_BITS: u32 = 5;
    /// That of [`LARGEST`].
    const LARGEST_EXPONENT: u32 = 53 - Self::DIGITS;

    #[inline(always)]
    fn new(value: i64) -> Self {
        let magnitude = value.unsigned_abs().min(LARGEST.unsigned_abs());
        // At least 26 bits, so that the exponent is not negative; it is below 32.
        let zeros = (magnitude | 1 << (Self::DIGITS - 1)).leading_zeros();
        let exponent = (u64::BITS - Self::DIGITS).wrapping_sub(zeros) & 31;
        let digits = (magnitude >> exponent) as i32;
        let digits = if value < 0 { -digits } else { digits };
        Self(digits << Self::EXPONENT_BITS | (Self::LARGEST_EXPONENT - exponent) as i32)
    }

    /// A share of the value, raised by [`RATE_BITS`] and rounded down.
    #[inline(always)]
    fn share(self, share: i32) -> i64 {
        const _: () = assert!(SHARE_BITS - RATE_BITS == Short::LARGEST_EXPONENT);
        let digits = i64::from(self.0 >> Self::EXPONENT_BITS);
        let left = self.0 & ((1 << Self::EXPONENT_BITS) - 1);
        (digits * i64::from(share)) >> left
    }
}

/// A setpoint in 16 bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

    const fn at_rest(position: i64) -> Self {
        Self {
            position,
            velocity: Short::ZERO,
            acceleration: Short::ZERO,
        }
    }

    fn rests(&self) -> bool {
        *self == Self::at_rest(self.position)
    }
}

/// What a past setpoint counts; what is left of one belongs to the setpoint of now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Tap {
    ticks: u32,
    /// For rates, raised by [`SHARE_BITS`].
    share: i32,
    /// For positions, a Q64 fraction.
    weight: u64,
}

/// A shaper on a device: takes a setpoint each tick and gives the shaped one.
#[derive(Debug, Clone)]
pub struct Shaper {
    taps: Vec<Tap, { MOST_IMPULSES - 1 }>,
    /// The share of the setpoint of now: all of them add up to 2^31, which alone does not fit.
    own: i32,
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
        let rest = Entry::at_rest(0);
        Self {
            taps: Vec::new(),
            own: i32::MAX,
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
            // A part is below one, so 2^63 times it fits.
            let weight = (fixed(part, 63) as u64) << 1;
            let share = (weight >> (u64::BITS - SHARE_BITS)) as i32;
            // Room for all but the first: there is no error to look at.
            let _ = self.taps.push(Tap {
                ticks,
                share,
                weight,
            });
        }
        let shares = self.taps.iter().map(|tap| i64::from(tap.share));
        self.own = ((1 << SHARE_BITS) - shares.sum::<i64>()).min(i32::MAX.into()) as i32;
        self.begin_anew();
        Ok(())
    }

    /// Forgets the past: the axis stands at `position`, and has for long.
    pub fn reset(&mut self, position: Position) {
        self.last = Entry::new(&Setpoint {
            position,
            ..Setpoint::default()
        });
        self.begin_anew();
    }

    /// As if the last setpoint had been there for long.
    #[inline(never)]
    fn begin_anew(&mut self) {
        let few = [self.last; FEW];
        for past in self.past.chunks_exact_mut(FEW) {
            past.copy_from_slice(&few);
        }
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
        let (mut position, mut velocity, mut acceleration) = (0, 0, 0);
        for tap in &self.taps {
            let ticks = tap.ticks as usize;
            let before = if self.next < ticks { CAPACITY } else { 0 };
            // No tap is longer than the past, so this is always in it.
            let place = (self.next + before).wrapping_sub(ticks);
            let Some(then) = self.past.get(place) else {
                break;
            };
            let difference = (then.position - now.position) << POSITION_BITS;
            position += scale(difference, tap.weight);
            velocity += then.velocity.share(tap.share);
            acceleration += then.acceleration.share(tap.share);
        }
        velocity += now.velocity.share(self.own);
        acceleration += now.acceleration.share(self.own);
        if let Some(oldest) = self.past.get_mut(self.next) {
            *oldest = now;
        }
        self.next = if self.next + 1 < CAPACITY {
            self.next + 1
        } else {
            0
        };
        let nearest = |sum: i64, bits: u32| (sum + (1 << (bits - 1))) >> bits;
        Setpoint {
            position: Position::from_counts(now.position + nearest(position, POSITION_BITS)),
            velocity: Velocity::from_counts(nearest(velocity, RATE_BITS)),
            acceleration: Acceleration::from_counts(nearest(acceleration, RATE_BITS)),
        }
    }

    /// How much later the shaped motion arrives: the longest delay of a part.
    #[inline(never)]
    pub fn delay(&self) -> Ticks {
        Ticks(self.taps.last().map_or(0, |tap| tap.ticks))
    }

    /// Whether the shaped setpoint has caught up: it is the one that was given last, and stays so
    /// as long as that stays the same.
    #[inline(never)]
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
