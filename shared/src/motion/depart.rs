//! Taking on a move: from rest as it is asked for, otherwise as a retarget.

use super::beta::Beta;
use super::chain::Chain;
use super::trapezoid::Trapezoid;
use super::{Motion, Move, PlanError, Planned, Profile, smooth};
use crate::limits::Limits;
use crate::time::{LONGEST_MOVE, Tick, Ticks};
use crate::units::{Position, sum};

impl Motion {
    /// Takes on a move that leaves at `start`, or as soon after as the motion under way allows;
    /// `now` is the tick of the last setpoint that stays as it is, from which nothing may jump.
    ///
    /// From rest the move is the one asked for, or an error. Under way, a beta move is laid over
    /// what is left of another, for longer than asked where the sum would break a limit, and from
    /// the middle of the other on where there is no room before. Where there is none at all, it
    /// follows the other if that leads the same way; else, and where something else is under way,
    /// the axis stops first. An s-curve leads from the commanded position, velocity and acceleration
    /// to the new target, and a trapezoid from the commanded velocity. What is under way goes on
    /// until `start`. The axis stops first where the way to the new target would leave the travel, and
    /// where an s-curve would pass the limit of velocity or acceleration: in a stop that is harder than the
    /// jerk limit.
    ///
    /// A move that was taken on but has not left yet is replaced.
    ///
    /// # Errors
    /// A target outside the travel, a duration too short or too long. The motion is unchanged.
    pub fn start(
        &mut self,
        now: Tick,
        start: Tick,
        asked: Move,
        limits: &Limits,
    ) -> Result<Planned, PlanError> {
        inside(asked.target, limits)?;
        if asked.duration > LONGEST_MOVE {
            return Err(PlanError::TooLong);
        }
        let start = start.max(now);
        if !self.has_pending(now) {
            self.fold(now);
            return self.take_on(now, start, asked, limits);
        }
        self.replace(now, start, asked, limits)
    }

    /// Takes on a move in the place of one that waits, which stays where there is an error.
    ///
    /// Apart, so that the copy is on the stack only where it is needed.
    #[inline(never)]
    fn replace(
        &mut self,
        now: Tick,
        start: Tick,
        asked: Move,
        limits: &Limits,
    ) -> Result<Planned, PlanError> {
        let mut next = self.clone();
        next.drop_pending(now);
        next.fold(now);
        let planned = next.take_on(now, start, asked, limits)?;
        *self = next;
        Ok(planned)
    }

    /// Takes on a move while none waits.
    #[inline(never)]
    fn take_on(
        &mut self,
        now: Tick,
        start: Tick,
        asked: Move,
        limits: &Limits,
    ) -> Result<Planned, PlanError> {
        // Room for what comes is made by what has ended.
        self.phases.retain(|phase| phase.end() > now);
        if self.is_moving(start) {
            self.retarget(now, start, asked, limits)
        } else {
            self.depart(start, asked, limits)
        }
    }

    /// Adds a move from the rest that the motion has come to by `start`.
    #[inline(never)]
    pub(super) fn depart(
        &mut self,
        start: Tick,
        asked: Move,
        limits: &Limits,
    ) -> Result<Planned, PlanError> {
        let range = asked.target - self.target();
        let too_fast = |shortest: Option<Ticks>| match shortest {
            Some(shortest) if shortest > asked.duration => PlanError::TooFast { shortest },
            _ => PlanError::TooLong,
        };
        // The base moves by the range; what is laid over it stays as it is.
        let rest = sum(self.rest, range.counts());
        let mut chain = Chain::new(start, self.rest);
        let laid = match asked.profile {
            Profile::Beta => {
                let beta = Beta::new(start, range, asked.duration);
                if !beta.keeps(limits) {
                    return Err(too_fast(Beta::shortest(range, limits)));
                }
                self.betas.push(beta).map_err(|_| PlanError::TooLong)?;
                return Ok(Planned {
                    start,
                    end: beta.end(),
                });
            }
            Profile::SCurve => {
                smooth::from_rest(&mut chain, range, rest, asked.duration, limits)
                    .map_err(too_fast)?;
                Some(())
            }
            Profile::Trapezoid | Profile::ShapedTrapezoid { .. } => {
                let trapezoid = shape(range, asked, limits).ok_or_else(|| {
                    let shortest = Trapezoid::shortest(range, limits);
                    let shortest = shortest.map(|shortest| shortest.duration());
                    // Long enough, but its ramps are too steep: one tick more says so.
                    too_fast(shortest.map(|shortest| shortest.max(Ticks(asked.duration.0 + 1))))
                })?;
                let laid = chain.lay(&trapezoid.pieces(range.counts()), Some(rest));
                chain.step();
                laid
            }
        };
        laid.ok_or(PlanError::TooLong)?;
        chain.depart();
        let end = start.after(asked.duration);
        self.phases
            .extend_from_slice(&chain.phases)
            .map_err(|_| PlanError::TooLong)?;
        self.rest = rest;
        Ok(Planned { start, end })
    }
}

/// The trapezoid that is asked for, where the limits allow it.
fn shape(range: Position, asked: Move, limits: &Limits) -> Option<Trapezoid> {
    match asked.profile {
        Profile::ShapedTrapezoid {
            acceleration,
            deceleration,
        } => {
            let ramps = acceleration.0.saturating_add(deceleration.0);
            let cruise = Ticks(asked.duration.0.checked_sub(ramps)?);
            Trapezoid::new(acceleration, cruise, deceleration)
                .filter(|trapezoid| trapezoid.allowed(range, limits))
        }
        _ => Trapezoid::within(range, asked.duration, limits),
    }
}

/// That a target is inside the travel.
pub(super) fn inside(target: Position, limits: &Limits) -> Result<(), PlanError> {
    if limits.allow(target) {
        return Ok(());
    }
    let nearest = if target < limits.position_minimum() {
        limits.position_minimum()
    } else {
        limits.position_maximum()
    };
    Err(PlanError::OutsideTravel { target, nearest })
}

/// The least duration of a move from rest over `range`.
pub(super) fn shortest(profile: Profile, range: Position, limits: &Limits) -> Option<Ticks> {
    match profile {
        Profile::Beta => Beta::shortest(range, limits),
        Profile::SCurve => smooth::shortest_s_curve(range, limits),
        Profile::Trapezoid | Profile::ShapedTrapezoid { .. } => {
            Trapezoid::shortest(range, limits).map(|shortest| shortest.duration())
        }
    }
}
