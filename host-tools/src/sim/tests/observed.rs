//! What tests want to know of a run.

use canter_shared::axis::state::State;
use canter_shared::node::AxisSetpoint;
use canter_shared::wire::frame::Frame;

use super::*;

/// One node's tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tick {
    pub(super) time: TrueTime,
    pub(super) node: usize,
    pub(super) synchronised: bool,
    pub(super) setpoint: AxisSetpoint,
    pub(super) fault: Option<&'static str>,
    pub(super) plant: PlantState,
}

/// Everything in the order in which it was told.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Observed {
    pub(super) frames: Vec<Transmission>,
    pub(super) destroyed: Vec<Destroyed>,
    pub(super) deliveries: Vec<(TrueTime, Delivery)>,
    pub(super) ticks: Vec<Tick>,
    pub(super) states: Vec<(TrueTime, Station, ErrorState)>,
    pub(super) power: Vec<(TrueTime, usize, bool)>,
    pub(super) disturbances: Vec<(TrueTime, Disturbance)>,
}

impl Observer for Observed {
    fn frame(&mut self, transmission: &Transmission) {
        self.frames.push(*transmission);
    }

    fn destroyed(&mut self, destroyed: &Destroyed) {
        self.destroyed.push(*destroyed);
    }

    fn delivery(&mut self, time: TrueTime, delivery: &Delivery) {
        self.deliveries.push((time, *delivery));
    }

    fn tick(&mut self, time: TrueTime, tick: &AxisTick<'_>) {
        self.ticks.push(Tick {
            time,
            node: tick.node,
            synchronised: tick.synchronised,
            setpoint: tick.setpoint,
            fault: tick.axis.fault().map(|fault| fault.name()),
            plant: tick.plant,
        });
    }

    fn error_state(&mut self, time: TrueTime, station: Station, state: ErrorState) {
        self.states.push((time, station, state));
    }

    fn power(&mut self, time: TrueTime, node: usize, on: bool) {
        self.power.push((time, node, on));
    }

    fn disturbance(&mut self, time: TrueTime, disturbance: &Disturbance) {
        self.disturbances.push((time, *disturbance));
    }
}

impl Observed {
    /// How often `frame` was received by `receiver`.
    pub(super) fn received(&self, receiver: Station, frame: &Frame) -> usize {
        let mut deliveries = self.deliveries.iter();
        let by = |delivery: &Delivery| delivery.receiver == receiver && delivery.frame == *frame;
        deliveries
            .by_ref()
            .filter(|(_, delivery)| by(delivery))
            .count()
    }

    /// What a node did last.
    pub(super) fn last(&self, node: usize) -> &Tick {
        let mut ticks = self.ticks.iter().rev();
        ticks.find(|tick| tick.node == node).expect("it ticks")
    }

    /// What a node's axis did from `time` on: its states, each once.
    pub(super) fn states_since(&self, node: usize, time: TrueTime) -> Vec<State> {
        let ticks = self.ticks.iter();
        let mut states: Vec<State> = ticks
            .filter(|tick| tick.node == node && tick.time >= time)
            .map(|tick| tick.setpoint.state)
            .collect();
        states.dedup();
        states
    }
}

/// A bus of some nodes that nobody has spoken on yet, and what is seen of it.
pub(super) fn bus(
    nodes: usize,
    change: impl FnOnce(&mut Configuration),
) -> (SimulatedBus, Rc<RefCell<Observed>>) {
    let mut configuration = Configuration::default();
    configuration.axes.truncate(nodes);
    change(&mut configuration);
    let mut bus = SimulatedBus::new(&configuration);
    let observed = Rc::new(RefCell::new(Observed::default()));
    bus.observe(Rc::clone(&observed));
    (bus, observed)
}
