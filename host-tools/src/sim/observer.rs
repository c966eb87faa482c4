//! What can be seen of a simulation from outside, at its true times.

use std::cell::RefCell;
use std::rc::Rc;

use canter_shared::node::AxisSetpoint;

use super::{Transmission, TrueTime};

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
    /// A frame has come to its end on the bus; they come in the order in which they were sent.
    fn frame(&mut self, transmission: &Transmission) {
        let _ = transmission;
    }

    /// A node handed a setpoint to its drive at `time`. A node that has not had a SYNC yet is not
    /// seen: its ticks are not those of the bus. From then on each axis has one for each tick.
    fn setpoint(&mut self, time: TrueTime, setpoint: &AxisSetpoint) {
        let _ = (time, setpoint);
    }
}

impl<O: Observer> Observer for Rc<RefCell<O>> {
    fn frame(&mut self, transmission: &Transmission) {
        self.borrow_mut().frame(transmission);
    }

    fn setpoint(&mut self, time: TrueTime, setpoint: &AxisSetpoint) {
        self.borrow_mut().setpoint(time, setpoint);
    }
}

/// Keeps everything: 50 MB for twelve axes in a minute. What lasts longer observes for itself.
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
