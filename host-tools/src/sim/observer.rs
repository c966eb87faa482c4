//! What can be seen of a simulation from outside, at its true times.

use std::cell::RefCell;
use std::rc::Rc;

use canter_shared::axis::Axis;
use canter_shared::drive::DriveReport;
use canter_shared::node::AxisSetpoint;
use canter_shared::wire::frame::Frame;

use super::{Disturbance, ErrorState, PlantState, Station, Transmission, TrueTime};

/// Sees everything in a simulated robot as it happens.
///
/// For one that the caller keeps and looks into later, hand over an [`Rc`] of a [`RefCell`], which
/// must not be borrowed while the bus is being used:
///
/// ```
/// # use std::{cell::RefCell, rc::Rc};
/// # use canter::sim::{Configuration, Record, SimulatedBus};
/// let mut bus = SimulatedBus::new(&Configuration::default());
/// let record = Rc::new(RefCell::new(Record::default()));
/// bus.observe(record.clone());
/// // ... the bus goes to a client ...
/// assert!(record.borrow().frames.is_empty());
/// ```
pub trait Observer {
    /// A frame has come to its end on the bus, whole; they come in the order in which they were
    /// sent. Who got it, and when, [`Self::delivery`] tells.
    fn frame(&mut self, transmission: &Transmission) {
        let _ = transmission;
    }

    /// A frame was ended by an error frame, which is over now.
    fn destroyed(&mut self, destroyed: &Destroyed) {
        let _ = destroyed;
    }

    /// A station has taken a frame from its controller: a node's core has just dealt with it, or
    /// the host's [`Bus::receive`](crate::bus::Bus::receive) is about to return it. Only what comes
    /// here has been received, and what comes here twice has been received twice.
    fn delivery(&mut self, time: TrueTime, delivery: &Delivery) {
        let _ = (time, delivery);
    }

    /// A node handed a setpoint to its drive at `time`. A node that has not had a SYNC yet is not
    /// seen: its ticks are not those of the bus. From then on each axis has one for each tick.
    fn setpoint(&mut self, time: TrueTime, setpoint: &AxisSetpoint) {
        let _ = (time, setpoint);
    }

    /// A node has done its tick, with SYNC or without. Comes right before [`Self::setpoint`].
    fn tick(&mut self, time: TrueTime, tick: &AxisTick<'_>) {
        let _ = (time, tick);
    }

    /// The error state of a station's controller has changed.
    fn error_state(&mut self, time: TrueTime, station: Station, state: ErrorState) {
        let _ = (time, station, state);
    }

    /// A node has lost its power, or has it again and begins anew.
    fn power(&mut self, time: TrueTime, node: usize, on: bool) {
        let _ = (time, node, on);
    }

    /// Something goes wrong from now on, by choice or by chance. The chance of single frames
    /// ([`Rates`](super::Rates), `corrupted` to `lost`) is seen by what becomes of them only.
    fn disturbance(&mut self, time: TrueTime, disturbance: &Disturbance) {
        let _ = (time, disturbance);
    }
}

/// A frame that a station received.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Delivery {
    /// Who received it.
    pub receiver: Station,
    /// Who sent it.
    pub sender: Station,
    /// What was received.
    pub frame: Frame,
}

/// A frame that did not come to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Destroyed {
    /// When its first bit began.
    pub start: TrueTime,
    /// When the last bit of the error frame ended.
    pub end: TrueTime,
    /// Who sent it; of several that sent at once, the first in the order of stations.
    pub sender: Station,
    /// What was sent.
    pub frame: Frame,
    /// Why.
    pub cause: Destruction,
}

/// Why a frame was destroyed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Destruction {
    /// The wire was disturbed.
    Disturbed,
    /// This receiver saw an error. Where it saw it in the last bit but one, the others have the
    /// frame all the same, and have it again when it is repeated.
    Misread(Station),
    /// Others sent the same identifier at once, and another payload.
    Collision,
    /// Nobody was there to acknowledge it.
    NotAcknowledged,
    /// Its sender lost its power.
    CutOff,
}

/// A node after its tick.
#[derive(Debug, Clone, Copy)]
pub struct AxisTick<'a> {
    /// Which node, counted from 0 in the order of the configuration.
    pub node: usize,
    /// Whether the node has had a SYNC since it was switched on.
    pub synchronised: bool,
    /// Its setpoint, with the axis's id, the tick by its own clock and the state.
    pub setpoint: AxisSetpoint,
    /// The axis itself: its fault, its limits, its holder.
    pub axis: &'a Axis,
    /// What the drive says, which the axis will hear at its next tick.
    pub drive: DriveReport,
    /// Where the shaft really is.
    pub plant: PlantState,
}

impl<O: Observer> Observer for Rc<RefCell<O>> {
    fn frame(&mut self, transmission: &Transmission) {
        self.borrow_mut().frame(transmission);
    }

    fn destroyed(&mut self, destroyed: &Destroyed) {
        self.borrow_mut().destroyed(destroyed);
    }

    fn delivery(&mut self, time: TrueTime, delivery: &Delivery) {
        self.borrow_mut().delivery(time, delivery);
    }

    fn setpoint(&mut self, time: TrueTime, setpoint: &AxisSetpoint) {
        self.borrow_mut().setpoint(time, setpoint);
    }

    fn tick(&mut self, time: TrueTime, tick: &AxisTick<'_>) {
        self.borrow_mut().tick(time, tick);
    }

    fn error_state(&mut self, time: TrueTime, station: Station, state: ErrorState) {
        self.borrow_mut().error_state(time, station, state);
    }

    fn power(&mut self, time: TrueTime, node: usize, on: bool) {
        self.borrow_mut().power(time, node, on);
    }

    fn disturbance(&mut self, time: TrueTime, disturbance: &Disturbance) {
        self.borrow_mut().disturbance(time, disturbance);
    }
}

/// Keeps frames and setpoints: 50 MB for twelve axes in a minute. What lasts longer, or wants to
/// see more, observes for itself.
#[derive(Debug, Clone, Default)]
pub struct Record {
    /// Every frame in the order of the bus.
    pub frames: Vec<Transmission>,
    /// Every setpoint in the order of true time.
    pub setpoints: Vec<(TrueTime, AxisSetpoint)>,
}

impl Observer for Record {
    fn frame(&mut self, transmission: &Transmission) {
        self.frames.push(*transmission);
    }

    fn setpoint(&mut self, time: TrueTime, setpoint: &AxisSetpoint) {
        self.setpoints.push((time, *setpoint));
    }
}
