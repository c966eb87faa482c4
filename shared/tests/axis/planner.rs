//! Who plans for an axis on the bench: at once, or as slowly as a test wants.

use canter_shared::axis::{Axis, Outcome, Plan};
use canter_shared::time::Ticks;

/// Plans what waits, whenever something has happened to the axis.
#[derive(Debug, Clone, Default)]
pub struct Planner {
    /// The lead that is asked for.
    pub lead: Ticks,
    /// How many more frames and ticks pass before each plan is brought back, over and over; none
    /// for never.
    pub delays: Vec<Option<u8>>,
    /// What became of the plans that were brought back.
    pub outcomes: Vec<Outcome>,
    turn: usize,
    at_work: Option<(Plan, Option<u8>)>,
}

impl Planner {
    /// A planner that takes `delay` frames and ticks for each plan.
    pub fn slow(lead: u32, delay: u8) -> Self {
        Self::erratic(lead, vec![Some(delay)])
    }

    /// A planner that takes these frames and ticks for its plans in turn.
    pub fn erratic(lead: u32, delays: Vec<Option<u8>>) -> Self {
        Self {
            lead: Ticks(lead),
            delays,
            ..Self::default()
        }
    }

    /// A frame or a tick has passed. Gives what became of the last plan that was brought back.
    pub fn act(&mut self, axis: &mut Axis) -> Option<Outcome> {
        let mut last = None;
        loop {
            match self.at_work.take() {
                Some((plan, Some(0))) => {
                    let outcome = axis.commit(&plan.work());
                    self.outcomes.push(outcome);
                    last = Some(outcome);
                }
                Some((plan, Some(left))) => {
                    self.at_work = Some((plan, Some(left - 1)));
                    return last;
                }
                // Lost: the axis must get on without.
                Some((_, None)) | None => {}
            }
            let plan = axis.take_plan(self.lead);
            let Some(plan) = plan else {
                return last;
            };
            let delay = match self.delays.len() {
                0 => Some(0),
                count => self.delays[self.turn % count],
            };
            self.turn += 1;
            self.at_work = Some((plan, delay));
        }
    }
}
