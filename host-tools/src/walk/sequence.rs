//! The whole motion as time goes on: up, walk, settle, down.

use super::climb::Climb;
use super::order::Order;
use crate::gait::{Body, Gait, GaitError, Planner, Quadruped, State};

/// A motion is looked at by itself so often, in s: at each knot of the stream and halfway between.
pub(super) const GRID: f64 = 0.005;

/// Marks of the grid from knot to knot.
pub(super) const MARKS_PER_KNOT: u64 = 2;

/// How far ahead it goes in one go, in s.
const MOST_AHEAD: f64 = 60.0;

/// How a robot walks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The first gait; none to stand only.
    pub gait: Option<Gait>,
    /// What the body does from the first step on.
    pub body: Body,
    /// The hips above the ground where the robot sits, in m.
    pub sitting: f64,
    /// Where the motion begins: sitting, or standing already.
    pub begins_standing: bool,
}

impl Settings {
    /// A walk that sits at half its height, and begins there.
    pub fn new(gait: Option<Gait>, body: Body) -> Self {
        Self {
            gait,
            body,
            sitting: 0.5 * body.height,
            begins_standing: false,
        }
    }

    /// Whether the numbers make sense.
    ///
    /// # Errors
    /// [`Body::check`], [`Gait::check`]; standing that is to go somewhere.
    pub fn check(&self) -> Result<(), GaitError> {
        self.body.check()?;
        Body::standing(self.sitting).check()?;
        match &self.gait {
            Some(gait) => gait.check(),
            None if self.body != self.body.at_rest() => Err(GaitError::Standing),
            None => Ok(()),
        }
    }

    /// How the body is where the motion begins.
    pub fn start(&self) -> Body {
        Body::standing(if self.begins_standing {
            self.body.height
        } else {
            self.sitting
        })
    }
}

/// What the robot is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Up from its seat, feet where they are.
    StandingUp,
    /// Walks, or stands where it has no gait; obeys.
    Walking,
    /// After a stop: the last steps.
    Settling,
    /// Down to its seat.
    SittingDown,
    /// Sits, at rest.
    Sitting,
}

impl Phase {
    /// In words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::StandingUp => "stands up",
            Self::Walking => "walks",
            Self::Settling => "settles",
            Self::SittingDown => "sits down",
            Self::Sitting => "sits",
        }
    }
}

/// The motion of every joint from the first knot to the last. Equal orders at equal times give equal
/// motions, bit by bit, however finely it is looked at; so the same can be gone through again, see
/// [`Replay`](super::Replay).
#[derive(Debug, Clone)]
pub struct Sequence {
    /// Only ever on a mark of the grid, or where an order was taken.
    planner: Planner,
    /// What the planner said where it is.
    state: State,
    /// The last mark that has passed.
    mark: u64,
    /// From one mark that is looked at to the next.
    stride: u64,
    /// The last time that was asked for, in s.
    time: f64,
    phase: Phase,
    body: Body,
    gait: Option<Gait>,
    sitting: f64,
    climb: Climb,
    /// Whether a stop waits until the robot stands.
    stops: bool,
}

impl Sequence {
    /// At rest, at time 0.
    ///
    /// # Errors
    /// Settings out of their ranges; a seat that a leg does not reach.
    pub fn new(quadruped: Quadruped, settings: &Settings) -> Result<Self, GaitError> {
        settings.check()?;
        let start = settings.start();
        let mut planner = Planner::new(quadruped, start)?;
        let state = planner.advance(0.0)?;
        let mut sequence = Self {
            planner,
            state,
            mark: 0,
            stride: 1,
            time: 0.0,
            phase: Phase::StandingUp,
            body: settings.body,
            gait: settings.gait,
            sitting: settings.sitting,
            climb: Climb::new(start, Body::standing(settings.body.height)),
            stops: false,
        };
        sequence.pass()?;
        Ok(sequence)
    }

    /// What it is doing.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// What the body is asked to do.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// How long a cycle of the gait lasts, in s; 0 where there is none.
    pub(super) fn period(&self) -> f64 {
        self.gait.map_or(0.0, |gait| gait.period)
    }

    /// Whether all that was asked for has come in wholly.
    pub(super) fn is_settled(&self) -> bool {
        self.planner.is_settled() && matches!(self.phase, Phase::Walking | Phase::Sitting)
    }

    /// Looks at every so many marks from now on, for a glance ahead.
    pub(super) fn stride(&mut self, marks: u64) {
        self.stride = marks.max(1);
    }

    /// Takes an order, now. While it stands up an order waits for the first step; after
    /// [`Order::Stop`] it changes nothing.
    ///
    /// # Errors
    /// What is out of its range; nothing is changed then.
    pub fn order(&mut self, order: &Order) -> Result<(), GaitError> {
        order.check()?;
        if !matches!(self.phase, Phase::StandingUp | Phase::Walking) || self.stops {
            return Ok(());
        }
        self.state = self.planner.advance(self.time)?;
        let is_up = self.phase == Phase::Walking;
        match order {
            Order::Body(body) => {
                self.body = *body;
                if is_up {
                    self.planner.command(body)?;
                }
            }
            Order::Gait(gait) => {
                self.gait = Some(*gait);
                if is_up {
                    self.planner.walk(gait)?;
                }
            }
            Order::Stand => {
                self.gait = None;
                self.planner.stop();
            }
            Order::Stop if is_up => self.settle(),
            Order::Stop => self.stops = true,
        }
        Ok(())
    }

    fn settle(&mut self) {
        self.phase = Phase::Settling;
        self.planner.stop();
    }

    /// What all joints do at a time in s, which is not before the last one.
    ///
    /// # Errors
    /// A foot that its leg does not reach; a time that is over or more than a minute ahead.
    pub fn advance(&mut self, time: f64) -> Result<State, GaitError> {
        if !(self.time..=self.time + MOST_AHEAD).contains(&time) {
            return Err(GaitError::Time {
                now: self.time,
                asked: time,
                most: MOST_AHEAD,
            });
        }
        loop {
            let next = (self.mark + self.stride) as f64 * GRID;
            if next > time {
                break;
            }
            self.state = self.planner.advance(next)?;
            self.mark += self.stride;
            self.pass()?;
        }
        self.time = time;
        if time == self.state.time {
            return Ok(self.state);
        }
        // Looked at between the marks, the planner itself stays where it is.
        self.planner.clone().advance(time)
    }

    /// From one phase to the next, at a mark.
    fn pass(&mut self) -> Result<(), GaitError> {
        // Only where a knot is, so that the stream ends with one.
        if self.stride == 1 && !self.mark.is_multiple_of(MARKS_PER_KNOT) {
            return Ok(());
        }
        match self.phase {
            Phase::StandingUp => {
                if self.climb.go_on(&mut self.planner)? {
                    self.phase = Phase::Walking;
                    if self.stops {
                        self.body = *self.climb.to();
                        self.settle();
                        return Ok(());
                    }
                    self.planner.command(&self.body)?;
                    if let Some(gait) = &self.gait {
                        self.planner.walk(gait)?;
                    }
                }
            }
            Phase::Settling => {
                if self.planner.is_standing() && self.planner.is_settled() {
                    self.phase = Phase::SittingDown;
                    self.climb = Climb::new(self.body.at_rest(), Body::standing(self.sitting));
                }
            }
            Phase::SittingDown => {
                if self.climb.go_on(&mut self.planner)? {
                    self.phase = Phase::Sitting;
                }
            }
            Phase::Walking | Phase::Sitting => {}
        }
        Ok(())
    }
}
