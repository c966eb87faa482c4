//! Stops, emergency stops, disabling, and the faults that end in one.

use super::bench::{Bench, beta, control, stopping_ticks, travel, turns};
use canter_shared::axis::Outcome;
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::drive::simulated::Simulated;
use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::units::Position;
use canter_shared::wire::command::{Action, Command, wire_position};
use canter_shared::wire::reason::Reason;
use std::f64::consts::TAU;

/// On the way in from 5 turns, where the travel ends at 1.
fn moving_inwards() -> Bench {
    let mut bench = Bench::enabled(travel(1.0), 5.0);
    assert_eq!(bench.go(0.0, 6_000), Outcome::Accepted);
    bench.run(2_000);
    assert!(bench.velocity() < -3.0, "{}", bench.velocity());
    assert!(bench.place() > 3.0, "{}", bench.place());
    bench
}

#[test]
fn a_stop_outside_the_travel_stops() {
    let mut bench = moving_inwards();
    let most = stopping_ticks(bench.velocity(), bench.axis.limits());
    assert_eq!(bench.send(Command::Stop { sequence: 9 }), Outcome::Accepted);
    bench.ticks_to_rest(most);
    assert_eq!(bench.axis.state(), State::OperationEnabled);
    bench.stays(1_000);
    assert!(bench.place() > 3.0);
    // And it goes on from there when told so.
    assert_eq!(bench.go(0.0, 6_000), Outcome::Accepted);
    bench.run(6_000);
    assert_eq!(bench.setpoint.position, Position::ZERO);
}

#[test]
fn an_emergency_stop_outside_the_travel_stops() {
    let mut bench = moving_inwards();
    let most = stopping_ticks(bench.velocity(), bench.axis.limits());
    assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
    bench.ticks_to_rest(most);
    bench.run(1);
    assert_eq!(bench.axis.state(), State::Fault);
    assert_eq!(bench.axis.fault(), Some(Fault::EmergencyStop));
    assert!(bench.place() > 3.0);
}

#[test]
fn disabling_outside_the_travel_stops() {
    let mut bench = moving_inwards();
    let most = stopping_ticks(bench.velocity(), bench.axis.limits());
    assert_eq!(bench.control(Action::Disable), Outcome::Accepted);
    bench.ticks_to_rest(most);
    bench.run(1);
    assert_eq!(bench.axis.state(), State::SwitchOnDisabled);
    assert!(bench.place() > 3.0);
}

#[test]
fn a_silent_host_outside_the_travel_stops_the_axis() {
    let mut bench = moving_inwards();
    bench.beats = false;
    bench.run(251);
    let most = stopping_ticks(bench.velocity(), bench.axis.limits());
    bench.ticks_to_rest(most);
    bench.run(1);
    assert_eq!(bench.axis.state(), State::Fault);
    assert_eq!(bench.axis.fault(), Some(Fault::HostTimeout));
    assert!(bench.place() > 2.0);
}

#[test]
fn another_target_outside_the_travel_is_reached_without_going_farther_out() {
    let mut bench = moving_inwards();
    // The bench sees at each tick that the axis goes no farther out.
    assert_eq!(bench.go(0.9, 100), Outcome::Accepted);
    bench.ticks_to_rest(10_000);
    assert_eq!(bench.setpoint.position, wire_position(turns(0.9)));
}

/// From far outside to the far end of the travel: a stop that needs more room than is left must
/// not come out on the other side, though that is less far outside than where the axis was.
#[test]
fn a_stop_on_the_way_in_does_not_go_out_on_the_other_side() {
    let limits = Limits::new(&LimitValues {
        velocity: 59.0,
        acceleration: 270.0,
        deceleration: 21.4,
        jerk: 615.0,
        position_minimum: -TAU,
        position_maximum: TAU,
    })
    .expect("in range");
    for milliseconds in [3_800, 4_000, 4_200, 4_500, 5_000, 5_500] {
        for after in [1, 2, 5, 10, 50, 200, 1_000, 2_000] {
            let mut bench = Bench::enabled(limits, 12.0996);
            assert_eq!(bench.go_trapezoid(-1.0, milliseconds), Outcome::Accepted);
            bench.run(after);
            // The bench sees that no setpoint leads out of the travel.
            assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
            bench.run(6_000);
            assert_eq!(bench.axis.state(), State::Fault);
        }
    }
}

/// A trapezoid's acceleration comes at once whatever the jerk limit, and so it must go: taken back
/// slowly, it would carry the axis on to full speed after an emergency stop.
#[test]
fn an_emergency_stop_does_not_speed_up_a_trapezoid() {
    let limits = Limits::new(&LimitValues {
        jerk: 500.0,
        ..DEFAULT_VALUES
    })
    .expect("in range");
    for after in [1, 5, 20, 50, 80] {
        let mut bench = Bench::enabled(limits, 0.0);
        assert_eq!(bench.go_trapezoid(10.0, 3_300), Outcome::Accepted);
        bench.run(after);
        let before = bench.velocity();
        assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
        while bench.axis.is_moving() {
            bench.step();
            let now = bench.velocity();
            assert!(now <= before + 0.3, "from {before} to {now} rad/s");
        }
    }
}

#[test]
fn every_kind_of_move_stops_in_the_time_that_the_limits_allow() {
    for after in [1, 50, 150, 300, 600, 900, 990, 1_050] {
        for quick in [false, true] {
            let mut bench = Bench::enabled(Limits::default(), 0.0);
            let outcome = if quick {
                bench.go_trapezoid(3.0, 1_100)
            } else {
                bench.go(1.5, 1_100)
            };
            assert_eq!(outcome, Outcome::Accepted);
            bench.run(after);
            let most = stopping_ticks(bench.velocity(), bench.axis.limits());
            assert_eq!(bench.send(Command::Stop { sequence: 0 }), Outcome::Accepted);
            bench.ticks_to_rest(most);
            bench.stays(100);
        }
    }
}

/// A trapezoid takes no notice of the jerk limit, so its last braking is harder than a stop with
/// little jerk: the stop that keeps the jerk limit would end outside of the travel.
#[test]
fn an_emergency_stop_on_the_way_to_the_end_of_the_travel_begins_at_once() {
    let limits = Limits::new(&LimitValues {
        jerk: 20.0,
        position_minimum: -100.0,
        position_maximum: 100.0,
        ..DEFAULT_VALUES
    })
    .expect("in range");
    let mut bench = Bench::enabled(limits, 0.0);
    let end = 100.0 / TAU;
    assert_eq!(bench.go_trapezoid(end, 6_000), Outcome::Accepted);
    // 0.9 s from the end at nearly full speed, where 0.1 s of braking would do.
    bench.run(5_100);
    let before = bench.velocity();
    assert!(before > 16.0, "{before}");
    assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
    bench.run(500);
    assert!(
        bench.velocity() < 0.9 * before,
        "0.5 s after the emergency stop: {} rad/s of {before}",
        bench.velocity()
    );
}

/// A ramp of many ticks, and a deceleration limit below that of acceleration: the velocity still
/// rises while the acceleration is taken back, and a second stop plans that rise anew.
#[test]
fn a_stop_in_a_stop_while_speeding_up_keeps_the_velocity_limit() {
    let limits = Limits::new(&LimitValues {
        velocity: 0.5808,
        acceleration: 9.4498,
        deceleration: 3.1622,
        jerk: 9.4498,
        ..DEFAULT_VALUES
    })
    .expect("in range");
    for first in [3, 9, 15, 30, 60] {
        for second in 0..100 {
            let mut bench = Bench::enabled(limits, 0.0);
            assert_eq!(bench.go_trapezoid(1.0, 12_000), Outcome::Accepted);
            bench.run(first);
            assert_eq!(bench.send(Command::Stop { sequence: 0 }), Outcome::Accepted);
            bench.run(second);
            // The bench sees the velocity at each tick.
            assert_eq!(bench.send(Command::Stop { sequence: 0 }), Outcome::Accepted);
            bench.ticks_to_rest(2_000);
        }
    }
}

#[test]
fn stops_in_a_flood_do_not_put_off_the_rest() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.go(5.0, 4_000), Outcome::Accepted);
    bench.run(2_000);
    let most = stopping_ticks(bench.velocity(), bench.axis.limits());
    for sequence in 0..=u8::MAX {
        assert_eq!(bench.send(Command::Stop { sequence }), Outcome::Accepted);
        bench.step();
        if !bench.axis.is_moving() {
            assert!(u64::from(sequence) < most, "{sequence} of {most} ticks");
            return;
        }
    }
    panic!("still {} rad/s", bench.velocity());
}

#[test]
fn enabling_in_the_tick_of_disabling_is_refused() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.control(Action::Disable), Outcome::Accepted);
    assert_eq!(
        bench.control(Action::Enable),
        Outcome::Rejected(Reason::Moving)
    );
    bench.run(5);
    assert_eq!(bench.axis.state(), State::SwitchOnDisabled);
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    bench.run(10);
    assert_eq!(bench.axis.state(), State::OperationEnabled);
}

#[test]
fn a_move_while_disabling_is_refused() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.go(5.0, 4_000), Outcome::Accepted);
    bench.run(2_000);
    assert_eq!(bench.control(Action::Disable), Outcome::Accepted);
    for _ in 0..3 {
        assert_eq!(bench.go(0.0, 4_000), Outcome::Rejected(Reason::NotEnabled));
        bench.step();
    }
    bench.ticks_to_rest(200);
    bench.run(1);
    assert_eq!(bench.axis.state(), State::SwitchOnDisabled);
    bench.stays(1_000);
}

#[test]
fn an_emergency_stop_is_latched_in_every_state() {
    // Before the first word of the drive, disabled, enabling, enabled.
    for (ticks, enable) in [(0, false), (5, false), (6, true), (20, true)] {
        let mut bench = Bench::new(Limits::default(), 2.0);
        bench.run(ticks.min(5));
        if enable {
            assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
            assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
            bench.run(ticks - 5);
        }
        let state = bench.axis.state();
        assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
        bench.run(2);
        assert_eq!(bench.axis.state(), State::Fault, "from {state}");
        assert_eq!(bench.axis.fault(), Some(Fault::EmergencyStop));
        assert!(!bench.command.enable);
        bench.stays(2_000);
    }
}

#[test]
fn a_fault_refuses_everything_until_it_is_cleared() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
    bench.run(2);
    let latched = Outcome::Rejected(Reason::FaultLatched);
    assert_eq!(bench.control(Action::Enable), latched);
    assert_eq!(bench.answer().detail, u8::from(Fault::EmergencyStop).into());
    assert_eq!(bench.go(1.0, 1_000), latched);
    bench.stays(1_100);
    assert_eq!(bench.control(Action::Clear), Outcome::Accepted);
    bench.stays(1_100);
    assert_eq!(bench.axis.state(), State::SwitchOnDisabled);
    assert_eq!(bench.axis.fault(), None);
}

#[test]
fn clearing_while_the_axis_still_stops_is_refused() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.go(5.0, 4_000), Outcome::Accepted);
    bench.run(2_000);
    assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
    assert_eq!(
        bench.control(Action::Clear),
        Outcome::Rejected(Reason::Moving)
    );
    bench.ticks_to_rest(200);
    assert_eq!(bench.axis.fault(), Some(Fault::EmergencyStop));
}

/// A program that clears and enables does not wait for a tick in between.
#[test]
fn clear_and_enable_may_come_in_one_tick() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
    bench.run(2);
    assert_eq!(bench.control(Action::Clear), Outcome::Accepted);
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    bench.run(10);
    assert_eq!(bench.axis.state(), State::OperationEnabled);
}

/// Found by the soak, seed 104246: three frames of one tick.
#[test]
fn clear_enable_and_disable_in_one_tick_leave_the_axis_disabled() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
    bench.run(20);
    for action in [Action::Clear, Action::Enable, Action::Disable] {
        assert_eq!(bench.control(action), Outcome::Accepted);
    }
    bench.run(50);
    assert_eq!(bench.axis.state(), State::SwitchOnDisabled);
}

#[test]
fn nothing_of_before_moves_the_axis_after_a_fault_is_cleared() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.send(beta(3, 1.0, 1_000)), Outcome::Accepted);
    bench.run(500);
    assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
    bench.ticks_to_rest(200);
    bench.run(1);
    // Somebody moved it by hand meanwhile.
    bench.drive = Simulated::new(turns(-0.25));
    assert_eq!(bench.send(control(4, Action::Clear)), Outcome::Accepted);
    bench.run(5);
    assert_eq!(bench.send(control(5, Action::Enable)), Outcome::Accepted);
    bench.run(10);
    assert_eq!(bench.axis.state(), State::OperationEnabled);
    assert_eq!(bench.setpoint.position, turns(-0.25));
    let stale = Outcome::Rejected(Reason::StaleSequence);
    assert_eq!(bench.send(beta(3, 1.0, 1_000)), stale);
    bench.stays(2_000);
}
