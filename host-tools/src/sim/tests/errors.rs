//! Errors on the wire, by the standard's rules and numbers. A bit is 1 us here.

use canter_shared::wire::frame::Frame;

use super::observed::{Observed, bus};
use super::*;

/// A time at which nobody has anything to say: nodes tick at whole milliseconds of their own, and
/// speak when it is their turn.
fn quiet(bus: &mut SimulatedBus, observed: &Rc<RefCell<Observed>>) {
    loop {
        let before = observed.borrow().frames.len();
        let until = BusTime(bus.now().0 + 3_000);
        bus.run(until);
        if observed.borrow().frames.len() == before {
            return;
        }
    }
}

fn counters(bus: &SimulatedBus, station: Station) -> (u16, u16) {
    let counters = bus.error_counters(station);
    (counters.transmit(), counters.receive())
}

/// A frame that no node answers, of the lowest identifier in use.
fn frame(byte: u8) -> Frame {
    Frame::new(0x040, &[byte]).expect("a valid frame")
}

/// Goes on until something is so, bit by bit, for a second at most.
fn go_on(bus: &mut SimulatedBus, is: impl Fn() -> bool) {
    for _ in 0..1_000_000 {
        if is() {
            return;
        }
        let until = BusTime(bus.now().0 + 1);
        bus.run(until);
    }
    panic!("it never came to that");
}

/// Goes on until the frame is through, and the receivers have it.
fn until_sent(bus: &mut SimulatedBus, observed: &Rc<RefCell<Observed>>, frame: &Frame) {
    let is = |sent: &Transmission| sent.frame == *frame;
    go_on(bus, || observed.borrow().frames.iter().any(is));
    let until = BusTime(bus.now().0 + 25);
    bus.run(until);
}

#[test]
fn a_corrupted_frame_is_destroyed_counted_and_sent_again() {
    let (mut bus, observed) = bus(3, |_| {});
    quiet(&mut bus, &observed);
    bus.disturb(Disturbance::Corrupt { frames: 1 });
    bus.send(&frame(1)).expect("room");
    let start = bus.true_now();
    go_on(&mut bus, || !observed.borrow().destroyed.is_empty());
    assert_eq!(counters(&bus, Station::Host), (8, 0));
    for node in 0..3 {
        assert_eq!(counters(&bus, Station::Node(node)), (0, 1));
    }
    until_sent(&mut bus, &observed, &frame(1));
    assert_eq!(counters(&bus, Station::Host), (7, 0));
    for node in 0..3 {
        assert_eq!(counters(&bus, Station::Node(node)), (0, 0));
        assert_eq!(
            observed.borrow().received(Station::Node(node), &frame(1)),
            1
        );
    }
    let observed = observed.borrow();
    let (destroyed, sent) = (observed.destroyed[0], observed.frames.last().expect("one"));
    assert_eq!(destroyed.cause, Destruction::Disturbed);
    assert_eq!(
        (destroyed.sender, destroyed.frame),
        (Station::Host, frame(1))
    );
    assert_eq!(destroyed.start, start);
    // 6 + 6 bits of flags and 8 of delimiter after the error; then 3 of space.
    let bits = (destroyed.end.0 - destroyed.start.0) / 1_000;
    assert!((21..u64::from(sent.bits) + 20).contains(&bits), "{bits}");
    assert_eq!(sent.start.0, destroyed.end.0 + 3_000);
}

#[test]
fn nodes_tell_how_many_error_frames_they_saw() {
    let mut host = Host::seeded(3);
    host.wait(200_000);
    host.bus.disturb(Disturbance::Corrupt { frames: 5 });
    host.wait(200_000);
    for axis in (1..=12).filter_map(AxisId::new) {
        let mut heard = host.heard.iter().rev();
        let seen = heard.find_map(|(_, from, report)| match report {
            Report::Heartbeat { error_frames, .. } if *from == axis => Some(*error_frames),
            _ => None,
        });
        assert_eq!(seen, Some(5), "axis {axis}");
    }
}

#[test]
fn a_receiver_that_misreads_destroys_the_frame_for_all_while_it_is_error_active() {
    let (mut bus, observed) = bus(3, |_| {});
    quiet(&mut bus, &observed);
    let receiver = Station::Node(1);
    // 14 times 9 is 126, 15 times 9 is 135: from then on it is error passive.
    bus.disturb(Disturbance::Misread {
        receiver,
        frames: 16,
    });
    bus.send(&frame(1)).expect("room");
    until_sent(&mut bus, &observed, &frame(1));
    {
        let observed = observed.borrow();
        assert_eq!(observed.destroyed.len(), 15);
        let cause = Destruction::Misread(receiver);
        assert!(observed.destroyed.iter().all(|one| one.cause == cause));
        // The sixteenth is only missed by it; the others have the frame.
        assert_eq!(observed.received(receiver, &frame(1)), 0);
        assert_eq!(observed.received(Station::Node(0), &frame(1)), 1);
        assert_eq!(
            observed
                .states
                .iter()
                .map(|state| (state.1, state.2))
                .collect::<Vec<_>>(),
            [(receiver, ErrorState::ErrorPassive)]
        );
    }
    assert_eq!(counters(&bus, receiver), (0, 136));
    assert_eq!(counters(&bus, Station::Node(0)), (0, 14));
    assert_eq!(counters(&bus, Station::Host), (119, 0));
    // One good frame, and it is error active again.
    bus.send(&frame(2)).expect("room");
    until_sent(&mut bus, &observed, &frame(2));
    assert_eq!(counters(&bus, receiver), (0, 127));
    assert_eq!(observed.borrow().received(receiver, &frame(2)), 1);
    let last = observed
        .borrow()
        .states
        .last()
        .map(|state| (state.1, state.2));
    assert_eq!(last, Some((receiver, ErrorState::ErrorActive)));
}

#[test]
fn an_error_in_the_last_bit_but_one_doubles_the_frame_for_the_others() {
    let (mut bus, observed) = bus(3, |_| {});
    quiet(&mut bus, &observed);
    let receiver = Station::Node(1);
    bus.disturb(Disturbance::Double { receiver });
    bus.send(&frame(1)).expect("room");
    until_sent(&mut bus, &observed, &frame(1));
    let observed = observed.borrow();
    assert_eq!(observed.received(receiver, &frame(1)), 1);
    assert_eq!(observed.received(Station::Node(0), &frame(1)), 2);
    assert_eq!(observed.received(Station::Node(2), &frame(1)), 2);
    assert_eq!(observed.destroyed.len(), 1);
    assert_eq!(counters(&bus, Station::Host), (7, 0));
    // 1 and 8, and 1 back for the second time; the others saw no error.
    assert_eq!(counters(&bus, receiver), (0, 8));
    assert_eq!(counters(&bus, Station::Node(0)), (0, 0));
}

/// If the sender dies in between, a receiver never gets what the others have.
#[test]
fn a_doubled_frame_whose_sender_dies_is_missed_by_one() {
    let (mut bus, observed) = bus(3, |_| {});
    while bus.receive(BusTime(50_000)).expect("up").is_some() {}
    bus.disturb(Disturbance::Double {
        receiver: Station::Host,
    });
    go_on(&mut bus, || !observed.borrow().destroyed.is_empty());
    let destroyed = observed.borrow().destroyed[0];
    let Station::Node(node) = destroyed.sender else {
        panic!("only nodes have spoken");
    };
    bus.disturb(Disturbance::CutPower {
        node,
        time: Duration::from_millis(100),
    });
    let until = BusTime(bus.now().0 + 10_000);
    while bus.receive(until).expect("up").is_some() {}
    // It has said the same before, and would say it again 20 ms later.
    let observed = observed.borrow();
    let received = |receiver: Station| {
        let deliveries = observed.deliveries.iter();
        let since = deliveries.filter(|(time, _)| *time > destroyed.start);
        let by = |one: &Delivery| one.receiver == receiver && one.frame == destroyed.frame;
        since.filter(|(_, one)| by(one)).count()
    };
    assert_eq!(received(Station::Node((node + 1) % 3)), 1);
    assert_eq!(received(Station::Host), 0);
}

#[test]
fn a_sender_that_fails_32_times_is_off_the_bus_and_comes_back_by_the_rule() {
    let (mut bus, observed) = bus(1, |_| {});
    // Only the node speaks: its heartbeat is the next frame.
    quiet(&mut bus, &observed);
    bus.disturb(Disturbance::Corrupt { frames: 32 });
    let node = Station::Node(0);
    let until = BusTime(bus.now().0 + 200_000);
    bus.run(until);
    let observed = observed.borrow();
    assert_eq!(observed.destroyed.len(), 32);
    assert!(observed.destroyed.iter().all(|one| one.sender == node));
    // Each failure counts 8: passive at 128, off at 256.
    let at = |count: usize| observed.destroyed[count - 1].end;
    let states: Vec<_> = observed
        .states
        .iter()
        .filter(|state| state.1 == node)
        .collect();
    assert_eq!(*states[0], (at(16), node, ErrorState::ErrorPassive));
    assert_eq!(*states[1], (at(32), node, ErrorState::BusOff));
    // Nobody else speaks: 128 times 11 recessive bits, of which 8 were the error delimiter.
    let back = TrueTime(at(32).0 + (128 * 11 - 8) * 1_000);
    assert_eq!(*states[2], (back, node, ErrorState::ErrorActive));
    let next = observed.frames.iter().find(|sent| sent.start > at(32));
    let next = next.expect("what waited is sent");
    assert!(next.start >= back);
    assert_eq!(next.frame, observed.destroyed[0].frame);
    assert_eq!(counters(&bus, node), (0, 0));
    // The host saw all of it too: 32 errors, and some good frames since.
    let (_, receive) = counters(&bus, Station::Host);
    assert!(receive < 32, "{receive}");
}

#[test]
fn on_a_busy_bus_each_frame_counts_once_for_the_way_back() {
    let (mut bus, observed) = bus(1, |_| {});
    quiet(&mut bus, &observed);
    bus.disturb(Disturbance::Corrupt { frames: 32 });
    let until = |bus: &mut SimulatedBus, wanted: ErrorState| {
        let is = || observed.borrow().states.last().map(|state| state.2) == Some(wanted);
        go_on(bus, is);
    };
    until(&mut bus, ErrorState::BusOff);
    bus.disturb(Disturbance::Babble {
        what: Babble::Frame(frame(7)),
        time: Duration::from_secs(1),
    });
    until(&mut bus, ErrorState::ErrorActive);
    let observed = observed.borrow();
    let off = observed.destroyed[31].end;
    let frames = observed.frames.iter().filter(|sent| sent.start > off);
    // The recessive bits before the first of them count for one or two.
    let frames = frames.count();
    assert!((125..=128).contains(&frames), "{frames}");
}

#[test]
fn a_host_that_is_off_the_bus_is_told_and_restarted() {
    let mut host = Host::new(&Configuration {
        axes: Configuration::default().axes[..2].to_vec(),
        ..Configuration::default()
    });
    host.wait(100_500);
    // Its SYNC is the next frame: nobody else speaks for half a millisecond.
    let sync = host.next_sync;
    host.bus
        .disturb_at(sync, Disturbance::Corrupt { frames: 32 });
    host.wait(300_000);
    let told: Vec<&ErrorEvent> = host.complaints.iter().map(|(_, error)| error).collect();
    assert_eq!(
        told,
        [
            &ErrorEvent::ErrorPassive,
            &ErrorEvent::BusOff,
            &ErrorEvent::Restarted
        ]
    );
    // 100 ms of rest, then 128 times 11 recessive bits at least.
    let away = host.complaints[2].0.0 - host.complaints[1].0.0;
    assert!((101_400..110_000).contains(&away), "{away} us");
    let record = host.record.borrow();
    let mut sent = record.frames.iter().rev();
    let last = sent.find(|sent| sent.sender == Station::Host);
    assert!(last.expect("some").start.0 > host.complaints[2].0.0 * 1_000);
}

#[test]
fn a_sender_that_nobody_hears_tries_for_ever_and_stays_error_passive() {
    let (mut bus, observed) = bus(1, |_| {});
    quiet(&mut bus, &observed);
    bus.disturb(Disturbance::CutPower {
        node: 0,
        time: Duration::from_millis(100),
    });
    bus.send(&frame(1)).expect("room");
    let until = BusTime(bus.now().0 + 99_000);
    bus.run(until);
    assert_eq!(counters(&bus, Station::Host), (128, 0));
    let tries = observed.borrow().destroyed.len();
    // 18 + 8 + 15 bits and the acknowledge slot, 6 + 8 of error frame, 3 + 8 of space: about 70.
    assert!((1_200..1_500).contains(&tries), "{tries}");
    until_sent(&mut bus, &observed, &frame(1));
    assert_eq!(observed.borrow().received(Station::Node(0), &frame(1)), 1);
    assert_eq!(counters(&bus, Station::Host), (127, 0));
}

#[test]
fn an_error_passive_sender_lets_others_go_first() {
    for failures in [0, 20] {
        let (mut bus, observed) = bus(1, |_| {});
        quiet(&mut bus, &observed);
        bus.disturb(Disturbance::Corrupt { frames: failures });
        let stranger = Frame::new(0x7FF, &[]).expect("a valid frame");
        for byte in 1..=2 {
            bus.send(&frame(byte)).expect("room");
        }
        bus.forge(&stranger);
        until_sent(&mut bus, &observed, &stranger);
        until_sent(&mut bus, &observed, &frame(2));
        let observed = observed.borrow();
        let order = observed.frames.iter().map(|sent| sent.frame);
        let order: Vec<Frame> = order
            .filter(|sent| sent.id() != 0x501 && sent.id() != 0x601)
            .collect();
        let mut wanted = vec![frame(1), frame(2), stranger];
        if failures > 0 {
            // The stranger goes first whenever the host has just failed and must wait.
            wanted = vec![stranger, frame(1), frame(2)];
        }
        assert_eq!(order, wanted, "{failures} failures");
    }
}

#[test]
fn two_payloads_of_one_identifier_destroy_each_other_until_one_gives_up() {
    let (mut bus, observed) = bus(1, |_| {});
    quiet(&mut bus, &observed);
    bus.send(&frame(0b1111)).expect("room");
    bus.forge(&frame(0b0111));
    until_sent(&mut bus, &observed, &frame(0b1111));
    let observed = observed.borrow();
    assert_eq!(observed.destroyed.len(), 16);
    let collision = |one: &Destroyed| one.cause == Destruction::Collision;
    assert!(observed.destroyed.iter().all(collision));
    // Error passive both of them, the one with the dominant bit goes on to the end.
    let order: Vec<_> = observed.frames.iter().rev().take(2).collect();
    assert_eq!(order[1].frame, frame(0b0111));
    assert_eq!(order[1].sender, Station::Stranger);
    assert_eq!(order[0].frame, frame(0b1111));
    // 16 times 8, 8 more for the one that gave up, and 1 back.
    assert_eq!(counters(&bus, Station::Host), (135, 0));
}

#[test]
fn the_same_frame_from_two_at_once_is_one_frame() {
    let (mut bus, observed) = bus(1, |_| {});
    quiet(&mut bus, &observed);
    bus.send(&frame(1)).expect("room");
    bus.forge(&frame(1));
    until_sent(&mut bus, &observed, &frame(1));
    let until = BusTime(bus.now().0 + 1_000);
    bus.run(until);
    let observed = observed.borrow();
    assert_eq!(observed.received(Station::Node(0), &frame(1)), 1);
    assert!(observed.destroyed.is_empty());
}
