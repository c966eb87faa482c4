//! A piece of motion that is a polynomial in time of degree three at most.
//!
//! Position is start + d1 u + d2 u^2 + d3 u^3 with u = elapsed / duration, where d1 + d2 + d3 is
//! the piece's whole difference of position in counts: the next piece starts from there exactly,
//! so rounding cannot add up over pieces.

use super::Contribution;
use super::fixed::{ALMOST_ONE, scale};
use crate::time::{TICKS_PER_SECOND, Tick, Ticks};

/// Bits behind the point of the position's coefficients.
///
/// A piece stays inside the travel of +-2^42 counts, and its coefficients are at most a few times
/// its difference of at most 2^43.
const COEFFICIENT_BITS: u32 = 16;

/// The largest coefficient in counts: the sum of three, raised, is below 3 * 2^61 and fits an i64.
const LARGEST_COEFFICIENT: f64 = (1u64 << (61 - COEFFICIENT_BITS)) as f64;

/// One polynomial piece, from its start tick to just before the next piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Phase {
    start: Tick,
    duration: Ticks,
    departs: bool,
    step: u64,
    from: i64,
    difference: i64,
    /// Raised by [`COEFFICIENT_BITS`].
    position: [i64; 3],
    /// Counts per second.
    velocity: [i64; 3],
    /// Counts per second squared.
    acceleration: [i64; 2],
}

/// What a phase begins with: counts, counts/s, counts/s^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Entry {
    pub tick: Tick,
    pub position: i64,
    pub velocity: f64,
    pub acceleration: f64,
}

impl Phase {
    /// A phase of constant jerk from `entry` until the acceleration is `acceleration`.
    ///
    /// Gives the phase and what the next one begins with. `None` where the phase would run over
    /// more counts than a position can hold.
    pub(crate) fn constant_jerk(
        entry: Entry,
        duration: Ticks,
        acceleration: f64,
    ) -> Option<(Self, Entry)> {
        if duration.0 == 0 {
            return None;
        }
        let seconds = f64::from(duration.0) / TICKS_PER_SECOND as f64;
        let ramp = acceleration - entry.acceleration;
        let linear = entry.velocity * seconds;
        let quadratic = entry.acceleration * seconds * seconds / 2.0;
        let cubic = ramp * seconds * seconds / 6.0;
        let coefficients = [linear, quadratic, cubic];
        if !coefficients
            .iter()
            .all(|coefficient| coefficient.abs() < LARGEST_COEFFICIENT)
        {
            return None;
        }
        let raised = (1u64 << COEFFICIENT_BITS) as f64;
        let velocity = [
            entry.velocity,
            entry.acceleration * seconds,
            ramp * seconds / 2.0,
        ];
        let difference = libm::round(linear + quadratic + cubic) as i64;
        let phase = Self {
            start: entry.tick,
            duration,
            departs: false,
            step: ALMOST_ONE / u64::from(duration.0),
            from: entry.position,
            difference,
            position: coefficients.map(|coefficient| (coefficient * raised) as i64),
            velocity: velocity.map(|coefficient| coefficient as i64),
            acceleration: [entry.acceleration as i64, ramp as i64],
        };
        let exit = Entry {
            tick: entry.tick.after(duration),
            position: entry.position.saturating_add(difference),
            velocity: velocity.iter().sum(),
            acceleration,
        };
        Some((phase, exit))
    }

    /// The first tick that the phase no longer covers.
    pub(crate) fn end(&self) -> Tick {
        self.start.after(self.duration)
    }

    /// The same phase with its exit moved to `position`: takes up the rounding of a whole chain,
    /// a count or two, so that its last phase ends exactly where it was meant to.
    pub(crate) fn ending_at(mut self, position: i64) -> Self {
        self.difference = position.saturating_sub(self.from);
        self
    }

    /// The same phase as the first of a move that leaves from rest, and that can be dropped as
    /// long as it has not begun.
    pub(crate) fn departing(mut self) -> Self {
        self.departs = true;
        self
    }

    /// Whether the phase is the first of a move that leaves from rest.
    pub(crate) fn departs(&self) -> bool {
        self.departs
    }

    /// Whether the phase speeds up evenly, which only a trapezoid does.
    pub(crate) fn speeds_up(&self) -> bool {
        let ([start, ramp], [velocity, _, _]) = (self.acceleration, self.velocity);
        // At its beginning a trapezoid has no velocity yet.
        ramp == 0 && start != 0 && velocity.signum() * start.signum() >= 0
    }

    /// The tick at which the phase begins.
    pub(crate) fn start(&self) -> Tick {
        self.start
    }

    /// The position where the phase begins.
    pub(crate) fn entry_position(&self) -> i64 {
        self.from
    }

    /// The position where the next phase begins.
    pub(crate) fn exit_position(&self) -> i64 {
        self.from.saturating_add(self.difference)
    }

    /// The motion at a tick that the phase covers; its entry before that, its exit at rest after.
    pub(crate) fn contribution(&self, tick: Tick) -> Contribution {
        let elapsed = tick.since(self.start).0;
        if elapsed >= self.duration.0 {
            return Contribution {
                position: self.exit_position(),
                ..Contribution::default()
            };
        }
        let u = u64::from(elapsed) * self.step;
        let [d1, d2, d3] = self.position;
        let raised = scale(d1 + scale(d2 + scale(d3, u), u), u);
        let half = 1 << (COEFFICIENT_BITS - 1);
        let [v0, v1, v2] = self.velocity;
        let [a0, a1] = self.acceleration;
        Contribution {
            position: self
                .from
                .saturating_add((raised + half) >> COEFFICIENT_BITS),
            velocity: v0 + scale(v1 + scale(v2, u), u),
            acceleration: a0 + scale(a1, u),
        }
    }
}
