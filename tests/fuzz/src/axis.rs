//! A node of two axes under whatever frames, drives, planners and hosts there may be: the setpoints
//! keep the limits and do not jump, and nothing moves that is not held and enabled.

use canter_shared::axis::state::State;
use canter_shared::axis::{FinishedPlan, Plan};
use canter_shared::drive::simulated::Simulated;
use canter_shared::drive::{Condition, Drive, DriveCommand, DriveReport, Trouble};
use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::Setpoint;
use canter_shared::node::{Board, Identity, Node};
use canter_shared::time::{LocalTime, Tick, Ticks};
use canter_shared::units::{COUNTS_PER_TURN, Position};
use canter_shared::wire::command::{Action, Command, ProfileKind, Session};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId};
use std::cell::Cell;
use std::rc::Rc;

const AXES: usize = 2;

/// The session of the host that means well.
const SESSION: Session = 1;

/// Ticks of one input at most, so that many inputs are tried.
const MOST_TICKS: u32 = 4_000;

/// Ticks between two heartbeats of the host that means well.
const BEAT: u32 = 50;

/// Takes the bytes as a script: each step is one byte that says what happens, and what belongs to it.
pub fn run(data: &[u8]) {
    let mut bench = Bench::new();
    let mut script = Script(data);
    while let Some(step) = script.byte() {
        if bench.ticks > MOST_TICKS {
            return;
        }
        bench.act(step, &mut script);
    }
    // Whatever was under way goes on.
    bench.run(200);
}

/// The bytes that are left; what is beyond the end is zero.
struct Script<'a>(&'a [u8]);

impl Script<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*first)
    }

    fn bytes<const COUNT: usize>(&mut self) -> [u8; COUNT] {
        std::array::from_fn(|_| self.byte().unwrap_or_default())
    }

    fn number(&mut self) -> u8 {
        self.byte().unwrap_or_default()
    }

    fn word(&mut self) -> u16 {
        u16::from_le_bytes(self.bytes())
    }
}

/// A drive that claims what it is told to.
struct Claiming {
    drive: Simulated,
    claim: Rc<Cell<Option<Condition>>>,
}

impl Drive for Claiming {
    fn command(&mut self, tick: Tick, command: DriveCommand) {
        self.drive.command(tick, command);
    }

    fn report(&self) -> DriveReport {
        let report = self.drive.report();
        DriveReport {
            condition: self.claim.get().unwrap_or(report.condition),
            ..report
        }
    }
}

/// What is remembered of an axis from one look at it to the next.
#[derive(Clone, Copy)]
struct Seen {
    setpoint: Setpoint,
    state: State,
    moving: bool,
}

struct Bench {
    node: Node<Claiming, AXES>,
    claims: [Rc<Cell<Option<Condition>>>; AXES],
    seen: [Seen; AXES],
    ticks: u32,
    sequence: u8,
    beats: bool,
    plans: bool,
    /// A plan that a slow planner has worked out and not brought back.
    finished: Option<FinishedPlan>,
}

fn axis(index: u8) -> AxisId {
    AxisId::new(1 + index % AXES as u8).expect("1 or 2")
}

/// Of one axis those by default; the other is slow one way, and has a short travel.
fn limits(index: usize) -> Limits {
    let narrow = LimitValues {
        velocity: 8.0,
        acceleration: 60.0,
        deceleration: 150.0,
        jerk: 4_000.0,
        position_minimum: -2.0,
        position_maximum: 5.0,
    };
    let values = if index == 0 { DEFAULT_VALUES } else { narrow };
    Limits::new(&values).expect("in range")
}

impl Bench {
    fn new() -> Self {
        let mut node = Node::new(Identity {
            chip: [0; 12],
            firmware: [0; 3],
            board: Board::Simulated,
        });
        let claims: [Rc<Cell<Option<Condition>>>; AXES] = Default::default();
        for (index, claim) in claims.iter().enumerate() {
            let drive = Claiming {
                drive: Simulated::new(Position::ZERO),
                claim: Rc::clone(claim),
            };
            node.add_axis(axis(index as u8), limits(index), drive)
                .expect("there is room");
        }
        let seen = Seen {
            setpoint: Setpoint::default(),
            state: State::NotReadyToSwitchOn,
            moving: false,
        };
        Self {
            node,
            claims,
            seen: [seen; AXES],
            ticks: 0,
            sequence: 0,
            beats: true,
            plans: true,
            finished: None,
        }
    }

    fn act(&mut self, step: u8, script: &mut Script) {
        match step % 16 {
            0 | 1 => {
                let ticks = script.number();
                self.run(u32::from(ticks));
            }
            2 => self.recover(),
            3 => self.raw(script.word(), &script.bytes()),
            4 => {
                // A function, at one of the axes or at all of them, with any payload.
                let [function, axis] = script.bytes();
                let id = u16::from(function % 32) << 6 | u16::from(axis % 4);
                self.raw(id, &script.bytes());
            }
            5..=8 => {
                let [profile, target, slow] = script.bytes();
                self.go(step, profile, target, slow);
            }
            9 => {
                let [ahead, group] = script.bytes();
                self.trigger(ahead, group);
            }
            10 => {
                let [index, action, session] = script.bytes();
                self.control(index, action, session);
            }
            11 => self.say(
                Address::Axis(axis(script.number())),
                Command::Stop { sequence: 0 },
            ),
            12 => self.claim(script.number(), script.number()),
            13 => self.beats = !self.beats,
            14 => self.plans = !self.plans,
            _ => match script.number() % 5 {
                0 => self.say(Address::All, Command::EmergencyStop),
                1 => self.plan(),
                2 => self.finished = self.node.take_plan(Ticks(0)).map(Plan::work),
                3 => self.finished = self.node.take_plan(Ticks(3)).map(Plan::work),
                _ => self.commit(),
            },
        }
    }

    /// Clears, holds and enables as a good host would.
    fn recover(&mut self) {
        self.claims.iter().for_each(|claim| claim.set(None));
        self.beats = true;
        self.plans = true;
        for action in [Action::Clear, Action::Hold, Action::Clear, Action::Enable] {
            for index in 0..AXES as u8 {
                self.control(index, u8::from(action), 0);
            }
            self.run(4);
        }
    }

    fn control(&mut self, index: u8, action: u8, session: u8) {
        let Ok(action) = Action::try_from(action) else {
            return;
        };
        let command = Command::Control {
            action,
            sequence: self.next(),
            session: SESSION + Session::from(session),
        };
        self.say(Address::Axis(axis(index)), command);
    }

    fn go(&mut self, index: u8, profile: u8, target: u8, slow: u8) {
        let [beta, trapezoid] = [ProfileKind::Beta, ProfileKind::Trapezoid];
        let profiles = [beta, trapezoid, ProfileKind::SCurve, beta];
        let command = Command::Move {
            profile: profiles[usize::from(profile % 4)],
            staged: profile >= 192,
            // An eighth of a turn at most from zero, or 32 turns.
            target: Position::from_counts(
                i64::from(target as i8) * COUNTS_PER_TURN / if index < 128 { 1024 } else { 4 },
            ),
            duration: Ticks(8 * u32::from(slow)),
            sequence: self.next(),
        };
        self.say(Address::Axis(axis(index)), command);
    }

    fn trigger(&mut self, ahead: u8, group: u8) {
        let start = self.node.bus_time(self.node.next_tick()).next_tick();
        let command = Command::Trigger {
            group: self.sequence.wrapping_sub(group),
            session: SESSION,
            start: start.after(Ticks(ahead.into())),
        };
        self.say(Address::All, command);
    }

    fn claim(&mut self, index: u8, condition: u8) {
        let condition = match condition % 8 {
            0 => Some(Condition::Lost),
            1 => Some(Condition::Disabled),
            2 => Some(Condition::Enabled),
            3 => Some(Condition::Faulted(Trouble::Other)),
            _ => None,
        };
        self.claims[usize::from(index) % AXES].set(condition);
    }

    fn next(&mut self) -> u8 {
        self.sequence = self.sequence.wrapping_add(1);
        self.sequence
    }

    fn say(&mut self, address: Address, command: Command) {
        if let Ok(frame) = command.encode(address) {
            self.handle(&frame);
        }
    }

    fn raw(&mut self, id: u16, data: &[u8; 9]) {
        let [length, data @ ..] = data;
        let length = usize::from(*length % 9);
        if let Some(frame) = Frame::new(id & 0x7FF, &data[..length]) {
            self.handle(&frame);
        }
    }

    fn handle(&mut self, frame: &Frame) {
        // Between the last tick and the next.
        let now = LocalTime(self.node.next_tick().0.saturating_sub(400));
        self.node.handle_frame(now, frame);
        self.look();
        if self.plans {
            self.plan();
        }
        self.drain(now);
    }

    fn plan(&mut self) {
        self.node.plan();
        self.look();
    }

    /// What was taken some time ago.
    fn commit(&mut self) {
        if let Some(finished) = self.finished.take() {
            self.node.commit(&finished);
            self.look();
        }
    }

    /// Whether what begins to move may: it is held, and enabled.
    fn look(&mut self) {
        for (axis, seen) in self.node.axes().zip(&mut self.seen) {
            let moving = axis.is_moving();
            if moving && !seen.moving {
                assert!(axis.session().is_some(), "{} moves for nobody", axis.id());
                assert_eq!(axis.state(), State::OperationEnabled, "{}", axis.id());
            }
            seen.moving = moving;
        }
    }

    fn drain(&mut self, now: LocalTime) {
        // A frame for each answer that fits its queue, for all that is told by itself, and no more.
        for _ in 0..64 {
            if self.node.poll_transmit(now).is_none() {
                return;
            }
        }
        panic!("it has something to say without end");
    }

    fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    fn tick(&mut self) {
        self.ticks += 1;
        let now = self.node.next_tick();
        self.look();
        let setpoints = self.node.tick(now).to_vec();
        for ((axis, seen), new) in self.node.axes().zip(&mut self.seen).zip(setpoints) {
            let command = axis.drive_command();
            assert_eq!(command.enable, new.state.drives(), "{new:?}");
            assert_eq!(command.position, new.setpoint.position, "{new:?}");
            keeps_the_promise(seen, &new.setpoint, new.state, axis.limits());
            seen.setpoint = new.setpoint;
            seen.state = new.state;
        }
        self.look();
        if self.plans {
            self.plan();
        }
        if self.beats && self.ticks.is_multiple_of(BEAT) {
            let session = SESSION;
            self.say(Address::All, Command::HostHeartbeat { session });
        }
        self.drain(now);
    }
}

/// One tick of an axis against the one before it.
fn keeps_the_promise(last: &Seen, now: &Setpoint, state: State, limits: &Limits) {
    let told = || {
        format!(
            "{state}: from {:?} ({}) to {now:?}",
            last.setpoint, last.state
        )
    };
    let before = &last.setpoint;
    let strongest = limits.acceleration().max(limits.deceleration());
    assert!(now.velocity.abs() <= limits.velocity(), "{}", told());
    assert!(now.acceleration.abs() <= strongest, "{}", told());
    let may_move = matches!(
        state,
        State::OperationEnabled | State::QuickStopActive | State::FaultReactionActive
    );
    if !may_move {
        let at_rest = Setpoint {
            position: now.position,
            ..Setpoint::default()
        };
        assert_eq!(*now, at_rest, "{}", told());
    }
    if matches!(last.state, State::ReadyToSwitchOn) || !last.state.drives() {
        // Not led yet: it is where its drive is.
        return;
    }
    let moved = (now.position - before.position).abs().counts();
    assert!(
        moved <= limits.velocity().counts() / 1_000 + 4,
        "{}",
        told()
    );
    assert!(last.moving || moved == 0, "by itself, {}", told());
    let outside = |position: Position| {
        let below = (limits.position_minimum() - position).counts();
        let above = (position - limits.position_maximum()).counts();
        below.max(above).max(0)
    };
    let farther = outside(now.position) > outside(before.position);
    assert!(!farther, "out of the travel, {}", told());
    if state.drives() {
        let change = (now.velocity - before.velocity).abs().counts();
        assert!(change <= strongest.counts() / 1_000 + 64, "{}", told());
    }
}
