//! Models of servo drives, to try links and nodes on without one: `canter drive`.
//!
//! A model knows only what its drive's documents say: it decodes by itself and shares no code with the
//! links. It is sans-IO: frames in and out, and a tick of 1 ms. [`run()`] gives it a bus in real time.
//!
//! | file | what it holds |
//! |---|---|
//! | `odrive`, `mit`, `cia402` | a drive of each kind |
//! | `shaft` | what its motor moves |
//! | `station` | a drive that gets into trouble |
//! | `run` | drives on a bus, in real time |

mod cia402;
mod mit;
mod odrive;
mod run;
mod shaft;
mod station;

pub use cia402::Cia402Model;
pub use mit::MitModel;
pub use odrive::OdriveModel;
pub use run::run;
pub use station::{Station, Trial, Trouble};

use canter_shared::drive::settings::{DriveKind, OdriveFirmware};
use canter_shared::wire::frame::Frame;

/// What a model is of.
#[derive(Debug, Clone, Copy)]
pub struct Make {
    /// Its language; there is no model of the simulated one, which is in the node itself.
    pub kind: DriveKind,
    /// Which ODrive.
    pub firmware: OdriveFirmware,
    /// Silence of its node after which it stops, in ms; its own default where `None`.
    pub watchdog: Option<u32>,
    /// Whether it holds torque when it begins, as one that another program has left.
    pub starts_enabled: bool,
}

/// What a drive does, as somebody who stands beside it sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Whether it holds torque and follows.
    pub enabled: bool,
    /// Whether it has a fault.
    pub faulted: bool,
    /// Where its shaft is, in turns.
    pub position: f64,
    /// Where it was told to be, in turns.
    pub target: f64,
}

/// A drive of some kind, with its power on.
pub trait Model {
    /// Takes a frame of the bus.
    fn receive(&mut self, frame: &Frame);

    /// A millisecond passes.
    fn tick(&mut self);

    /// The next frame for the bus.
    fn poll_transmit(&mut self) -> Option<Frame>;

    /// It stops with a fault: its supply is too low.
    fn fail(&mut self);

    /// It stops by itself, without a fault.
    fn drop_out(&mut self);

    /// Its power went and came: what it was told is forgotten, its shaft stays.
    fn restart(&mut self);

    /// What it does.
    fn seen(&self) -> Seen;
}

/// A drive of this make and id, at rest at `turns`; `None` for the simulated one.
pub fn model(make: &Make, node: u8, turns: f64) -> Option<Box<dyn Model>> {
    let model: Box<dyn Model> = match make.kind {
        DriveKind::Simulated => return None,
        DriveKind::Odrive => Box::new(OdriveModel::new(make, node, turns)),
        DriveKind::Mit => Box::new(MitModel::new(make, node, turns)),
        DriveKind::Cia402 => Box::new(Cia402Model::new(make, node, turns)),
    };
    Some(model)
}

/// A frame of a model's own making.
fn frame(id: u16, data: &[u8]) -> Frame {
    Frame::new(id, data).expect("the ids and lengths of the models are right")
}
