//! What can go wrong, by choice or by chance.
//!
//! [`SimulatedBus::disturb`](super::SimulatedBus::disturb) does one thing now,
//! [`SimulatedBus::disturb_at`](super::SimulatedBus::disturb_at) does it at a true time, also while
//! a client waits; [`Rates`] in the configuration do them at random, from the seed. An
//! [`Observer`](super::Observer) sees each as it begins. Whatever names a node that is not there
//! does nothing.

use std::time::Duration;

use canter_shared::wire::frame::Frame;

use super::Station;

/// One thing that goes wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Disturbance {
    /// The wire is disturbed during each of the next `frames` frames, at a bit that the seed
    /// chooses: the sender sees it, an error frame ends the frame, all count, and it is sent again.
    Corrupt {
        /// How many; repetitions count too.
        frames: u32,
    },
    /// `receiver` alone misreads each of the next `frames` frames that it would receive. As long as
    /// it is error active it destroys them for everybody; an error passive one only misses them.
    Misread {
        /// Who misreads.
        receiver: Station,
        /// How many; repetitions count too.
        frames: u32,
    },
    /// `receiver` sees an error in the last bit but one of the next frame, which the others have
    /// taken by then: the sender sends it again, so they have it twice, and `receiver` once.
    Double {
        /// Who has it once.
        receiver: Station,
    },
    /// `receiver` does not get the next `frames` frames that it would receive, and nobody notices,
    /// it neither: worse than a full queue, which is counted.
    Lose {
        /// Who misses them.
        receiver: Station,
        /// How many.
        frames: u32,
    },
    /// A node looks at no frame for `time`, as when it is busy with something else: what comes
    /// meanwhile waits in its queue, and what finds no room there is lost and counted. Its ticks,
    /// which have precedence, go on. For the host see [`Self::StallHost`].
    Delay {
        /// Which node.
        node: usize,
        /// For how long.
        time: Duration,
    },
    /// A strange device sends without a pause, as often as the bus lets it.
    Babble {
        /// What it sends.
        what: Babble,
        /// For how long.
        time: Duration,
    },
    /// A node is without power for `time`: its drive lets go, and its axis coasts to rest. It
    /// comes back with nothing but what its flash holds, a clock that begins anew, and its axis
    /// disabled.
    CutPower {
        /// Which node.
        node: usize,
        /// For how long; zero is a reset.
        time: Duration,
    },
    /// The same, at the moment at which the node writes or erases its flash for the `after`-th
    /// time from now, which stays half done. Until then nothing happens.
    CutPowerWhileSaving {
        /// Which node.
        node: usize,
        /// How many operations are still whole.
        after: u32,
        /// For how long.
        time: Duration,
    },
    /// The host's process stands still: its next call, to send or to receive, comes back after
    /// `time` from now and does its work then. What it had sent goes out, what comes meanwhile waits.
    StallHost {
        /// For how long.
        time: Duration,
    },
    /// The host's process ends. What it had sent goes out; every later call gives
    /// [`BusError::Closed`](crate::bus::BusError::Closed) until
    /// [`SimulatedBus::revive_host`](super::SimulatedBus::revive_host), and
    /// [`SimulatedBus::run`](super::SimulatedBus::run) has the time go on.
    KillHost,
    /// The host's SYNC frames are lost on their way to its controller.
    LoseSync {
        /// For how long.
        time: Duration,
    },
    /// The drive of a node has trouble.
    Drive {
        /// Which node.
        node: usize,
        /// What trouble.
        trouble: DriveTrouble,
        /// For how long; then it is well again, disabled.
        time: Duration,
    },
}

/// What a babbling device sends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Babble {
    /// Always the same.
    Frame(Frame),
    /// Any identifier, length and bytes: forged commands and reports among them.
    Anything,
}

/// What a drive can have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DriveTrouble {
    /// A fault of its own: it lets go and says so.
    Fault,
    /// It lets go without a word, and says that it is disabled.
    Disable,
    /// It falls silent and, as it hears nothing either, lets go.
    Silence,
    /// It is blocked: the shaft stands still whatever the torque.
    Blocked,
}

/// How often what goes wrong, at random. The default is never.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rates {
    /// Of a million frames, how many are corrupted on the wire.
    pub corrupted: u32,
    /// Of a million frames, how many one of the receivers misreads.
    pub misread: u32,
    /// Of a million frames, how many come twice to all receivers but one.
    pub doubled: u32,
    /// Of a million receptions, how many are lost without a trace.
    pub lost: u32,
    /// A node that does not look at its frames.
    pub delays: Option<Recurring>,
    /// A device that babbles, one time the same frame and the next time anything.
    pub babbling: Option<Recurring>,
    /// Power cuts, of one node at a time.
    pub power_cuts: Option<Recurring>,
    /// Host processes that stand still.
    pub host_stalls: Option<Recurring>,
    /// Lost SYNC.
    pub sync_losses: Option<Recurring>,
    /// Trouble of a drive.
    pub drive_troubles: Option<Recurring>,
}

/// Something that happens again and again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Recurring {
    /// The mean time from one to the next; each is anything from 0 to twice this.
    pub every: Duration,
    /// The longest time that it lasts; each lasts anything from 0 to this.
    pub longest: Duration,
}
