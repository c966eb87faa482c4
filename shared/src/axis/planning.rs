//! Changes of motion: decided at once, planned by the owner when it has time, then committed.
//!
//! Planning takes up to 80 000 instructions, too many to hold off a tick. So a command or a fault
//! only leaves a job. The owner takes it as a [`Plan`] that holds all it needs, works on it outside
//! of any lock while ticks go on, and commits what came of it:
//!
//! ```text
//! handle_frame, tick     decide, and leave at most one job that waits
//! take_plan              the job, a copy of the motion, and the splice: a tick shortly ahead
//! Plan::work             pure; slow
//! commit                 the new motion takes over at the splice; the command is answered
//! ```
//!
//! - **A stop comes first.** It calls off every move that has not begun, which is refused; a move
//!   that comes before the stop is planned is refused as well.
//! - **The newest move counts.** It takes the place of one that waits, which is refused. One that is
//!   being worked on is finished and answered first, so that no flood of moves keeps all of them
//!   from being planned.
//! - **A plan that comes after its splice is made again** from where the axis then is, further
//!   ahead: 1, 2, 4 ... 64 ticks. A stop is made until it comes in time. A move that does not at
//!   the last is refused.
//!
//! Until then the motion under way goes on, to its own end at the farthest, inside its limits.
//!
//! What is asked for in more than one place and not in every tick is not inlined: at the level that
//! the tick's arithmetic is compiled with it would take kilobytes of flash.

use super::answer::{Refusal, acknowledgement, refusal};
use super::course::{Basis, StreamStop, Streamed};
use super::prepared::Prepared;
use super::reaction::Stopping;
use super::{Axis, Departure, Outcome, Reply, Staged};
use crate::limits::Limits;
use crate::motion::{Motion, Move, Planned};
use crate::time::{Tick, Ticks};
use crate::wire::id::{AxisId, Function};
use crate::wire::reason::Reason;

/// How often a plan that came too late is made again, each time twice as far ahead.
const MOST_DOUBLINGS: u8 = 6;

/// When a move is to leave.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Leave {
    Now,
    At(Tick),
    /// Not yet: it is only checked.
    WhenTriggered,
}

/// A move that is to be planned, and the command that is to be answered.
#[derive(Debug, Clone, Copy)]
pub(super) struct WantedMove {
    pub(super) asked: Move,
    pub(super) prepared: Prepared,
    pub(super) leave: Leave,
    pub(super) sequence: u8,
    pub(super) function: Function,
}

#[derive(Debug, Clone, Copy)]
enum Change {
    Stop(Stopping),
    Move(WantedMove),
}

#[derive(Debug, Clone, Copy)]
struct Job {
    change: Change,
    /// Tells the jobs of one axis apart.
    number: u32,
    /// When it was decided.
    since: Tick,
}

impl Job {
    fn stops(&self) -> bool {
        matches!(self.change, Change::Stop(_))
    }

    /// Whether it is a stop that is at least as hard.
    fn stops_as(&self, stopping: Stopping) -> bool {
        matches!(self.change, Change::Stop(own) if own >= stopping)
    }

    fn is_stage(&self) -> bool {
        matches!(self.change, Change::Move(wanted) if wanted.leave == Leave::WhenTriggered)
    }
}

/// The jobs of one axis.
#[derive(Debug, Clone, Default)]
pub(super) struct Planning {
    waiting: Option<Job>,
    /// The job that somebody has taken, and the splice that he was given.
    working: Option<(Job, Tick)>,
    /// The number of the last job.
    number: u32,
    /// How often the lead was doubled since a plan last came in time.
    doublings: u8,
}

impl Planning {
    fn jobs(&self) -> impl Iterator<Item = &Job> {
        let working = self.working.iter().map(|(job, _)| job);
        working.chain(&self.waiting)
    }

    fn stops(&self) -> bool {
        self.jobs().any(Job::stops)
    }

    /// Whether there is a job that will change the setpoint.
    pub(super) fn is_about_to_move(&self) -> bool {
        self.jobs().any(|job| !job.is_stage())
    }

    fn new_job(&mut self, change: Change, since: Tick) -> Job {
        self.number = self.number.wrapping_add(1);
        Job {
            change,
            number: self.number,
            since,
        }
    }

    /// Takes the oldest job out that is `wanted`.
    fn take(&mut self, wanted: impl Fn(&Job) -> bool) -> Option<Job> {
        let working = self.working.take_if(|(job, _)| wanted(job));
        let working = working.map(|(job, _)| job);
        working.or_else(|| self.waiting.take_if(|job| wanted(job)))
    }

    /// Forgets a stop of what has come to rest by itself meanwhile: no late planner keeps an axis
    /// from being at rest.
    pub(super) fn forget_stops(&mut self) {
        while self.take(Job::stops).is_some() {}
    }

    /// Forgets all jobs, none of which is a move.
    pub(super) fn clear(&mut self) {
        self.waiting = None;
        self.working = None;
    }
}

/// A change of motion that is to be worked out.
#[derive(Debug, Clone)]
#[must_use]
pub struct Plan {
    axis: AxisId,
    change: Change,
    number: u32,
    splice: Tick,
    limits: Limits,
    motion: Motion,
    /// What is under way instead of the motion, where it is a stream.
    stream: Option<Streamed>,
}

/// What came of a [`Plan`].
#[derive(Debug, Clone)]
#[must_use]
pub struct FinishedPlan {
    axis: AxisId,
    number: u32,
    splice: Tick,
    motion: Motion,
    stream: Option<StreamStop>,
    result: Result<Planned, Refusal>,
}

impl Plan {
    /// Whose it is.
    pub fn axis(&self) -> AxisId {
        self.axis
    }

    /// From which tick on the new motion is to hold.
    pub fn splice(&self) -> Tick {
        self.splice
    }

    /// Works it out, in up to 80 000 instructions. It touches nothing but itself.
    #[inline(never)]
    pub fn work(mut self) -> FinishedPlan {
        let (splice, limits) = (self.splice, &self.limits);
        let stream = self.stream.map(|streamed| {
            let stopping = match self.change {
                Change::Stop(stopping) => stopping,
                // No move is taken while there is a stream.
                Change::Move(_) => Stopping::Controlled,
            };
            streamed.stop(splice, stopping, limits, &mut self.motion)
        });
        let result = self.change_motion();
        FinishedPlan {
            axis: self.axis,
            number: self.number,
            splice: self.splice,
            motion: self.motion,
            stream,
            result,
        }
    }

    #[inline(never)]
    fn change_motion(&mut self) -> Result<Planned, Refusal> {
        let splice = self.splice;
        let wanted = match self.change {
            // Done already.
            Change::Stop(_) if self.stream.is_some() => {
                let end = self.motion.end().unwrap_or(splice);
                return Ok(Planned { start: splice, end });
            }
            Change::Stop(stopping) => {
                let end = match stopping {
                    Stopping::Controlled => self.motion.stop(splice, &self.limits),
                    Stopping::Quick => self.motion.quick_stop(splice, &self.limits),
                };
                return Ok(Planned { start: splice, end });
            }
            Change::Move(wanted) => wanted,
        };
        let start = match wanted.leave {
            // With the others of its group or not at all.
            Leave::At(start) if start < splice => {
                return Err((Reason::TooLate, splice.since(start).0));
            }
            Leave::At(start) => start,
            Leave::Now | Leave::WhenTriggered => splice,
        };
        let state = self.motion.at(splice);
        let limits = wanted.prepared.limits(&self.limits, &state);
        self.motion
            .start(splice, start, wanted.asked, &limits)
            .map_err(refusal)
    }
}

impl FinishedPlan {
    /// Whose it is.
    pub fn axis(&self) -> AxisId {
        self.axis
    }
}

impl Axis {
    /// The next change of motion that is to be worked out, if there is one and nobody has it.
    ///
    /// `lead` says how many ticks may pass until it is committed: it takes over that many after the
    /// last one, later where plans came too late. An owner that commits before it does anything
    /// else gives 0.
    // A plan is a kibibyte: without a call it is not handed on once more.
    #[inline(always)]
    pub fn take_plan(&mut self, lead: Ticks) -> Option<Plan> {
        if let Some((job, _)) = self.planning.working.take_if(|(_, at)| *at < self.tick) {
            // Whoever has it still: it will come too late.
            let _: Outcome = self.plan_again(job);
        }
        if self.planning.working.is_some() {
            return None;
        }
        let job = self.planning.waiting.take()?;
        let farther = (1 << self.planning.doublings) - 1;
        let ahead = self.tick.after(Ticks(lead.0.saturating_add(farther)));
        // What waits for its splice and the motion until then agree at the splice only.
        let (basis, splice) = self.course.basis(ahead);
        let stream = match basis {
            Basis::Motion(_) => None,
            Basis::Stream(streamed) => Some(streamed),
        };
        let plan = Plan {
            axis: self.id,
            change: job.change,
            number: job.number,
            splice,
            limits: self.planning_limits(),
            motion: match basis {
                Basis::Motion(motion) => motion.clone(),
                Basis::Stream(streamed) => Motion::at_rest(streamed.state.position),
            },
            stream,
        };
        self.planning.working = Some((job, splice));
        Some(plan)
    }

    /// Takes what came of a plan. What was called off meanwhile is ignored, its command has its
    /// answer; what comes after its splice is planned again.
    #[inline(never)]
    pub fn commit(&mut self, finished: &FinishedPlan) -> Outcome {
        let splice = finished.splice;
        let same = |(job, at): &mut (Job, Tick)| job.number == finished.number && *at == splice;
        let Some((job, _)) = self.planning.working.take_if(same) else {
            return Outcome::Ignored;
        };
        let in_time = splice >= self.tick;
        if in_time {
            self.planning.doublings = 0;
        }
        let begun = match (job.change, finished.result) {
            (Change::Move(wanted), Err(refusal)) => {
                // It waits for the next move of its kind.
                self.prepared.give_back(wanted.prepared);
                return self.settle(&wanted, job.number, Err(refusal));
            }
            (Change::Move(wanted), Ok(planned)) if wanted.leave == Leave::WhenTriggered => {
                self.staged = Some(Staged {
                    sequence: wanted.sequence,
                    asked: wanted.asked,
                    prepared: wanted.prepared,
                });
                let duration = planned.end.since(planned.start).0 + self.shaper.delay().0;
                return self.settle(&wanted, job.number, Ok(duration));
            }
            _ if !in_time => return self.plan_again(job),
            (Change::Move(wanted), Ok(planned)) => Some((wanted, planned)),
            // A stop is never refused.
            (Change::Stop(_), _) => None,
        };
        let stops = match job.change {
            Change::Stop(stopping) => Some(stopping),
            Change::Move(_) => None,
        };
        let departure = begun.map(|(wanted, planned)| Departure {
            sequence: wanted.sequence,
            start: planned.start,
        });
        match finished.stream {
            Some(StreamStop::AsItIs) => {}
            Some(StreamStop::Brake) => self.course.cut_stream(splice, &self.planning_limits()),
            Some(StreamStop::Planned) | None => {
                self.course
                    .splice(splice, &finished.motion, stops, departure);
            }
        }
        self.follow_course();
        self.telemetry.hasten();
        let Some((wanted, planned)) = begun else {
            return Outcome::Accepted;
        };
        self.staged = None;
        let arrives = planned.end.since(self.tick).0 + self.shaper.delay().0;
        self.settle(&wanted, job.number, Ok(arrives))
    }

    /// Works out and commits what waits, before anything else happens: for an owner that does
    /// one thing at a time. Says what became of it.
    pub fn plan(&mut self) -> Option<Outcome> {
        let plan = self.take_plan(Ticks(0))?;
        Some(self.commit(&plan.work()))
    }

    /// Whether there is something to plan that nobody has taken, or that has not come back in time.
    #[inline(never)]
    pub fn has_plan(&self) -> bool {
        match self.planning.working {
            Some((_, splice)) => splice < self.tick,
            None => self.planning.waiting.is_some(),
        }
    }

    /// Whether that is a stop, which goes before the moves of other axes.
    pub fn has_stop_to_plan(&self) -> bool {
        self.has_plan() && self.planning.stops()
    }

    /// How long a stop that was decided has not been planned: long is a planner that does not run.
    pub fn stop_overdue(&self) -> Ticks {
        let mut stops = self.planning.jobs().filter(|job| job.stops());
        stops
            .next()
            .map_or(Ticks(0), |job| self.tick.since(job.since))
    }

    /// Leaves a move to be planned; gives the number of the job.
    pub(super) fn want_move(&mut self, wanted: WantedMove) -> Result<u32, Refusal> {
        if self.planning.stops() || self.course.streams() {
            return Err((Reason::Moving, 0));
        }
        let job = self.planning.new_job(Change::Move(wanted), self.tick);
        if let Some(older) = self.planning.waiting.replace(job) {
            self.refuse(older, overtaken_by(&wanted));
        }
        Ok(job.number)
    }

    /// Calls off every move that has not begun.
    pub(super) fn call_off_moves(&mut self, why: Refusal) {
        self.call_off(why, |job| !job.stops());
        self.course.call_off_move();
        self.departure = None;
    }

    /// Leaves a stop to be planned where anything moves that is not about to stop as hard already;
    /// only once every move that has not begun is called off. A stream takes no more knots, and one
    /// that has run dry brakes as hard as can be by itself.
    pub(super) fn want_stop(&mut self, stopping: Stopping) {
        let brakes = self.course.close_stream(self.tick);
        // Stops in a flood must not put off the first one.
        let decided = brakes
            || self.planning.jobs().any(|job| job.stops_as(stopping))
            || self.course.is_about_to_stop(stopping);
        if !decided && self.course.is_moving(self.tick) {
            // A softer one that is still to be planned is not wanted any more.
            self.planning.clear();
            self.planning.waiting = Some(self.planning.new_job(Change::Stop(stopping), self.tick));
        }
    }

    /// Calls off the moves that were only to be checked.
    pub(super) fn call_off_stages(&mut self, why: Refusal) {
        self.call_off(why, Job::is_stage);
    }

    fn call_off(&mut self, why: Refusal, wanted: impl Fn(&Job) -> bool) {
        while let Some(job) = self.planning.take(&wanted) {
            self.refuse(job, why);
        }
    }

    fn refuse(&mut self, job: Job, why: Refusal) {
        if let Change::Move(wanted) = job.change {
            let _: Outcome = self.settle(&wanted, job.number, Err(why));
        }
    }

    /// Answers a command whose job is done; its repetition gets the same.
    #[inline(never)]
    fn settle(
        &mut self,
        wanted: &WantedMove,
        number: u32,
        answer: Result<u32, Refusal>,
    ) -> Outcome {
        let report = acknowledgement(wanted.function, wanted.sequence, answer);
        for last in [&mut self.last_command, &mut self.last_trigger] {
            if let Some((_, reply)) = last
                && matches!(*reply, Reply::Waits(awaited) if awaited == number)
            {
                *reply = Reply::Given(report);
            }
        }
        self.answer(wanted.function, wanted.sequence, answer)
    }

    fn plan_again(&mut self, job: Job) -> Outcome {
        let last = self.planning.doublings == MOST_DOUBLINGS;
        self.planning.doublings = MOST_DOUBLINGS.min(self.planning.doublings + 1);
        let newer = self.planning.waiting.map(|job| job.change);
        let why = match (job.change, newer) {
            (Change::Move(_), Some(Change::Move(newer))) => overtaken_by(&newer),
            (Change::Move(_), _) if last => {
                self.planning.doublings = 0;
                (Reason::TooLate, self.tick.since(job.since).0)
            }
            _ => {
                self.planning.waiting = Some(job);
                return Outcome::Planning;
            }
        };
        self.refuse(job, why);
        Outcome::Rejected(why.0)
    }
}

/// A move that was not begun when a newer one came.
fn overtaken_by(newer: &WantedMove) -> Refusal {
    (Reason::Overtaken, newer.sequence.into())
}
