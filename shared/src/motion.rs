//! From limits to setpoints.
//!
//! A [`Motion`] is what an axis is doing: a base (rest, or phases of constant jerk such as a stop
//! or a trapezoid) and beta moves laid over it. Every piece is evaluated from its own start tick
//! in integers, and what has ended is folded into the base, so nothing drifts.
//!
//! | file | what it holds |
//! |---|---|
//! | `trajectory` | what every profile in f64 can tell |
//! | `bounds`, `error` | its limits, and why it cannot be made |
//! | `segments` | pieces of constant jerk in f64 |
//! | `beta` | the beta S-curve, integers and f64 |
//! | `s_curve` | time-optimal with a limit of jerk, from state to state |
//! | `trapezoid` | constant acceleration, cruise, constant deceleration |
//! | `polynomial` | cubic, quintic and septic between boundary values |
//! | `bezier` | Bezier curves up to degree 16 |
//! | `sync` | several axes that arrive together, or on a straight line |
//! | `stop` | the controlled stop from any state |
//! | `retarget` | whether beta moves laid over each other keep the limits |
//! | `shaping` | setpoints that leave a mode of the machine at rest |
//! | `stream` | knots at a fixed period, and the curves between them |
//! | `phase` | a polynomial piece in integers |
//! | `fixed` | 64-bit fractions |

pub mod beta;
pub mod bezier;
pub mod bounds;
pub mod error;
mod fixed;
mod phase;
pub mod polynomial;
mod retarget;
pub mod s_curve;
pub mod segments;
pub mod shaping;
mod stop;
pub mod stream;
pub mod sync;
pub mod trajectory;
pub mod trapezoid;

use crate::limits::Limits;
use crate::time::{LONGEST_MOVE, Tick, Ticks};
use crate::units::{Acceleration, Position, Velocity};
use beta::{Beta, Contribution};
use core::fmt;
use heapless::Vec;
use phase::{Entry, Phase};
use trapezoid::Trapezoid;

/// Beta moves that may be under way on one axis at once: the first, and those laid over it by
/// retargets. One more than that waits for a stop.
pub const OVERLAID_MOVES: usize = 4;

/// Phases that the base may hold: a stop and the trapezoid that follows it.
const BASE_PHASES: usize = stop::STOP_PHASES + trapezoid::TRAPEZOID_PHASES;

/// What an axis is told to do at one tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Setpoint {
    /// Where to be.
    pub position: Position,
    /// How fast to pass through there.
    pub velocity: Velocity,
    /// How the velocity changes there.
    pub acceleration: Acceleration,
}

/// The shape of a move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// The beta S-curve.
    Beta,
    /// The trapezoid that cruises as slowly as its duration allows.
    Trapezoid,
    /// A trapezoid that accelerates and decelerates for these times.
    ShapedTrapezoid {
        /// How long it accelerates.
        acceleration: Ticks,
        /// How long it decelerates.
        deceleration: Ticks,
    },
}

/// A move that is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Move {
    /// Where to come to rest.
    pub target: Position,
    /// From leaving to rest.
    pub duration: Ticks,
    /// How to get there.
    pub profile: Profile,
}

/// A move that was taken on: when it starts and when it has arrived.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Planned {
    /// The last tick at rest.
    pub start: Tick,
    /// The first tick at the target.
    pub end: Tick,
}

/// Why a move was not taken on. The motion is then as it was before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlanError {
    /// The target is outside the travel.
    OutsideTravel {
        /// What was asked for.
        target: Position,
        /// The nearest that is allowed.
        nearest: Position,
    },
    /// The duration is too short for the limits.
    TooFast {
        /// The least duration that the limits allow.
        shortest: Ticks,
    },
    /// The move would last longer than [`LONGEST_MOVE`].
    TooLong,
}

impl fmt::Display for PlanError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutsideTravel { target, nearest } => write!(
                formatter,
                "target {} rad is outside the travel, which ends at {} rad",
                target.radians(),
                nearest.radians()
            ),
            Self::TooFast { shortest } => write!(
                formatter,
                "duration is too short for the limits; it must be at least {} s",
                shortest.seconds()
            ),
            Self::TooLong => write!(
                formatter,
                "duration must be at most {} s",
                LONGEST_MOVE.seconds()
            ),
        }
    }
}

impl core::error::Error for PlanError {}

/// What one axis is doing: a base and the beta moves laid over it.
#[derive(Debug, Clone)]
pub struct Motion {
    /// Where the base rests once its phases have ended.
    rest: i64,
    /// What moves the base before that, in order; between two moves it rests.
    phases: Vec<Phase, BASE_PHASES>,
    betas: Vec<Beta, OVERLAID_MOVES>,
}

impl Motion {
    /// At rest at `position`.
    pub fn at_rest(position: Position) -> Self {
        Self {
            rest: position.counts(),
            phases: Vec::new(),
            betas: Vec::new(),
        }
    }

    /// The setpoint at `tick`, which must not be before the last one given to a method that
    /// changes the motion.
    pub fn at(&self, tick: Tick) -> Setpoint {
        let mut sum = self.base(tick);
        for beta in &self.betas {
            let part = beta.contribution(tick);
            sum.position = sum.position.saturating_add(part.position);
            sum.velocity = sum.velocity.saturating_add(part.velocity);
            sum.acceleration = sum.acceleration.saturating_add(part.acceleration);
        }
        Setpoint {
            position: Position::from_counts(sum.position),
            velocity: Velocity::from_counts(sum.velocity),
            acceleration: Acceleration::from_counts(sum.acceleration),
        }
    }

    fn base(&self, tick: Tick) -> Contribution {
        let at_rest = |position| Contribution {
            position,
            ..Contribution::default()
        };
        match self.phases.iter().find(|phase| tick < phase.end()) {
            Some(phase) if tick < phase.start() => at_rest(phase.entry_position()),
            Some(phase) => phase.contribution(tick),
            None => at_rest(self.rest),
        }
    }

    /// Where the axis comes to rest if nothing else is commanded.
    pub fn target(&self) -> Position {
        let over = self
            .betas
            .iter()
            .fold(0i64, |sum, beta| sum.saturating_add(beta.range().counts()));
        Position::from_counts(self.rest.saturating_add(over))
    }

    /// The first tick from which the axis rests at [`Self::target`]; `None` where it already does
    /// whatever the tick.
    pub fn end(&self) -> Option<Tick> {
        let phases = self.phases.last().map(Phase::end);
        let betas = self.betas.iter().map(Beta::end).max();
        phases.max(betas)
    }

    /// Whether the setpoint still changes, or will, after `tick`.
    pub fn is_moving(&self, tick: Tick) -> bool {
        self.end().is_some_and(|end| tick < end)
    }

    /// Forgets what has ended by `tick`, whose place the base takes over exactly.
    pub fn fold(&mut self, tick: Tick) {
        if self.phases.last().is_some_and(|last| last.end() <= tick) {
            self.phases.clear();
        }
        let rest = &mut self.rest;
        let phases = &mut self.phases;
        self.betas.retain(|beta| {
            let ended = beta.end() <= tick;
            if ended && phases.is_empty() {
                *rest = rest.saturating_add(beta.range().counts());
            }
            // Over a base that still moves an ended beta stays as a constant, until both rest.
            !(ended && phases.is_empty())
        });
    }

    /// Drops the moves that were to start at `now` or later, and so have not moved anything yet.
    fn drop_pending(&mut self, now: Tick) {
        let pending = |phase: &Phase| phase.departs() && phase.start() >= now;
        if let Some(first) = self.phases.iter().position(pending) {
            if let Some(phase) = self.phases.get(first) {
                self.rest = phase.entry_position();
            }
            self.phases.truncate(first);
        }
        self.betas.retain(|beta| beta.start() < now);
    }

    /// Takes on a move that leaves at `start`, or as soon after as the motion under way allows;
    /// `now` is the tick of the last setpoint, from which nothing may jump.
    ///
    /// From rest the move is the one asked for, or an error. Under way, a beta move is laid over
    /// what is left of the others, for longer than asked where the sum would break a limit; where
    /// no such duration is near, and for a trapezoid, the axis stops first and goes on from there.
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
        let target = asked.target;
        if !limits.allow(target) {
            let nearest = if target < limits.position_minimum() {
                limits.position_minimum()
            } else {
                limits.position_maximum()
            };
            return Err(PlanError::OutsideTravel { target, nearest });
        }
        if asked.duration > LONGEST_MOVE {
            return Err(PlanError::TooLong);
        }
        let start = start.max(now);
        let mut next = self.clone();
        next.drop_pending(now);
        next.fold(now);
        let planned = if next.is_moving(start) {
            next.retarget(now, start, asked, limits)?
        } else {
            next.depart(start, asked, limits)?
        };
        *self = next;
        Ok(planned)
    }

    /// Adds a move from the rest that the motion has come to by `start`.
    fn depart(&mut self, start: Tick, asked: Move, limits: &Limits) -> Result<Planned, PlanError> {
        let range = asked.target - self.target();
        let too_fast = |shortest: Option<Ticks>| match shortest {
            Some(shortest) if shortest > asked.duration => PlanError::TooFast { shortest },
            _ => PlanError::TooLong,
        };
        let trapezoid = match asked.profile {
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
            Profile::Trapezoid => Trapezoid::within(range, asked.duration, limits),
            Profile::ShapedTrapezoid {
                acceleration,
                deceleration,
            } => {
                let ramps = acceleration.0.saturating_add(deceleration.0);
                let cruise = asked.duration.0.checked_sub(ramps).map(Ticks);
                cruise
                    .and_then(|cruise| Trapezoid::new(acceleration, cruise, deceleration))
                    .filter(|trapezoid| trapezoid.allowed(range, limits))
            }
        };
        let trapezoid = trapezoid.ok_or_else(|| {
            let shortest = Trapezoid::shortest(range, limits).map(|shortest| shortest.duration());
            // Long enough, but its ramps are too steep: one tick more says so.
            let least = shortest.map(|shortest| shortest.max(Ticks(asked.duration.0 + 1)));
            too_fast(least)
        })?;
        // The base moves by the range; what is laid over it stays as it is.
        let rest = self.rest.saturating_add(range.counts());
        let phases = trapezoid
            .phases(start, self.rest, rest)
            .ok_or(PlanError::TooLong)?;
        self.phases
            .extend_from_slice(&phases)
            .map_err(|_| PlanError::TooLong)?;
        self.rest = rest;
        Ok(Planned {
            start,
            end: start.after(trapezoid.duration()),
        })
    }

    /// Changes the target under way: by laying a beta move over the rest, or after a stop.
    fn retarget(
        &mut self,
        now: Tick,
        start: Tick,
        asked: Move,
        limits: &Limits,
    ) -> Result<Planned, PlanError> {
        let range = asked.target - self.target();
        if asked.profile == Profile::Beta && self.phases.is_empty() && !self.betas.is_full() {
            let laid_over =
                retarget::overlay(self.rest, &self.betas, start, range, asked.duration, limits);
            if let Some(beta) = laid_over
                && self.betas.push(beta).is_ok()
            {
                let end = self.end().unwrap_or(start);
                return Ok(Planned { start, end });
            }
        }
        let start = self.stop(now, limits).max(start);
        let range = asked.target - self.target();
        let (profile, shortest) = match asked.profile {
            Profile::Beta => (Profile::Beta, Beta::shortest(range, limits)),
            // Ramps that were meant for another range mean nothing for this one.
            Profile::Trapezoid | Profile::ShapedTrapezoid { .. } => (
                Profile::Trapezoid,
                Trapezoid::shortest(range, limits).map(|shortest| shortest.duration()),
            ),
        };
        let duration = asked.duration.max(shortest.ok_or(PlanError::TooLong)?);
        let asked = Move {
            duration,
            profile,
            ..asked
        };
        self.depart(start, asked, limits)
    }

    /// Comes to rest as quickly as the limits allow, wherever that is; what was still to start is
    /// dropped. Gives the first tick at rest.
    ///
    /// Where whole ticks would carry the stop out of the travel, the motion under way, which was
    /// checked to stay inside and is as good as at its end, runs on to it. From outside the
    /// travel every stop counts that does not lead farther out.
    pub fn stop(&mut self, now: Tick, limits: &Limits) -> Tick {
        self.drop_pending(now);
        self.fold(now);
        let Some(end) = self.end().filter(|end| now < *end) else {
            return now;
        };
        let state = self.at(now);
        // A trapezoid takes no notice of the jerk limit at its corners, and a stop that gave its
        // acceleration back slowly would speed up on and on: it ends here, as at a corner.
        let speeds_up = self
            .phases
            .iter()
            .any(|phase| phase.start() <= now && now < phase.end() && phase.speeds_up());
        let acceleration = if speeds_up {
            Acceleration::ZERO
        } else {
            state.acceleration
        };
        let entry = Entry {
            tick: now,
            position: state.position.counts(),
            velocity: state.velocity.counts() as f64,
            acceleration: acceleration.counts() as f64,
        };
        // From outside the travel, the way back in belongs to it.
        let least = limits.position_minimum().min(state.position);
        let greatest = limits.position_maximum().max(state.position);
        let inside = |stop: &stop::Stop| {
            let place = Position::from_counts(stop.rest.position);
            (least..=greatest).contains(&place)
        };
        let sooner = |stop: &stop::Stop| stop.rest.tick < end;
        let stop = match stop::plan(entry, limits, 1.0) {
            // A motion that rests as soon is left alone, a stop under way above all.
            Some(stop) if inside(&stop) => Some(stop).filter(sooner),
            _ => HARDER.into_iter().find_map(|times| {
                stop::plan(entry, limits, times)
                    .filter(inside)
                    .filter(sooner)
            }),
        };
        match stop {
            Some(stop) => {
                self.betas.clear();
                self.phases.clear();
                // Three phases in room for six: there is no error to look at.
                let _ = self.phases.extend_from_slice(&stop.phases);
                self.rest = stop.rest.position;
                stop.rest.tick
            }
            None => end,
        }
    }
}

/// Multiples of the jerk limit that a stop is tried with where it would end outside of the travel:
/// the travel goes before the jerk.
const HARDER: [f64; 4] = [4.0, 16.0, 256.0, 65_536.0];
