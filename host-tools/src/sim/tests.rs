use std::cell::RefCell;
use std::rc::Rc;

use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::limits::Limits;
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::Position;
use canter_shared::wire::command::{Action, Command, ProfileKind, Session, wire_position};
use canter_shared::wire::id::{Address, AxisId, Function};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::{IdentityPart, Report};

use super::*;

const SESSION: Session = 0xCA27;

/// A host that does what it must: SYNC at 50 Hz, and a heartbeat with each.
struct Host {
    bus: SimulatedBus,
    record: Rc<RefCell<Record>>,
    counter: u8,
    next_sync: BusTime,
    heard: Vec<(BusTime, AxisId, Report)>,
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
            if let Some(Received {
                time,
                event: Event::Frame(frame),
            }) = received
            {
                let (axis, report) = Report::decode(&frame)
                    .expect("nodes speak the protocol")
                    .expect("only nodes are heard");
                self.heard.push((time, axis, report));
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

#[test]
fn one_seed_gives_the_same_bytes_and_another_does_not() {
    let run = |seed| {
        let mut host = Host::seeded(seed);
        host.move_all();
        let setpoints = host.record.borrow().setpoints.clone();
        (host.log(), setpoints)
    };
    let (log, setpoints) = run(1);
    assert_eq!(run(1), (log.clone(), setpoints.clone()));
    let (other_log, other_setpoints) = run(2);
    assert_ne!(log, other_log);
    assert_ne!(setpoints, other_setpoints);
}

#[test]
fn twelve_axes_are_held_enabled_moved_and_arrive() {
    let mut host = Host::seeded(1);
    host.move_all();
    let answers = |wanted: Function| {
        let answer = |(_, _, report): &&(BusTime, AxisId, Report)| {
            matches!(report, Report::Acknowledgement { function, reason, .. }
                if *function == wanted && *reason == Reason::Accepted)
        };
        host.heard.iter().filter(answer).count()
    };
    assert_eq!(answers(Function::Control), 24);
    assert_eq!(answers(Function::StageBeta), 12);
    assert_eq!(answers(Function::Trigger), 12);
    let mut started = Vec::new();
    for axis in (1..=12).filter_map(AxisId::new) {
        let last = host
            .heard
            .iter()
            .rev()
            .find_map(|(_, from, report)| match report {
                Report::Feedback {
                    position, moving, ..
                } if *from == axis => Some((*position, *moving)),
                _ => None,
            });
        assert_eq!(last, Some((target(axis), false)), "axis {axis}");
        started.extend(
            host.heard
                .iter()
                .filter_map(|(_, from, report)| match report {
                    Report::Started { time, .. } if *from == axis => Some(time.0),
                    _ => None,
                }),
        );
    }
    assert_eq!(started.len(), 12);
}

/// What a move really is: when, in true time, each axis left.
#[test]
fn the_axes_leave_together_in_true_time() {
    let mut host = Host::seeded(1);
    host.wait(3_000_000);
    host.move_all();
    let record = host.record.borrow();
    let mut left = Vec::new();
    for axis in (1..=12).filter_map(AxisId::new) {
        let leaves = record.setpoints.iter().find(|(_, setpoint)| {
            setpoint.axis == axis && setpoint.setpoint.velocity.counts() != 0
        });
        left.push(leaves.expect("every axis moves").0.0);
    }
    let skew = left.iter().max().expect("12 axes") - left.iter().min().expect("12 axes");
    assert!(skew < 20_000, "skew {skew} ns");
}

#[test]
fn each_axis_has_one_setpoint_for_each_tick() {
    let mut host = Host::seeded(4);
    host.move_all();
    let record = host.record.borrow();
    for axis in (1..=12).filter_map(AxisId::new) {
        let ticks: Vec<Tick> = record
            .setpoints
            .iter()
            .filter(|(_, setpoint)| setpoint.axis == axis)
            .map(|(_, setpoint)| setpoint.tick)
            .collect();
        assert!(ticks.len() > 1_000);
        assert!(ticks.windows(2).all(|pair| pair[1].0 == pair[0].0 + 1));
    }
    let last = record.setpoints.last().map(|(_, setpoint)| setpoint.state);
    assert_eq!(last, Some(State::OperationEnabled));
}

#[test]
fn sync_brings_the_clocks_together() {
    for seed in 0..8 {
        let mut host = Host::seeded(seed);
        host.wait(4_000_000);
        let mut worst = (0, 0);
        for _ in 0..300 {
            host.wait(10_007);
            let now = host.bus.now().0 as i64;
            let late: Vec<i64> = host
                .bus
                .node_times()
                .map(|time| now - time.0 as i64)
                .collect();
            let most = *late.iter().max().expect("12 nodes");
            let least = *late.iter().min().expect("12 nodes");
            worst = (worst.0.max(most - least), worst.1.max(most.abs()));
        }
        // Against each other; all are late by the frame that carries SYNC, 111 to 135 bits.
        assert!(worst.0 <= 20, "seed {seed}: apart by {} us", worst.0);
        assert!(worst.1 <= 155, "seed {seed}: late by {} us", worst.1);
    }
}

#[test]
fn frames_keep_their_distance_and_the_load_is_their_sum() {
    let mut host = Host::seeded(1);
    host.move_all();
    let before = host.bus.load();
    let record = host.record.borrow();
    let mut busy = 0;
    for pair in record.frames.windows(2) {
        assert!(pair[1].start.0 >= pair[0].end.0 + 3_000);
    }
    for sent in &record.frames {
        assert_eq!(sent.end.0 - sent.start.0, u64::from(sent.bits) * 1_000);
        busy += sent.end.0 - sent.start.0 + 3_000;
    }
    assert_eq!(before.busy, busy);
    assert!((0.05..0.5).contains(&before.share()), "{}", before.share());
}

#[test]
fn the_lowest_identifier_goes_first_once_the_bus_is_free() {
    let mut bus = SimulatedBus::new(&Configuration {
        axes: Configuration::default().axes[..2].to_vec(),
        ..Configuration::default()
    });
    let record = Rc::new(RefCell::new(Record::default()));
    bus.observe(record.clone());
    bus.receive(BusTime(50)).expect("up");
    // Both nodes' first feedback or heartbeat and the host's frame wait or come meanwhile.
    let frame = Command::IdentityRequest
        .encode(Address::All)
        .expect("no values");
    bus.send(&frame).expect("room");
    while bus.now() < BusTime(200_000) {
        bus.receive(BusTime(200_000)).expect("up");
    }
    let frames = &record.borrow().frames;
    let identities = frames
        .iter()
        .filter(|sent| sent.frame.id() >> 6 == u16::from(u8::from(Function::Identity)));
    assert_eq!(identities.count(), 6);
    // Of the two nodes' answers, which wait together, axis 1 is heard before axis 2 each time.
    let first = frames
        .iter()
        .position(|sent| sent.frame.id() == 29 << 6 | 1)
        .expect("axis 1 answers");
    assert_eq!(frames[first + 1].frame.id(), 29 << 6 | 1);
    assert_eq!(frames[first + 2].frame.id(), 29 << 6 | 1);
    assert_eq!(frames[first + 3].frame.id(), 29 << 6 | 2);
}

#[test]
fn two_nodes_of_one_id_are_both_heard_and_latch_it() {
    let axis = AxisId::new(5).expect("in range");
    let mut host = Host::new(&Configuration {
        axes: vec![
            RobotAxis {
                id: axis,
                limits: Limits::default(),
                shaping: None,
            };
            2
        ],
        ..Configuration::default()
    });
    host.say(axis.into(), Command::IdentityRequest);
    host.wait(50_000);
    let mut chips: Vec<_> = host
        .heard
        .iter()
        .filter_map(|(_, _, report)| match report {
            Report::Identity(IdentityPart::ChipFirst(half)) => Some(*half),
            _ => None,
        })
        .collect();
    chips.sort();
    chips.dedup();
    assert_eq!(chips.len(), 2);
    // Each hears the other, and both go on saying so: ten heartbeats a second from each.
    host.heard.clear();
    host.wait(1_000_000);
    let faults: Vec<_> = host
        .heard
        .iter()
        .filter_map(|(_, _, report)| match report {
            Report::Heartbeat { fault, .. } => Some(*fault),
            _ => None,
        })
        .collect();
    assert!(faults.len() >= 18, "{}", faults.len());
    let double = u8::from(Fault::DuplicateAxis);
    assert!(faults.iter().all(|fault| *fault == double), "{faults:?}");
}

#[test]
fn time_goes_to_where_the_caller_waits_and_never_back() {
    let mut bus = SimulatedBus::new(&Configuration {
        axes: Vec::new(),
        ..Configuration::default()
    });
    assert_eq!(bus.receive(BusTime(1_234)).expect("up"), None);
    assert_eq!(bus.now(), BusTime(1_234));
    assert_eq!(bus.receive(BusTime(7)).expect("up"), None);
    assert_eq!(bus.now(), BusTime(1_234));
    assert_eq!(bus.receive(BusTime(u64::MAX)).expect("up"), None);
}

#[test]
fn a_full_queue_is_waited_for() {
    let mut bus = SimulatedBus::new(&Configuration::default());
    let frame = Command::IdentityRequest
        .encode(Address::All)
        .expect("no values");
    for _ in 0..HOST_QUEUE {
        bus.send(&frame).expect("room");
    }
    assert_eq!(bus.now(), BusTime(0));
    // Long enough for the nodes to answer while nobody reads.
    for _ in 0..50 {
        bus.send(&frame).expect("waits");
    }
    let sent = bus.now();
    assert!(sent > BusTime(50 * 40), "{sent:?}");
    // What came meanwhile is there, in order, at the time at which it came.
    let mut last = BusTime(0);
    let mut count = 0;
    while let Some(received) = bus.receive(BusTime(0)).expect("up") {
        assert!((last..=sent).contains(&received.time));
        last = received.time;
        count += 1;
    }
    assert!(count > 10, "{count} frames");
    assert_eq!(bus.now(), sent);
}
