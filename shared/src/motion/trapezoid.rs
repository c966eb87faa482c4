//! The trapezoid: constant acceleration, cruise, constant deceleration, rest to rest.
//!
//! With phases of n_a, n_c and n_d ticks the cruise velocity over a range R is
//! v = 2 R / (n_a + 2 n_c + n_d), the accelerations are v / n_a and v / n_d. All phases are whole
//! ticks, so every phase change falls on a setpoint, and position is exactly continuous there.
//!
//! [`Trapezoid`] is the device's, in integers; [`exact`] is in f64, from and to any velocity.

mod cruise;
pub mod exact;

pub(crate) use cruise::to_rest;

use super::chain::{Piece, turns};
use super::phase::{Moment, Rates};
use super::smooth::ROUNDING_MARGIN;
use crate::limits::Limits;
use crate::time::{LONGEST_MOVE, TICKS_PER_SECOND, Ticks};
use crate::units::{Position, floor, whole};

/// A trapezoid's phases in ticks: how long it accelerates, cruises and decelerates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trapezoid {
    acceleration: Ticks,
    cruise: Ticks,
    deceleration: Ticks,
}

impl Trapezoid {
    /// A trapezoid of these phases; `None` unless it accelerates and decelerates for at least one
    /// tick each and is no longer than [`LONGEST_MOVE`].
    pub fn new(acceleration: Ticks, cruise: Ticks, deceleration: Ticks) -> Option<Self> {
        let whole = acceleration
            .0
            .checked_add(cruise.0)?
            .checked_add(deceleration.0)?;
        let valid = acceleration.0 > 0 && deceleration.0 > 0 && whole <= LONGEST_MOVE.0;
        valid.then_some(Self {
            acceleration,
            cruise,
            deceleration,
        })
    }

    /// The trapezoid of `duration` over `range` whose cruise is slowest within the limits.
    ///
    /// `None` where the limits do not allow the range in that time.
    pub fn within(range: Position, duration: Ticks, limits: &Limits) -> Option<Self> {
        if duration > LONGEST_MOVE {
            return None;
        }
        let rate = TICKS_PER_SECOND as f64;
        let range = range.abs().counts() as f64;
        let length = f64::from(duration.0);
        let up = (limits.acceleration().counts() as f64 - ROUNDING_MARGIN) / (rate * rate);
        let down = (limits.deceleration().counts() as f64 - ROUNDING_MARGIN) / (rate * rate);
        // R = v T - k v^2 with k = 1 / (2 a) + 1 / (2 d): the lesser root.
        let k = 0.5 / up + 0.5 / down;
        let root = libm::sqrt((length * length - 4.0 * k * range).max(0.0));
        let cruise_velocity = 2.0 * range / (length + root);
        let mut rise = whole_above(cruise_velocity / up);
        let mut fall = whole_above(cruise_velocity / down);
        loop {
            if rise + fall > length {
                return None;
            }
            let velocity = 2.0 * range / (2.0 * length - rise - fall);
            if velocity > up * rise {
                rise += 1.0;
            } else if velocity > down * fall {
                fall += 1.0;
            } else {
                let trapezoid = Self {
                    acceleration: Ticks(whole(rise) as u32),
                    cruise: Ticks(whole(length - rise - fall) as u32),
                    deceleration: Ticks(whole(fall) as u32),
                };
                return trapezoid.keeps(range, limits).then_some(trapezoid);
            }
        }
    }

    /// The quickest trapezoid of whole ticks over `range` within the limits; `None` where it would
    /// last longer than [`LONGEST_MOVE`].
    pub fn shortest(range: Position, limits: &Limits) -> Option<Self> {
        let distance = range.abs().counts() as f64;
        let up = limits.acceleration().counts() as f64;
        let down = limits.deceleration().counts() as f64;
        let k = 0.5 / up + 0.5 / down;
        let cruise = (limits.velocity().counts() as f64).min(libm::sqrt(distance / k));
        let seconds = if cruise > 0.0 {
            distance / cruise + k * cruise
        } else {
            0.0
        };
        let mut duration = Ticks(Ticks::from_seconds_ceil(seconds)?.0.max(2));
        // Whole ticks for each phase can ask for one or two more.
        while duration <= LONGEST_MOVE {
            if let Some(trapezoid) = Self::within(range, duration, limits) {
                return Some(trapezoid);
            }
            duration = Ticks(duration.0 + 1);
        }
        None
    }

    /// How long the whole move lasts.
    pub fn duration(&self) -> Ticks {
        Ticks(self.acceleration.0 + self.cruise.0 + self.deceleration.0)
    }

    /// How long it accelerates.
    pub fn acceleration(&self) -> Ticks {
        self.acceleration
    }

    /// How long it decelerates.
    pub fn deceleration(&self) -> Ticks {
        self.deceleration
    }

    /// Counts/s for a distance in counts.
    fn cruise_velocity(&self, distance: f64) -> f64 {
        let ticks =
            f64::from(self.acceleration.0 + self.deceleration.0) + 2.0 * f64::from(self.cruise.0);
        2.0 * distance / ticks * TICKS_PER_SECOND as f64
    }

    fn keeps(&self, distance: f64, limits: &Limits) -> bool {
        let rate = TICKS_PER_SECOND as f64;
        let velocity = self.cruise_velocity(distance.abs());
        let up = velocity * rate / f64::from(self.acceleration.0);
        let down = velocity * rate / f64::from(self.deceleration.0);
        velocity <= limits.velocity().counts() as f64 - ROUNDING_MARGIN
            && up <= limits.acceleration().counts() as f64 - ROUNDING_MARGIN / 2.0
            && down <= limits.deceleration().counts() as f64 - ROUNDING_MARGIN / 2.0
    }

    /// Whether a move over `range` with these phases keeps the limits.
    pub fn allowed(&self, range: Position, limits: &Limits) -> bool {
        self.keeps(range.counts() as f64, limits)
    }

    /// The pieces of the move over a range in counts.
    pub(crate) fn pieces(&self, range: i64) -> [Piece; 3] {
        let rate = TICKS_PER_SECOND as f64;
        let velocity = self.cruise_velocity(turns(range));
        let fall = Ticks(self.acceleration.0 + self.cruise.0);
        let up = velocity * rate / f64::from(self.acceleration.0);
        let down = -velocity * rate / f64::from(self.deceleration.0);
        [
            (self.acceleration, up, 0.0, velocity),
            (fall, 0.0, velocity, velocity),
            (self.duration(), down, velocity, 0.0),
        ]
        .map(|(ends, acceleration, from, to)| Piece {
            ends: Moment::from_ticks(ends),
            entry: Rates::new(from, acceleration),
            exit: Rates::new(to, acceleration),
        })
    }
}

/// The least whole number that is not below `value`, from 1 up.
fn whole_above(value: f64) -> f64 {
    (floor(-value) as f64).min(-1.0).abs()
}
