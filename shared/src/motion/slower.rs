//! To rest in a chosen time: a change of velocity, a cruise, and a stop.
//!
//! What is reached within the time grows with the velocity of the cruise. An f32 finds the cruise
//! to its 20 bits or so for next to nothing; two steps in f64 make it exact.

use super::bounds::Bounds;
use super::chain::Piece;
use super::change::{Change, Number, Strength};
use super::phase::{Moment, Rates};
use super::trajectory::Sample;
use crate::time::Ticks;
use crate::units::COUNTS_PER_TURN;
use core::mem::replace;

/// A change of velocity, a cruise, and a stop.
const PIECES: usize = 7;

/// Halvings of the bracket, or better, in f32.
const STEPS: usize = 20;

/// Steps of the secant in f64 that make it exact.
const MOST_SECANTS: usize = 3;

/// How far from the target counts as there: half a count of 2^-32 turn.
const EXACT: f64 = 0.5 / COUNTS_PER_TURN as f64;

/// Halvings for the fastest cruise, which only has to be an upper bound, and how near that must be.
const COARSE_STEPS: usize = 24;
const COARSE: f32 = 0.004;

/// How near the target is near enough in f32, as a part of the way.
const NEAR: f32 = 2e-7;

/// A motion towards greater places that is to reach one within a time.
#[derive(Debug, Clone, Copy)]
struct Wanted<F> {
    velocity: F,
    acceleration: F,
    target: F,
    /// `None` for as long as it takes without a cruise.
    duration: Option<F>,
    strength: Strength<F>,
}

/// A motion with its cruise.
#[derive(Debug, Clone, Copy)]
struct Tried<F> {
    change: Change<F>,
    stop: Change<F>,
    /// Of the cruise.
    velocity: F,
    /// Seconds of the cruise.
    cruise: F,
    /// How far beyond the target it gets.
    beyond: F,
}

impl<F: Number> Wanted<F> {
    fn with(&self, velocity: F) -> Tried<F> {
        let zero = F::default();
        let change = Change::new(self.velocity, self.acceleration, velocity, &self.strength);
        let stop = Change::new(velocity, zero, zero, &self.strength);
        let cruise = self.duration.map_or(zero, |duration| {
            duration - change.duration() - stop.duration()
        });
        let reached = change.distance() + stop.distance() + velocity * cruise;
        Tried {
            change,
            stop,
            velocity,
            cruise,
            beyond: reached - self.target,
        }
    }
}

impl Wanted<f64> {
    /// The motion that reaches the target in time with a cruise up to `fastest`.
    fn solved(&self, fastest: f64) -> Option<Tried<f64>> {
        let coarse = self.coarse();
        let (velocity, slope) = coarse.cruise(fastest as f32)?;
        // Clearly without a cruise: f64 would not change that.
        if coarse.with(velocity).cruise < -1e-3 * coarse.duration.unwrap_or_default() {
            return None;
        }
        let mut before = self.with(f64::from(velocity));
        let mut tried = self.with(before.velocity - before.beyond / f64::from(slope));
        // One step of the secant is nearly always enough, and costs as much as all in f32.
        for _ in 0..MOST_SECANTS {
            let gained = before.beyond - tried.beyond;
            if gained == 0.0 || tried.beyond.abs() <= EXACT {
                break;
            }
            let share = tried.beyond / gained;
            let next = tried.velocity - share * (before.velocity - tried.velocity);
            before = replace(&mut tried, self.with(next));
        }
        let inside = 0.0 < tried.velocity && tried.velocity <= fastest && 0.0 <= tried.cruise;
        inside.then_some(tried)
    }

    fn coarse(&self) -> Wanted<f32> {
        Wanted {
            velocity: self.velocity as f32,
            acceleration: self.acceleration as f32,
            target: self.target as f32,
            duration: self.duration.map(|duration| duration as f32),
            strength: Strength {
                rise: self.strength.rise as f32,
                fall: self.strength.fall as f32,
                jerk: self.strength.jerk as f32,
            },
        }
    }
}

impl Wanted<f32> {
    /// The fastest cruise, up to `fastest`, that the time is enough for, or a little more; `None`
    /// where it is not even enough for a stop.
    fn fastest(&self, fastest: f32) -> Option<f32> {
        let enough = |velocity: f32| self.with(velocity).cruise >= 0.0;
        if enough(fastest) {
            return Some(fastest);
        }
        // What the velocity comes to when the acceleration is taken back: the ramps to there and
        // to rest are those of a stop, and to more they last longer.
        let taken = self.acceleration * self.acceleration.abs() / (2.0 * self.strength.jerk);
        let mut slow = clamped(self.velocity + taken, fastest);
        if !enough(slow) {
            return None;
        }
        let mut fast = fastest;
        for _ in 0..COARSE_STEPS {
            // Much faster than the time is enough for, it would not get as far as that.
            if fast - slow <= COARSE * fast {
                break;
            }
            let middle = 0.5 * (slow + fast);
            if enough(middle) {
                slow = middle;
            } else {
                fast = middle;
            }
        }
        Some(fast)
    }

    /// The velocity of the cruise up to `fastest`, and how much farther it gets for each unit of
    /// it; `None` where the time is too short.
    fn cruise(&self, fastest: f32) -> Option<(f32, f32)> {
        let (mut slow, mut fast) = (0.0, self.fastest(fastest)?);
        let mut short = self.with(slow).beyond;
        let mut far = self.with(fast).beyond;
        if far.is_nan() || far < 0.0 || short > 0.0 {
            return None;
        }
        // Regula falsi; the end that stays twice counts half (Illinois).
        let mut stayed = 0i32;
        for _ in 0..STEPS {
            let velocity = (slow * far - fast * short) / (far - short);
            if !(slow < velocity && velocity < fast) {
                break;
            }
            let beyond = self.with(velocity).beyond;
            if beyond.abs() <= NEAR * self.target {
                (fast, far) = (velocity, 0.0);
                break;
            }
            if beyond > 0.0 {
                (fast, far) = (velocity, beyond);
                stayed = stayed.min(0) - 1;
                if stayed < -1 {
                    short *= 0.5;
                }
            } else {
                (slow, short) = (velocity, beyond);
                stayed = stayed.max(0) + 1;
                if stayed > 1 {
                    far *= 0.5;
                }
            }
        }
        let velocity = if far < -short { fast } else { slow };
        let step = 4e-3 * velocity + 1e-5 * fast;
        let slope = (self.with(velocity + step).beyond - self.with(velocity).beyond) / step;
        if slope > 0.0 {
            Some((velocity, slope))
        } else {
            // Without ramps it would be the duration.
            self.duration.map(|duration| (velocity, duration))
        }
    }
}

/// A velocity from zero to `fastest`.
fn clamped(velocity: f32, fastest: f32) -> f32 {
    if velocity < 0.0 {
        0.0
    } else if velocity > fastest {
        fastest
    } else {
        velocity
    }
}

/// The way from a state, seen in one direction.
pub(crate) struct Way {
    wanted: Wanted<f64>,
    sign: f64,
    fastest: f64,
}

impl Way {
    /// From `from`, at place zero, to rest at `target`, in turns.
    ///
    /// The target must be beyond the place, in the direction `sign`, where a stop from here leads
    /// to. `speeding` is what the speed may rise with.
    pub(crate) fn new(
        from: &Sample,
        target: f64,
        sign: f64,
        speeding: f64,
        bounds: &Bounds,
    ) -> Self {
        let wanted = Wanted {
            velocity: sign * from.velocity,
            acceleration: sign * from.acceleration,
            target: sign * target,
            duration: None,
            strength: Strength {
                rise: speeding,
                fall: bounds.deceleration(),
                jerk: bounds.jerk(),
            },
        };
        Self {
            wanted,
            sign,
            fastest: bounds.velocity(),
        }
    }

    /// The pieces that last for `duration`, with one change of velocity to a cruise inside the
    /// limits. `None` where the time is too short for a cruise.
    pub(crate) fn lasting(&self, duration: Ticks) -> Option<[Piece; PIECES]> {
        let wanted = Wanted {
            duration: Some(duration.seconds()),
            ..self.wanted
        };
        let tried = wanted.solved(self.fastest)?;
        // The last piece ends on the tick, whatever the rounding of its parts.
        let mut pieces = tried.pieces(self.sign);
        if let Some(last) = pieces.last_mut() {
            last.ends = Moment::from_ticks(duration);
        }
        Some(pieces)
    }

    /// The pieces from above the velocity limit: down to it, a cruise, and a stop; where the target
    /// is too near for that, down to a lower velocity from which a stop follows at once. The speed
    /// never rises again. `None` from below the limit.
    pub(crate) fn down(&self) -> Option<[Piece; PIECES]> {
        let Wanted {
            velocity,
            acceleration,
            strength,
            ..
        } = self.wanted;
        let taken = 0.5 * acceleration * acceleration.abs();
        let jerk = strength.jerk;
        if velocity <= self.fastest && jerk * velocity + taken <= jerk * self.fastest {
            return None;
        }
        let mut tried = self.wanted.with(self.fastest);
        if tried.beyond <= 0.0 {
            tried.cruise = -tried.beyond / self.fastest;
        } else {
            tried = self.wanted.solved(self.fastest)?;
        }
        Some(tried.pieces(self.sign))
    }
}

impl Tried<f64> {
    /// The change, the cruise and the stop, in the direction `sign`.
    fn pieces(&self, sign: f64) -> [Piece; PIECES] {
        let (change, stop) = if sign < 0.0 {
            (self.change.mirrored(), self.stop.mirrored())
        } else {
            (self.change, self.stop)
        };
        let coasting = Rates::new(sign * self.velocity, 0.0);
        let begins = change.duration() + self.cruise;
        let coast = Piece {
            ends: Moment::from_seconds(begins),
            entry: coasting,
            exit: coasting,
        };
        let [ramp, hold, release] = change.pieces(0.0);
        let [brake, slow, rest] = stop.pieces(begins);
        [ramp, hold, release, coast, brake, slow, rest]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::s_curve::{self, SignedBounds};
    use crate::motion::trajectory::Trajectory;
    use proptest::prelude::*;

    fn wanted() -> impl Strategy<Value = (Wanted<f64>, f64)> {
        let strength = (0.0..3.0f64, 0.0..3.0f64, 0.0..3.5f64).prop_map(|(rise, fall, jerk)| {
            let (rise, fall) = (libm::exp10(rise), libm::exp10(fall));
            Strength {
                rise,
                fall,
                jerk: rise.max(fall) * libm::exp10(jerk),
            }
        });
        let from = (0.05..200.0f64, -1.0..1.0f64, -1.0..1.0f64);
        let to = (0.0..60.0f64, 0.01..10.0f64);
        (strength, from, to).prop_map(|(strength, (fastest, velocity, acceleration), to)| {
            let wanted = Wanted {
                velocity: fastest * velocity,
                acceleration: strength.rise.min(strength.fall) * acceleration,
                target: to.0,
                duration: Some(to.1),
                strength,
            };
            (wanted, fastest)
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn what_is_found_is_exact((wanted, fastest) in wanted()) {
            if let Some(tried) = wanted.solved(fastest) {
                prop_assert!(tried.beyond.abs() * COUNTS_PER_TURN as f64 <= 8.0, "{tried:?}");
            }
        }

        /// From rest the general solver finds the same, so nothing is missed.
        #[test]
        fn from_rest_whatever_is_long_enough_is_found(
            (wanted, fastest) in wanted(),
            longer in 1.001..5.0f64,
        ) {
            let Strength { rise, fall, jerk } = wanted.strength;
            let Ok(signed) = SignedBounds::new(fastest, -fastest, rise, -fall, jerk) else {
                return Err(TestCaseError::reject("limits"));
            };
            let (from, to) = (Sample::at_rest(0.0), Sample::at_rest(wanted.target + 0.01));
            let Ok(quickest) = s_curve::time_optimal(from, to, &signed) else {
                return Err(TestCaseError::fail("limits that any axis may have"));
            };
            let rested = Wanted {
                velocity: 0.0,
                acceleration: 0.0,
                target: to.position,
                duration: Some(quickest.duration() * longer),
                ..wanted
            };
            prop_assert!(rested.solved(fastest).is_some(), "{rested:?} {}", quickest.duration());
        }
    }
}
