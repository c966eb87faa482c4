//! Nodes that lose their power.

use canter_shared::axis::state::State;
use canter_shared::units::Velocity;
use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};

use super::observed::{Observed, bus};
use super::*;

const AWAY: Duration = Duration::from_millis(500);

/// All axes on their way, each with a speed.
fn moving(seed: u64) -> (Host, Rc<RefCell<Observed>>) {
    let mut host = Host::seeded(seed);
    let observed = Rc::new(RefCell::new(Observed::default()));
    host.bus.observe(Rc::clone(&observed));
    host.wait(500_000);
    host.control(Action::Hold, 1);
    host.control(Action::Enable, 2);
    for axis in (1..=12).filter_map(AxisId::new) {
        let command = Command::Move {
            profile: ProfileKind::Beta,
            staged: false,
            target: wire_position(Position::from_radians(5.0).expect("in range")),
            duration: Ticks(1_000),
            sequence: 3,
        };
        host.say(axis.into(), command);
    }
    host.wait(500_000);
    (host, observed)
}

#[test]
fn a_node_without_power_coasts_and_comes_back_disabled() {
    let (mut host, observed) = moving(1);
    let before = observed.borrow().last(3).plant;
    assert!(before.velocity.radians() > 3.0, "{before:?}");
    let cut = host.bus.true_now();
    host.bus.disturb(Disturbance::CutPower {
        node: 3,
        time: AWAY,
    });
    assert!(host.bus.axis(3).is_none());
    host.heard.clear();
    host.wait(499_000);
    assert!(
        host.heard
            .iter()
            .all(|(time, axis, _)| axis.get() != 4 || time.0 < cut.0 / 1_000 + 1_000)
    );
    host.wait(200_000);
    let observed = observed.borrow();
    let back = TrueTime(cut.0 + 500_000_000);
    assert_eq!(observed.power, [(cut, 3, false), (back, 3, true)]);
    let ticks = observed.ticks.iter().filter(|tick| tick.node == 3);
    assert!(
        ticks
            .clone()
            .all(|tick| tick.time <= cut || tick.time >= back)
    );
    // It has gone on without torque, far less than its move would have.
    let first = ticks
        .clone()
        .find(|tick| tick.time >= back)
        .expect("it is back");
    let gone = (first.plant.position - before.position).radians();
    assert!((1.0..3.0).contains(&gone), "{gone} rad");
    assert_eq!(first.plant.velocity, Velocity::ZERO);
    let states = observed.states_since(3, back);
    assert_eq!(states, [State::SwitchOnDisabled]);
    let last = observed.last(3);
    assert_eq!(last.fault, None);
    // It takes the place where it is for its own.
    let off = (last.setpoint.setpoint.position - first.plant.position).abs();
    assert!(off.radians() < 1e-6, "{off:?}");
    // Nobody else has noticed.
    for node in (0..12).filter(|node| *node != 3) {
        assert_eq!(observed.last(node).setpoint.state, State::OperationEnabled);
        assert_eq!(observed.states_since(node, cut), [State::OperationEnabled]);
    }
}

#[test]
fn a_node_that_was_reset_has_a_new_clock_until_the_next_sync() {
    let (mut host, observed) = moving(2);
    let cut = host.bus.true_now();
    host.bus.disturb(Disturbance::CutPower {
        node: 3,
        time: Duration::ZERO,
    });
    host.wait(300_000);
    let observed = observed.borrow();
    let since = observed.ticks.iter();
    let since = since.filter(|tick| tick.node == 3 && tick.time >= cut);
    let since: Vec<_> = since.collect();
    assert_eq!(since[0].time, cut);
    assert!(!since[0].synchronised);
    assert_eq!(since[0].setpoint.tick, Tick(0));
    assert!(since.last().expect("ticks").synchronised);
    let now = host.bus.now();
    let believed = host.bus.node_times().nth(3).expect("12 nodes");
    assert!(now.0.abs_diff(believed.0) < 200, "{believed:?} at {now:?}");
}

#[test]
fn a_frame_ends_where_its_sender_loses_its_power() {
    let (mut bus, observed) = bus(3, |_| {});
    bus.run(BusTime(200_300));
    let request = Command::IdentityRequest
        .encode(AxisId::new(2).expect("in range").into())
        .expect("no values");
    bus.send(&request).expect("room");
    // Right in the node's first answer.
    let until = BusTime(bus.now().0 + 53 + 3 + 20 + 50);
    bus.run(until);
    let cut = bus.true_now();
    let sent = observed.borrow().frames.len();
    bus.disturb(Disturbance::CutPower {
        node: 1,
        time: AWAY,
    });
    let until = BusTime(bus.now().0 + 100);
    bus.run(until);
    let observed = observed.borrow();
    assert_eq!(observed.frames.len(), sent);
    let destroyed = observed.destroyed.last().expect("one");
    assert_eq!(destroyed.cause, Destruction::CutOff);
    assert_eq!(destroyed.sender, Station::Node(1));
    // 12 bits of flags and 8 of delimiter, from the end of the bit that was cut off.
    let rest = destroyed.end.0 - cut.0;
    assert!((20_000..=21_000).contains(&rest), "{rest} ns");
    for other in [Station::Host, Station::Node(0), Station::Node(2)] {
        assert_eq!(bus.error_counters(other).receive(), 1, "{other:?}");
    }
}

#[test]
fn what_a_node_had_to_send_is_lost_with_its_power() {
    let (mut bus, observed) = bus(2, |_| {});
    bus.run(BusTime(200_300));
    let request = Command::IdentityRequest
        .encode(AxisId::new(2).expect("in range").into())
        .expect("no values");
    bus.send(&request).expect("room");
    bus.disturb_at(
        BusTime(200_330),
        Disturbance::Babble {
            what: Babble::Frame(request),
            time: Duration::from_millis(2),
        },
    );
    bus.disturb_at(
        BusTime(201_500),
        Disturbance::CutPower {
            node: 1,
            time: Duration::from_millis(2),
        },
    );
    bus.run(BusTime(300_000));
    let observed = observed.borrow();
    assert_eq!(observed.power.len(), 2);
    let mut sent = observed.frames.iter();
    let identity = |sent: &&Transmission| sent.frame.id() >> 6 == 29;
    assert_eq!(sent.find(identity), None);
}

#[test]
fn the_power_fails_in_the_middle_of_saving() {
    let (mut bus, observed) = bus(2, |_| {});
    bus.run(BusTime(100_000));
    bus.disturb(Disturbance::CutPowerWhileSaving {
        node: 1,
        after: 2,
        time: AWAY,
    });
    bus.run(BusTime(200_000));
    assert!(observed.borrow().power.is_empty());
    let flash = bus.flash_mut(1).expect("two nodes");
    assert_eq!(flash.write(0, &[5; 32]), Err(FlashError::PowerCut));
    bus.run(BusTime(202_000));
    assert!(bus.axis(1).is_none() && bus.axis(0).is_some());
    bus.run(BusTime(800_000));
    assert!(bus.axis(1).is_some());
    assert_eq!(observed.borrow().power.len(), 2);
    // What was written before is still there.
    let flash = bus.flash_mut(1).expect("two nodes");
    let mut read = [0; 32];
    flash.read(0, &mut read).expect("power");
    assert_eq!(read[..16], [5; 16]);
    assert_eq!(read[24..], [0xFF; 8]);
    flash.write(24, &[6; 8]).expect("whole again");
}
