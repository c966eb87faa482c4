//! The controlled stop: from any state to rest, quickly and inside the limits; no target counts.
//!
//! It is the quickest change of velocity to zero with limited jerk, in three pieces: the
//! acceleration goes to a deceleration p, stays there, and comes back to zero just as the velocity
//! does. With jerk j and start (v, a) in the direction of motion, the middle piece vanishes for
//! p = sqrt(j v + a^2 / 2), the triangle; where that is over the deceleration limit d, p = d. A
//! ramp that lasts t from one acceleration to another by c, and from velocity v to w, goes
//! t (v + w) / 2 - c t^2 / 12.
//!
//! [`super::s_curve::change_velocity`] is the same in general; a stop must be cheaper than that.

use super::Motion;
use super::bounds::Bounds;
use super::chain::Piece;
use super::phase::{Moment, Rates};
use super::trajectory::Sample;
use crate::limits::Limits;
use crate::time::Tick;

/// Multiples of the jerk limit that a stop is tried with: where it would leave the travel, the
/// travel goes before the jerk.
const TIMES: [f64; 5] = [1.0, 4.0, 16.0, 256.0, 65_536.0];

/// A stop from a velocity and an acceleration.
pub(crate) struct Braking {
    /// The direction in which it comes to rest.
    sign: f64,
    /// Velocity and acceleration in that direction.
    velocity: f64,
    acceleration: f64,
    /// The greatest deceleration.
    peak: f64,
    /// The velocities after the first and the second piece.
    after_ramp: f64,
    after_hold: f64,
    /// Seconds of the three pieces.
    ramp: f64,
    hold: f64,
    release: f64,
}

impl Braking {
    /// The stop of `from`, whose place does not matter.
    pub(crate) fn new(from: &Sample, bounds: &Bounds) -> Self {
        let jerk = bounds.jerk();
        let slow = 1.0 / jerk;
        let half_square = 0.5 * from.acceleration * from.acceleration;
        // The direction of the velocity that is left once the acceleration has been taken back.
        let carried = jerk * from.velocity + half_square.copysign(from.acceleration);
        let sign = 1.0f64.copysign(carried);
        let (velocity, acceleration) = (sign * from.velocity, sign * from.acceleration);
        let square = jerk * velocity + half_square;
        let limit = bounds.deceleration();
        let triangle = square <= limit * limit;
        let peak = if triangle { libm::sqrt(square) } else { limit };
        let ramp = (peak + acceleration).abs() * slow;
        let release = peak * slow;
        let after_hold = 0.5 * peak * release;
        let (after_ramp, hold) = if triangle {
            (after_hold, 0.0)
        } else {
            let after_ramp = velocity + 0.5 * (acceleration - peak) * ramp;
            (after_ramp, ((after_ramp - after_hold) / peak).max(0.0))
        };
        Self {
            sign,
            velocity,
            acceleration,
            peak,
            after_ramp,
            after_hold,
            ramp,
            hold,
            release,
        }
    }

    /// Seconds until it rests.
    pub(crate) fn duration(&self) -> f64 {
        self.ramp + self.hold + self.release
    }

    /// How far it goes.
    pub(crate) fn distance(&self) -> f64 {
        let bend = (self.peak + self.acceleration) * self.ramp * self.ramp
            - self.peak * self.release * self.release;
        let double = self.ramp * (self.velocity + self.after_ramp)
            + self.hold * (self.after_ramp + self.after_hold)
            + self.release * self.after_hold;
        self.sign * (0.5 * double + bend * (1.0 / 12.0))
    }

    /// The pieces of the stop.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = Piece> {
        let rates = |velocity: f64, acceleration: f64| {
            Rates::new(self.sign * velocity, self.sign * acceleration)
        };
        let after_ramp = rates(self.after_ramp, -self.peak);
        let after_hold = rates(self.after_hold, -self.peak);
        let begins = rates(self.velocity, self.acceleration);
        let held = self.ramp + self.hold;
        [
            (self.ramp, begins, after_ramp),
            (held, after_ramp, after_hold),
            (held + self.release, after_hold, Rates::default()),
        ]
        .into_iter()
        .map(|(ends, entry, exit)| Piece {
            ends: Moment::from_seconds(ends),
            entry,
            exit,
        })
    }
}

impl Motion {
    /// Comes to rest as quickly as the limits allow, wherever that is; what was still to start is
    /// dropped. Gives the first tick at rest.
    ///
    /// A motion that rests as soon anyway is left alone, a stop under way above all. Where a stop
    /// would leave the travel, it is made with more jerk than the limit; where even that does not
    /// help, the motion under way, which was checked to stay inside, runs on to its end. From
    /// outside the travel every stop counts that does not lead farther out.
    pub fn stop(&mut self, now: Tick, limits: &Limits) -> Tick {
        self.drop_pending(now);
        self.fold(now);
        let Some(end) = self.end().filter(|end| now < *end) else {
            return now;
        };
        let commanded = self.commanded(now);
        let stop = TIMES
            .into_iter()
            .filter_map(|times| commanded.stop(now, limits, times))
            .find(|chain| chain.stays(limits));
        match stop {
            Some(chain) if chain.end < end => {
                self.take_over(now, &chain);
                chain.end
            }
            _ => end,
        }
    }
}
