use canter_shared::axis::fault::Fault;
use canter_shared::wire::id::Function;
use canter_shared::wire::report::IdentityPart;

use super::*;

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
        assert_eq!(sent.busy(), sent.end.0 - sent.start.0 + 3_000);
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
        axes: vec![RobotAxis::new(axis); 2],
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
    for _ in 0..host::SEND_QUEUE {
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
