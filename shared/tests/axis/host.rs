//! A host that falls silent.

use super::bench::{Bench, OTHER, turns};
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::axis::{HOST_TIMEOUT, Outcome};
use canter_shared::drive::simulated::Simulated;
use canter_shared::limits::Limits;
use canter_shared::wire::command::{Action, Command};
use canter_shared::wire::reason::Reason;

/// Ticks until a fault is latched, at most `most`.
#[track_caller]
fn ticks_to_fault(bench: &mut Bench, most: u64) -> u64 {
    let begin = bench.tick;
    while bench.axis.fault().is_none() {
        assert!(bench.tick - begin < most, "no fault in {most} ticks");
        bench.step();
    }
    bench.tick - begin
}

/// In mid-move, just after a heartbeat.
fn heard_in_mid_move() -> Bench {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.go(10.0, 8_000), Outcome::Accepted);
    bench.run(2_000 - bench.tick % 50);
    bench.beats = false;
    bench
}

#[test]
fn a_silent_host_is_a_fault_in_time() {
    let mut bench = heard_in_mid_move();
    let timeout = u64::from(HOST_TIMEOUT.0);
    let ticks = ticks_to_fault(&mut bench, timeout + 1);
    assert!(ticks >= timeout, "{ticks}");
    assert_eq!(bench.axis.fault(), Some(Fault::HostTimeout));
    assert_eq!(bench.axis.state(), State::FaultReactionActive);
    assert_eq!(bench.axis.session(), None);
    // The bench holds the stop to the limits.
    bench.ticks_to_rest(150);
    bench.run(1);
    assert_eq!(bench.axis.state(), State::Fault);
    bench.stays(10_000);
}

#[test]
fn nothing_goes_on_after_a_silent_host_is_back() {
    let mut bench = heard_in_mid_move();
    let group = bench.stage(1.0, 8_000);
    bench.run(1_000);
    assert_eq!(bench.axis.state(), State::Fault);
    bench.drive = Simulated::new(turns(-3.0));
    bench.beats = true;
    assert_eq!(
        bench.control(Action::Clear),
        Outcome::Rejected(Reason::NotHeld)
    );
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    assert_eq!(bench.control(Action::Clear), Outcome::Accepted);
    bench.run(5);
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    bench.run(10);
    assert_eq!(bench.axis.state(), State::OperationEnabled);
    assert_eq!(bench.setpoint.position, turns(-3.0));
    assert_eq!(bench.trigger(group, 5), Outcome::Ignored);
    bench.stays(10_000);
}

#[test]
fn the_heartbeat_of_another_session_keeps_nothing_alive() {
    let mut bench = heard_in_mid_move();
    for _ in 0..300 {
        bench.step();
        let _: Outcome = bench.send(Command::HostHeartbeat { session: OTHER });
    }
    assert_eq!(bench.axis.fault(), Some(Fault::HostTimeout));
}

#[test]
fn commands_keep_nothing_alive() {
    let mut bench = heard_in_mid_move();
    let timeout = u64::from(HOST_TIMEOUT.0);
    for _ in 0..=timeout {
        let _: Outcome = bench.go(10.0, 8_000);
        bench.step();
    }
    assert_eq!(bench.axis.fault(), Some(Fault::HostTimeout));
}

#[test]
fn a_late_heartbeat_is_in_time() {
    let mut bench = heard_in_mid_move();
    for _ in 0..20 {
        bench.run(HOST_TIMEOUT.0.into());
        let beat = Command::HostHeartbeat {
            session: super::bench::SESSION,
        };
        assert_eq!(bench.send(beat), Outcome::Accepted);
    }
    assert_eq!(bench.axis.fault(), None);
}

#[test]
fn a_silent_host_of_a_disabled_axis_only_loses_it() {
    let mut bench = Bench::new(Limits::default(), 0.0);
    bench.run(5);
    bench.beats = false;
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    bench.run(300);
    assert_eq!(bench.axis.session(), None);
    assert_eq!(bench.axis.fault(), None);
    assert_eq!(bench.axis.state(), State::SwitchOnDisabled);
}

/// Whatever the last word of a host was, it counts only while there is a host.
#[test]
fn enabling_with_the_last_breath_does_not_enable() {
    for last in 0..4 {
        let mut bench = Bench::new(Limits::default(), 0.0);
        bench.run(5);
        bench.beats = false;
        assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
        bench.run(u64::from(HOST_TIMEOUT.0) - last);
        assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
        bench.run(1_000);
        assert!(
            !bench.command.enable,
            "{last} ticks before the end: {} without a session",
            bench.axis.state()
        );
    }
}

#[test]
fn a_silent_host_while_enabling_is_a_fault() {
    let mut bench = Bench::new(Limits::default(), 0.0);
    bench.condition = Some(canter_shared::drive::Condition::Disabled);
    bench.run(5);
    bench.beats = false;
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    bench.run(260);
    assert_eq!(bench.axis.fault(), Some(Fault::HostTimeout));
    assert_eq!(bench.axis.state(), State::Fault);
}
