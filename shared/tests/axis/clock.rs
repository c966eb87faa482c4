//! SYNC, honest and wild: setpoints keep their limits in the time that really passes.

use super::bench::{AXIS, beta, frame, trapezoid};
use super::node_bench::{Lame, NodeBench, OFFSET, Sent, fastest, most_in_a_millisecond};
use canter_shared::axis::HOST_TIMEOUT;
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::drive::Drive;
use canter_shared::drive::simulated::Simulated;
use canter_shared::limits::Limits;
use canter_shared::node::TICK_LEAD;
use canter_shared::time::bus_clock::BusClock;
use canter_shared::time::{BusTime, LocalTime, Tick};
use canter_shared::units::Position;
use canter_shared::wire::command::{Action, Command};

/// A SYNC takes 111 bits at least, so a bus of 1 Mbit/s carries no more than one in this time.
const FULL_BUS: u64 = 111;

/// The largest part by which the clock may run too fast or too slow: 200 ppm and 500 ppm.
const PART: f64 = 700e-6;

/// At full speed in mid-move: a trapezoid of 100 turns just above its shortest time.
fn at_full_speed() -> NodeBench<Simulated> {
    let mut bench = NodeBench::enabled();
    bench.send(trapezoid(3, 100.0, 31_600));
    bench.run(2_000_000);
    let speed = bench.sent.last().expect("ticks").setpoint.setpoint.velocity;
    assert!(speed.radians() > 19.9, "{speed:?}");
    bench.sent.clear();
    bench
}

/// What has left so far was no faster than the limit in local time, but for the clock's part.
#[track_caller]
fn keeps_its_speed<D: Drive>(bench: &NodeBench<D>) {
    let most = most_in_a_millisecond(&bench.sent);
    assert!(most <= 2, "{most} ticks in a millisecond");
    let limit = Limits::default().velocity().radians() * (1.0 + 1e-3);
    for ticks in [1, 2, 10, 100] {
        let speed = fastest(&bench.sent, ticks);
        assert!(speed <= limit, "{speed} rad/s over {ticks} ticks");
    }
}

/// Around the instant of a tick its setpoints leave, so it runs before: from the first one on, and by bus time.
#[test]
fn a_tick_runs_ahead_of_its_instant() {
    let mut bench = NodeBench::new(Simulated::new(Position::ZERO));
    bench.run(20_000);
    let first = &bench.sent[0];
    assert_eq!((first.at, first.setpoint.tick), (0, Tick(0)));
    let ahead = |sent: &Sent, offset: u64| sent.setpoint.tick.time().0 - (sent.at + offset);
    for sent in &bench.sent[1..] {
        assert_eq!(ahead(sent, 0), TICK_LEAD);
    }
    bench.sync(bench.now + OFFSET);
    // The one that was under way when the clock was set comes no later for it.
    bench.run(2_000);
    bench.sent.clear();
    bench.run(100_000);
    assert!(bench.sent.len() >= 99);
    for sent in &bench.sent {
        assert_eq!(ahead(sent, OFFSET), TICK_LEAD);
    }
}

#[test]
fn a_flood_of_syncs_ahead_does_not_speed_up_a_move() {
    for period in [FULL_BUS, 250, 1_000, 5_000, 20_000] {
        let mut bench = at_full_speed();
        while bench.sent.len() < 5_000 {
            bench.sync_ahead(49_000);
            bench.run(period);
        }
        keeps_its_speed(&bench);
        assert_eq!(bench.axis().fault(), None);
    }
}

#[test]
fn a_flood_of_syncs_behind_does_not_freeze_a_move() {
    for period in [FULL_BUS, 250, 1_000, 5_000, 20_000] {
        let mut bench = at_full_speed();
        // Long enough for the rate to come to its end before it counts.
        let flood = |bench: &mut NodeBench<Simulated>| {
            for _ in 0..5_000_000 / period {
                bench.sync_ahead(-49_000);
                bench.run(period);
            }
        };
        flood(&mut bench);
        let (local, bus) = bench.bus_time_in(flood);
        // Both ends are whole microseconds.
        let most = PART * local as f64 + 1.0;
        let slow = local.abs_diff(bus);
        assert!(slow as f64 <= most, "{slow} us, one SYNC in {period} us");
    }
}

#[test]
fn the_clock_cannot_be_led_astray_by_changing_floods() {
    for side in [-1, 1] {
        let mut bench = at_full_speed();
        // First SYNCs that could be true, which lead the rate to its end; then so many wild ones
        // that their rounding would count.
        for _ in 0..4_000 {
            bench.sync_ahead(side * 19);
            bench.run(1_000);
        }
        let (local, bus) = bench.bus_time_in(|bench| {
            for _ in 0..20_000 {
                bench.sync_ahead(side * 49_000);
                bench.run(FULL_BUS);
            }
        });
        let part = bus as f64 / local as f64 - 1.0;
        assert!(part.abs() <= 1e-3, "{part}");
        keeps_its_speed(&bench);
    }
}

/// Whatever the clock was made to believe, it follows an honest one within seconds.
#[test]
fn a_clock_that_was_led_astray_comes_back() {
    for side in [-1, 1] {
        let mut bench = NodeBench::enabled();
        for _ in 0..4_000 {
            bench.sync_ahead(side * 19);
            bench.run(1_000);
        }
        let begin = bench.node.bus_time(LocalTime(bench.now)).0 - bench.now;
        for _ in 0..1_000 {
            bench.sync(begin + bench.now);
            bench.run(20_000);
        }
        let shown = bench.node.bus_time(LocalTime(bench.now)).0;
        let off = shown.abs_diff(begin + bench.now);
        assert!(off <= 100, "off by {off} us after 20 s of honest SYNCs");
    }
}

/// Crystals of +-100 ppm, and a host whose SYNCs come late by up to 5 ms, three in four of them.
#[test]
fn the_clock_follows_through_jitter_whatever_comes_first() {
    let mut worst = 0;
    for case in 1..=400u64 {
        let mut seed = case.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let part = if case % 2 == 0 { 10_001 } else { 9_999 };
        let mut clock = BusClock::new();
        for step in 0..3_000 {
            let local = |bus: u64| LocalTime(1_000 + bus * part / 10_000);
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let late = if seed >> 62 == 0 {
                0
            } else {
                (seed >> 33) % 5_000
            };
            let bus = step * 20_000;
            // From the tenth second on something moves all the time.
            let sent = BusTime(OFFSET + bus);
            clock.synchronise(local(bus + late), step as u8, sent, step < 500);
            if step > 1_000 {
                let shown = clock.bus_time(local(bus)).0;
                worst = worst.max(shown.abs_diff(OFFSET + bus));
            }
        }
    }
    assert!(worst <= 500, "off by {worst} us");
}

/// Honest SYNCs with one that is 45 ms ahead, at each place in a window.
#[test]
fn one_sync_far_ahead_in_mid_move_makes_no_burst() {
    for place in 0..8 {
        let mut bench = at_full_speed();
        let begin = bench.node.bus_time(LocalTime(bench.now)).0 - bench.now;
        for index in 0..48 {
            let outlier = if index == 16 + place { 45_000 } else { 0 };
            bench.sync(begin + bench.now + outlier);
            bench.run(20_000);
        }
        keeps_its_speed(&bench);
    }
}

/// The commander's clock was away for minutes, in which two crystals part by what would be many
/// ticks at once.
#[test]
fn syncs_that_come_back_after_minutes_in_mid_move_make_no_burst() {
    for ahead in [49_000, -49_000] {
        let mut bench = NodeBench::enabled();
        bench.send(trapezoid(3, 900.0, 300_000));
        bench.run(270_000_000);
        bench.sent.clear();
        for _ in 0..100 {
            bench.sync_ahead(ahead);
            bench.run(20_000);
        }
        assert!(bench.axis().is_moving());
        keeps_its_speed(&bench);
    }
}

/// At rest the clock may go forward, but a move that comes then leaves from its new time: what
/// the ticks in between would have done is not made up for.
#[test]
fn a_move_that_comes_with_a_correction_of_the_clock_makes_no_burst() {
    for move_first in [false, true] {
        let mut bench = NodeBench::enabled();
        let begin = bench.node.bus_time(LocalTime(bench.now)).0 - bench.now;
        for _ in 0..7 {
            bench.run(20_000);
            bench.sync(begin + bench.now);
        }
        bench.run(20_000);
        bench.sent.clear();
        let quick = trapezoid(3, 10.0, 3_300);
        if move_first {
            bench.send(quick);
        }
        bench.sync(begin + bench.now + 45_000);
        if !move_first {
            bench.send(quick);
        }
        bench.run(200_000);
        keeps_its_speed(&bench);
    }
}

#[test]
fn a_wild_sync_in_mid_move_changes_nothing() {
    let mut bench = at_full_speed();
    for wild in [0, 1, OFFSET / 2, 1 << 40, (1 << 56) - 1] {
        let (local, bus) = bench.bus_time_in(|bench| {
            bench.sync(wild);
            bench.run(10_000);
        });
        assert_eq!(local.abs_diff(bus), 0);
    }
    keeps_its_speed(&bench);
    assert_eq!(most_in_a_millisecond(&bench.sent), 1);
}

#[test]
fn an_emergency_stop_in_a_flood_of_syncs_comes_to_rest() {
    for ahead in [-49_000, 49_000] {
        let mut bench = at_full_speed();
        bench.send(Command::EmergencyStop);
        for _ in 0..150_000 / FULL_BUS {
            bench.sync_ahead(ahead);
            bench.run(FULL_BUS);
        }
        assert_eq!(bench.axis().state(), State::Fault);
        assert_eq!(bench.axis().fault(), Some(Fault::EmergencyStop));
    }
}

/// Two commanders with clocks of their own, each with 50 SYNCs a second.
fn two_masters<D: Drive>(bench: &mut NodeBench<D>, clocks: [u64; 2], microseconds: u64) {
    let begin = bench.now;
    let end = begin + microseconds;
    for clock in clocks.into_iter().cycle() {
        if bench.now >= end {
            return;
        }
        bench.sync(clock + bench.now - begin);
        bench.run(10_000);
    }
}

/// Clocks that begin when their host does are near zero; others count from long ago.
const CLOCKS: [[u64; 2]; 4] = [
    [5_000_000_000, 9_000_000_000],
    [9_000_000_000, 5_000_000_000],
    [0, 9_000_000_000],
    [1_700_000_000_000_000, 100_000],
];

#[test]
fn two_masters_do_not_keep_a_dead_session() {
    for clocks in CLOCKS {
        let mut bench = NodeBench::enabled();
        bench.beats = false;
        two_masters(&mut bench, clocks, 2 * 1_000 * u64::from(HOST_TIMEOUT.0));
        assert_eq!(bench.axis().session(), None, "{clocks:?}");
        assert_eq!(bench.axis().fault(), Some(Fault::HostTimeout), "{clocks:?}");
        assert_eq!(bench.axis().state(), State::Fault, "{clocks:?}");
    }
}

/// A clock that stands still at zero, against one that runs.
#[test]
fn a_broken_clock_does_not_keep_a_dead_session() {
    let mut bench = NodeBench::enabled();
    bench.beats = false;
    for _ in 0..100 {
        bench.sync(0);
        bench.run(10_000);
        bench.sync(9_000_000_000 + bench.now);
        bench.run(10_000);
    }
    assert_eq!(bench.axis().session(), None);
    assert_eq!(bench.axis().fault(), Some(Fault::HostTimeout));
}

#[test]
fn two_masters_do_not_kill_a_live_session() {
    for clocks in CLOCKS {
        let mut bench = NodeBench::enabled();
        two_masters(&mut bench, clocks, 2_000_000);
        assert_eq!(bench.axis().fault(), None, "{clocks:?}");
        assert_eq!(bench.axis().state(), State::OperationEnabled, "{clocks:?}");
    }
}

#[test]
fn two_masters_do_not_stop_the_enable_time_out() {
    for clocks in CLOCKS {
        let mut bench = NodeBench::new(Lame);
        bench.hold_and_enable();
        bench.run(5_000);
        assert_eq!(bench.axis().state(), State::ReadyToSwitchOn);
        two_masters(&mut bench, clocks, 1_500_000);
        assert_eq!(
            bench.axis().fault(),
            Some(Fault::EnableTimeout),
            "{clocks:?}"
        );
    }
}

/// A clock that steps for each SYNC must not starve the tick, which watches over everything.
#[test]
fn the_tick_comes_however_often_the_clock_steps() {
    let mut bench = NodeBench::enabled();
    bench.send(Command::EmergencyStop);
    for index in 0..500 {
        // Just after a tick, each time on another clock, and again before the next tick.
        bench.sync((index % 2 + 1) * 5_000_000_000 + 100);
        bench.run(850);
    }
    assert_eq!(bench.axis().state(), State::Fault, "no tick in 0.4 s");
    let torque = bench.sent.last().expect("ticks").setpoint.state.drives();
    assert!(!torque, "the drive still holds torque");
}

/// A SYNC that sets the clock does not move a resting axis, and moves leave by the new time.
#[test]
fn a_step_of_the_clock_at_rest_moves_nothing() {
    let mut bench = NodeBench::enabled();
    for time in [OFFSET * 5, OFFSET, OFFSET * 9] {
        // Until the host that told the time before counts as gone.
        bench.run(500_000);
        bench.sync(time);
        bench.run(100_000);
        assert_eq!(bench.axis().state(), State::OperationEnabled);
        let last = bench.sent.last().expect("ticks").setpoint;
        assert_eq!(last.setpoint.position, Position::ZERO);
        assert!(last.tick.0.abs_diff((time + 100_000) / 1_000) <= 1);
    }
    bench.send(beta(3, 1.0, 1_000));
    bench.run(1_100_000);
    let last = bench.sent.last().expect("ticks").setpoint.setpoint;
    assert_eq!(last.position, super::bench::turns(1.0));
    assert!(fastest(&bench.sent, 1) < 20.0);
}

/// Frames to other axes and to nobody leave a node alone.
#[test]
fn only_the_axis_that_is_meant_is_moved() {
    let mut bench = NodeBench::enabled();
    let mine = frame(beta(3, 1.0, 1_000));
    for axis in 0..64u16 {
        let id = mine.id() & !0x3F | axis;
        let other = canter_shared::wire::frame::Frame::new(id, mine.data()).expect("a frame");
        if axis != u16::from(AXIS.get()) {
            bench.node.handle_frame(LocalTime(bench.now), &other);
        }
    }
    bench.run(10_000);
    assert!(!bench.axis().is_moving());
    bench.send(super::bench::control(3, Action::Disable));
    bench.run(10_000);
    assert_eq!(bench.axis().state(), State::SwitchOnDisabled);
}
