//! The simulated robot, seen by a host that does what it must.

mod chance;
mod disturbed;
mod errors;
mod observed;
mod plant;
mod power;
mod robot;
mod saving;
mod wire;

use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

use canter_shared::time::{Tick, Ticks};
use canter_shared::units::Position;
use canter_shared::wire::command::{Action, Command, ProfileKind, Session, wire_position};
use canter_shared::wire::id::{Address, AxisId};
use canter_shared::wire::report::Report;

use super::*;
use crate::bus::{Bus, ErrorEvent, Event, Received};

const SESSION: Session = 0xCA27;

/// A host that does what it must: SYNC at 50 Hz, and a heartbeat with each.
struct Host {
    bus: SimulatedBus,
    record: Rc<RefCell<Record>>,
    counter: u8,
    next_sync: BusTime,
    heard: Vec<(BusTime, AxisId, Report)>,
    complaints: Vec<(BusTime, ErrorEvent)>,
}

impl Host {
    fn new(configuration: &Configuration) -> Self {
        let mut bus = SimulatedBus::new(configuration);
        let record = Rc::new(RefCell::new(Record::default()));
        bus.observe(record.clone());
        Self {
            bus,
            record,
            counter: 0,
            next_sync: BusTime(0),
            heard: Vec::new(),
            complaints: Vec::new(),
        }
    }

    fn seeded(seed: u64) -> Self {
        Self::new(&Configuration {
            seed,
            ..Configuration::default()
        })
    }

    fn say(&mut self, address: Address, command: Command) {
        let frame = command.encode(address).expect("values in range");
        self.bus.send(&frame).expect("the simulated bus takes it");
    }

    fn wait(&mut self, microseconds: u64) {
        let end = BusTime(self.bus.now().0 + microseconds);
        while self.bus.now() < end {
            if self.bus.now() >= self.next_sync {
                self.next_sync = BusTime(self.bus.now().0 + 20_000);
                let (counter, time) = (self.counter, self.bus.now());
                self.counter = counter.wrapping_add(1);
                self.say(Address::All, Command::Sync { counter, time });
                self.say(Address::All, Command::HostHeartbeat { session: SESSION });
            }
            let until = end.min(self.next_sync);
            let received = self.bus.receive(until).expect("the simulated bus is up");
            let Some(Received { time, event }) = received else {
                continue;
            };
            match event {
                Event::Frame(frame) => {
                    if let Ok(Some((axis, report))) = Report::decode(&frame) {
                        self.heard.push((time, axis, report));
                    }
                }
                Event::Error(error) => self.complaints.push((time, error)),
            }
        }
    }

    fn control(&mut self, action: Action, sequence: u8) {
        for axis in (1..=12).filter_map(AxisId::new) {
            let command = Command::Control {
                action,
                sequence,
                session: SESSION,
            };
            self.say(axis.into(), command);
        }
        self.wait(20_000);
    }

    /// Enables all twelve, moves them together and waits until they are there.
    fn move_all(&mut self) {
        self.wait(500_000);
        self.control(Action::Hold, 1);
        self.control(Action::Enable, 2);
        for axis in (1..=12).filter_map(AxisId::new) {
            let command = Command::Move {
                profile: ProfileKind::Beta,
                staged: true,
                target: target(axis),
                duration: Ticks(400),
                sequence: 3,
            };
            self.say(axis.into(), command);
        }
        self.wait(20_000);
        let start = Tick(self.bus.now().0 / 1_000 + 20);
        let trigger = Command::Trigger {
            group: 3,
            session: SESSION,
            start,
        };
        self.say(Address::All, trigger);
        self.wait(500_000);
    }

    fn log(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for sent in &self.record.borrow().frames {
            crate::log::candump::write(&mut bytes, sent.end.bus_time(), &sent.frame)
                .expect("a vector takes everything");
        }
        bytes
    }
}

fn target(axis: AxisId) -> Position {
    let radians = f64::from(axis.get()) * 0.1;
    wire_position(Position::from_radians(radians).expect("in range"))
}
