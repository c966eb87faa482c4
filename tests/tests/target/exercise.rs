//! Everything that a node can be asked over its bus, with frames of all kinds close behind one another.

use std::time::Instant;

use canter_shared::axis::state::State;
use canter_shared::parameter::Parameter;
use canter_shared::time::{BusTime, Tick, Ticks};
use canter_shared::units::{COUNTS_PER_TURN, Position, Velocity};
use canter_shared::wire::command::{Action, Command, Item, ProfileKind, Session};
use canter_shared::wire::id::{Address, AxisId};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;
use canter_tests::PATIENCE;

use crate::emulated::Emulated;

const SESSION: Session = 4_712;

/// Changes of motion, for each axis.
const MOVES: u32 = 90;

/// Knots of a stream, every 10 ms.
const KNOTS: u32 = 60;
const PERIOD: u8 = 10;

const READ: Command = Command::ParameterRead {
    parameter: Parameter::VelocityLimit as u8,
    item: Item::Saved,
};

/// In ms: so long that no busy machine comes between the node and its heartbeats.
const TIMEOUT: i64 = 10_000;

/// Who asks, and what came of it.
pub struct Exercise<'a> {
    node: &'a mut Emulated,
    /// The bus's clock begins here.
    began: Instant,
    random: u64,
    sequence: u8,
    /// Feedback of the first axis, which comes every 20 ms.
    feedbacks: u32,
    /// By axis: position, state, whether it moves.
    seen: [(Position, u8, bool); 3],
    /// Commands that were accepted.
    pub accepted: u32,
    /// Moves that were accepted while the one before was under way.
    pub retargets: u32,
    /// Axes whose stream ran dry in mid-motion.
    pub dry: u32,
    /// Times that the parameters were saved.
    pub saves: u32,
}

impl<'a> Exercise<'a> {
    pub fn new(node: &'a mut Emulated) -> Self {
        Self {
            node,
            began: Instant::now(),
            random: 0x9E37_79B9_7F4A_7C15,
            sequence: 0,
            feedbacks: 0,
            seen: [(Position::ZERO, 0, false); 3],
            accepted: 0,
            retargets: 0,
            dry: 0,
            saves: 0,
        }
    }

    /// All of it, once.
    pub fn run(&mut self) {
        self.configure(Parameter::HostTimeout, TIMEOUT);
        self.enable();
        self.move_about();
        // Where this machine is late, one may run dry before it has begun to move.
        while self.dry == 0 {
            self.stream();
        }
        self.enable();
        self.node.say(Address::All, Command::EmergencyStop);
        self.wait_for(State::Fault);
        self.enable();
        self.change_drives();
    }

    fn enable(&mut self) {
        while self.control(Action::Enable) != [true; 3] {
            self.control(Action::Hold);
            self.control(Action::Clear);
        }
        self.wait_for(State::OperationEnabled);
    }

    /// Moves of each profile to places and in times of no order, most while another is under way.
    fn move_about(&mut self) {
        for round in 0..MOVES {
            let faulty = |seen: &(_, u8, _)| seen.1 == u8::from(State::Fault);
            if self.seen.iter().any(faulty) {
                self.enable();
            }
            if round % 10 == 9 {
                self.ask_all(|_, sequence| Command::Stop { sequence });
                continue;
            }
            let staged = round % 7 == 3;
            let [targets, durations] =
                [1 << 33, 700].map(|below| [0; 3].map(|_| self.below(below)));
            let moving = self.seen.map(|(_, _, moving)| moving);
            let asked = |axis: usize, sequence| Command::Move {
                profile: [
                    ProfileKind::Beta,
                    ProfileKind::SCurve,
                    ProfileKind::Trapezoid,
                ][(round as usize + axis) % 3],
                staged,
                target: Position::from_counts(targets[axis] as i64 - (1 << 32)),
                duration: Ticks(300 + durations[axis] as u32),
                sequence,
            };
            let accepted = self.ask_all(asked);
            if staged {
                let trigger = Command::Trigger {
                    group: self.sequence,
                    session: SESSION,
                    start: Tick(self.bus_time().0 / 1_000 + 30),
                };
                self.node.say(Address::All, trigger);
            }
            let both = accepted.iter().zip(moving);
            self.retargets += both
                .filter(|(accepted, moving)| **accepted && *moving)
                .count() as u32;
            // As long as it takes until some of them have come to their cruise, or to their end.
            let pause = self.below(12) as u32;
            self.pass(pause);
        }
    }

    /// Streams to all axes that run dry in the middle of a motion.
    fn stream(&mut self) {
        self.enable();
        self.ask_all(|_, sequence| Command::Stop { sequence });
        self.wait_until(|_, moving| !moving);
        let from = self.seen.map(|(position, _, _)| position.counts());
        let start = Tick(self.bus_time().0 / 1_000 + 60);
        let begun = self.ask_all(|_, sequence| Command::StreamBegin {
            start,
            period: PERIOD,
            number: 0,
            sequence,
        });
        assert_eq!(begun, [true; 3], "the axes rest and are held");
        let began = self.feedbacks;
        for knot in 1..=KNOTS {
            // One circle's projection in a second: it begins at rest and ends in motion.
            let angle = std::f64::consts::TAU * f64::from(knot) * f64::from(PERIOD) * 1e-3;
            let radius = 0.05 * COUNTS_PER_TURN as f64;
            let place = (radius * (1.0 - angle.cos())) as i64;
            let speed = (radius * std::f64::consts::TAU * angle.sin()) as i64;
            for (axis, from) in axes().zip(from) {
                let command = Command::Knot {
                    position: Position::from_counts(from + place),
                    velocity: Velocity::from_counts(speed),
                    number: (knot % 64) as u8,
                };
                self.node.say(Address::Axis(axis), command);
            }
            // Two knots for each feedback, six ahead.
            while 2 * (self.feedbacks - began) + 6 < knot {
                self.hear();
            }
        }
        let ended = [State::Fault, State::OperationEnabled].map(u8::from);
        self.wait_until(|state, moving| !moving && ended.contains(&state));
        let dry = self
            .seen
            .iter()
            .filter(|seen| seen.1 == u8::from(State::Fault));
        self.dry += dry.count() as u32;
    }

    /// Each kind of drive, saved: there is none on the emulated board, so the links ask for it in vain.
    fn change_drives(&mut self) {
        self.control(Action::Disable);
        self.wait_for(State::SwitchOnDisabled);
        for kind in [1, 2, 3, 0] {
            self.configure(Parameter::DriveKind, kind);
            self.pass(5);
            let saved = self.control(Action::Save);
            self.saves += u32::from(saved == [true; 3]);
        }
        self.wait_for(State::SwitchOnDisabled);
    }

    /// Sets a parameter of all axes, which are disabled.
    fn configure(&mut self, parameter: Parameter, value: i64) {
        let write = |_, sequence| Command::ParameterWrite {
            parameter: parameter.into(),
            value,
            sequence,
        };
        while self.ask_all(write) != [true; 3] {
            self.control(Action::Hold);
            self.control(Action::Configure);
        }
    }

    fn control(&mut self, action: Action) -> [bool; 3] {
        self.ask_all(|_, sequence| Command::Control {
            action,
            sequence,
            session: SESSION,
        })
    }

    /// Asks all axes the same and a little more, and waits for the answers: whether each has accepted.
    fn ask_all(&mut self, command: impl Fn(usize, u8) -> Command) -> [bool; 3] {
        self.sequence = self.sequence.wrapping_add(1);
        let sequence = self.sequence;
        let mut answers = [None; 3];
        let mut repeat = self.feedbacks;
        while answers.contains(&None) {
            // What was lost in a full queue is said again, as every host does.
            if self.feedbacks >= repeat {
                repeat += 20;
                for (index, axis) in axes().enumerate() {
                    self.node.say(Address::Axis(axis), command(index, sequence));
                }
                // While they work on it, others want to know something.
                self.node.say(Address::All, Command::IdentityRequest);
                for axis in axes() {
                    self.node.say(Address::Axis(axis), READ);
                }
            }
            let (axis, report) = self.hear();
            if let Report::Acknowledgement {
                sequence: of,
                reason,
                ..
            } = report
                && of == sequence
            {
                answers[axis] = Some(reason == Reason::Accepted);
            }
        }
        let answers = answers.map(|answer| answer == Some(true));
        self.accepted += answers.iter().filter(|accepted| **accepted).count() as u32;
        answers
    }

    /// Waits until all axes are in a state.
    fn wait_for(&mut self, state: State) {
        self.wait_until(|seen, _| seen == u8::from(state));
    }

    /// Waits until all axes say, from now on, what is waited for: their state and whether they move.
    fn wait_until(&mut self, wanted: impl Fn(u8, bool) -> bool) {
        let mut waiting = [true; 3];
        // What is under way may still be older.
        self.pass(2);
        while waiting.contains(&true) {
            let (axis, report) = self.hear();
            if let Report::Feedback { state, moving, .. } = report {
                waiting[axis] = !wanted(state, moving);
            }
        }
    }

    /// Lets so many feedbacks come.
    fn pass(&mut self, feedbacks: u32) {
        let end = self.feedbacks + feedbacks;
        while self.feedbacks < end {
            self.hear();
        }
    }

    /// The next report, and which of the axes it is from; keeps the axes while they speak.
    fn hear(&mut self) -> (usize, Report) {
        let patient = self.began.elapsed() < 3 * PATIENCE;
        assert!(patient, "the node does not get on: {:?}", self.seen);
        let (axis, report) = self.node.report();
        let axis = usize::from(axis.get() - 1);
        if let Report::Feedback {
            position,
            state,
            moving,
            ..
        } = report
        {
            self.seen[axis] = (position, state, moving);
            if axis == 0 {
                self.feedbacks += 1;
                let sync = Command::Sync {
                    counter: self.feedbacks as u8,
                    time: self.bus_time(),
                };
                self.node.say(Address::All, sync);
                self.node
                    .say(Address::All, Command::HostHeartbeat { session: SESSION });
            }
        }
        (axis, report)
    }

    fn bus_time(&self) -> BusTime {
        BusTime(1_000_000 + self.began.elapsed().as_micros() as u64)
    }

    fn below(&mut self, end: u64) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        self.random % end
    }
}

fn axes() -> impl Iterator<Item = AxisId> {
    (1..=3).filter_map(AxisId::new)
}
