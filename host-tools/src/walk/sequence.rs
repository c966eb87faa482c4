//! The whole motion as time goes on: up, walk, settle, down.

use super::order::Order;
use crate::gait::{Body, Gait, GaitError, Planner, Quadruped, State};

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

/// The motion of every joint from the first knot to the last. Equal orders at equal times give equal
/// motions, however finely it is looked at; so the same can be gone through again, see
/// [`Replay`](super::Replay).
#[derive(Debug, Clone)]
pub struct Sequence {
    planner: Planner,
    settings: Settings,
    phase: Phase,
}

impl Sequence {
    /// At rest, at time 0.
    ///
    /// # Errors
    /// Settings out of their ranges.
    pub fn new(quadruped: Quadruped, settings: &Settings) -> Result<Self, GaitError>;

    /// What it is doing.
    pub fn phase(&self) -> Phase;

    /// Takes an order, now. While it stands up an order waits for the first step; after
    /// [`Order::Stop`] it changes nothing.
    ///
    /// # Errors
    /// What is out of its range; nothing is changed then.
    pub fn order(&mut self, order: &Order) -> Result<(), GaitError>;

    /// What all joints do at a time in s, which is not before the last one.
    ///
    /// # Errors
    /// A foot that its leg does not reach.
    pub fn advance(&mut self, time: f64) -> Result<State, GaitError>;
}
