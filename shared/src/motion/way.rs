//! The way from a state to rest at a target, seen in one direction: as quickly as the limits allow, in a
//! chosen time, or down from above the velocity limit.
//!
//! All of them are a change of velocity, a cruise and a stop; [`wanted`] finds the one among a family of
//! these that gets to the target.
//!
//! The quickest motion peaks at the highest velocity from which it can still stop in time: every higher
//! peak leads farther. What it reaches grows from the peak on that the velocity comes to by itself
//! while the acceleration is taken back; with that peak it is the quickest stop, unless the axis is
//! braking. Then there is a gap: a target a little beyond that stop, and short of where it would get to
//! by releasing the brake for good before braking again. There it releases the brake in part, for the longer the
//! farther the target is.
//!
//! [`super::s_curve`] solves the same in closed forms, for any stop velocity, and a test holds both to each
//! other. A device does with this: it takes a tenth of the flash.

mod wanted;

use super::bounds::Bounds;
use super::chain::Piece;
use super::change::Strength;
use super::phase::Moment;
use super::trajectory::Sample;
use crate::time::Ticks;
use wanted::{Family, Wanted};
pub(crate) use wanted::{PIECES, Tried};

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
            family: Family::Velocity,
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
        let tried = wanted.cruising(self.fastest)?;
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
        let Wanted { velocity, .. } = self.wanted;
        if velocity <= self.fastest && self.wanted.released() <= self.fastest {
            return None;
        }
        let tried = match self.at_the_limit() {
            Some(tried) => tried,
            None => self.wanted.cruising(self.fastest)?,
        };
        Some(tried.pieces(self.sign))
    }

    /// The quickest motion, which [`Self::pieces`] lays; `None` where the numbers are beyond what any axis
    /// does.
    pub(crate) fn quickest(&self) -> Option<Tried<f64>> {
        self.at_the_limit()
            .or_else(|| self.wanted.peaking(self.fastest))
    }

    /// The pieces of the quickest motion.
    pub(crate) fn pieces(&self, quickest: &Tried<f64>) -> [Piece; PIECES] {
        quickest.pieces(self.sign)
    }

    /// The motion that cruises at the velocity limit, where the target is far enough for that.
    fn at_the_limit(&self) -> Option<Tried<f64>> {
        if self.wanted.is_clearly_beyond(self.fastest) {
            return None;
        }
        let mut tried = self.wanted.with(self.fastest);
        (tried.beyond <= 0.0).then(|| {
            tried.cruise = -tried.beyond / self.fastest;
            tried
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::s_curve::{self, SignedBounds};
    use crate::motion::trajectory::Trajectory;
    use crate::units::COUNTS_PER_TURN;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        /// Against the solver in closed forms, from states inside the limits.
        #[test]
        fn the_quickest_is_as_quick_as_the_time_optimal_one(
            part in -1.0..1.0f64,
            acceleration in -1.0..1.0f64,
            beyond in -6.0..1.0f64,
            limits in [0.5..2.0f64, 5.0..20.0f64, 5.0..20.0f64, 50.0..5000.0f64],
        ) {
            let [fastest, rise, fall, jerk] = limits;
            let acceleration = acceleration * rise.min(fall);
            let taken = acceleration * acceleration / (2.0 * jerk);
            prop_assume!(taken < fastest);
            let velocity = part * (fastest - taken);
            let from = Sample { velocity, acceleration, ..Sample::default() };
            let signed = SignedBounds::new(fastest, -fastest, rise, -fall, jerk).expect("limits");
            let bounds = Bounds::new(fastest, rise, fall, jerk).expect("limits");
            let stop = s_curve::change_velocity(from, 0.0, &signed).expect("a stop");
            let target = stop.end().position + libm::exp10(beyond);
            let exact = |target| {
                s_curve::time_optimal(from, Sample::at_rest(target), &signed).map(|curve| curve.duration())
            };
            let way = Way::new(&from, target, 1.0, rise, &bounds);
            let quickest = way.quickest().expect("a motion");
            // A device's motion may miss its target by four counts, which shows in the time where little more
            // than the stop is to go: it is as quick as the ones to there.
            let four = 4.0 / COUNTS_PER_TURN as f64;
            let times = [-four, 0.0, four].map(|by| exact(target + by).expect("a motion"));
            let least = times.into_iter().fold(f64::INFINITY, f64::min) * (1.0 - 1e-8);
            let most = times.into_iter().fold(0.0, f64::max) * (1.0 + 1e-8);
            let seconds = quickest.duration();
            prop_assert!(
                least < seconds && seconds < most,
                "{seconds} {times:?} {from:?} {target} {limits:?}"
            );
        }
    }
}
