//! A body that stands, slowly up or down.

use crate::gait::{Body, GaitError, Planner};

/// How far the hips go at most by one command, in m. The planner takes half a second for each.
const STEP: f64 = 0.05;

/// From one command to the next, in s: half of what each takes, so that together they are smooth.
const STEP_TIME: f64 = 0.25;

/// From one stand to another, by as many commands as that takes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Climb {
    from: Body,
    to: Body,
    /// Commands that have been given, and all.
    step: u32,
    steps: u32,
    /// When the next one is due, in s.
    due: f64,
}

impl Climb {
    pub(super) fn new(from: Body, to: Body) -> Self {
        let steps = ((to.height - from.height).abs() / STEP).ceil();
        let leans = from.roll != to.roll || from.pitch != to.pitch;
        Self {
            from,
            to,
            step: 0,
            steps: (steps as u32).max(leans.into()),
            due: 0.0,
        }
    }

    pub(super) fn to(&self) -> &Body {
        &self.to
    }

    /// Gives the command that is due. Tells whether the body stands where it should.
    pub(super) fn go_on(&mut self, planner: &mut Planner) -> Result<bool, GaitError> {
        let time = planner.time();
        // Sums of times are off by rounding.
        if self.step < self.steps && time >= self.due - 1e-9 {
            self.step += 1;
            self.due = time + STEP_TIME;
            planner.command(&self.part())?;
        }
        Ok(self.step == self.steps && planner.is_settled())
    }

    fn part(&self) -> Body {
        if self.step == self.steps {
            return self.to;
        }
        let share = f64::from(self.step) / f64::from(self.steps);
        let mix = |from: f64, to: f64| from + (to - from) * share;
        Body {
            height: mix(self.from.height, self.to.height),
            roll: mix(self.from.roll, self.to.roll),
            pitch: mix(self.from.pitch, self.to.pitch),
            ..Body::standing(self.to.height)
        }
    }
}
