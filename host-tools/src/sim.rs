//! The simulated robot behind [`Bus`]: the devices' own core on a CAN bus in virtual time.
//!
//! Nothing here reads a clock. Time passes only where a caller waits, in [`Bus::receive`], in a
//! [`Bus::send`] into a full queue or in [`SimulatedBus::run`], and from event to event: a frame
//! ends, a receiver gets it, a node's tick is due. All chance comes from one seed, so the same
//! calls give the same bytes.
//!
//! | file | what it holds |
//! |---|---|
//! | `clock` | true time, and each node's crystal |
//! | `station` | who is on the bus |
//! | `bits` | the exact length of a frame, stuff bits counted |
//! | `medium` | the wire: one frame at a time, its end, its load |
//! | `contest` | several that send one identifier at once |
//! | `fault_confinement` | error counters and states, by the standard's rules |
//! | `controller` | what a station has to send, and its place on the bus |
//! | `traffic` | arbitration, the fate of a frame, delivery |
//! | `errors` | what all count, bus-off and the way back |
//! | `host` | the host's process and its queues |
//! | `device` | a node: the core, its crystal, its receive queue |
//! | `plant` | a node's drive, motor, shaft and encoder |
//! | `flash` | a node's flash |
//! | `segment` | a bus whose stations the caller plays |
//! | `disturbance`, `chance` | what goes wrong, by choice and at random |
//! | `observer` | what can be recorded |
//! | `random` | the seed's numbers |
//!
//! What is not simulated: propagation on the cable, errors within error frames, overload frames,
//! and the 11 recessive bits that a controller waits when it is switched on.

pub(crate) mod bits;
mod chance;
mod clock;
mod contest;
mod controller;
mod device;
mod disturbance;
mod errors;
mod fault_confinement;
mod flash;
mod host;
mod medium;
mod observer;
mod plant;
pub(crate) mod random;
mod segment;
mod station;
#[cfg(test)]
mod tests;
mod traffic;

use std::collections::VecDeque;

use canter_shared::axis::Axis;
use canter_shared::time::BusTime;
use canter_shared::wire::frame::Frame;

use crate::bus::Bitrate;
#[cfg(doc)]
use crate::bus::Bus;
use crate::robot::{Robot, RobotAxis};
use chance::Chance;
use clock::NEVER;
pub use clock::TrueTime;
use controller::{Controller, NOTHING};
use device::{Device, Step};
pub use disturbance::{Babble, Disturbance, DriveTrouble, Rates, Recurring};
pub use fault_confinement::{ErrorCounters, ErrorState};
pub use flash::{FlashError, SimulatedFlash};
use host::Host;
use medium::Medium;
pub use medium::{Load, Transmission};
pub use observer::{AxisTick, Delivery, Destroyed, Destruction, Observer, Record};
pub use plant::{PlantError, PlantModel, PlantState, PlantValues};
use random::SplitMix64;
pub use segment::{Passed, Segment};
pub use station::Station;

/// What robot to simulate.
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    /// One node for each axis, in this order. An axis that is named twice gives two nodes that
    /// do not know of each other, as on a bus that was set up wrongly.
    pub axes: Vec<RobotAxis>,
    /// Where all chance comes from: crystals, receivers' delays, chip ids, what goes wrong.
    pub seed: u64,
    /// The bus's bit rate.
    pub bitrate: Bitrate,
    /// Each crystal is off by at most this, in ppm.
    pub crystal_ppm: u32,
    /// Each receiver, at each frame, is late by at most this, in nanoseconds.
    pub receive_jitter: u32,
    /// What each node moves; without it [`PlantModel::fitting`] chooses by the axis's limits.
    pub plant: Option<PlantModel>,
    /// What goes wrong at random.
    pub disturbances: Rates,
}

impl Configuration {
    /// The axes of `robot` on a bus of 1 Mbit/s: seed 1, crystals of +-100 ppm, receivers late by
    /// up to 20 us, and nothing goes wrong.
    pub fn of(robot: &Robot) -> Self {
        Self {
            axes: robot.axes().to_vec(),
            seed: 1,
            bitrate: Bitrate::default(),
            crystal_ppm: 100,
            receive_jitter: 20_000,
            plant: None,
            disturbances: Rates::default(),
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
///
/// Stations have places: the host 0, the nodes from 1 on, the stranger last.
pub struct SimulatedBus {
    now: TrueTime,
    medium: Medium,
    /// By places.
    controllers: Vec<Controller>,
    /// By places: the identifier that each wants to send.
    wanted: Vec<u16>,
    /// The lowest of them: who has it is the next to send.
    lowest: u16,
    devices: Vec<Device>,
    /// When each device is due, and the first of these times.
    due: Vec<TrueTime>,
    first_due: TrueTime,
    host: Host,
    /// Places that are bus-off.
    off: Vec<usize>,
    /// Until when some error passive sender waits.
    suspended: TrueTime,
    stranger: Stranger,
    random: SplitMix64,
    receive_jitter: u64,
    chance: Chance,
    /// What was ordered for later, in the order of its times.
    ordered: VecDeque<(TrueTime, Disturbance)>,
    /// Frames that are still to be corrupted.
    corruptions: u32,
    /// Whether any controller has something wrong to do.
    has_marks: bool,
    observer: Option<Box<dyn Observer>>,
}

/// The device that is not ours.
#[derive(Debug, Default)]
struct Stranger {
    forged: VecDeque<Frame>,
    babbles: Option<(Babble, TrueTime)>,
}

impl SimulatedBus {
    /// A robot whose nodes were switched on some seconds ago and whose clocks nobody has set yet;
    /// time is 0.
    pub fn new(configuration: &Configuration) -> Self {
        let mut random = SplitMix64::new(configuration.seed);
        let device = |axis| {
            let plant = configuration.plant.as_ref();
            Device::new(axis, plant, configuration.crystal_ppm, &mut random)
        };
        let devices: Vec<Device> = configuration.axes.iter().map(device).collect();
        let nodes = devices.len();
        let mut controllers = vec![Controller::new(host::SEND_QUEUE)];
        controllers.resize_with(nodes + 1, || Controller::new(device::SEND_QUEUE));
        let mut absent = Controller::new(1);
        absent.power_off();
        controllers.push(absent);
        let due: Vec<TrueTime> = devices.iter().map(Device::due).collect();
        Self {
            now: TrueTime::default(),
            medium: Medium::new(configuration.bitrate),
            wanted: vec![NOTHING; controllers.len()],
            lowest: NOTHING,
            controllers,
            devices,
            first_due: due.iter().copied().min().unwrap_or(NEVER),
            due,
            host: Host::default(),
            off: Vec::new(),
            suspended: TrueTime::default(),
            stranger: Stranger::default(),
            random,
            receive_jitter: configuration.receive_jitter.into(),
            chance: Chance::new(configuration.disturbances, configuration.seed, nodes),
            ordered: VecDeque::new(),
            corruptions: 0,
            has_marks: false,
            observer: None,
        }
    }

    /// Shows everything from now on to `observer`, instead of to the one before.
    pub fn observe(&mut self, observer: impl Observer + 'static) {
        self.observer = Some(Box::new(observer));
    }

    /// The true time, which the host's clock shows in whole microseconds.
    pub fn true_now(&self) -> TrueTime {
        self.now
    }

    /// Lets time pass until `until` without the host: what it has sent goes out, what comes for it
    /// waits. An `until` that has passed does nothing.
    pub fn run(&mut self, until: BusTime) {
        let until = TrueTime::of(until);
        while self.now < until {
            self.advance(until);
        }
    }

    /// How much of the time since the start the bus was taken, the frame under way aside.
    pub fn load(&self) -> Load {
        self.medium.load(self.now)
    }

    /// What each node believes the bus time to be, in the order of the configuration; the truth
    /// is [`Bus::now`]. A node without power believes in 0.
    pub fn node_times(&self) -> impl Iterator<Item = BusTime> {
        self.devices.iter().map(|device| device.bus_time(self.now))
    }

    /// The axis of a node; none where there is no such node, or while it has no power.
    pub fn axis(&self, node: usize) -> Option<&Axis> {
        self.devices.get(node)?.axis()
    }

    /// Where the shaft of a node really was at the node's last tick.
    pub fn plant(&self, node: usize) -> Option<PlantState> {
        self.devices.get(node).map(Device::plant)
    }

    /// The flash of a node, for whoever keeps something there.
    pub fn flash_mut(&mut self, node: usize) -> Option<&mut SimulatedFlash> {
        self.devices.get_mut(node).map(Device::flash_mut)
    }

    /// The error counters of a station; zero for a node that is not there.
    pub fn error_counters(&self, station: Station) -> ErrorCounters {
        let place = station.place(self.devices.len());
        place.map_or_else(ErrorCounters::default, |place| {
            self.controllers[place].counters()
        })
    }

    fn station(&self, place: usize) -> Station {
        Station::at(place, self.devices.len())
    }

    /// The next instant at which something happens on the bus or in a node.
    fn next_event(&self) -> Option<TrueTime> {
        let medium = self.medium.due().or_else(|| self.begins());
        let ordered = self.ordered.front().map(|(time, _)| *time);
        let chance = self.chance.due();
        let mut next = self.first_due.min(chance);
        for time in [medium, ordered, self.recovers()].into_iter().flatten() {
            next = next.min(time);
        }
        (next < NEVER).then_some(next)
    }

    /// Does what comes next, or lets time pass until `until` where that is sooner.
    fn advance(&mut self, until: TrueTime) {
        match self.next_event() {
            Some(event) if event <= until => self.step(event),
            _ => self.now = self.now.max(until),
        }
    }

    /// Everything that is due at `event`: what goes wrong, a frame's end, the nodes in their order,
    /// controllers that come back, then those that wait for a free bus.
    fn step(&mut self, event: TrueTime) {
        // What the host just sent may wait for a bus that has been free for some time.
        self.now = self.now.max(event);
        self.disturb_in_time();
        self.finish();
        if self.first_due <= self.now {
            self.step_devices();
        }
        self.recover();
        self.begin();
    }

    fn step_devices(&mut self) {
        for node in 0..self.devices.len() {
            while self.due[node] <= self.now {
                self.step_device(node);
            }
        }
        self.find_first_due();
    }

    fn step_device(&mut self, node: usize) {
        let (now, place) = (self.now, node + 1);
        let device = &mut self.devices[node];
        let step = device.step(now, &mut self.controllers[place]);
        self.due[node] = device.due();
        self.look_at(place);
        if let Some(observer) = &mut self.observer {
            let device = &self.devices[node];
            match step {
                Step::Frame(sender, frame) => {
                    let receiver = Station::Node(node);
                    let delivery = Delivery {
                        receiver,
                        sender,
                        frame,
                    };
                    observer.delivery(now, &delivery);
                }
                Step::Tick(setpoint) => {
                    if let Some(axis) = device.axis() {
                        let tick = AxisTick {
                            node,
                            synchronised: device.is_synchronised(),
                            setpoint,
                            axis,
                            drive: device.drive(),
                            plant: device.plant(),
                        };
                        observer.tick(now, &tick);
                    }
                    if device.is_synchronised() {
                        observer.setpoint(now, &setpoint);
                    }
                }
                Step::Saved => {}
                Step::Started => observer.power(now, node, true),
            }
        }
        if let Some(time) = self.devices[node].power_failed() {
            self.cut_power(node, time);
        }
    }

    /// The controller at `place` may want to send something else than before.
    fn look_at(&mut self, place: usize) {
        let wanted = self.controllers[place].wanted();
        if wanted != self.wanted[place] {
            self.wanted[place] = wanted;
            self.lowest = self.wanted.iter().copied().min().unwrap_or(NOTHING);
        }
    }

    /// Something may be due at a node sooner or later than before.
    fn look_at_device(&mut self, node: usize) {
        self.due[node] = self.devices[node].due();
        self.find_first_due();
    }

    fn find_first_due(&mut self) {
        let first = self.due.iter().copied().min();
        self.first_due = first.unwrap_or(NEVER);
    }

    /// The station at `place` has room for another frame to send.
    fn refill(&mut self, place: usize, now: TrueTime) {
        match self.station(place) {
            Station::Host => {}
            Station::Node(node) => {
                self.devices[node].refill(now, &mut self.controllers[place]);
            }
            Station::Stranger => self.refill_stranger(),
        }
        self.look_at(place);
    }
}
