//! One axis: who may move it, what it is doing, and when it must stop.
//!
//! The promise above all others: whatever frames arrive, in whatever order, lost, doubled or
//! forged, the setpoints never leave the limits and never jump. Whatever goes wrong leads to a stop
//! and to a latched fault. Nothing resumes motion by itself. Enabling starts from where the drive
//! is, never from an old target.
//!
//! The axis is sans-IO. Its owner calls `handle_frame` and `handle_drive` when something arrives,
//! `tick` exactly once for each tick, and `poll_transmit` until there is nothing left to send.
//! Each of these is quick. Motion is planned apart from them, see `planning`: after each the owner
//! sees to it that what waits is planned, before it goes on (`plan`) or at a lower priority
//! (`take_plan`, `commit`).
//!
//! | file | what it holds |
//! |---|---|
//! | `command`, `answer` | what each command does, and its answer |
//! | `commander` | who holds the axis |
//! | `streaming` | streams of knots |
//! | `parameters` | what is set about the axis |
//! | `prepared` | what is told ahead of a move |
//! | `planning` | changes of motion: decided, planned, committed |
//! | `course` | the motion under way, and the one that takes over |
//! | `supervision` | host, drive and bus watched |
//! | `reaction` | how the axis comes to rest when something has gone wrong |
//! | `fault` | the table of what can go wrong |
//! | `state` | the states, and the way from one to the next |
//! | `telemetry` | what is sent, and when |

mod answer;
mod command;
mod commander;
mod course;
pub mod fault;
mod parameters;
mod planning;
mod prepared;
mod reaction;
pub mod state;
mod streaming;
pub(crate) mod supervision;
mod telemetry;

use crate::drive::{Condition, DriveCommand, DriveReport};
use crate::limits::Limits;
use crate::motion::shaping::{Shaper, Shaping, ShapingError};
use crate::motion::{Move, Setpoint};
use crate::parameter::{Reaction, Settings, Values};
use crate::time::{BusTime, Tick, Ticks};
use crate::units::Position;
use crate::wire::command::Session;
use crate::wire::frame::Frame;
use crate::wire::id::AxisId;
use crate::wire::reason::Reason;
use crate::wire::report::Report;
use commander::Commander;
use course::Course;
use fault::Fault;
use parameters::Saving;
use planning::Planning;
pub use planning::{FinishedPlan, Plan};
use prepared::Prepared;
use state::State;
pub use telemetry::Counters;
use telemetry::{Due, Telemetry};

/// Silence of the holding session after which an axis stops: the parameter `host.timeout`, 0.25 s.
pub const HOST_TIMEOUT: Ticks = Ticks(250);

/// What became of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[must_use]
pub enum Outcome {
    /// It was not a command for this axis.
    Ignored,
    /// It was taken; an answer is waiting where the command has one.
    Accepted,
    /// A move is to be planned: whether it is taken will be answered then.
    Planning,
    /// It was refused; the answer with the reason is waiting.
    Rejected(Reason),
    /// It was a repetition; the first answer, where there is one, is waiting again or still to come.
    Repeated,
}

/// What an axis is to do once it has come to rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Request {
    Enable,
    Disable,
}

/// A move that waits for its trigger.
#[derive(Debug, Clone, Copy)]
struct Staged {
    sequence: u8,
    asked: Move,
    prepared: Prepared,
}

/// What a repetition is answered.
#[derive(Debug, Clone, Copy)]
enum Reply {
    Given(Report),
    /// Nothing yet: the answer comes when the job of this number is done.
    Waits(u32),
    /// Nothing yet: the answer comes when the save of this command's number is done.
    Saves(u8),
}

/// A move whose start is still to be reported.
#[derive(Debug, Clone, Copy)]
struct Departure {
    sequence: u8,
    start: Tick,
}

/// One axis.
#[derive(Debug, Clone)]
pub struct Axis {
    id: AxisId,
    /// The parameters as they were set, and what they mean.
    values: Values,
    settings: Settings,
    /// The values that it will have after a loss of power.
    saved: Values,
    saving: Option<Saving>,
    state: State,
    fault: Option<Fault>,
    /// How the axis comes to rest, while it does so because of a fault.
    reaction: Reaction,
    /// Ticks for which the drive has been too far from its setpoint.
    astray: u16,
    /// When the state was entered.
    since: Tick,
    request: Option<Request>,
    course: Course,
    planning: Planning,
    setpoint: Setpoint,
    /// The tick of the setpoint above, and the bus time at which it was handed over.
    tick: Tick,
    handed_over: BusTime,
    drive: Option<DriveReport>,
    /// The drive shall forget its faults: since the next tick, at this one.
    wants_reset: bool,
    resets: bool,
    commander: Commander,
    staged: Option<Staged>,
    prepared: Prepared,
    /// The setpoints of the course go through it.
    shaper: Shaper,
    departure: Option<Departure>,
    last_command: Option<(Frame, Reply)>,
    last_trigger: Option<(Frame, Reply)>,
    telemetry: Telemetry,
    counters: Counters,
}

impl Axis {
    /// An axis with these limits and the other parameters' defaults: see [`Values::of_limits`].
    pub fn new(id: AxisId, limits: Limits) -> Self {
        Self::with_values(id, &Values::of_limits(id.get(), &limits))
    }

    /// An axis that waits for the first word from its drive.
    pub fn with_values(id: AxisId, values: &Values) -> Self {
        let settings = values.settings();
        let mut shaper = Shaper::none();
        // A new one stands, so there is no error to look at.
        let _ = shaper.change(settings.shaping.as_ref());
        Self {
            id,
            values: *values,
            settings,
            saved: *values,
            saving: None,
            state: State::NotReadyToSwitchOn,
            fault: None,
            reaction: Reaction::ControlledStop,
            astray: 0,
            since: Tick(0),
            request: None,
            course: Course::at_rest(Position::ZERO),
            planning: Planning::default(),
            setpoint: Setpoint::default(),
            tick: Tick(0),
            handed_over: BusTime(0),
            drive: None,
            wants_reset: false,
            resets: false,
            commander: Commander::default(),
            staged: None,
            prepared: Prepared::default(),
            shaper,
            departure: None,
            last_command: None,
            last_trigger: None,
            telemetry: Telemetry::new(id.get()),
            counters: Counters::default(),
        }
    }

    /// The axis's number on the bus.
    pub fn id(&self) -> AxisId {
        self.id
    }

    /// What the axis may do.
    pub fn limits(&self) -> &Limits {
        &self.settings.limits
    }

    /// The state of the axis.
    pub fn state(&self) -> State {
        self.state
    }

    /// The latched fault, if any.
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// The session that holds the axis, if any.
    pub fn session(&self) -> Option<Session> {
        self.commander.session()
    }

    /// The counters, whose bus part the owner keeps.
    pub fn counters_mut(&mut self) -> &mut Counters {
        &mut self.counters
    }

    /// Whether the setpoint changes, or will without another command.
    pub fn is_moving(&self) -> bool {
        self.planning.is_about_to_move()
            || self.course.is_moving(self.tick)
            || self.shapes() && !self.shaper.is_settled()
    }

    /// Shapes the setpoints for a mode of the machine from now on, or no longer. Moves and stops
    /// then arrive later, by the shaper's delay.
    ///
    /// # Errors
    /// [`ShapingError::Moving`] unless the axis is at rest and nothing is about to move it; a shaper
    /// that its parameters, which go in steps, cannot hold.
    pub fn shape(&mut self, shaping: Option<&Shaping>) -> Result<(), ShapingError> {
        if self.is_moving() {
            return Err(ShapingError::Moving);
        }
        let values = self.values.shaped(shaping)?;
        self.take_values(&values, values.settings())
    }

    fn shapes(&self) -> bool {
        self.shaper.delay() > Ticks(0)
    }

    /// The limits to plan inside. A shaped setpoint is a mean of several, some of which may speed
    /// up while others slow down: then one limit of acceleration must do for both.
    fn planning_limits(&self) -> Limits {
        if self.shapes() {
            self.settings.limits.symmetric()
        } else {
            self.settings.limits
        }
    }

    /// Takes what the drive said.
    pub fn handle_drive(&mut self, report: DriveReport) {
        self.drive = Some(report);
    }

    /// The setpoint of `tick`, handed over for bus time `now`, which is later than the tick's where the node
    /// is; called once for each tick in turn.
    pub fn tick(&mut self, tick: Tick, now: BusTime) -> Setpoint {
        self.tick = tick;
        self.handed_over = now;
        self.resets = core::mem::take(&mut self.wants_reset);
        self.follow_course();
        self.supervise();
        if self.state.drives() {
            self.setpoint = self.course.at(tick);
            let mut arrived = self.course.fold(tick);
            if arrived {
                self.planning.forget_stops();
            }
            if self.shapes() {
                let late = !self.shaper.is_settled();
                self.setpoint = self.shaper.shape(self.setpoint);
                arrived = (arrived || late) && self.shaper.is_settled();
            }
            if arrived {
                self.telemetry.hasten();
            }
        }
        if let Some(departure) = self.departure
            && departure.start <= tick
        {
            self.departure = None;
            // When a tick is due is known to 1 us: one that came early by that began no earlier for it.
            let time = now.max(departure.start.time());
            self.telemetry.started(departure.sequence, time);
        }
        self.telemetry.tick(tick, &self.settings);
        self.setpoint
    }

    /// Has the motion take over that is to at this tick.
    fn follow_course(&mut self) {
        if let Some(departure) = self.course.advance(self.tick) {
            self.departure = departure;
        }
    }

    /// What to tell the drive at this tick.
    pub fn drive_command(&self) -> DriveCommand {
        DriveCommand {
            enable: self.state.drives(),
            reset: self.resets,
            position: self.setpoint.position,
            velocity: self.setpoint.velocity,
            acceleration: self.setpoint.acceleration,
        }
    }

    /// The next frame to send, until there is none.
    pub fn poll_transmit(&mut self) -> Option<Frame> {
        let report = match self.telemetry.next()? {
            Due::Report(report) => report,
            Due::Feedback => self.feedback(),
            Due::Heartbeat => self.heartbeat(),
        };
        Some(report.encode(self.id))
    }

    fn feedback(&self) -> Report {
        let (position, velocity) = match self.drive {
            Some(report) => (report.position, report.velocity),
            None => (self.setpoint.position, self.setpoint.velocity),
        };
        Report::Feedback {
            position,
            velocity,
            state: self.state.into(),
            moving: self.is_moving(),
            target_reached: self.course.is_complete(self.tick),
        }
    }

    fn heartbeat(&self) -> Report {
        Report::Heartbeat {
            state: self.state.into(),
            fault: self.fault.map_or(0, u8::from),
            session: self.commander.session().unwrap_or(0),
            bus_off: self.counters.bus_off,
            error_frames: self.counters.error_frames,
            lost: self.counters.lost,
            rejected: self.counters.rejected,
        }
    }

    /// Follows a step of the bus clock to `tick`, which happens at rest only.
    pub fn rebase(&mut self, tick: Tick) {
        let step = tick.0.wrapping_sub(self.tick.0) as i64;
        self.tick = tick;
        // May lie before the beginning of bus time.
        self.since = Tick(self.since.0.wrapping_add_signed(step));
        self.commander.rebase(step);
        self.course.settle();
        self.departure = None;
    }

    fn condition(&self) -> Option<Condition> {
        self.drive.map(|report| report.condition)
    }

    /// Whether the drive is there, without a fault of its own, and in a place that can be told.
    fn drive_is_ready(&self) -> bool {
        let well = |report: &DriveReport| {
            matches!(report.condition, Condition::Disabled | Condition::Enabled)
        };
        self.drive
            .is_some_and(|report| well(&report) && self.carries(&report))
    }
}
