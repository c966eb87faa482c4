//! A motion among a family of them that gets to a target.
//!
//! What is reached grows along each family. An f32 finds the member to its 20 bits or so for next to nothing;
//! steps in f64 make it exact.

use super::super::chain::{MOST_PHASES, Piece};
use super::super::change::{Change, Number, Strength};
use super::super::phase::{Moment, Rates};
use crate::units::COUNTS_PER_TURN;
use core::mem::replace;

/// A change of velocity, a cruise, and a stop.
pub(crate) const PIECES: usize = MOST_PHASES;

/// Halvings of the bracket, or better, in f32.
const STEPS: usize = 20;

/// Steps of the secant in f64 that make it exact.
///
/// One is nearly always enough, and costs as much as all in f32; with the last of them a bracket is halved
/// down to nothing.
const MOST_SECANTS: usize = 40;

/// Steps after which a motion that is to the target will do.
const ENOUGH: usize = 3;

/// How far from the target counts as there: half a count of 2^-32 turn.
const EXACT: f64 = 0.5 / COUNTS_PER_TURN as f64;

/// The same as a part of the way, where the duration counts.
const EXACT_PART: f64 = 1e-12;

/// How far from the target a motion is still one to it: what its last piece is moved by.
const THERE: f64 = 4.0 / COUNTS_PER_TURN as f64;

/// Halvings for the fastest cruise, which only has to be an upper bound, and how near that must be.
const COARSE_STEPS: usize = 24;
const COARSE: f32 = 0.004;

/// How near the target is near enough in f32, as a part of the way.
const NEAR: f32 = 2e-7;

/// How far beyond the target, as a part of the way, is plain in f32.
const CLEARLY: f32 = 1e-3;

/// What is varied until the target is reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Family {
    /// The velocity of the cruise.
    Velocity,
    /// How much harder it accelerates, at its peak, than it does already.
    Harder,
    /// For how long the brake is released before it is applied again.
    Released,
}

/// A motion towards greater places that is to reach one within a time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wanted<F> {
    pub velocity: F,
    pub acceleration: F,
    pub target: F,
    /// `None` for as long as it takes without a cruise.
    pub duration: Option<F>,
    pub family: Family,
    pub strength: Strength<F>,
}

/// A motion with its cruise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tried<F> {
    /// In its family.
    place: F,
    change: Change<F>,
    stop: Change<F>,
    /// Of the cruise.
    velocity: F,
    /// Seconds of the cruise.
    pub(super) cruise: F,
    /// How far beyond the target it gets.
    pub(super) beyond: F,
}

impl<F: Number> Wanted<F> {
    /// The member of the family at `place`.
    pub(super) fn with(&self, place: F) -> Tried<F> {
        let zero = F::default();
        let to = |velocity| Change::new(self.velocity, self.acceleration, velocity, &self.strength);
        let (change, velocity, acceleration) = match self.family {
            Family::Velocity => (to(place), place, zero),
            Family::Harder => {
                let acceleration = self.accelerating();
                let more = place * (place + acceleration + acceleration);
                let velocity = self.released() + more / self.strength.jerk;
                (to(velocity), velocity, zero)
            }
            Family::Released => {
                let change =
                    Change::releasing(self.velocity, self.acceleration, place, self.strength.jerk);
                (change, change.to(), change.exit())
            }
        };
        let stop = Change::new(velocity, acceleration, zero, &self.strength);
        let cruise = self.duration.map_or(zero, |duration| {
            duration - change.duration() - stop.duration()
        });
        let reached = change.distance() + stop.distance() + velocity * cruise;
        Tried {
            place,
            change,
            stop,
            velocity,
            cruise,
            beyond: reached - self.target,
        }
    }

    /// What the velocity comes to when the acceleration is taken back: the ramps to there and to rest are
    /// those of a stop.
    pub(super) fn released(&self) -> F {
        let twice = self.strength.jerk + self.strength.jerk;
        self.velocity + self.acceleration * self.acceleration.absolute() / twice
    }

    /// The acceleration, where it is one.
    fn accelerating(&self) -> F {
        if self.acceleration > F::default() {
            self.acceleration
        } else {
            F::default()
        }
    }
}

impl Wanted<f64> {
    /// The motion that reaches the target in time with a cruise up to `fastest`, or without a time and a
    /// cruise.
    pub(super) fn cruising(&self, fastest: f64) -> Option<Tried<f64>> {
        let coarse = self.coarse();
        let fast = coarse.fastest(fastest as f32)?;
        let found = coarse.between(0.0, fast, 0.0)?;
        // Clearly without a cruise: f64 would not change that.
        if coarse.with(found.place).cruise < -1e-3 * coarse.duration.unwrap_or_default() {
            return None;
        }
        let tried = self.exactly(0.0, fastest, found);
        let inside = 0.0 < tried.velocity && 0.0 <= tried.cruise && tried.is_there();
        inside.then_some(tried)
    }

    /// Whether it is plain without an exact look that the member at a place gets beyond the target.
    pub(super) fn is_clearly_beyond(&self, place: f64) -> bool {
        let tried = self.coarse().with(place as f32);
        tried.beyond > CLEARLY * (tried.beyond + self.target.abs() as f32)
    }

    /// The quickest motion that never cruises; `None` where it would be faster than `fastest`.
    pub(super) fn peaking(&self, fastest: f64) -> Option<Tried<f64>> {
        let released = self.released();
        let with = |family| Self { family, ..*self };
        if released <= 0.0 {
            return self.found(0.0, fastest);
        }
        let harder = with(Family::Harder);
        if harder.with(0.0).beyond <= 0.0 {
            let acceleration = self.accelerating();
            let more = self.strength.jerk * (fastest - released);
            let most = libm::sqrt((acceleration * acceleration + more).max(0.0)) - acceleration;
            return harder.found(0.0, most);
        }
        with(Family::Released).found(0.0, -self.acceleration / self.strength.jerk)
    }

    /// The member between two places that gets to the target, which is known to lie between where they get:
    /// an f32 may see it otherwise, since a root of what rounding leaves of nothing is large.
    fn found(&self, low: f64, high: f64) -> Option<Tried<f64>> {
        let found = self.coarse().between(low as f32, high as f32, f32::MAX)?;
        Some(self.exactly(low, high, found)).filter(Tried::is_there)
    }

    /// From near the target to it: a secant, inside a bracket that gets narrower.
    fn exactly(&self, low: f64, high: f64, near: Near) -> Tried<f64> {
        let (mut low, mut high) = (low, high);
        let mut tried = self.with(f64::from(near.place));
        let scale = self.target.abs() + (self.target + tried.beyond).abs();
        let exact = EXACT.min(EXACT_PART * scale);
        let mut next = tried.place - tried.beyond / f64::from(near.slope);
        for step in 0..MOST_SECANTS {
            if tried.beyond.abs() <= exact || step >= ENOUGH && tried.is_there() {
                break;
            }
            if tried.beyond > 0.0 {
                high = tried.place;
            } else {
                low = tried.place;
            }
            // As well where it is no number.
            if !(low < next && next < high) {
                next = 0.5 * (low + high);
            }
            let before = replace(&mut tried, self.with(next));
            let share = tried.beyond / (before.beyond - tried.beyond);
            next = tried.place - share * (before.place - tried.place);
        }
        tried
    }

    fn coarse(&self) -> Wanted<f32> {
        Wanted {
            velocity: self.velocity as f32,
            acceleration: self.acceleration as f32,
            target: self.target as f32,
            duration: self.duration.map(|duration| duration as f32),
            family: self.family,
            strength: Strength {
                rise: self.strength.rise as f32,
                fall: self.strength.fall as f32,
                jerk: self.strength.jerk as f32,
            },
        }
    }
}

/// A place near the target, and how much farther it gets for each unit of it.
#[derive(Debug, Clone, Copy)]
struct Near {
    place: f32,
    slope: f32,
}

impl Wanted<f32> {
    /// The fastest cruise, up to `fastest`, that the time is enough for, or a little more; `None`
    /// where it is not even enough for a stop.
    fn fastest(&self, fastest: f32) -> Option<f32> {
        let enough = |velocity: f32| self.with(velocity).cruise >= 0.0;
        if enough(fastest) {
            return Some(fastest);
        }
        // Up to there the ramps are those of a stop, and to more they last longer.
        let mut slow = clamped(self.released(), fastest);
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

    /// The member between two places that gets to the target; `None` where that is not between them, by
    /// more than `clearly` times the way.
    fn between(&self, low: f32, high: f32, clearly: f32) -> Option<Near> {
        let (mut slow, mut fast) = (low, high);
        let mut short = self.with(slow).beyond;
        let mut far = self.with(fast).beyond;
        if far.is_nan() || short.is_nan() {
            return None;
        }
        let scale = self.target.abs() + (self.target + short).abs();
        let near = NEAR * scale;
        let chord = (far - short) / (fast - slow);
        if far < -clearly * scale || short > clearly * scale {
            return None;
        }
        short = if short < -near { short } else { -near };
        far = if far > near { far } else { near };
        // Regula falsi; the end that stays twice counts half (Illinois).
        let mut stayed = 0i32;
        for _ in 0..STEPS {
            let place = (slow * far - fast * short) / (far - short);
            if !(slow < place && place < fast) {
                break;
            }
            let beyond = self.with(place).beyond;
            if beyond.abs() <= near {
                (fast, far) = (place, 0.0);
                break;
            }
            if beyond > 0.0 {
                (fast, far) = (place, beyond);
                stayed = stayed.min(0) - 1;
                if stayed < -1 {
                    short *= 0.5;
                }
            } else {
                (slow, short) = (place, beyond);
                stayed = stayed.max(0) + 1;
                if stayed > 1 {
                    far *= 0.5;
                }
            }
        }
        let place = if far < -short { fast } else { slow };
        let step = 4e-3 * place + 1e-5 * fast;
        let slope = (self.with(place + step).beyond - self.with(place).beyond) / step;
        let slope = if slope > 0.0 { slope } else { chord };
        Some(Near { place, slope })
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

impl Tried<f64> {
    /// Whether it gets to the target.
    fn is_there(&self) -> bool {
        self.beyond.abs() <= THERE
    }

    /// Seconds from the start to rest.
    pub(crate) fn duration(&self) -> f64 {
        self.change.duration() + self.cruise + self.stop.duration()
    }

    /// The change, the cruise and the stop, in the direction `sign`.
    pub(super) fn pieces(&self, sign: f64) -> [Piece; PIECES] {
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
    use crate::motion::trajectory::{Sample, Trajectory};
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
                family: Family::Velocity,
                strength,
            };
            (wanted, fastest)
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn what_is_found_is_exact((wanted, fastest) in wanted()) {
            if let Some(tried) = wanted.cruising(fastest) {
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
            prop_assert!(rested.cruising(fastest).is_some(), "{rested:?} {}", quickest.duration());
        }
    }
}
