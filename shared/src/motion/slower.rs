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

/// Halvings of the bracket, or better, in f32.
const STEPS: usize = 24;

/// A motion towards greater places that is to reach one within a time.
#[derive(Debug, Clone, Copy)]
struct Wanted<F> {
    velocity: F,
    acceleration: F,
    target: F,
    duration: F,
    strength: Strength<F>,
}

/// A motion with its cruise.
#[derive(Debug, Clone, Copy)]
struct Tried<F> {
    change: Change<F>,
    stop: Change<F>,
    cruise: F,
    /// How far beyond the target it gets.
    beyond: F,
}

impl<F: Number> Wanted<F> {
    fn with(&self, velocity: F) -> Tried<F> {
        let zero = F::default();
        let change = Change::new(self.velocity, self.acceleration, velocity, &self.strength);
        let stop = Change::new(velocity, zero, zero, &self.strength);
        let cruise = self.duration - change.duration() - stop.duration();
        let reached = change.distance() + stop.distance() + velocity * cruise;
        Tried {
            change,
            stop,
            cruise,
            beyond: reached - self.target,
        }
    }
}

impl Wanted<f64> {
    fn coarse(&self) -> Wanted<f32> {
        Wanted {
            velocity: self.velocity as f32,
            acceleration: self.acceleration as f32,
            target: self.target as f32,
            duration: self.duration as f32,
            strength: Strength {
                rise: self.strength.rise as f32,
                fall: self.strength.fall as f32,
                jerk: self.strength.jerk as f32,
            },
        }
    }
}

impl Wanted<f32> {
    /// The velocity of the cruise up to `fastest`, and how much farther it gets for each unit of
    /// it; `None` where the time is too short.
    fn cruise(&self, fastest: f32) -> Option<(f32, f32)> {
        let (mut slow, mut fast) = (0.0, fastest);
        let mut short = self.with(slow).beyond;
        let mut far = self.with(fast).beyond;
        if far.is_nan() || far < 0.0 || short > 0.0 {
            return None;
        }
        let mut slope = (far - short) / (fast - slow);
        // Regula falsi; the end that stays twice counts half (Illinois).
        let mut stayed = 0i32;
        for _ in 0..STEPS {
            let velocity = (slow * far - fast * short) / (far - short);
            if !(slow < velocity && velocity < fast) {
                break;
            }
            let beyond = self.with(velocity).beyond;
            if beyond > 0.0 {
                slope = (far - beyond) / (fast - velocity);
                (fast, far) = (velocity, beyond);
                stayed = stayed.min(0) - 1;
                if stayed < -1 {
                    short *= 0.5;
                }
            } else {
                slope = (beyond - short) / (velocity - slow);
                (slow, short) = (velocity, beyond);
                stayed = stayed.max(0) + 1;
                if stayed > 1 {
                    far *= 0.5;
                }
            }
        }
        let nearer = if far < -short { fast } else { slow };
        Some((nearer, slope))
    }
}

/// The pieces from `from`, at place zero, to rest at `target` in `duration`, with one change of
/// velocity to a cruise inside `bounds`. In turns.
///
/// The target must be beyond the place, in the direction `sign`, where a stop from here leads to.
/// `speeding` is what the speed may rise with. `None` where the time is too short for a cruise.
pub(crate) fn slower(
    from: &Sample,
    target: f64,
    duration: Ticks,
    sign: f64,
    speeding: f64,
    bounds: &Bounds,
) -> Option<impl Iterator<Item = Piece>> {
    let wanted = Wanted {
        velocity: sign * from.velocity,
        acceleration: sign * from.acceleration,
        target: sign * target,
        duration: duration.seconds(),
        strength: Strength {
            rise: speeding,
            fall: bounds.deceleration(),
            jerk: bounds.jerk(),
        },
    };
    let coarse = wanted.coarse();
    let (velocity, slope) = coarse.cruise(bounds.velocity() as f32)?;
    // Clearly without a cruise: f64 would not change that.
    if coarse.with(velocity).cruise < -1e-3 * coarse.duration {
        return None;
    }
    let first = f64::from(velocity);
    let before = wanted.with(first);
    let mut velocity = first;
    let mut tried = before;
    if slope > 0.0 {
        velocity = first - before.beyond / f64::from(slope);
        tried = wanted.with(velocity);
        let gained = before.beyond - tried.beyond;
        if gained != 0.0 {
            velocity -= tried.beyond * (first - velocity) / gained;
            tried = wanted.with(velocity);
        }
    }
    let Tried {
        change,
        stop,
        cruise,
        ..
    } = tried;
    if !(0.0 <= cruise && 0.0 < velocity && velocity <= bounds.velocity()) {
        return None;
    }
    let (change, stop) = if sign < 0.0 {
        (change.mirrored(), stop.mirrored())
    } else {
        (change, stop)
    };
    let coasting = Rates::new(sign * velocity, 0.0);
    let begins = change.duration() + cruise;
    let coast = Piece {
        ends: Moment::from_seconds(begins),
        entry: coasting,
        exit: coasting,
    };
    // The last piece ends on the tick, whatever the rounding of its parts.
    let stop = stop.pieces(begins).enumerate().map(move |(index, piece)| Piece {
        ends: if index == 2 {
            Moment::from_ticks(duration)
        } else {
            piece.ends
        },
        ..piece
    });
    Some(change.pieces(0.0).chain([coast]).chain(stop))
}
