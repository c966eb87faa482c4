//! What goes wrong by choice, seen to do what it says.

use canter_shared::wire::frame::Frame;

use super::observed::{Observed, bus};
use super::*;
use crate::bus::BusError;

const MILLISECOND: Duration = Duration::from_millis(1);

fn pass(bus: &mut SimulatedBus, milliseconds: u64) {
    let until = BusTime(bus.now().0 + milliseconds * 1_000);
    bus.run(until);
}

/// A frame that means nothing to anybody.
fn frame(byte: u8) -> Frame {
    Frame::new(0x0C1, &[byte]).expect("a valid frame")
}

/// The last heartbeat of an axis.
fn counted(host: &Host, wanted: u8) -> (u8, u8) {
    let mut heard = host.heard.iter().rev();
    let heartbeat = heard.find_map(|(_, from, report)| match report {
        Report::Heartbeat {
            error_frames, lost, ..
        } if from.get() == wanted => Some((*error_frames, *lost)),
        _ => None,
    });
    heartbeat.expect("each axis beats")
}

#[test]
fn a_lost_frame_is_missed_by_one_receiver_and_noticed_by_nobody() {
    let (mut bus, observed) = bus(3, |_| {});
    pass(&mut bus, 101);
    let receiver = Station::Node(1);
    bus.disturb(Disturbance::Lose {
        receiver,
        frames: 2,
    });
    for byte in 1..=3 {
        bus.send(&frame(byte)).expect("room");
    }
    pass(&mut bus, 1);
    let observed = observed.borrow();
    for (node, received) in [(0, [1, 1, 1]), (1, [0, 0, 1]), (2, [1, 1, 1])] {
        for (byte, received) in (1..=3).zip(received) {
            let count = observed.received(Station::Node(node), &frame(byte));
            assert_eq!(count, received, "node {node}, frame {byte}");
        }
        let counters = bus.error_counters(Station::Node(node));
        assert_eq!(counters, ErrorCounters::default());
    }
}

#[test]
fn a_busy_node_keeps_32_frames_counts_the_rest_and_goes_on_ticking() {
    let mut host = Host::seeded(2);
    host.wait(100_000);
    let observed = Rc::new(RefCell::new(Observed::default()));
    host.bus.observe(Rc::clone(&observed));
    let start = host.bus.true_now();
    host.bus.disturb(Disturbance::Delay {
        node: 4,
        time: 10 * MILLISECOND,
    });
    // 45 frames without answer, of 55 bits and 3 of space.
    for _ in 0..45 {
        host.bus.forge(&frame(9));
    }
    host.wait(9_000);
    let busy = Station::Node(4);
    {
        let observed = observed.borrow();
        assert_eq!(observed.received(busy, &frame(9)), 0);
        assert_eq!(observed.received(Station::Node(3), &frame(9)), 45);
        let ticks = observed.ticks.iter().filter(|tick| tick.node == 4);
        assert_eq!(ticks.count(), 9);
    }
    host.wait(200_000);
    let observed = observed.borrow();
    let mut deliveries = observed.deliveries.iter();
    let first = deliveries.find(|(_, delivery)| delivery.receiver == busy);
    assert_eq!(first.expect("some").0.0, start.0 + 10_000_000);
    let at_once = |(time, delivery): &&(TrueTime, Delivery)| {
        delivery.receiver == busy && time.0 == start.0 + 10_000_000
    };
    assert_eq!(observed.deliveries.iter().filter(at_once).count(), 32);
    let (_, lost) = counted(&host, 5);
    assert!((13..25).contains(&lost), "{lost}");
    assert_eq!(counted(&host, 4), (0, 0));
}

#[test]
fn a_babbler_of_the_lowest_identifier_holds_off_everybody_for_its_time() {
    let (mut bus, observed) = bus(3, |_| {});
    pass(&mut bus, 100);
    let babble = Frame::new(0x001, &[1, 2]).expect("a valid frame");
    bus.disturb(Disturbance::Babble {
        what: Babble::Frame(babble),
        time: 100 * MILLISECOND,
    });
    let start = bus.true_now();
    let mut sent = 0;
    let refused = loop {
        match bus.send(&frame(1)) {
            Ok(()) => sent += 1,
            Err(error) => break error,
        }
    };
    // The queue of the interface, and 50 ms of waiting.
    assert_eq!(sent, host::SEND_QUEUE);
    assert!(
        matches!(refused, BusError::SendQueueFull { .. }),
        "{refused}"
    );
    assert!((50_000..51_000).contains(&((bus.true_now().0 - start.0) / 1_000)));
    let before = bus.load();
    pass(&mut bus, 40);
    assert!(bus.load().since(before).share() > 0.99);
    pass(&mut bus, 60);
    let observed = observed.borrow();
    let end = start.0 + 100_000_000;
    for sent in observed.frames.iter().filter(|sent| sent.start > start) {
        // One may have waited when the time was over.
        if sent.sender == Station::Stranger {
            assert!(sent.start.0 <= end + 100_000, "{sent:?}");
        } else {
            assert!(sent.start.0 > end, "{sent:?}");
        }
    }
    assert_eq!(observed.received(Station::Node(2), &frame(1)), sent);
}

#[test]
fn a_babbler_of_anything_forges_commands_and_reports() {
    let (mut bus, observed) = bus(3, |_| {});
    bus.disturb(Disturbance::Babble {
        what: Babble::Anything,
        time: 1_000 * MILLISECOND,
    });
    pass(&mut bus, 1_000);
    let observed = observed.borrow();
    let forged = observed.frames.iter();
    let forged = forged.filter(|sent| sent.sender == Station::Stranger);
    let mut identifiers = std::collections::BTreeSet::new();
    let mut lengths = std::collections::BTreeSet::new();
    for sent in forged {
        identifiers.insert(sent.frame.id());
        lengths.insert(sent.frame.data().len());
    }
    assert!(identifiers.len() > 1_900, "{}", identifiers.len());
    assert_eq!(
        lengths.into_iter().collect::<Vec<_>>(),
        (0..=8).collect::<Vec<_>>()
    );
}

#[test]
fn forged_frames_are_sent_in_order_by_a_stranger() {
    let (mut bus, observed) = bus(2, |_| {});
    pass(&mut bus, 100);
    for byte in 0..5 {
        bus.forge(&frame(byte));
    }
    pass(&mut bus, 1);
    let observed = observed.borrow();
    let sent = observed.frames.iter();
    let sent = sent.filter(|sent| sent.sender == Station::Stranger);
    let sent: Vec<Frame> = sent.map(|sent| sent.frame).collect();
    assert_eq!(sent, (0..5).map(frame).collect::<Vec<_>>());
    let delivery = observed
        .deliveries
        .iter()
        .find(|(_, one)| one.frame == frame(0));
    assert_eq!(delivery.expect("received").1.sender, Station::Stranger);
}

#[test]
fn a_host_that_stands_still_is_given_up_and_finds_all_that_came() {
    let mut host = Host::seeded(5);
    host.move_all();
    let start = host.bus.now();
    let at = BusTime(start.0 + 10_000);
    host.bus.disturb_at(
        at,
        Disturbance::StallHost {
            time: 400 * MILLISECOND,
        },
    );
    // It would have come back at once.
    let until = BusTime(start.0 + 20_000);
    while host.bus.now() < BusTime(at.0 + 400_000) {
        let received = host
            .bus
            .receive(until)
            .expect("up")
            .expect("somebody spoke");
        assert!(received.time <= host.bus.now());
    }
    // What came meanwhile has the times at which it came: heartbeats with the fault among them.
    assert_eq!(host.bus.now(), BusTime(at.0 + 400_000));
    let mut times = Vec::new();
    while let Some(received) = host.bus.receive(BusTime(0)).expect("up") {
        times.push(received.time.0 - at.0);
    }
    assert!(times.iter().any(|time| *time < 60_000) && times.is_sorted());
    let faults = (0..12).map(|node| host.bus.axis(node).and_then(|axis| axis.fault()));
    assert!(
        faults
            .clone()
            .all(|fault| fault.is_some_and(|fault| fault.name() == "host_timeout"))
    );
}

#[test]
fn a_host_that_does_not_read_is_told_how_many_frames_it_lost() {
    let (mut bus, observed) = bus(1, |_| {});
    bus.disturb(Disturbance::Babble {
        what: Babble::Frame(frame(1)),
        time: 500 * MILLISECOND,
    });
    pass(&mut bus, 500);
    // More than 500 ms / 62 us; 4 MiB hold 5461.
    let sent = observed.borrow().frames.len();
    assert!(sent > 7_000, "{sent}");
    let mut read = 0;
    while let Some(received) = bus.receive(BusTime(0)).expect("up") {
        assert!(matches!(received.event, Event::Frame(_)));
        read += 1;
    }
    assert_eq!(read, 5_461);
    pass(&mut bus, 100);
    let received = bus
        .receive(BusTime(0))
        .expect("up")
        .expect("the node speaks");
    let lost = ErrorEvent::LostReception(Some((sent - read) as u32));
    assert_eq!(received.event, Event::Error(lost));
    let next = bus.receive(BusTime(0)).expect("up").expect("its frame");
    assert!(matches!(next.event, Event::Frame(_)));
}

#[test]
fn a_host_that_is_killed_gets_nothing_done_until_another_takes_over() {
    let mut host = Host::seeded(5);
    host.move_all();
    let at = BusTime(host.bus.now().0 + 3_000);
    host.bus.disturb_at(at, Disturbance::KillHost);
    let error = loop {
        match host.bus.receive(BusTime(at.0 + 50_000)) {
            Ok(received) => assert!(received.is_some()),
            Err(error) => break error,
        }
    };
    assert!(matches!(error, BusError::Closed { .. }), "{error}");
    assert_eq!(host.bus.now(), at);
    assert!(host.bus.send(&frame(1)).is_err());
    pass(&mut host.bus, 400);
    let faults = (0..12).filter_map(|node| host.bus.axis(node)?.fault());
    assert_eq!(
        faults
            .filter(|fault| fault.name() == "host_timeout")
            .count(),
        12
    );
    host.bus.revive_host();
    host.heard.clear();
    host.say(Address::All, Command::IdentityRequest);
    host.wait(50_000);
    let parts = host.heard.iter();
    let parts = parts.filter(|(_, _, report)| matches!(report, Report::Identity(_)));
    assert_eq!(parts.count(), 36);
}

#[test]
fn lost_sync_never_gets_to_the_wire_and_other_frames_do() {
    let mut host = Host::seeded(6);
    host.wait(100_000);
    let start = host.bus.true_now();
    host.bus.disturb(Disturbance::LoseSync {
        time: 200 * MILLISECOND,
    });
    host.wait(400_000);
    let record = host.record.borrow();
    let sent = |id: u16, from: u64, to: u64| {
        let times = start.0 + from * 1_000_000..start.0 + to * 1_000_000;
        let frames = record.frames.iter();
        let frames = frames.filter(|sent| sent.frame.id() == id && times.contains(&sent.start.0));
        frames.count()
    };
    assert_eq!(sent(0x040, 0, 200), 0);
    assert_eq!(sent(0x140, 0, 200), 10);
    assert_eq!(sent(0x040, 200, 400), 10);
}

#[test]
fn troubles_of_a_drive_are_faults_of_its_axis() {
    for (trouble, fault) in [
        (DriveTrouble::Fault, "drive_fault"),
        (DriveTrouble::Disable, "drive_fault"),
        (DriveTrouble::Silence, "drive_lost"),
    ] {
        let mut host = Host::seeded(7);
        host.move_all();
        host.bus.disturb(Disturbance::Drive {
            node: 3,
            trouble,
            time: 100 * MILLISECOND,
        });
        host.wait(50_000);
        for node in 0..12 {
            let latched = host.bus.axis(node).expect("power").fault();
            let wanted = (node == 3).then_some(fault);
            assert_eq!(
                latched.map(|fault| fault.name()),
                wanted,
                "{trouble:?}, node {node}"
            );
        }
    }
}

#[test]
fn what_is_ordered_happens_in_the_order_of_its_times_also_while_the_host_waits() {
    let (mut bus, observed) = bus(1, |_| {});
    let corrupt = |frames| Disturbance::Corrupt { frames };
    bus.disturb_at(BusTime(2_000), corrupt(2));
    bus.disturb_at(BusTime(1_000), corrupt(1));
    bus.disturb_at(BusTime(2_000), corrupt(3));
    bus.disturb_at(BusTime(9_000), corrupt(4));
    while bus.receive(BusTime(5_000)).expect("up").is_some() {}
    let observed = observed.borrow();
    let times: Vec<_> = observed
        .disturbances
        .iter()
        .map(|(time, what)| (time.0, *what))
        .collect();
    assert_eq!(
        times,
        [
            (1_000_000, corrupt(1)),
            (2_000_000, corrupt(2)),
            (2_000_000, corrupt(3))
        ]
    );
}

#[test]
fn what_names_a_node_that_is_not_there_does_nothing() {
    let (mut bus, observed) = bus(1, |_| {});
    let (node, time) = (1, MILLISECOND);
    for disturbance in [
        Disturbance::Delay { node, time },
        Disturbance::CutPower { node, time },
        Disturbance::CutPowerWhileSaving {
            node,
            after: 0,
            time,
        },
        Disturbance::Lose {
            receiver: Station::Node(node),
            frames: 1,
        },
    ] {
        bus.disturb(disturbance);
    }
    pass(&mut bus, 100);
    let observed = observed.borrow();
    assert!(observed.power.is_empty() && observed.destroyed.is_empty());
    assert!(!observed.frames.is_empty());
}
