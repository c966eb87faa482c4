//! The simulated robot behind [`Bus`]: the devices' own core on a CAN bus in virtual time.
//!
//! Nothing here reads a clock. Time passes only where a caller waits, in [`Bus::receive`] or in a
//! [`Bus::send`] into a full queue, and from event to event: a frame ends, a receiver gets it, a
//! node's tick is due. All chance comes from one seed, so the same calls give the same bytes.
//!
//! | file | what it holds |
//! |---|---|
//! | `clock` | true time, and each node's crystal |
//! | `bits` | the exact length of a frame, stuff bits counted |
//! | `medium` | the wire: arbitration, one frame at a time, its load |
//! | `device` | a node: the core, its crystal, its mailbox |
//! | `observer` | what can be recorded |
//! | `random` | the seed's numbers |
//!
//! What is not simulated: bit errors and lost frames, propagation on the cable, and a node with
//! several mailboxes; a frame that waits in a node's one mailbox is not overtaken by its own
//! node's more urgent ones.

mod bits;
mod clock;
mod device;
mod disturbance;
mod fault_confinement;
mod medium;
mod observer;
mod plant;
mod random;
mod station;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;

use canter_shared::time::BusTime;
use canter_shared::wire::frame::Frame;

use crate::bus::{Bitrate, Bus, BusError, Event, Received};
use crate::robot::{Robot, RobotAxis};
pub use clock::TrueTime;
use device::Device;
pub use disturbance::{Babble, Disturbance, DriveTrouble, Rates, Recurring};
pub use fault_confinement::{ErrorCounters, ErrorState};
pub use medium::{Load, Transmission};
use medium::{Medium, arbitrate};
pub use observer::{AxisTick, Delivery, Destroyed, Destruction, Observer, Record};
pub use plant::PlantState;
use random::SplitMix64;
pub use station::Station;

/// Frames that the host can have waiting: those of a Linux CAN interface (`txqueuelen`), so that
/// a client meets its first full queue here and not on the robot.
const HOST_QUEUE: usize = 10;

/// What robot to simulate.
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    /// One node for each axis, in this order. An axis that is named twice gives two nodes that
    /// do not know of each other, as on a bus that was set up wrongly.
    pub axes: Vec<RobotAxis>,
    /// Where all chance comes from: crystals, receivers' delays, chip ids, ties.
    pub seed: u64,
    /// The bus's bit rate.
    pub bitrate: Bitrate,
    /// Each crystal is off by at most this, in ppm.
    pub crystal_ppm: u32,
    /// Each receiver, at each frame, is late by at most this, in nanoseconds.
    pub receive_jitter: u32,
}

impl Configuration {
    /// The axes of `robot` on a bus of 1 Mbit/s: seed 1, crystals of +-100 ppm, receivers late by
    /// up to 20 us.
    pub fn of(robot: &Robot) -> Self {
        Self {
            axes: robot.axes().to_vec(),
            seed: 1,
            bitrate: Bitrate::default(),
            crystal_ppm: 100,
            receive_jitter: 20_000,
        }
    }
}

impl Default for Configuration {
    /// That of the default robot, with axes 1 to 12 and default limits.
    fn default() -> Self {
        Self::of(&Robot::default())
    }
}

/// A robot on a bus of its own, seen from the host.
pub struct SimulatedBus {
    now: TrueTime,
    medium: Medium,
    devices: Vec<Device>,
    outgoing: VecDeque<Frame>,
    incoming: VecDeque<(TrueTime, Frame)>,
    random: SplitMix64,
    receive_jitter: u64,
    observer: Option<Box<dyn Observer>>,
}

impl SimulatedBus {
    /// A robot whose nodes were switched on some seconds ago and whose clocks nobody has set yet;
    /// time is 0.
    pub fn new(configuration: &Configuration) -> Self {
        let mut random = SplitMix64::new(configuration.seed);
        let devices = configuration
            .axes
            .iter()
            .map(|axis| Device::new(axis, configuration.crystal_ppm, &mut random))
            .collect();
        Self {
            now: TrueTime::default(),
            medium: Medium::new(configuration.bitrate),
            devices,
            outgoing: VecDeque::new(),
            incoming: VecDeque::new(),
            random,
            receive_jitter: configuration.receive_jitter.into(),
            observer: None,
        }
    }

    /// Shows everything from now on to `observer`, instead of to the one before.
    pub fn observe(&mut self, observer: impl Observer + 'static) {
        self.observer = Some(Box::new(observer));
    }

    /// How much of the time since the start the bus was taken, the frame under way aside.
    pub fn load(&self) -> Load {
        self.medium.load(self.now)
    }

    /// What each node believes the bus time to be, in the order of the configuration; the truth
    /// is [`Bus::now`].
    pub fn node_times(&self) -> impl Iterator<Item = BusTime> {
        self.devices.iter().map(|device| device.bus_time(self.now))
    }

    /// The next instant at which something happens on the bus or in a node.
    fn next_event(&self) -> Option<TrueTime> {
        let waiting = !self.outgoing.is_empty()
            || self
                .devices
                .iter()
                .any(|device| device.outgoing().is_some());
        let devices = self.devices.iter().map(Device::due).min();
        let medium = self.medium.due(waiting);
        devices.into_iter().chain(medium).min()
    }

    /// Everything that is due at `event`: a frame ends, then the nodes in their order, then those
    /// that wait for a free bus.
    fn step(&mut self, event: TrueTime) {
        // What the host just sent may wait for a bus that has been free for some time.
        self.now = self.now.max(event);
        if let Some(ended) = self.medium.finish(self.now) {
            self.deliver(&ended);
        }
        for device in &mut self.devices {
            while device.due() <= self.now {
                let setpoint = device.step(self.now);
                if let (Some(observer), Some(setpoint)) = (&mut self.observer, setpoint) {
                    observer.setpoint(self.now, &setpoint);
                }
            }
        }
        if self.medium.is_free(self.now) {
            let host = self.outgoing.front().map(|frame| (Station::Host, frame));
            let nodes = self
                .devices
                .iter()
                .enumerate()
                .filter_map(|(at, device)| Some((Station::Node(at), device.outgoing()?)));
            let waiting = host.into_iter().chain(nodes);
            if let Some((sender, frame)) = arbitrate(waiting, &mut self.random) {
                self.medium.begin(self.now, sender, frame);
            }
        }
    }

    fn deliver(&mut self, ended: &Transmission) {
        let (end, frame) = (ended.end, ended.frame);
        for (at, device) in self.devices.iter_mut().enumerate() {
            if ended.sender == Station::Node(at) {
                device.sent(end);
            } else {
                let delay = self.random.up_to(self.receive_jitter);
                device.deliver(end.after(delay), frame);
            }
        }
        if ended.sender == Station::Host {
            self.outgoing.pop_front();
        } else {
            let time = end.after(self.random.up_to(self.receive_jitter));
            let last = self.incoming.back().map_or(time, |last| time.max(last.0));
            self.incoming.push_back((last, frame));
        }
        if let Some(observer) = &mut self.observer {
            observer.frame(ended);
        }
    }
}

impl Bus for SimulatedBus {
    fn now(&self) -> BusTime {
        self.now.bus_time()
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        // A real bus would make the caller wait here until there is room.
        while self.outgoing.len() >= HOST_QUEUE
            && let Some(event) = self.next_event()
        {
            self.step(event);
        }
        self.outgoing.push_back(*frame);
        Ok(())
    }

    fn receive(&mut self, until: BusTime) -> Result<Option<Received>, BusError> {
        let until = TrueTime::of(until).max(self.now);
        loop {
            let arrives = self.incoming.front().map(|(time, _)| *time);
            let event = self.next_event();
            // At one instant the robot is first, so that nothing of it is left in the past.
            if let Some(event) = event.filter(|event| *event <= arrives.unwrap_or(until).min(until))
            {
                self.step(event);
            } else if let Some((time, frame)) =
                self.incoming.pop_front_if(|(time, _)| *time <= until)
            {
                self.now = self.now.max(time);
                return Ok(Some(Received {
                    time: time.bus_time(),
                    event: Event::Frame(frame),
                }));
            } else {
                self.now = until;
                return Ok(None);
            }
        }
    }

    fn description(&self) -> String {
        format!("simulated robot of {} axes", self.devices.len())
    }
}
