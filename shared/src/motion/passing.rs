//! Taking over from what is not a [`Motion`], a stream above all: from any commanded state.

use super::chain::Chain;
use super::depart::inside;
use super::retarget::lead;
use super::smooth::{Commanded, ROUNDING_MARGIN};
use super::stop::HARDER;
use super::{Motion, Move, PlanError, Planned, Setpoint};
use crate::limits::Limits;
use crate::time::{LONGEST_MOVE, Tick};

impl Motion {
    /// The quickest stop inside the limits from `state`, which was commanded at `now`.
    ///
    /// As [`Self::stop`] it takes more jerk than the limit rather than leave the travel, and rather
    /// than pass another limit: a stream may come there with any acceleration. `None` where
    /// even that would leave them, or the state is beyond what any axis does.
    pub fn stop_from(now: Tick, state: Setpoint, limits: &Limits) -> Option<Self> {
        let commanded = Commanded {
            state,
            steps: false,
        };
        [1.0].into_iter().chain(HARDER).find_map(|times| {
            if passes(&state, limits, times, ROUNDING_MARGIN) {
                return None;
            }
            let mut chain = Chain::new(now, state.position.counts());
            commanded.stop(&mut chain, limits, times)?;
            chain
                .stays(limits)
                .then(|| Self::of(state, now, &chain))
                .flatten()
        })
    }

    /// A move from `state`, which was commanded at `now`, as [`Self::start`] makes it in mid-move:
    /// a trapezoid goes on from the velocity, everything else along an s-curve, for longer than
    /// asked where the limits ask for it.
    ///
    /// # Errors
    /// A target outside the travel, or one that can only be reached through outside, or by passing
    /// another limit: stop first. A duration that is too long.
    pub fn start_from(
        now: Tick,
        state: Setpoint,
        asked: Move,
        limits: &Limits,
    ) -> Result<(Self, Planned), PlanError> {
        let target = asked.target;
        inside(target, limits)?;
        if asked.duration > LONGEST_MOVE {
            return Err(PlanError::TooLong);
        }
        let commanded = Commanded {
            state,
            steps: false,
        };
        let mut chain = Chain::new(now, state.position.counts());
        let outside = PlanError::OutsideTravel {
            target,
            nearest: target,
        };
        if asked.is_smooth() && overshoots(&commanded, limits) {
            return Err(outside);
        }
        lead(&mut chain, &commanded, asked, limits).ok_or(outside)?;
        let motion = Self::of(state, now, &chain).ok_or(outside)?;
        let end = chain.end;
        Ok((motion, Planned { start: now, end }))
    }

    fn of(state: Setpoint, now: Tick, chain: &Chain) -> Option<Self> {
        let mut motion = Self::at_rest(state.position);
        motion.take_over(now, chain).then_some(motion)
    }
}

/// Whether a limit, less a margin, is passed while a multiple of the jerk limit takes the acceleration
/// back: seen along the acceleration, v + a^2 / 2 j is the velocity then.
///
/// So the velocity limit is passed; or, where the speed falls by more than it may rise with, standstill is
/// before no more of it is left than that.
///
/// A state that is above its limit, since that was lowered, does not pass it any more; nor does one that
/// steps to another acceleration, with an infinite multiple.
pub(super) fn passes(state: &Setpoint, limits: &Limits, times: f64, margin: f64) -> bool {
    let acceleration = state.acceleration.counts() as f64;
    let twice_jerk = 2.0 * limits.jerk().counts() as f64 * times;
    let gained = acceleration * acceleration / twice_jerk;
    let speed = state.velocity.counts() as f64;
    let along = if acceleration < 0.0 { -speed } else { speed };
    let fastest = limits.velocity().counts() as f64;
    let mut most = fastest;
    let strong = state.acceleration.abs();
    if along <= 0.0 && limits.acceleration() < strong && strong <= limits.deceleration() {
        let rises = limits.acceleration().counts() as f64;
        most = most.min(rises * rises / twice_jerk);
    }
    gained > 0.0 && along <= fastest + ROUNDING_MARGIN && along + gained > most - margin
}

/// Whether a smooth way on would pass a limit.
///
/// A stop that has been made with more jerk than the limit, and a stream, come to accelerations that
/// the jerk limit takes too long to take back. The tolerance is what rounding a state to counts makes
/// of a motion that comes to the limit just so: a count of acceleration for a / j seconds.
pub(super) fn overshoots(commanded: &Commanded, limits: &Limits) -> bool {
    let state = &commanded.state;
    let seconds = (state.acceleration.counts() as f64).abs() / limits.jerk().counts() as f64;
    !commanded.steps && passes(state, limits, 1.0, -ROUNDING_MARGIN * (1.0 + seconds))
}
