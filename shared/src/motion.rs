//! From limits to setpoints.
//!
//! A [`Motion`] is what an axis is doing: a base (rest, or phases of constant jerk such as a stop,
//! a trapezoid or an s-curve) and beta moves laid over it. Every piece is evaluated from its own
//! start in integers, and what has ended is folded into the base, so nothing drifts.
//!
//! In f64, for planning on host and device and for study; units are the caller's own:
//!
//! | file | what it holds |
//! |---|---|
//! | `trajectory` | what every profile in f64 can tell |
//! | `bounds`, `error` | its limits, and why it cannot be made |
//! | `segments` | pieces of constant jerk |
//! | `beta::exact`, `beta::general` | the beta S-curve, with p = 5/2 and with any p |
//! | `trapezoid::exact` | constant acceleration, cruise, constant deceleration |
//! | `s_curve` | time-optimal with a limit of jerk, from state to state |
//! | `polynomial` | cubic, quintic and septic between boundary values |
//! | `bezier` | Bezier curves up to degree 16 |
//! | `sync` | several axes that arrive together, or on a straight line |
//!
//! In integers, what a node commands:
//!
//! | file | what it holds |
//! |---|---|
//! | `request` | what is asked for, what was taken on, and why not |
//! | `depart` | moves from rest |
//! | `retarget` | another target, or other limits, in mid-move |
//! | `stop` | the controlled stop from any state |
//! | `passing` | stops and moves that take over from a stream |
//! | `beta`, `overlay` | beta moves, and whether two of them laid over each other keep the limits |
//! | `trapezoid` | trapezoids of whole ticks, and to rest from any velocity |
//! | `smooth`, `way`, `change` | s-curves, how they get to a target, and one ramp of them |
//! | `chain`, `phase` | pieces of constant jerk |
//! | `stream` | knots at a fixed period, and the curves between them |
//! | `shaping` | setpoints that leave a mode of the machine at rest |
//! | `fixed` | 64-bit fractions |
//! | `elementary` | cube root, sine and exponential in little flash |

pub mod beta;
pub mod bezier;
pub mod bounds;
mod chain;
mod change;
mod depart;
mod elementary;
pub mod error;
mod fixed;
mod overlay;
mod passing;
mod phase;
pub mod polynomial;
mod request;
mod retarget;
pub mod s_curve;
pub mod segments;
pub mod shaping;
mod smooth;
mod stop;
pub mod stream;
pub mod sync;
pub mod trajectory;
pub mod trapezoid;
mod way;

pub use request::{Move, PlanError, Planned, Profile};
pub use smooth::shortest_s_curve;

use crate::time::Tick;
use crate::units::{Acceleration, Position, Velocity, sum};
use beta::{Beta, Contribution};
use chain::{Chain, MOST_PHASES};
use heapless::Vec;
use phase::Phase;
use smooth::Commanded;

/// Beta moves that may be under way on one axis at once: the first, and the one that a retarget
/// lays over it. Each costs the tick about 370 instructions.
pub const OVERLAID_MOVES: usize = 2;

/// One beta move more than may be under way: it waits for the others to end.
const BETAS: usize = OVERLAID_MOVES + 1;

/// Phases that the base may hold: the longest chain, and five that are left of another before it. Where more
/// are left, what is asked for leaves at once.
const PHASES: usize = MOST_PHASES + 5;

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

/// What one axis is doing: a base and the beta moves laid over it.
#[derive(Debug, Clone)]
pub struct Motion {
    /// Where the base rests once its phases have ended.
    rest: i64,
    /// What moves the base before that, in order; between two moves it rests.
    phases: Vec<Phase, PHASES>,
    betas: Vec<Beta, BETAS>,
    /// Phases that take over from the betas instead of moving the base under them.
    takeover: Option<Takeover>,
}

/// Phases that end the beta moves under way.
#[derive(Debug, Clone, Copy)]
struct Takeover {
    /// The first tick that is theirs.
    tick: Tick,
    /// Where the base rests before.
    rest: i64,
}

impl Motion {
    /// At rest at `position`.
    pub fn at_rest(position: Position) -> Self {
        Self {
            rest: position.counts(),
            phases: Vec::new(),
            betas: Vec::new(),
            takeover: None,
        }
    }

    /// The setpoint at `tick`, which must not be before the last one given to a method that
    /// changes the motion.
    #[inline(never)]
    pub fn at(&self, tick: Tick) -> Setpoint {
        let base = match self.takeover {
            Some(takeover) if tick < takeover.tick => Contribution::at_rest(takeover.rest),
            takeover => {
                let base = self.base(tick);
                if takeover.is_some() {
                    return base.setpoint();
                }
                base
            }
        };
        // Each move is far inside the travel, so no sum can wrap, and looking for it would cost as
        // much as a root.
        let sum = self.betas.iter().fold(base, |sum, beta| {
            let part = beta.contribution(tick);
            Contribution {
                position: sum.position.wrapping_add(part.position),
                velocity: sum.velocity.wrapping_add(part.velocity),
                acceleration: sum.acceleration.wrapping_add(part.acceleration),
            }
        });
        sum.setpoint()
    }

    #[inline(always)]
    fn base(&self, tick: Tick) -> Contribution {
        match self.phases.iter().find(|phase| !phase.is_over(tick)) {
            Some(phase) if tick < phase.first() => Contribution::at_rest(phase.entry_position()),
            Some(phase) => phase.contribution(tick),
            None => Contribution::at_rest(self.rest),
        }
    }

    /// The setpoint at `tick`, and whether it is a trapezoid's.
    fn commanded(&self, tick: Tick) -> Commanded {
        let covers = |phase: &Phase| phase.first() <= tick && tick < phase.end();
        let phase = self.phases.iter().find(|phase| covers(phase));
        Commanded {
            state: self.at(tick),
            steps: phase.is_some_and(Phase::steps),
        }
    }

    /// Where the axis comes to rest if nothing else is commanded.
    pub fn target(&self) -> Position {
        let over = match self.takeover {
            Some(_) => 0,
            None => self.betas_range(),
        };
        Position::from_counts(sum(self.rest, over))
    }

    fn betas_range(&self) -> i64 {
        self.betas
            .iter()
            .fold(0, |all, beta| sum(all, beta.range().counts()))
    }

    /// The first tick from which the axis rests at [`Self::target`]; `None` where it already does
    /// whatever the tick.
    pub fn end(&self) -> Option<Tick> {
        let phases = self.phases.last().map(Phase::end);
        let betas = self.betas.iter().map(Beta::end).max();
        match self.takeover {
            // What takes over may have nowhere to go, and until then the betas go on.
            Some(takeover) => phases.max(Some(takeover.tick)),
            None => phases.max(betas),
        }
    }

    /// Whether the setpoint still changes, or will, after `tick`.
    pub fn is_moving(&self, tick: Tick) -> bool {
        // Asked several times in each tick: without looking for the latest of the ends.
        self.phases.last().is_some_and(|last| tick < last.end())
            || match self.takeover {
                Some(takeover) => tick < takeover.tick,
                None => self.betas.iter().any(|beta| tick < beta.end()),
            }
    }

    /// Whether it rests whatever the tick.
    pub(crate) fn has_settled(&self) -> bool {
        self.phases.is_empty() && self.betas.is_empty() && self.takeover.is_none()
    }

    /// Forgets what has ended by `tick`, whose place the base takes over exactly.
    pub fn fold(&mut self, tick: Tick) {
        // Asked at every tick, and hardly ever so.
        let ended = self.takeover.is_some_and(|takeover| takeover.tick <= tick)
            || self.phases.last().is_some_and(|last| last.is_over(tick))
            || self.betas.iter().any(|beta| beta.end() <= tick);
        if !ended {
            return;
        }
        if self.takeover.is_some_and(|takeover| takeover.tick <= tick) {
            self.takeover = None;
            self.betas.clear();
        }
        if self.phases.last().is_some_and(|last| last.is_over(tick)) {
            self.phases.clear();
        }
        if self.takeover.is_some() {
            // What takes over stands on what the betas came to.
            return;
        }
        let rest = &mut self.rest;
        let phases = &mut self.phases;
        self.betas.retain(|beta| {
            let ended = beta.end() <= tick;
            if ended {
                let range = beta.range().counts();
                *rest = sum(*rest, range);
                phases.iter_mut().for_each(|phase| phase.shift(range));
            }
            !ended
        });
    }

    /// Whether a move is to start at `now` or later.
    fn has_pending(&self, now: Tick) -> bool {
        self.takeover.is_some_and(|takeover| now <= takeover.tick)
            || self.betas.iter().any(|beta| beta.start() >= now)
            || self
                .phases
                .iter()
                .any(|phase| phase.departs() && phase.first() >= now)
    }

    /// Drops the moves that were to start at `now` or later, and so have not moved anything yet.
    fn drop_pending(&mut self, now: Tick) {
        if let Some(takeover) = self.takeover.filter(|takeover| now <= takeover.tick) {
            self.rest = takeover.rest;
            self.phases.clear();
            self.takeover = None;
        }
        let pending = |phase: &Phase| phase.departs() && phase.first() >= now;
        if let Some(first) = self.phases.iter().position(pending) {
            if let Some(phase) = self.phases.get(first) {
                self.rest = phase.entry_position();
            }
            self.phases.truncate(first);
        }
        self.betas.retain(|beta| beta.start() < now);
    }

    /// Lets `chain` take over from whatever is under way at its start, which is not before `now`.
    ///
    /// `false`, and the motion is as it was, where there is no room for what goes on until then.
    fn take_over(&mut self, now: Tick, chain: &Chain) -> bool {
        let tick = chain.start;
        if tick <= now {
            self.phases.clear();
            self.betas.clear();
            self.takeover = None;
        } else {
            self.phases.retain(|phase| phase.end() > now);
            let before = |phase: &Phase| phase.first() < tick;
            let kept = self.phases.iter().filter(|phase| before(phase)).count();
            if kept + chain.phases.len() > PHASES {
                return false;
            }
            // Before an earlier takeover there are but betas.
            let begun = self.takeover.is_none_or(|takeover| takeover.tick < tick);
            if kept == 0 && begun && !self.betas.is_empty() {
                self.takeover = Some(Takeover {
                    tick,
                    rest: self.rest,
                });
            } else if let Some(takeover) = &mut self.takeover {
                takeover.tick = takeover.tick.min(tick);
            }
            self.phases.truncate(kept);
            if let Some(last) = self.phases.last_mut() {
                last.cut(tick);
            }
        }
        // There is room, so there is no error to look at.
        let _ = self.phases.extend_from_slice(&chain.phases);
        self.rest = chain.rest;
        true
    }
}
