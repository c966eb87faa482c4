//! Who plans for an axis on the bench: at once, or as slowly as a test wants.

use super::bench::Bench;
use canter_shared::axis::{Axis, Outcome, Plan};
use canter_shared::limits::Limits;
use canter_shared::time::Ticks;
use canter_shared::wire::command::Command;
use canter_shared::wire::id::Function;
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;

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

pub const STOP: Command = Command::Stop { sequence: 200 };

/// An enabled axis whose plans come back after `delay` frames and ticks.
pub fn slow(lead: u32, delay: u8) -> Bench {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    bench.planner = Planner::slow(lead, delay);
    bench.reports.clear();
    bench
}

/// At full speed towards 10 turns.
pub fn moving(lead: u32, delay: u8) -> Bench {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.go(10.0, 8_000), Outcome::Accepted);
    bench.run(4_000);
    bench.planner = Planner::slow(lead, delay);
    bench.reports.clear();
    bench
}

/// The answers so far to moves and triggers.
pub fn answers(bench: &Bench) -> Vec<(u8, Reason)> {
    let answer = |report: &Report| match *report {
        Report::Acknowledgement {
            sequence,
            reason,
            function,
            ..
        } => (function != Function::Stop).then_some((sequence, reason)),
        _ => None,
    };
    bench.reports.iter().filter_map(answer).collect()
}
