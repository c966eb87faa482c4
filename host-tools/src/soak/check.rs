//! Sees what happens in a simulated robot, and holds it to the invariants.
//!
//! The checker has a truth of its own: it knows what robot was built, decodes every frame that a
//! node really got, and from that alone says what the node may do. What a node claims of itself
//! (its state, its fault, its holder) needs such a reason; its setpoints are judged as they are.
//! Nothing is allocated at a tick or a frame as long as all is well.
//!
//! | file | what it holds |
//! |---|---|
//! | `believed` | who holds an axis and what it was asked for, from the frames that it got |
//! | `setpoint` | limits and continuity |
//! | `authority` | who may have an axis moved, enabled, cleared |
//! | `stopping` | when an axis must rest |
//! | `parameters` | what an axis may be set to |
//! | `answers` | what an axis may answer |
//! | `statistics` | what an episode was made of |

mod answers;
mod authority;
mod believed;
mod parameters;
mod setpoint;
mod statistics;
mod stopping;

use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::drive::DriveReport;
use canter_shared::limits::Limits;
use canter_shared::motion::Setpoint;
use canter_shared::motion::shaping::Shaper;
use canter_shared::parameter::Values;
use canter_shared::time::{Tick, Ticks};
use canter_shared::wire::command::{Command, Session};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::AxisId;
use canter_shared::wire::report::Report;

use super::invariant::{Invariant, Violation};
use crate::robot::RobotAxis;
use crate::sim::{AxisTick, Station, Transmission, TrueTime};
use answers::Answers;
use authority::Authority;
use believed::{Admission, Believed};
use parameters::Parameters;
use setpoint::Setpoints;
pub use statistics::Statistics;
use stopping::Stopping;

/// What is wrong.
pub(super) struct Finding(pub(super) Invariant, pub(super) String);

type Verdict = Result<(), Finding>;

/// What was seen of an axis at a tick.
#[derive(Debug, Clone, Copy)]
pub(super) struct Glance {
    pub(super) time: TrueTime,
    pub(super) tick: Tick,
    pub(super) state: State,
    pub(super) setpoint: Setpoint,
    pub(super) fault: Option<Fault>,
    pub(super) session: Option<Session>,
    /// Whether the axis says that its setpoint changes, or will by itself.
    pub(super) moving: bool,
    /// What the axis hears of its drive at its next tick.
    pub(super) drive: DriveReport,
}

impl Glance {
    pub(super) fn of(time: TrueTime, tick: &AxisTick<'_>) -> Self {
        Self {
            time,
            tick: tick.setpoint.tick,
            state: tick.setpoint.state,
            setpoint: tick.setpoint.setpoint,
            fault: tick.axis.fault(),
            session: tick.axis.session(),
            moving: tick.axis.is_moving(),
            drive: tick.drive,
        }
    }

    /// Whether the setpoint stands, and goes on to stand.
    fn rests(&self) -> bool {
        !self.moving && self.setpoint.velocity.counts() == 0
    }
}

/// What the checker believes that an axis is set to.
#[derive(Debug, Clone, Copy)]
struct Believe {
    axis: AxisId,
    limits: Limits,
    /// By how much its shaper delays what it does.
    delay: Ticks,
    /// Silence of its holder after which it stops.
    host_timeout: Ticks,
}

impl Believe {
    fn of(axis: AxisId, values: &Values) -> Self {
        let settings = values.settings();
        let mut shaper = Shaper::none();
        // A new one is at rest, so it takes any that is possible.
        let shaped = shaper.change(settings.shaping.as_ref());
        Self {
            axis,
            limits: settings.limits,
            delay: shaped.map_or(Ticks(0), |()| shaper.delay()),
            host_timeout: settings.host_timeout,
        }
    }
}

/// One axis under watch.
#[derive(Debug)]
struct Watch {
    believe: Believe,
    parameters: Parameters,
    /// What follows begins anew with the node.
    since: TrueTime,
    believed: Believed,
    setpoints: Setpoints,
    authority: Authority,
    stopping: Stopping,
    answers: Answers,
    last: Option<Glance>,
}

impl Watch {
    fn new(axis: &RobotAxis) -> Self {
        let believe = Believe::of(axis.id, &axis.values);
        Self::with(believe, Parameters::new(&axis.values), TrueTime(0))
    }

    fn with(believe: Believe, parameters: Parameters, since: TrueTime) -> Self {
        Self {
            believe,
            parameters,
            since,
            believed: Believed::new(believe.axis, believe.host_timeout),
            setpoints: Setpoints::default(),
            authority: Authority::default(),
            stopping: Stopping::default(),
            answers: Answers::default(),
            last: None,
        }
    }

    /// The node has lost its power, or has it again.
    fn power(&mut self, time: TrueTime) {
        let kept = Parameters::new(self.parameters.values());
        let mut parameters = std::mem::replace(&mut self.parameters, kept);
        parameters.power_off();
        *self = Self::with(self.believe, parameters, time);
    }

    fn tick(
        &mut self,
        now: &Glance,
        claimed: (&Values, &Limits),
        statistics: &mut Statistics,
    ) -> Verdict {
        let last = self.last.replace(*now);
        let (last, axis) = (last.as_ref(), self.believe.axis);
        statistics.tick(last, now);
        if self.parameters.tick(axis.get(), last, now, claimed)? {
            self.believe = Believe::of(axis, self.parameters.values());
            self.believed.set_timeout(self.believe.host_timeout);
            self.setpoints
                .change(now.setpoint.position, &self.believe.limits);
            statistics.changes += u64::from(last.is_some());
        }
        self.believed.tick(last, now)?;
        self.authority.tick(last, now, &mut self.believed)?;
        if let Some(last) = last {
            self.setpoints.tick(last, now, &self.believe)?;
        }
        self.believed.forget_asked();
        self.stopping.tick(last, now, &self.believe, statistics)
    }

    fn command(&mut self, time: TrueTime, frame: &Frame, command: &Command) {
        let admission = self.believed.take(time, frame, command, self.last.as_ref());
        self.answers.command(command, admission);
        if admission == Admission::Yes {
            self.parameters.command(self.believe.axis.get(), command);
        }
        if let Some(last) = &self.last {
            let moves = self.believed.was_asked_to_move();
            self.stopping
                .command(time, command, moves, last, &self.believe);
        }
    }

    fn report(&mut self, report: &Report) -> Verdict {
        self.parameters.report(report);
        self.believed.report(report);
        self.answers.report(report)
    }
}

/// Watches a robot.
#[derive(Debug)]
pub(super) struct Checker {
    seed: u64,
    watches: Vec<Watch>,
    statistics: Statistics,
    violation: Option<Violation>,
}

impl Checker {
    /// For the nodes of these axes, in their order.
    pub(super) fn new(seed: u64, axes: &[RobotAxis]) -> Self {
        Self {
            seed,
            watches: axes.iter().map(Watch::new).collect(),
            statistics: Statistics::default(),
            violation: None,
        }
    }

    /// The first thing that was wrong.
    pub(super) fn violation(&self) -> Option<&Violation> {
        self.violation.as_ref()
    }

    pub(super) fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    fn judge(&mut self, time: TrueTime, node: usize, verdict: Verdict) {
        if let Err(Finding(invariant, detail)) = verdict
            && self.violation.is_none()
        {
            let watch = self.watches.get(node);
            self.violation = Some(Violation {
                seed: self.seed,
                invariant,
                axis: watch.map(|watch| watch.believe.axis),
                tick: watch
                    .and_then(|watch| watch.last)
                    .map_or(Tick(0), |last| last.tick),
                time,
                detail,
            });
        }
    }

    /// A node got a frame.
    pub(super) fn deliver(&mut self, time: TrueTime, node: usize, frame: &Frame) {
        let Ok(Some((address, command))) = Command::decode(frame) else {
            return;
        };
        if let Some(watch) = self.watches.get_mut(node)
            && address.includes(watch.believe.axis)
        {
            watch.command(time, frame, &command);
        }
    }

    /// A node did its tick.
    pub(super) fn tick(&mut self, node: usize, now: &Glance, claimed: (&Values, &Limits)) {
        if let Some(watch) = self.watches.get_mut(node) {
            let verdict = watch.tick(now, claimed, &mut self.statistics);
            self.judge(now.time, node, verdict);
        }
    }

    /// A node has lost its power, or has it again and begins anew.
    pub(super) fn power(&mut self, time: TrueTime, node: usize, on: bool) {
        self.statistics.resets += u64::from(on);
        if let Some(watch) = self.watches.get_mut(node) {
            watch.power(time);
        }
    }

    /// Something went wrong by choice or by chance.
    pub(super) fn disturbance(&mut self) {
        self.statistics.disturbances += 1;
    }

    /// A frame was on the bus, whole.
    pub(super) fn frame(&mut self, transmission: &Transmission) {
        self.statistics.frames += 1;
        let Station::Node(node) = transmission.sender else {
            return;
        };
        let Ok(Some((_, report))) = Report::decode(&transmission.frame) else {
            return;
        };
        if let Report::Started { .. } = report {
            self.statistics.starts += 1;
        }
        // The last bits of a frame are as good without its sender.
        if let Some(watch) = self.watches.get_mut(node)
            && watch.since <= transmission.start
        {
            let verdict = watch.report(&report);
            self.judge(transmission.end, node, verdict);
        }
    }
}
