//! One seed, from its beginning to its end or to a violation.

use std::any::Any;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::rc::Rc;
use std::time::Duration;

use canter_shared::axis::state::State;
use canter_shared::parameter::Parameter;
use canter_shared::time::{BusTime, Tick};
use canter_shared::units::{COUNTS_PER_TURN, Position};
use canter_shared::wire::command::Command;
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, Function};

use super::actor::{Actor, Commander, Heard, Hostile, Rival, Sheet, Voice};
use super::check::{Checker, Glance, Statistics};
use super::fault::Faults;
use super::invariant::{Invariant, Violation};
use super::recording::{Input, Recording};
use super::sabotage::{Ghost, Sabotage, lowered, wear_out};
use super::scenario::Scenario;
use crate::bus::Bus;
use crate::robot::RobotAxis;
use crate::sim::{
    AxisTick, Delivery, Disturbance, Observer, SimulatedBus, Station, Transmission, TrueTime,
};

/// How long an episode lasts in virtual time: 100 seeds make an hour.
pub const EPISODE: Duration = Duration::from_secs(36);

/// What all episodes have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// What may go wrong.
    pub faults: Faults,
    /// How many axes each robot has, 1 to 12; none leaves it to the seed.
    pub axes: Option<u8>,
    /// What is broken on purpose.
    pub sabotage: Option<Sabotage>,
}

impl Default for Options {
    /// Everything may go wrong, and nothing is broken on purpose.
    fn default() -> Self {
        Self {
            faults: Faults::ALL,
            axes: None,
            sabotage: None,
        }
    }
}

/// How an episode ended.
#[derive(Debug)]
pub struct Ending {
    /// The seed.
    pub seed: u64,
    /// How many axes the robot had.
    pub axes: usize,
    /// How much virtual time passed.
    pub lasted: Duration,
    /// What happened.
    pub statistics: Statistics,
    /// What was wrong, with what makes it happen again.
    pub violation: Option<(Violation, Recording)>,
}

/// Sees and remembers what happens.
struct Witness {
    checker: Checker,
    heard: Heard,
    frames: Vec<(BusTime, Frame)>,
    sabotage: Option<Sabotage>,
    /// What the axes say that they are, where that is not what they are.
    meant: Vec<RobotAxis>,
    /// The node that is to begin with something that was never saved.
    begins: Option<usize>,
    /// Counts what a saboteur lets pass.
    passed: u64,
}

impl Witness {
    /// Whether what is sabotaged happens this time, one time in `every`.
    fn strikes(&mut self, sabotage: Sabotage, every: u64) -> bool {
        if self.sabotage != Some(sabotage) {
            return false;
        }
        self.passed += 1;
        self.passed.is_multiple_of(every)
    }

    /// What a saboteur makes of a tick; none where he hides it.
    fn sabotage_tick(&mut self, node: usize, now: &mut Glance) -> Option<()> {
        if self.sabotage.is_none() {
            return Some(());
        }
        let moves = now.state == State::OperationEnabled && now.setpoint.velocity.counts() != 0;
        if now.state == State::Fault && self.strikes(Sabotage::ForgottenFault, 50) {
            (now.state, now.fault) = (State::SwitchOnDisabled, None);
        }
        if !moves {
            return Some(());
        }
        if self.strikes(Sabotage::Jump, 500) {
            let far = Position::from_counts(COUNTS_PER_TURN / 100);
            now.setpoint.position = now.setpoint.position + far;
        }
        if self.strikes(Sabotage::DeafToStop, 300) {
            let frame = Command::Stop { sequence: 0 }.encode(Address::All).ok()?;
            self.checker.deliver(now.time, node, &frame);
        }
        if self.strikes(Sabotage::Panic, 500) {
            panic!("on purpose, in the {}th setpoint of a motion", self.passed);
        }
        (!self.strikes(Sabotage::MissedTick, 500)).then_some(())
    }

    /// Whether a saboteur hides a frame that a node got.
    fn hides(&mut self, delivery: &Delivery) -> bool {
        let from = |function| delivery.frame.id() >> 6 == u16::from(u8::from(function));
        match self.sabotage {
            Some(Sabotage::BeatsForTheDead) => {
                delivery.sender == Station::Stranger && from(Function::HostHeartbeat)
            }
            Some(Sabotage::HiddenMove) => {
                from(Function::MoveBeta) && self.strikes(Sabotage::HiddenMove, 20)
            }
            _ => false,
        }
    }
}

impl Observer for Witness {
    fn frame(&mut self, transmission: &Transmission) {
        self.frames
            .push((transmission.end.bus_time(), transmission.frame));
        self.heard.hear(&transmission.frame);
        self.checker.frame(transmission);
        let is_answer =
            transmission.frame.id() >> 6 == u16::from(u8::from(Function::Acknowledgement));
        if is_answer && self.strikes(Sabotage::DoubledAnswer, 20) {
            self.checker.frame(transmission);
        }
    }

    fn delivery(&mut self, time: TrueTime, delivery: &Delivery) {
        if let Station::Node(node) = delivery.receiver
            && !self.hides(delivery)
        {
            self.checker.deliver(time, node, &delivery.frame);
        }
    }

    fn tick(&mut self, time: TrueTime, tick: &AxisTick<'_>) {
        let mut now = Glance::of(time, tick);
        let mut values = *tick.axis.values();
        let mut limits = *tick.axis.limits();
        if let Some(axis) = self.meant.get(tick.node) {
            values = lowered(&values, axis);
            limits = values.settings().limits;
        }
        if self.begins.take_if(|node| *node == tick.node).is_some() {
            let parameter = Parameter::HeartbeatPeriod;
            let torn = values.with(parameter, values.get(parameter) ^ 1);
            values = torn.map_or(values, |(torn, _)| torn);
        }
        let shown = self.sabotage_tick(tick.node, &mut now);
        if shown.is_some() {
            self.checker.tick(tick.node, &now, (&values, &limits));
        }
    }

    fn power(&mut self, time: TrueTime, node: usize, on: bool) {
        if on && self.sabotage == Some(Sabotage::TornParameters) {
            self.begins = Some(node);
        }
        self.checker.power(time, node, on);
    }

    fn disturbance(&mut self, _time: TrueTime, _disturbance: &Disturbance) {
        self.checker.disturbance();
    }
}

/// A robot under watch, and all that was sent to it.
pub(super) struct Stage {
    seed: u64,
    options: Options,
    bus: SimulatedBus,
    witness: Rc<RefCell<Witness>>,
    inputs: Vec<Input>,
    /// When flash loses something next, where that is wanted.
    wears_out: BusTime,
}

impl Stage {
    pub(super) fn new(seed: u64, options: Options, scenario: &Scenario) -> Self {
        let mut bus = SimulatedBus::new(&scenario.configuration);
        let witness = Rc::new(RefCell::new(Witness {
            checker: Checker::new(seed, &scenario.axes),
            heard: Heard::default(),
            frames: Vec::new(),
            sabotage: options.sabotage,
            meant: match options.sabotage {
                Some(Sabotage::HigherLimits) => scenario.axes.clone(),
                _ => Vec::new(),
            },
            begins: None,
            passed: 0,
        }));
        bus.observe(Rc::clone(&witness));
        for (at, disturbance) in &scenario.orders {
            bus.disturb_at(*at, *disturbance);
        }
        Self {
            seed,
            options,
            bus,
            witness,
            inputs: Vec::new(),
            wears_out: BusTime(5_000_000),
        }
    }

    /// Lets time pass; says whether all is still well.
    pub(super) fn run(&mut self, until: BusTime) -> bool {
        let wears_out = self.options.sabotage == Some(Sabotage::WornFlash);
        while wears_out && self.wears_out <= until {
            self.bus.run(self.wears_out);
            self.wears_out = BusTime(self.wears_out.0 + 5_000_000);
            wear_out(&mut self.bus);
        }
        self.bus.run(until);
        self.witness.borrow().checker.violation().is_none()
    }

    /// Somebody sends a frame.
    pub(super) fn send(&mut self, voice: Voice, frame: Frame) {
        let time = self.bus.now();
        self.inputs.push(Input { time, voice, frame });
        match voice {
            // A full queue is a frame less, as for any process.
            Voice::Host => drop(self.bus.send(&frame)),
            Voice::Stranger => self.bus.forge(&frame),
        }
    }

    /// The end; `panicked` with what was said then.
    fn end(self, axes: usize, panicked: Option<String>) -> Ending {
        let now = self.bus.true_now();
        drop(self.bus);
        let witness = self.witness.borrow();
        let panicked = panicked.map(|detail| Violation {
            seed: self.seed,
            invariant: Invariant::Panic,
            axis: None,
            tick: Tick(now.0 / 1_000_000),
            time: now,
            detail,
        });
        let violation = witness.checker.violation().cloned().or(panicked);
        Ending {
            seed: self.seed,
            axes,
            lasted: Duration::from_nanos(now.0),
            statistics: *witness.checker.statistics(),
            violation: violation.map(|violation| {
                let recording = Recording {
                    seed: self.seed,
                    faults: self.options.faults,
                    axes: self.options.axes,
                    words: violation.to_string(),
                    inputs: self.inputs,
                    frames: witness.frames.clone(),
                };
                (violation, recording)
            }),
        }
    }
}

/// Plays what `act` does with the robot of a seed, until it is done or something is wrong.
pub(super) fn play(seed: u64, options: Options, act: impl FnOnce(&mut Stage, &Scenario)) -> Ending {
    let scenario = Scenario::draw(seed, &options);
    let mut stage = Stage::new(seed, options, &scenario);
    // Nothing of a stage that has panicked is used but what the observer has written down.
    let played = catch_unwind(AssertUnwindSafe(|| act(&mut stage, &scenario)));
    let panicked = played.err().map(|panic| words(&*panic));
    stage.end(scenario.axes.len(), panicked)
}

fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("a panic without words").to_owned()
}

/// Runs one seed.
pub fn run(seed: u64, options: Options) -> Ending {
    play(seed, options, |stage, scenario| {
        let mut actors = actors(seed, options, scenario);
        let end = BusTime(EPISODE.as_micros() as u64);
        let mut out = Vec::new();
        loop {
            let next = actors.iter_mut().min_by_key(|actor| actor.due());
            let Some(actor) = next.filter(|actor| actor.due() < end) else {
                break;
            };
            if !stage.run(actor.due()) {
                return;
            }
            let now = stage.bus.now();
            actor.act(now, &stage.witness.borrow().heard, &mut out);
            let voice = actor.voice();
            for frame in out.drain(..) {
                stage.send(voice, frame);
            }
        }
        stage.run(end);
    })
}

fn actors(seed: u64, options: Options, scenario: &Scenario) -> Vec<Box<dyn Actor>> {
    let sheets = || {
        scenario.axes.iter().map(|axis| Sheet {
            id: axis.id,
            limits: axis.limits(),
        })
    };
    let commander = Commander::new(seed, sheets(), &scenario.absences);
    let mut actors: Vec<Box<dyn Actor>> = vec![Box::new(commander)];
    if scenario.has_rival {
        actors.push(Box::new(Rival::new(seed, sheets())));
    }
    if scenario.is_hostile {
        actors.push(Box::new(Hostile::new(seed, sheets())));
    }
    if options.sabotage == Some(Sabotage::BeatsForTheDead) {
        actors.push(Box::new(Ghost::default()));
    }
    actors
}
