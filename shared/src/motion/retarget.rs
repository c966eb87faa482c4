//! Another target, or other limits, in mid-move: from the commanded state, and nothing jumps.

use super::beta::Beta;
use super::chain::{Chain, turns};
use super::depart::{inside, shortest};
use super::passing::overshoots;
use super::smooth::Commanded;
use super::{Motion, Move, OVERLAID_MOVES, PlanError, Planned, Profile};
use super::{overlay, smooth, trapezoid};
use crate::limits::Limits;
use crate::time::{Tick, Ticks};
use crate::units::Position;

impl Motion {
    /// Changes the target under way at `start`: by laying a beta move over it, by a curve from the
    /// commanded state, or after a stop.
    pub(super) fn retarget(
        &mut self,
        now: Tick,
        start: Tick,
        asked: Move,
        limits: &Limits,
    ) -> Result<Planned, PlanError> {
        if asked.profile == Profile::Beta {
            return match self.lay_over(start, asked, limits) {
                Some(planned) => Ok(planned),
                None if self.is_on_the_way_to(asked.target) => {
                    let rest = self.end().unwrap_or(start).max(start);
                    self.go_on_from(rest, asked, limits)
                }
                None => self.stop_first(now, start, asked, limits),
            };
        }
        // Where there is no room for what goes on until `start`, it leaves at once.
        for start in [start, now] {
            let commanded = self.commanded(start);
            if asked.is_smooth() && overshoots(&commanded, limits) {
                break;
            }
            let mut chain = Chain::new(start, commanded.state.position.counts());
            let Some(()) = lead(&mut chain, &commanded, asked, limits) else {
                break;
            };
            if self.take_over(now, &chain) {
                let end = chain.end;
                return Ok(Planned { start, end });
            }
        }
        self.stop_first(now, start, asked, limits)
    }

    /// Changes the target after a stop; the motion is as it was where that cannot be.
    ///
    /// Apart, so that the copy is on the stack only where it is needed.
    #[inline(never)]
    fn stop_first(
        &mut self,
        now: Tick,
        start: Tick,
        asked: Move,
        limits: &Limits,
    ) -> Result<Planned, PlanError> {
        let before = self.clone();
        let rest = self.stop(now, limits).max(start);
        let planned = self.go_on_from(rest, asked, limits);
        if planned.is_err() {
            *self = before;
        }
        planned
    }

    /// Adds a move from the rest that the motion comes to at `start`, for longer than asked where
    /// the limits ask for it.
    fn go_on_from(
        &mut self,
        start: Tick,
        asked: Move,
        limits: &Limits,
    ) -> Result<Planned, PlanError> {
        let range = asked.target - self.target();
        let profile = match asked.profile {
            // Ramps that were meant for another range mean nothing for this one.
            Profile::ShapedTrapezoid { .. } => Profile::Trapezoid,
            profile => profile,
        };
        let duration = match profile {
            Profile::Beta => overlay::long_enough(range, asked.duration, limits),
            // Without a shortest duration what is asked for is refused as well.
            _ => shortest(profile, range, limits)
                .map_or(asked.duration, |least| least.max(asked.duration)),
        };
        let asked = Move {
            duration,
            profile,
            ..asked
        };
        self.depart(start, asked, limits)
    }

    /// Lays a beta move over the one under way; the end is that of both.
    ///
    /// Where there is no room for it at `start`, and the target is farther on, it begins in the
    /// middle of the other: from there that slows down, as this one speeds up.
    fn lay_over(&mut self, start: Tick, asked: Move, limits: &Limits) -> Option<Planned> {
        if !self.phases.is_empty() || self.betas.len() >= OVERLAID_MOVES {
            return None;
        }
        let range = asked.target - self.target();
        let laid = |from: Tick| {
            let place = self.at(from).position.counts();
            let left = Ticks(asked.duration.0.saturating_sub(from.since(start).0));
            overlay::overlay(place, &self.betas, from, range, left, limits)
        };
        let beta = laid(start).or_else(|| {
            let half = |beta: &Beta| Ticks(beta.duration().0 / 2 + 1);
            let middle = self
                .betas
                .first()
                .map(|beta| beta.start().after(half(beta)))?;
            (middle > start && self.is_on_the_way_to(asked.target))
                .then(|| laid(middle))
                .flatten()
        })?;
        self.betas.push(beta).ok()?;
        let end = self.end()?;
        let start = beta.start();
        Some(Planned { start, end })
    }

    /// Whether nothing but beta moves is under way, and they all lead towards `target`.
    fn is_on_the_way_to(&self, target: Position) -> bool {
        let farther = (target - self.target()).counts().signum();
        let along = |beta: &Beta| beta.range().counts().signum() == farther;
        self.phases.is_empty() && !self.betas.is_full() && self.betas.iter().all(along)
    }

    /// Goes on to the target inside other limits, from `now` on; gives the first tick at rest.
    ///
    /// What keeps the new limits is left alone, so raised limits change nothing. Otherwise the
    /// motion goes on as after a retarget to its own target: by trapezoid where that is under way,
    /// else by s-curve. A speed above the new limit comes down to it along one ramp, neither below
    /// it nor back, with the acceleration first taken back where there is some. A move that has
    /// not left yet, and that the new limits do not allow, leaves at its time for longer, or is
    /// made at once where the axis is still moving.
    ///
    /// # Errors
    /// A target outside the new travel; so is a target inside that can only be reached through
    /// outside. The motion is unchanged, and inside the limits that it was planned with: stop it
    /// first. An axis that rests has no target to lose, and takes any limits.
    pub fn change_limits(&mut self, now: Tick, limits: &Limits) -> Result<Tick, PlanError> {
        self.fold(now);
        let Some(end) = self.end().filter(|end| now < *end) else {
            return Ok(now);
        };
        let target = self.target();
        inside(target, limits)?;
        if self.keeps(now, limits) {
            return Ok(end);
        }
        if self.has_pending(now)
            && let Some(end) = self.depart_anew(now, limits)?
        {
            return Ok(end);
        }
        let commanded = self.commanded(now);
        let asked = Move {
            target,
            duration: end.since(now),
            profile: if commanded.steps {
                Profile::Trapezoid
            } else {
                Profile::SCurve
            },
        };
        let mut chain = Chain::new(now, commanded.state.position.counts());
        lead(&mut chain, &commanded, asked, limits).ok_or(PlanError::OutsideTravel {
            target,
            nearest: target,
        })?;
        self.take_over(now, &chain);
        Ok(chain.end)
    }

    /// Plans the move that waits for its start anew, where the axis rests until then.
    ///
    /// Apart, so that the copy is on the stack only where it is needed.
    #[inline(never)]
    fn depart_anew(&mut self, now: Tick, limits: &Limits) -> Result<Option<Tick>, PlanError> {
        let mut settled = self.clone();
        settled.drop_pending(now);
        let departure = self.departure(now);
        let Some(departure) = departure.filter(|_| !settled.is_moving(now)) else {
            return Ok(None);
        };
        let target = self.target();
        let least = shortest(departure.profile, target - settled.target(), limits);
        let asked = Move {
            target,
            duration: departure.duration.max(least.ok_or(PlanError::TooLong)?),
            profile: departure.profile,
        };
        let planned = settled.depart(departure.start, asked, limits)?;
        *self = settled;
        Ok(Some(planned.end))
    }

    /// The move that leaves from rest at `now` or later.
    fn departure(&self, now: Tick) -> Option<Departure> {
        let beta = self.betas.iter().find(|beta| beta.start() >= now);
        let phase = self
            .phases
            .iter()
            .find(|phase| phase.departs() && phase.first() >= now);
        match (beta, phase, self.phases.last()) {
            (Some(beta), ..) => Some(Departure {
                start: beta.start(),
                duration: beta.duration(),
                profile: Profile::Beta,
            }),
            (None, Some(phase), Some(last)) => Some(Departure {
                start: phase.first(),
                duration: last.end().since(phase.first()),
                profile: if phase.steps() {
                    Profile::Trapezoid
                } else {
                    Profile::SCurve
                },
            }),
            _ => None,
        }
    }

    /// Whether what is left from `now` on keeps `limits`; `false` where that is not plain.
    fn keeps(&self, now: Tick, limits: &Limits) -> bool {
        if self.takeover.is_some() {
            return false;
        }
        let place = self.at(now).position.counts();
        let betas = self.betas.iter().all(|beta| beta.keeps(limits))
            && (self.betas.is_empty() || overlay::keep(place, &self.betas, now, limits));
        let following = self.phases.iter().skip(1).map(Some).chain([None]);
        let mut joined = self.phases.iter().zip(following);
        betas
            && self.phases.iter().all(|phase| phase.keeps(now, limits))
            && joined.all(|(phase, next)| phase.joins(next, limits))
    }
}

/// A move that has not left yet.
struct Departure {
    start: Tick,
    duration: Ticks,
    profile: Profile,
}

/// Lays a chain from a commanded state to a target; `None` where it would leave the travel or last
/// longer than a move may.
#[inline(never)]
pub(super) fn lead(
    chain: &mut Chain,
    commanded: &Commanded,
    asked: Move,
    limits: &Limits,
) -> Option<()> {
    let Move {
        target,
        duration,
        profile,
    } = asked;
    match profile {
        Profile::Trapezoid | Profile::ShapedTrapezoid { .. } => {
            let velocity = turns(commanded.state.velocity.counts());
            let distance = turns((target - commanded.state.position).counts());
            let bounds = smooth::bounds(limits);
            let pieces = trapezoid::to_rest(velocity, distance, duration.seconds(), &bounds);
            chain.lay(&pieces, Some(target.counts()))?;
            chain.step();
        }
        Profile::Beta | Profile::SCurve => {
            commanded.rest_at(chain, target, duration, limits)?;
        }
    }
    chain.stays(limits).then_some(())
}
