//! What can go wrong, by choice or by chance.
//!
//! [`SimulatedBus::disturb`](super::SimulatedBus::disturb) does one thing now,
//! [`SimulatedBus::disturb_at`](super::SimulatedBus::disturb_at) does it at a true time, also while
//! a client waits; [`Rates`] in the configuration do them at random, from the seed. An
//! [`Observer`](super::Observer) sees each as it begins. Whatever names a node that is not there
//! does nothing.

use std::time::Duration;

use canter_shared::wire::frame::Frame;

use super::chance::nanoseconds;
use super::clock::TrueTime;
use super::controller::Controller;
use super::{SimulatedBus, Station};
use canter_shared::time::BusTime;

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

impl SimulatedBus {
    /// Has things go wrong at other rates from now on.
    pub fn set_rates(&mut self, rates: Rates) {
        self.chance.change(self.now, rates);
    }

    /// Has something go wrong now.
    pub fn disturb(&mut self, disturbance: Disturbance) {
        if let Some(observer) = &mut self.observer {
            observer.disturbance(self.now, &disturbance);
        }
        self.apply(disturbance);
    }

    /// Has something go wrong at `time`, or now where that has passed; of several at one time, the
    /// one that was ordered first is first.
    pub fn disturb_at(&mut self, time: BusTime, disturbance: Disturbance) {
        let time = TrueTime::of(time);
        let place = self.ordered.partition_point(|(other, _)| *other <= time);
        self.ordered.insert(place, (time, disturbance));
    }

    /// Has a strange device send `frame`, after those that it has still to send.
    pub fn forge(&mut self, frame: &Frame) {
        self.stranger.forged.push_back(*frame);
        self.refill_stranger();
    }

    /// A new process on the host, after [`Disturbance::KillHost`]: it hears what comes from now
    /// on. What the old one had sent and is not out yet stays.
    pub fn revive_host(&mut self) {
        self.host.revive();
    }

    /// What was ordered for this time, or comes by chance.
    pub(super) fn disturb_in_time(&mut self) {
        while let Some((_, disturbance)) = self.ordered.pop_front_if(|(time, _)| *time <= self.now)
        {
            self.disturb(disturbance);
        }
        while self.chance.due() <= self.now
            && let Some(disturbance) = self.chance.take(self.now)
        {
            self.disturb(disturbance);
        }
    }

    fn apply(&mut self, disturbance: Disturbance) {
        let until = |time| self.now.after(nanoseconds(time));
        match disturbance {
            Disturbance::Corrupt { frames } => {
                self.corruptions = self.corruptions.saturating_add(frames);
            }
            Disturbance::Misread { receiver, frames } => {
                self.mark(receiver, frames, |one| &mut one.misreads);
            }
            Disturbance::Double { receiver } => self.mark(receiver, 1, |one| &mut one.doubles),
            Disturbance::Lose { receiver, frames } => {
                self.mark(receiver, frames, |one| &mut one.losses);
            }
            Disturbance::Delay { node, time } => {
                let until = until(time);
                if let Some(device) = self.devices.get_mut(node) {
                    device.delay(until);
                    self.look_at_device(node);
                }
            }
            Disturbance::Babble { what, time } => {
                self.stranger.babbles = Some((what, until(time)));
                self.refill_stranger();
            }
            Disturbance::CutPower { node, time } => self.cut_power(node, time),
            Disturbance::CutPowerWhileSaving { node, after, time } => {
                if let Some(device) = self.devices.get_mut(node) {
                    device.cut_power_while_saving(after, time);
                }
            }
            Disturbance::StallHost { time } => self.host.stall(until(time)),
            Disturbance::KillHost => self.host.kill(),
            Disturbance::LoseSync { time } => self.host.lose_sync(until(time)),
            Disturbance::Drive {
                node,
                trouble,
                time,
            } => {
                let ticks = nanoseconds(time).div_ceil(1_000_000);
                if let Some(device) = self.devices.get_mut(node) {
                    device.trouble(trouble, ticks);
                }
            }
        }
    }

    fn mark(&mut self, station: Station, times: u32, what: fn(&mut Controller) -> &mut u32) {
        if let Some(place) = station.place(self.devices.len()) {
            let count = what(&mut self.controllers[place]);
            *count = count.saturating_add(times);
            self.has_marks = true;
        }
    }

    /// Takes the power away from a node; one that has none stays without it until the later time.
    pub(super) fn cut_power(&mut self, node: usize, time: Duration) {
        let until = self.now.after(nanoseconds(time));
        let Some(device) = self.devices.get_mut(node) else {
            return;
        };
        let place = node + 1;
        let had_power = device.axis().is_some();
        device.cut_power(self.now, until);
        self.controllers[place].power_off();
        self.medium.lose(self.now, place);
        self.look_at(place);
        self.look_at_device(node);
        if let Some(observer) = self.observer.as_mut().filter(|_| had_power) {
            observer.power(self.now, node, false);
        }
    }

    /// Gives the stranger its next frame: a forged one before what it babbles. It is on the bus
    /// only as long as it has one.
    pub(super) fn refill_stranger(&mut self) {
        let place = self.controllers.len() - 1;
        let stranger = &mut self.controllers[place];
        if !stranger.is_empty() {
            return;
        }
        let now = self.now;
        let frame = self.stranger.forged.pop_front().or_else(|| {
            let (what, until) = self.stranger.babbles?;
            (now < until).then(|| match what {
                Babble::Frame(frame) => frame,
                Babble::Anything => self.chance.frame(),
            })
        });
        match frame {
            Some(frame) => {
                if !stranger.is_powered() {
                    stranger.power_on(now);
                }
                stranger.push(frame);
            }
            None => stranger.power_off(),
        }
        self.look_at(place);
    }
}
