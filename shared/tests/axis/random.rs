//! Whatever frames arrive: random commands, plausible and wild, doubled, out of order, and raw
//! bytes, with a drive and a host that come and go, and a planner that is late or loses plans. The
//! bench holds every setpoint to the promise, and every command is answered once.

use super::bench::{AXIS, Bench, OTHER, SESSION, frame, turns};
use super::planner::Planner;
use super::random_stream::{LastKnot, StreamStep, stream};
use super::reaction::{mend, trouble};
use canter_shared::axis::Outcome;
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::drive::simulated::Simulated;
use canter_shared::drive::{Condition, Trouble};
use canter_shared::limits::{LimitValues, Limits};
use canter_shared::motion::beta::Beta;
use canter_shared::parameter::{Parameter, Reaction};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::{Acceleration, Jerk, Position, Velocity};
use canter_shared::wire::command::{Action, Command, ProfileKind, Session};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::Address;
use canter_shared::wire::report::Report;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// How long a move is to last.
#[derive(Debug, Clone, Copy)]
pub enum Duration {
    /// So many times the shortest.
    Times(f64),
    Ticks(u32),
}

/// Where a move is to end.
#[derive(Debug, Clone, Copy)]
pub enum Target {
    /// A part of the travel, 0 to 1.
    Inside(f64),
    /// So many turns from here.
    Near(f64),
    Turns(f64),
}

#[derive(Debug, Clone)]
pub enum Step {
    Run(u64),
    /// Clear, hold and enable as a good host would.
    Recover,
    Move {
        profile: ProfileKind,
        staged: bool,
        target: Target,
        duration: Duration,
        ahead: u8,
    },
    /// The trigger of what was staged last.
    Trigger {
        session: Session,
        ahead: i64,
    },
    Stream(StreamStep),
    Shape(u32, u32, u8),
    Ramps(f64, f64, u8),
    Peaks(f64, f64, u8),
    Control(Action, Session, u8),
    /// A parameter and a place in its range, or beyond.
    Write(Parameter, f64, u8),
    Stop(u8),
    EmergencyStop,
    Beat(Session),
    Beats(bool),
    /// A frame from before, counted from the last one.
    Again(usize),
    Raw(u16, Vec<u8>),
    /// Any payload under the axis's own functions.
    Forged(u16, [u8; 8]),
    Drive(Option<Condition>),
    Heard(bool),
    ByHand(f64),
    /// How far the drive claims to be from where it is, in turns.
    Shift(f64),
    /// How much faster it claims to be than it is, in rad/s.
    Rush(f64),
    Trouble(Fault),
    /// How the axis is to react from now on.
    React(Parameter, Reaction),
}

fn profile() -> impl Strategy<Value = ProfileKind> {
    prop_oneof![
        Just(ProfileKind::Beta),
        Just(ProfileKind::Trapezoid),
        Just(ProfileKind::SCurve),
    ]
}

fn session() -> impl Strategy<Value = Session> {
    prop_oneof![8 => Just(SESSION), 1 => Just(OTHER), 1 => any::<u16>()]
}

/// The next number mostly, sometimes any.
pub fn ahead() -> impl Strategy<Value = u8> {
    prop_oneof![12 => Just(1u8), 1 => any::<u8>()]
}

fn target() -> impl Strategy<Value = Target> {
    prop_oneof![
        5 => (0.0..=1.0f64).prop_map(Target::Inside),
        2 => (-0.05..0.05f64).prop_map(Target::Near),
        1 => (-1_023.0..1_023.0f64).prop_map(Target::Turns),
    ]
}

fn duration() -> impl Strategy<Value = Duration> {
    prop_oneof![
        6 => (1.0..3.0f64).prop_map(Duration::Times),
        1 => (0u32..1 << 22).prop_map(Duration::Ticks),
        2 => (0u32..500).prop_map(Duration::Ticks),
    ]
}

fn movement() -> impl Strategy<Value = Step> {
    let staged = prop::bool::weighted(0.25);
    (profile(), staged, target(), duration(), ahead()).prop_map(
        |(profile, staged, target, duration, ahead)| Step::Move {
            profile,
            staged,
            target,
            duration,
            ahead,
        },
    )
}

fn action() -> impl Strategy<Value = Action> {
    prop::sample::select(Action::ALL.to_vec())
}

fn parameter() -> impl Strategy<Value = Parameter> {
    prop::sample::select(Parameter::ALL.to_vec())
}

fn condition() -> impl Strategy<Value = Option<Condition>> {
    prop_oneof![
        4 => Just(None),
        1 => Just(Some(Condition::Lost)),
        1 => Just(Some(Condition::Disabled)),
        1 => Just(Some(Condition::Enabled)),
        1 => Just(Some(Condition::Faulted(Trouble::Other))),
    ]
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        10 => (1u64..60).prop_map(Step::Run),
        3 => (1u64..4).prop_map(Step::Run),
        1 => (60u64..400).prop_map(Step::Run),
        3 => Just(Step::Recover),
        14 => movement(),
        4 => (session(), -5i64..60).prop_map(|(session, ahead)| Step::Trigger { session, ahead }),
        1 => (session(), any::<i32>())
            .prop_map(|(session, ahead)| Step::Trigger { session, ahead: ahead.into() }),
        24 => stream().prop_map(Step::Stream),
        2 => (1u32..200, 1u32..200, ahead()).prop_map(|(a, d, n)| Step::Shape(a, d, n)),
        1 => (1.0..400.0f64, 1.0..400.0f64, ahead()).prop_map(|(a, d, n)| Step::Ramps(a, d, n)),
        1 => (0.5..30.0f64, 100.0..40_000.0f64, ahead()).prop_map(|(v, j, n)| Step::Peaks(v, j, n)),
        2 => (action(), session(), ahead()).prop_map(|(a, s, n)| Step::Control(a, s, n)),
        2 => (parameter(), -0.01..1.01f64, ahead()).prop_map(|(p, v, n)| Step::Write(p, v, n)),
        2 => any::<u8>().prop_map(Step::Stop),
        1 => Just(Step::EmergencyStop),
        1 => session().prop_map(Step::Beat),
        1 => prop::bool::weighted(0.8).prop_map(Step::Beats),
        4 => (0usize..12).prop_map(Step::Again),
        1 => (0u16..1 << 11, prop::collection::vec(any::<u8>(), 0..=8))
            .prop_map(|(id, data)| Step::Raw(id, data)),
        2 => (0u16..32, any::<[u8; 8]>()).prop_map(|(id, data)| Step::Forged(id, data)),
        1 => condition().prop_map(Step::Drive),
        1 => prop::bool::weighted(0.9).prop_map(Step::Heard),
        1 => (-20.0..20.0f64).prop_map(Step::ByHand),
        1 => (-0.2..0.2f64).prop_map(Step::Shift),
        1 => (-5.0..5.0f64).prop_map(Step::Rush),
        1 => prop::sample::select(vec![
            Fault::FollowingError,
            Fault::OutsideTravel,
            Fault::Overspeed,
            Fault::FeedbackRange,
            Fault::BusOff,
            Fault::DuplicateAxis,
        ])
        .prop_map(Step::Trouble),
        2 => (
            prop::sample::select(vec![
                Parameter::HostReaction,
                Parameter::FollowingReaction,
                Parameter::BusReaction,
            ]),
            prop::sample::select(super::reaction::REACTIONS.to_vec()),
        )
            .prop_map(|(parameter, reaction)| Step::React(parameter, reaction)),
    ]
}

pub fn limits() -> impl Strategy<Value = Limits> {
    let exponents = (-0.5..2.0f64, 0.5..3.5f64, 0.5..3.5f64, 0.0..3.5f64);
    (exponents, -1.0..1.5f64, -5.0..5.0f64).prop_map(
        |((velocity, acceleration, deceleration, jerk), travel, middle)| {
            let power = |exponent: f64| 10f64.powf(exponent);
            let (half, middle) = (power(travel) * TAU, middle * TAU);
            Limits::new(&LimitValues {
                velocity: power(velocity),
                acceleration: power(acceleration),
                deceleration: power(deceleration),
                jerk: power(acceleration.max(deceleration) + jerk),
                position_minimum: middle - half,
                position_maximum: middle + half,
            })
            .expect("in range")
        },
    )
}

/// A bench and the frames that it was sent.
pub struct Run {
    pub bench: Bench,
    frames: Vec<Frame>,
    group: u8,
    pub knot: LastKnot,
    /// Knots that were taken on.
    pub knots: usize,
    /// Answers that the commands so far are owed, and those given again to repetitions.
    owed: usize,
    repeated: usize,
    /// Ticks in motion: a test that never moves proves nothing.
    moved: u64,
}

impl Run {
    pub fn send(&mut self, command: Command) {
        let frame = frame(command);
        self.frames.push(frame);
        self.handle(&frame);
    }

    fn handle(&mut self, frame: &Frame) {
        let before = self.answers();
        let outcome = self.bench.axis.handle_frame(self.bench.now(), frame);
        self.bench.drain();
        let answered = matches!(
            Command::decode(frame),
            Ok(Some((
                _,
                Command::Stop { .. }
                    | Command::Control { .. }
                    | Command::TrapezoidShape { .. }
                    | Command::RampLimits { .. }
                    | Command::PeakLimits { .. }
                    | Command::ParameterWrite { .. }
                    | Command::StreamBegin { .. }
            )))
        );
        let knot = matches!(Command::decode(frame), Ok(Some((_, Command::Knot { .. }))));
        match outcome {
            Outcome::Planning | Outcome::Rejected(_) => self.owed += 1,
            Outcome::Accepted if answered => self.owed += 1,
            // Answered where knots before it are missing.
            Outcome::Accepted if knot => {
                self.knots += 1;
                let answers = self.answers() - before;
                assert!(answers <= 1);
                self.owed += answers;
            }
            // At most once: what is still being planned is answered then.
            Outcome::Repeated => {
                let again = self.answers() - before;
                assert!(again <= 1);
                self.repeated += again;
            }
            Outcome::Accepted | Outcome::Ignored => {}
        }
        self.bench.planner.act(&mut self.bench.axis);
        self.bench.drain();
    }

    /// Answers so far.
    fn answers(&self) -> usize {
        let answer = |report: &&Report| matches!(report, Report::Acknowledgement { .. });
        self.bench.reports.iter().filter(answer).count()
    }

    pub fn number(&mut self, ahead: u8) -> u8 {
        self.bench.sequence = self.bench.sequence.wrapping_add(ahead);
        self.bench.sequence
    }

    fn control(&mut self, action: Action, session: Session, ahead: u8) {
        let sequence = self.number(ahead);
        self.send(Command::Control {
            action,
            sequence,
            session,
        });
    }

    pub fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.bench.step();
            self.moved += u64::from(self.bench.velocity() != 0.0);
        }
    }

    pub fn target(&self, target: Target) -> Position {
        let limits = self.bench.axis.limits();
        let wanted = match target {
            Target::Inside(part) => {
                let (from, to) = (limits.position_minimum(), limits.position_maximum());
                let length = (to - from).counts() as f64;
                from + Position::from_counts((length * part) as i64)
            }
            Target::Near(difference) => self.bench.setpoint.position + turns(difference),
            Target::Turns(place) => turns(place),
        };
        wanted.max(turns(-1_023.9)).min(turns(1_023.9))
    }

    fn duration(&self, duration: Duration, target: Position) -> Ticks {
        match duration {
            Duration::Ticks(ticks) => Ticks(ticks),
            Duration::Times(times) => {
                let range = target - self.bench.setpoint.position;
                let shortest = Beta::shortest(range, self.bench.axis.limits());
                let ticks = shortest.map_or(1.0, |shortest| f64::from(shortest.0));
                Ticks(((ticks * times) as u32).min((1 << 22) - 1))
            }
        }
    }

    pub fn take(&mut self, step: Step) {
        match step {
            Step::Run(ticks) => self.run(ticks),
            Step::Recover => {
                mend(&mut self.bench);
                self.bench.heard = true;
                for action in [Action::Hold, Action::Clear, Action::Enable] {
                    self.control(action, SESSION, 1);
                    self.run(3);
                }
            }
            Step::Move {
                profile,
                staged,
                target,
                duration,
                ahead,
            } => {
                let target = self.target(target);
                let duration = self.duration(duration, target);
                let sequence = self.number(ahead);
                if staged {
                    self.group = sequence;
                }
                self.send(Command::Move {
                    profile,
                    staged,
                    target,
                    duration,
                    sequence,
                });
            }
            Step::Trigger { session, ahead } => self.send(Command::Trigger {
                group: self.group,
                session,
                start: Tick(self.bench.tick.saturating_add_signed(ahead)),
            }),
            Step::Stream(step) => self.stream(step),
            Step::Shape(acceleration, deceleration, ahead) => {
                let sequence = self.number(ahead);
                self.send(Command::TrapezoidShape {
                    acceleration: Ticks(acceleration),
                    deceleration: Ticks(deceleration),
                    sequence,
                });
            }
            Step::Ramps(acceleration, deceleration, ahead) => {
                let sequence = self.number(ahead);
                let limit = |value| Acceleration::from_radians(value).expect("in range");
                self.send(Command::RampLimits {
                    acceleration: limit(acceleration),
                    deceleration: limit(deceleration),
                    sequence,
                });
            }
            Step::Peaks(velocity, jerk, ahead) => {
                let sequence = self.number(ahead);
                self.send(Command::PeakLimits {
                    velocity: Velocity::from_radians(velocity).expect("in range"),
                    jerk: Jerk::from_radians(jerk).expect("in range"),
                    sequence,
                });
            }
            Step::Control(action, session, ahead) => self.control(action, session, ahead),
            Step::Write(parameter, place, ahead) => {
                // Most writes come from who may write.
                if ahead != 0 {
                    self.control(Action::Configure, SESSION, 1);
                }
                let sequence = self.number(ahead);
                let entry = parameter.entry();
                let length = (entry.maximum - entry.minimum) as f64;
                // Cubed, because there are more numbers near the lower end that mean something.
                let value = entry.minimum + (length * place.powi(3)) as i64;
                self.send(Command::ParameterWrite {
                    parameter: parameter.into(),
                    value,
                    sequence,
                });
            }
            Step::Stop(sequence) => self.send(Command::Stop { sequence }),
            Step::EmergencyStop => self.send(Command::EmergencyStop),
            Step::Beat(session) => self.send(Command::HostHeartbeat { session }),
            Step::Beats(beats) => self.bench.beats = beats,
            Step::Again(back) => {
                let frame = self.frames.iter().rev().nth(back).copied();
                if let Some(frame) = frame {
                    self.handle(&frame);
                }
            }
            Step::Raw(id, data) => {
                let frame = Frame::new(id, &data).expect("a frame");
                self.handle(&frame);
            }
            Step::Forged(function, data) => {
                let axis = u16::from(AXIS.get());
                for length in [2, 4, 8] {
                    let id = function << 6 | axis;
                    let frame = Frame::new(id, &data[..length]).expect("a frame");
                    self.handle(&frame);
                }
            }
            Step::Drive(condition) => self.bench.condition = condition,
            Step::Heard(heard) => self.bench.heard = heard,
            Step::ByHand(place) => {
                // A drive that holds its place is not moved.
                if !self.bench.command.enable {
                    self.bench.drive = Simulated::new(turns(place));
                }
            }
            Step::Shift(turned) => self.bench.shift = turns(turned),
            Step::Rush(faster) => {
                self.bench.rush = Velocity::from_radians(faster).expect("in range");
            }
            Step::Trouble(fault) => trouble(&mut self.bench, fault),
            Step::React(parameter, reaction) => {
                self.control(Action::Configure, SESSION, 1);
                let sequence = self.number(1);
                self.send(Command::ParameterWrite {
                    parameter: parameter.into(),
                    value: u8::from(reaction).into(),
                    sequence,
                });
            }
        }
    }
}

/// Plans at once, or with frames and ticks between taking a plan and bringing it back.
pub fn planner() -> impl Strategy<Value = Planner> {
    let delay = prop_oneof![
        10 => (0u8..4).prop_map(Some),
        3 => (0u8..20).prop_map(Some),
        1 => any::<u8>().prop_map(Some),
        1 => Just(None),
    ];
    let delays = prop_oneof![
        1 => Just(Vec::new()),
        2 => prop::collection::vec(delay, 1..20),
    ];
    let lead = prop_oneof![3 => 0u32..4, 1 => 0u32..300];
    (lead, delays).prop_map(|(lead, delays)| Planner::erratic(lead, delays))
}

/// Where the drive stands: inside the travel, or anywhere.
fn place() -> impl Strategy<Value = Target> {
    prop_oneof![
        3 => (0.0..=1.0f64).prop_map(Target::Inside),
        1 => (-20.0..20.0f64).prop_map(Target::Turns),
    ]
}

fn run(limits: Limits, place: Target, planner: Planner, steps: Vec<Step>) -> Run {
    let mut run = Run {
        bench: Bench::new(limits, 0.0),
        frames: Vec::new(),
        group: 0,
        knot: LastKnot::default(),
        knots: 0,
        owed: 0,
        repeated: 0,
        moved: 0,
    };
    run.bench.drive = Simulated::new(run.target(place));
    run.bench.planner = planner;
    run.run(5);
    run.take(Step::Recover);
    for step in steps {
        run.take(step);
    }
    // In the end an emergency stop brings everything to rest, and nothing moves again.
    let stop = Command::EmergencyStop.encode(Address::All).expect("fits");
    run.handle(&stop);
    let mut left = 200_000;
    while run.bench.axis.state() != State::Fault && left > 0 {
        run.bench.step();
        left -= 1;
    }
    assert_eq!(run.bench.axis.state(), State::Fault);
    run.bench.stays(100);
    assert_eq!(run.answers(), run.owed + run.repeated);
    run
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    #[test]
    fn no_frames_make_a_setpoint_leave_its_limits(
        limits in limits(),
        place in place(),
        planner in planner(),
        steps in prop::collection::vec(step(), 1..60),
    ) {
        run(limits, place, planner, steps);
    }
}

/// A test that never moves, whose plans are never late, or in which nothing goes wrong proves nothing.
#[test]
fn the_random_frames_move_the_axis_and_their_plans_are_late() {
    let mut runner = TestRunner::deterministic();
    let (mut moved, mut knots, mut outcomes) = (0, 0, Vec::new());
    let mut faults = BTreeSet::new();
    for _ in 0..500 {
        let steps = prop::collection::vec(step(), 1..60);
        let case = (limits(), place(), planner(), steps).new_tree(&mut runner);
        let (limits, place, planner, steps) = case.expect("a case").current();
        let run = run(limits, place, planner, steps);
        moved += run.moved;
        knots += run.knots;
        faults.extend(run.bench.reports.iter().filter_map(|report| match report {
            Report::Fault { fault, .. } => Some(*fault),
            _ => None,
        }));
        outcomes.extend(run.bench.planner.outcomes);
    }
    let count = |wanted: fn(&Outcome) -> bool| outcomes.iter().filter(|o| wanted(o)).count();
    let accepted = count(|outcome| *outcome == Outcome::Accepted);
    let late = count(|outcome| *outcome == Outcome::Planning);
    let overtaken = count(|outcome| *outcome == Outcome::Ignored);
    assert!(moved > 10_000, "{moved}");
    assert!(knots > 500, "{knots}");
    for fault in super::reaction::CHOICES {
        assert!(faults.contains(&fault.into()), "{fault:?} of {faults:?}");
    }
    assert!(accepted > 300, "{accepted}");
    assert!(late > 50, "{late}");
    assert!(overtaken > 50, "{overtaken}");
}
