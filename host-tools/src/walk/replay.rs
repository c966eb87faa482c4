//! The motion once more, from the orders that were taken.

/// What a walk was, to go through it again: for what setpoints should have been.
#[derive(Debug, Clone)]
pub struct Replay {
    /// The robot.
    pub quadruped: Quadruped,
    /// How it began.
    pub settings: Settings,
    /// The orders that were taken, each with the time in s of the motion at which it was.
    pub orders: Vec<(f64, Order)>,
    /// How long the motion lasted, in s.
    pub duration: f64,
}

impl Replay {
    /// What all joints did, every `step` s from 0 to the end, and in which phase.
    pub fn states(&self, step: f64) -> impl Iterator<Item = Result<(Phase, State), GaitError>>;
}
