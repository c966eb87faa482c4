//! One axis on a bench: its drive, a host that beats, and an eye on every setpoint.

use super::planner::Planner;
use canter_shared::axis::state::State;
use canter_shared::axis::{Axis, Outcome};
use canter_shared::drive::simulated::Simulated;
use canter_shared::drive::{Condition, Drive, DriveCommand, DriveReport};
use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::Setpoint;
use canter_shared::parameter::Parameter;
use canter_shared::time::{BusTime, Tick, Ticks};
use canter_shared::units::{COUNTS_PER_TURN, Position, Velocity};
use canter_shared::wire::command::{Action, Command, ProfileKind, Session};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId, Function};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;
use std::f64::consts::TAU;

/// The session of the bench's own host.
pub const SESSION: Session = 0xC0DE;

/// Somebody else's.
pub const OTHER: Session = 0x1111;

/// The axis on the bench.
pub const AXIS: AxisId = AxisId::new(7).expect("an axis id");

/// A position in turns.
pub fn turns(turns: f64) -> Position {
    Position::from_counts((turns * COUNTS_PER_TURN as f64) as i64)
}

/// A travel of some turns to both sides, with the default limits.
pub fn travel(turns: f64) -> Limits {
    let end = turns * TAU;
    Limits::new(&LimitValues {
        position_minimum: -end,
        position_maximum: end,
        ..DEFAULT_VALUES
    })
    .expect("in range")
}

/// How far outside of the travel a position is.
pub fn outside(position: Position, limits: &Limits) -> Position {
    (limits.position_minimum() - position)
        .max(position - limits.position_maximum())
        .max(Position::ZERO)
}

/// A beta move, now.
pub fn beta(sequence: u8, target: f64, milliseconds: u32) -> Command {
    Command::Move {
        profile: ProfileKind::Beta,
        staged: false,
        target: turns(target),
        duration: Ticks(milliseconds),
        sequence,
    }
}

/// A trapezoid, now.
pub fn trapezoid(sequence: u8, target: f64, milliseconds: u32) -> Command {
    Command::Move {
        profile: ProfileKind::Trapezoid,
        staged: false,
        target: turns(target),
        duration: Ticks(milliseconds),
        sequence,
    }
}

/// A beta move that waits for its trigger.
pub fn staged(sequence: u8, target: f64, milliseconds: u32) -> Command {
    Command::Move {
        profile: ProfileKind::Beta,
        staged: true,
        target: turns(target),
        duration: Ticks(milliseconds),
        sequence,
    }
}

/// A control command of the bench's session.
pub fn control(sequence: u8, action: Action) -> Command {
    Command::Control {
        action,
        sequence,
        session: SESSION,
    }
}

/// The frame of a command, to the axis where it goes to one.
pub fn frame(command: Command) -> Frame {
    let broadcast = matches!(
        command,
        Command::Trigger { .. } | Command::HostHeartbeat { .. } | Command::Sync { .. }
    );
    let address = if broadcast {
        Address::All
    } else {
        Address::Axis(AXIS)
    };
    command.encode(address).expect("every field fits")
}

/// What an axis answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Answer {
    pub sequence: u8,
    pub function: Function,
    pub reason: Reason,
    pub detail: u32,
}

/// An axis, its drive and its host.
pub struct Bench {
    pub axis: Axis,
    /// Plans at once unless a test says otherwise.
    pub planner: Planner,
    pub drive: Simulated,
    /// What the drive claims to be instead of what it is.
    pub condition: Option<Condition>,
    /// How far the drive claims to be from where it is, and how much faster than it is.
    pub shift: Position,
    pub rush: Velocity,
    /// Whether the drive says anything.
    pub heard: bool,
    /// Whether the host sends its heartbeat.
    pub beats: bool,
    pub tick: u64,
    /// The number of the last command.
    pub sequence: u8,
    pub reports: Vec<Report>,
    pub setpoint: Setpoint,
    pub command: DriveCommand,
    before: State,
}

impl Bench {
    /// An axis whose drive stands at `position` turns.
    pub fn new(limits: Limits, position: f64) -> Self {
        Self {
            axis: Axis::new(AXIS, limits),
            planner: Planner::default(),
            drive: Simulated::new(turns(position)),
            condition: None,
            shift: Position::ZERO,
            rush: Velocity::ZERO,
            heard: true,
            beats: true,
            tick: 0,
            sequence: 0,
            reports: Vec::new(),
            setpoint: Setpoint::default(),
            command: DriveCommand::default(),
            before: State::NotReadyToSwitchOn,
        }
    }

    /// The same, held with number 1 and enabled with number 2.
    pub fn enabled(limits: Limits, position: f64) -> Self {
        let mut bench = Self::new(limits, position);
        bench.run(5);
        assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
        assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
        bench.run(10);
        assert_eq!(bench.axis.state(), State::OperationEnabled);
        bench
    }

    /// Bus time now, at the last tick.
    pub fn now(&self) -> BusTime {
        Tick(self.tick).time()
    }

    /// Some ticks.
    pub fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.step();
        }
    }

    /// One tick, whose setpoint must keep the promise.
    pub fn step(&mut self) {
        self.tick += 1;
        let told = self.report();
        if self.heard {
            self.axis.handle_drive(told);
        }
        let last = self.setpoint;
        self.setpoint = self.axis.tick(Tick(self.tick), self.now());
        self.command = self.axis.drive_command();
        self.drive.command(Tick(self.tick), self.command);
        self.check(last, told.position);
        self.before = self.axis.state();
        self.planner.act(&mut self.axis);
        if self.beats && self.tick.is_multiple_of(50) {
            let beat = Command::HostHeartbeat { session: SESSION };
            let outcome = self.axis.handle_frame(self.now(), &frame(beat));
            assert_eq!(outcome, Outcome::Accepted);
        }
        self.drain();
    }

    /// What the drive says.
    pub fn report(&self) -> DriveReport {
        let report = self.drive.report();
        DriveReport {
            condition: self.condition.unwrap_or(report.condition),
            position: report.position + self.shift,
            velocity: report.velocity + self.rush,
        }
    }

    fn check(&self, last: Setpoint, place: Position) {
        let (state, now, limits) = (self.axis.state(), self.setpoint, self.axis.limits());
        let strongest = limits.acceleration().max(limits.deceleration()).radians();
        assert_eq!(self.command.enable, state.drives(), "{state}");
        assert_eq!(self.command.position, now.position, "{state}");
        let may_move = matches!(
            state,
            State::OperationEnabled | State::QuickStopActive | State::FaultReactionActive
        );
        if !may_move {
            let at_rest = Setpoint {
                position: now.position,
                ..Setpoint::default()
            };
            assert_eq!(now, at_rest, "{state}");
        }
        assert!(now.velocity.abs() <= limits.velocity(), "{now:?}");
        assert!(now.acceleration.abs().radians() <= strongest, "{now:?}");
        if matches!(self.before, State::ReadyToSwitchOn) || !self.before.drives() {
            // Not yet led: the setpoint is where the drive is.
            assert!(
                !state.drives() || !self.heard || now.position == place,
                "{now:?}"
            );
            return;
        }
        let moved = (now.position - last.position).abs().radians();
        let most = limits.velocity().radians() * 1e-3 + 1e-8;
        assert!(moved <= most, "{state}: from {last:?} to {now:?}");
        let farther = outside(now.position, limits) > outside(last.position, limits);
        assert!(!farther, "{state}: from {last:?} to {now:?}");
        if state.drives() {
            let change = (now.velocity - last.velocity).abs().radians();
            let most = strongest * 1e-3 + 1e-6;
            assert!(change <= most, "{state}: from {last:?} to {now:?}");
        }
    }

    /// A frame from the bus; where it is planned at once, what then became of it.
    pub fn handle(&mut self, frame: &Frame) -> Outcome {
        let outcome = self.axis.handle_frame(self.now(), frame);
        let planned = self.planner.act(&mut self.axis);
        self.drain();
        match planned {
            Some(planned) if outcome == Outcome::Planning => planned,
            _ => outcome,
        }
    }

    /// A command as it stands.
    pub fn send(&mut self, command: Command) -> Outcome {
        self.handle(&frame(command))
    }

    /// The next number.
    pub fn next(&mut self) -> u8 {
        self.sequence = self.sequence.wrapping_add(1);
        self.sequence
    }

    /// A control command of the bench's session under the next number.
    pub fn control(&mut self, action: Action) -> Outcome {
        let sequence = self.next();
        self.send(control(sequence, action))
    }

    /// Where the drive is, whatever it claims.
    pub fn drive_position(&self) -> Position {
        self.drive.report().position
    }

    /// Sets a parameter to a raw value under the next number.
    #[track_caller]
    pub fn set(&mut self, parameter: Parameter, raw: i64) {
        let sequence = self.next();
        let write = Command::ParameterWrite {
            parameter: parameter.into(),
            value: raw,
            sequence,
        };
        assert_eq!(self.send(write), Outcome::Accepted, "{parameter:?} {raw}");
    }

    /// A beta move under the next number, now.
    pub fn go(&mut self, target: f64, milliseconds: u32) -> Outcome {
        let sequence = self.next();
        self.send(beta(sequence, target, milliseconds))
    }

    /// A trapezoid under the next number, now.
    pub fn go_trapezoid(&mut self, target: f64, milliseconds: u32) -> Outcome {
        let sequence = self.next();
        self.send(trapezoid(sequence, target, milliseconds))
    }

    /// A beta move under the next number, at the trigger.
    pub fn stage(&mut self, target: f64, milliseconds: u32) -> u8 {
        let sequence = self.next();
        assert_eq!(
            self.send(staged(sequence, target, milliseconds)),
            Outcome::Accepted
        );
        sequence
    }

    /// A trigger of `group` so many ticks after the last tick.
    pub fn trigger(&mut self, group: u8, ahead: u64) -> Outcome {
        self.send(Command::Trigger {
            group,
            session: SESSION,
            start: Tick(self.tick + ahead),
        })
    }

    /// Saves where that is asked for, and takes what the axis has to say.
    pub fn drain(&mut self) {
        if self.axis.wants_save() {
            self.axis.begin_save();
            let values = *self.axis.values();
            self.axis.end_save(Some(&values));
        }
        while let Some(frame) = self.axis.poll_transmit() {
            if let Ok(Some((axis, report))) = Report::decode(&frame) {
                assert_eq!(axis, AXIS);
                self.reports.push(report);
            }
        }
    }

    /// The last answer.
    #[track_caller]
    pub fn answer(&self) -> Answer {
        let answer = self.reports.iter().rev().find_map(|report| match *report {
            Report::Acknowledgement {
                sequence,
                function,
                reason,
                detail,
            } => Some(Answer {
                sequence,
                function,
                reason,
                detail,
            }),
            _ => None,
        });
        answer.expect("an answer")
    }

    /// The setpoint's position in turns.
    pub fn place(&self) -> f64 {
        self.setpoint.position.counts() as f64 / COUNTS_PER_TURN as f64
    }

    /// The setpoint's velocity in rad/s.
    pub fn velocity(&self) -> f64 {
        self.setpoint.velocity.radians()
    }

    /// Ticks until the axis rests, at most `most`.
    #[track_caller]
    pub fn ticks_to_rest(&mut self, most: u64) -> u64 {
        let begin = self.tick;
        while self.axis.is_moving() {
            assert!(
                self.tick - begin < most,
                "still {} rad/s and {} after {most} ticks",
                self.velocity(),
                self.axis.state()
            );
            self.step();
        }
        self.tick - begin
    }

    /// Runs on and sees that the setpoint stays where it is, without torque or with it.
    #[track_caller]
    pub fn stays(&mut self, ticks: u64) {
        let place = self.setpoint.position;
        for _ in 0..ticks {
            self.step();
            assert_eq!(self.setpoint.position, place, "{}", self.axis.state());
        }
        assert!(!self.axis.is_moving());
    }
}

/// The most ticks that a stop from this velocity takes: the braking, the ramps before and after
/// it, what is gained while an acceleration is still taken back, and whole ticks.
pub fn stopping_ticks(velocity: f64, limits: &Limits) -> u64 {
    let deceleration = limits.deceleration().radians();
    let ramp = deceleration / limits.jerk().radians();
    ((velocity.abs() / deceleration + 3.0 * ramp) * 1e3).ceil() as u64 + 5
}
