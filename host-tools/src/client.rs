//! A commander of axes on a bus: finds them, holds them, moves them together, lets them go.
//!
//! A [`Client`] listens at first. From [`Client::hold`] on it is the commander of some axes and
//! keeps them alive: it sends its heartbeat whenever it waits for something, and SYNC where no
//! other host does. It must then not be left waiting elsewhere for longer than the axes' time-out
//! (0.25 s), or they stop.
//!
//! | file | what it holds |
//! |---|---|
//! | `known` | what is known of each axis from its reports |
//! | `beacon` | SYNC, the host's heartbeat, and whose time is bus time |
//! | `link` | waiting, questions and answers |
//! | `power` | hold, enable, disable, clear, stop |
//! | `parameter` | parameters read, written, saved |
//! | `assign` | ids given out by chip id |
//! | `request` | what can be asked for |
//! | `plan` | each axis's part of a move, checked before anything is sent |
//! | `movement` | synchronised moves |
//! | `stream` | motion that is made up as it goes |
//! | `error` | what can go wrong |

mod assign;
mod beacon;
mod error;
mod known;
mod link;
mod movement;
mod parameter;
mod plan;
mod power;
mod request;
mod stream;

pub use assign::{ChipId, ChipIdError};
pub(crate) use beacon::{HEARTBEAT_PERIOD, SYNC_PERIOD};
pub use error::ClientError;
pub use known::{KnownAxis, KnownNode};
pub use movement::{Arrival, Progress};
pub use parameter::{Change, Reading};
pub(crate) use plan::RANGE_MARGIN;
pub use request::{Goal, MoveRequest, Overrides, Target};
pub use stream::{Pace, StreamEnd, StreamKnot};

use crate::bus::Bus;
use canter_shared::time::BusTime;
use canter_shared::wire::command::Session;
use canter_shared::wire::id::AxisId;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A host on a bus.
pub struct Client<B: Bus> {
    bus: B,
    session: Session,
    axes: BTreeMap<AxisId, KnownAxis>,
    nodes: Vec<KnownNode>,
    /// The axes that this session holds, in the order in which they were taken.
    held: Vec<AxisId>,
    /// The last number used; one sequence serves all axes, so that a group can share a number.
    sequence: u8,
    beacon: beacon::Beacon,
    /// Frames heard, whoever sent them.
    frames: u64,
    interrupt: Arc<AtomicBool>,
    /// Words for the person at the terminal that are no errors: what the bus complained of.
    complaints: Vec<String>,
}

impl<B: Bus> Client<B> {
    /// A client that only listens so far. `session` is drawn at random by whoever starts it; 0 is
    /// nobody, and is taken as 1.
    pub fn new(bus: B, session: Session) -> Self {
        Self {
            bus,
            session: session.max(1),
            axes: BTreeMap::new(),
            nodes: Vec::new(),
            held: Vec::new(),
            sequence: 0,
            beacon: beacon::Beacon::default(),
            frames: 0,
            interrupt: Arc::default(),
            complaints: Vec::new(),
        }
    }

    /// A flag that ends whatever the client waits for, with [`ClientError::Interrupted`]: for a
    /// signal handler. A move under way is stopped first.
    pub fn interrupt(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.interrupt)
    }

    fn is_interrupted(&self) -> bool {
        self.interrupt.load(Ordering::Relaxed)
    }

    /// The bus, to ask it about itself.
    pub fn bus(&self) -> &B {
        &self.bus
    }

    /// The bus, to change it.
    pub fn bus_mut(&mut self) -> &mut B {
        &mut self.bus
    }

    /// The bus's own time; see [`Self::bus_time`].
    pub fn now(&self) -> BusTime {
        self.bus.now()
    }

    /// What is known of the axes that have been heard.
    pub fn axes(&self) -> &BTreeMap<AxisId, KnownAxis> {
        &self.axes
    }

    /// How many frames were heard, whoever sent them.
    pub fn frames_heard(&self) -> u64 {
        self.frames
    }

    /// What the bus complained of since the last call, each once.
    pub fn take_complaints(&mut self) -> Vec<String> {
        std::mem::take(&mut self.complaints)
    }
}
