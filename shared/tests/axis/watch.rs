//! What is watched about the drive and the bus, and where the line is.

use super::bench::{AXIS, Bench, control, travel, turns};
use super::node_bench::NodeBench;
use canter_shared::axis::Outcome;
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::drive::Condition;
use canter_shared::drive::simulated::Simulated;
use canter_shared::limits::Limits;
use canter_shared::node::restart::Restart;
use canter_shared::node::{Board, BusEvent, Identity, Node};
use canter_shared::parameter::Parameter;
use canter_shared::time::{BusTime, LocalTime};
use canter_shared::units::{Position, Velocity};
use canter_shared::wire::command::{Action, Command};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId, Function};
use canter_shared::wire::layout::{LAYOUTS, POSITION_STEP, Sender};
use canter_shared::wire::reason::Reason;

fn radians(radians: f64) -> Position {
    Position::from_radians(radians).expect("in range")
}

fn speed(radians: f64) -> Velocity {
    Velocity::from_radians(radians).expect("in range")
}

/// At rest and enabled.
fn resting() -> Bench {
    Bench::enabled(Limits::default(), 0.0)
}

#[track_caller]
fn is_well(bench: &Bench) {
    assert_eq!(bench.axis.fault(), None);
    assert_eq!(bench.axis.state(), State::OperationEnabled);
}

/// The default following error is 0.5 rad for 50 ms.
#[test]
fn a_drive_may_be_away_for_the_following_time_and_no_longer() {
    for side in [1.0, -1.0] {
        let mut bench = resting();
        bench.shift = radians(side * 0.499);
        bench.run(1_000);
        is_well(&bench);
        bench.shift = radians(side * 0.501);
        bench.run(50);
        is_well(&bench);
        // Near for one tick, it may be away for as long again.
        bench.shift = Position::ZERO;
        bench.run(1);
        bench.shift = radians(side * 0.501);
        bench.run(50);
        is_well(&bench);
        bench.run(1);
        assert_eq!(bench.axis.fault(), Some(Fault::FollowingError));
    }
}

#[test]
fn the_following_error_and_its_time_can_be_set_and_switched_off() {
    let mut bench = resting();
    bench.set(Parameter::FollowingError, 100_000_000);
    bench.set(Parameter::FollowingTime, 3);
    bench.shift = radians(0.101);
    bench.run(3);
    is_well(&bench);
    bench.run(1);
    assert_eq!(bench.axis.fault(), Some(Fault::FollowingError));

    let mut bench = resting();
    bench.set(Parameter::FollowingError, 0);
    bench.shift = turns(1_010.0);
    bench.run(1_000);
    is_well(&bench);
}

/// A drive with no lag of its own is never away, however fast it is: what it reports before a tick
/// belongs to the setpoint of the tick before.
#[test]
fn a_report_is_held_against_the_setpoint_that_it_is_about() {
    let mut bench = resting();
    // At 20 rad/s the setpoints of two ticks are 0.02 rad apart.
    bench.set(Parameter::FollowingError, 15_000_000);
    bench.set(Parameter::FollowingTime, 1);
    assert_eq!(bench.go_trapezoid(30.0, 10_000), Outcome::Accepted);
    let mut fastest = 0.0f64;
    while bench.axis.is_moving() {
        // The simulated drive keeps a quarter of each step.
        bench.shift = bench.setpoint.position - bench.drive_position();
        bench.step();
        is_well(&bench);
        fastest = fastest.max(bench.velocity());
    }
    assert!(fastest > 18.0, "{fastest}");
}

#[test]
fn a_drive_that_leaves_the_travel_is_a_fault_at_once() {
    for side in [1.0, -1.0] {
        let mut bench = Bench::enabled(travel(1.0), side * 0.99);
        let outside = turns(side * 0.01);
        bench.shift = outside + radians(side * 0.499);
        bench.run(10);
        is_well(&bench);
        bench.shift = outside + radians(side * 0.501);
        bench.run(1);
        assert_eq!(bench.axis.fault(), Some(Fault::OutsideTravel));
    }
}

#[test]
fn a_drive_that_was_enabled_outside_may_come_back_and_go_no_farther() {
    for side in [1.0, -1.0] {
        let mut bench = Bench::enabled(travel(1.0), side * 5.0);
        bench.run(100);
        is_well(&bench);
        // Ahead of its setpoint on the way in, it is away but not farther out.
        bench.shift = radians(side * -0.501);
        bench.run(50);
        is_well(&bench);
        bench.shift = Position::ZERO;
        assert_eq!(bench.go(side * 0.5, 6_000), Outcome::Accepted);
        bench.ticks_to_rest(6_001);
        is_well(&bench);

        let mut bench = Bench::enabled(travel(1.0), side * 5.0);
        bench.shift = radians(side * 0.501);
        bench.run(1);
        assert_eq!(bench.axis.fault(), Some(Fault::OutsideTravel));
    }
}

/// The default margin is 5 rad/s over 20 rad/s.
#[test]
fn a_drive_that_is_too_fast_is_a_fault_at_once() {
    for side in [1.0, -1.0] {
        let mut bench = resting();
        bench.rush = speed(side * 24.99);
        bench.run(100);
        is_well(&bench);
        bench.rush = speed(side * 25.01);
        bench.run(1);
        assert_eq!(bench.axis.fault(), Some(Fault::Overspeed));
    }
    let mut bench = resting();
    bench.set(Parameter::OverspeedMargin, 0);
    bench.rush = speed(3_000.0);
    bench.run(100);
    is_well(&bench);
}

/// Where and how fast a drive without torque is, is nobody's command.
#[test]
fn a_drive_without_torque_may_be_moved_by_hand() {
    let mut bench = Bench::new(travel(1.0), 0.0);
    bench.condition = Some(Condition::Disabled);
    bench.rush = speed(100.0);
    bench.run(5);
    for place in [0.5, 2.0, 700.0, -3.0] {
        bench.drive = Simulated::new(turns(place));
        bench.run(100);
        assert_eq!(bench.axis.fault(), None);
        assert_eq!(bench.axis.state(), State::SwitchOnDisabled);
    }
    // Nor while it is told to enable and does not hold torque yet.
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    for place in [0.5, 2.0, 700.0, -3.0] {
        bench.drive = Simulated::new(turns(place));
        bench.run(100);
        assert_eq!(bench.axis.fault(), None);
        assert_eq!(bench.axis.state(), State::ReadyToSwitchOn);
    }
}

/// Beyond what Feedback can carry nothing is told right, and nothing could lead back.
#[test]
fn a_place_that_cannot_be_told_is_never_a_setpoint() {
    let edge = turns(1_024.0) - POSITION_STEP;
    for beyond in [
        turns(1_024.0),
        turns(2e3),
        turns(2e4),
        turns(1e6),
        turns(2.147e9),
    ] {
        for (fine, place) in [(edge, beyond), (-edge, -beyond)] {
            // From the first word on, and when it gets there.
            for begins in [place, fine] {
                let mut bench = Bench::new(Limits::default(), 0.0);
                bench.drive = Simulated::new(begins);
                bench.run(5);
                bench.drive = Simulated::new(place);
                // Before the tick that latches it.
                bench.axis.handle_drive(bench.report());
                assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
                let outcome = bench.control(Action::Enable);
                let reasons = [Reason::DriveNotReady, Reason::FaultLatched];
                assert!(
                    reasons.map(Outcome::Rejected).contains(&outcome),
                    "{outcome:?}"
                );
                bench.run(100);
                assert_eq!(bench.axis.fault(), Some(Fault::FeedbackRange));
                assert_eq!(bench.axis.state(), State::Fault);
                assert!(bench.setpoint.position.abs() <= edge);
                // It is latched again as soon as it is cleared.
                assert_eq!(bench.control(Action::Clear), Outcome::Accepted);
                assert_eq!(
                    bench.control(Action::Enable),
                    Outcome::Rejected(Reason::DriveNotReady)
                );
                bench.run(100);
                assert_eq!(bench.axis.fault(), Some(Fault::FeedbackRange));
                // Back in range it can be enabled.
                bench.drive = Simulated::new(fine);
                bench.run(1);
                assert_eq!(bench.control(Action::Clear), Outcome::Accepted);
                assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
                bench.run(10);
                is_well(&bench);
                assert_eq!(bench.setpoint.position, fine);
            }
        }
    }
}

#[test]
fn a_place_that_cannot_be_told_while_the_drive_enables_is_a_fault() {
    let mut bench = Bench::new(Limits::default(), 0.0);
    bench.condition = Some(Condition::Disabled);
    bench.run(5);
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    bench.run(5);
    assert_eq!(bench.axis.state(), State::ReadyToSwitchOn);
    bench.drive = Simulated::new(turns(1_024.0));
    bench.run(1);
    assert_eq!(bench.axis.fault(), Some(Fault::FeedbackRange));
    assert_eq!(bench.setpoint.position, Position::ZERO);
    assert!(!bench.command.enable);
}

#[test]
fn a_speed_that_cannot_be_told_is_a_fault_unless_the_axis_may_be_that_fast() {
    // 512 turn/s are 3217 rad/s.
    let (slower, faster) = (speed(3_216.0), speed(3_218.0));
    let mut bench = Bench::new(Limits::default(), 0.0);
    bench.rush = slower;
    bench.run(100);
    assert_eq!(bench.axis.fault(), None);
    bench.rush = faster;
    bench.run(1);
    assert_eq!(bench.axis.fault(), Some(Fault::FeedbackRange));

    let mut bench = resting();
    bench.set(Parameter::VelocityLimit, 4_000_000_000_000);
    bench.rush = faster;
    bench.run(100);
    is_well(&bench);
}

#[test]
fn off_the_bus_is_a_fault_in_every_state() {
    let mut bench = Bench::new(Limits::default(), 0.0);
    bench.axis.lose_bus();
    bench.run(5);
    assert_eq!(bench.axis.fault(), Some(Fault::BusOff));
    assert_eq!(bench.axis.state(), State::Fault);
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    assert_eq!(bench.control(Action::Clear), Outcome::Accepted);
    bench.run(5);
    bench.axis.lose_bus();
    bench.run(5);
    assert_eq!(bench.axis.fault(), Some(Fault::BusOff));
}

#[test]
fn off_the_bus_is_a_fault_of_all_axes_of_a_node_and_other_errors_are_not() {
    let identity = Identity {
        chip: [0; 12],
        firmware: [0; 3],
        board: Board::Simulated,
    };
    let mut node: Node<Simulated, 3> = Node::new(identity);
    for axis in 1..=3 {
        let axis = AxisId::new(axis).expect("an axis id");
        node.add_axis(axis, Limits::default(), Simulated::new(Position::ZERO))
            .expect("there is room");
    }
    node.count(BusEvent::ErrorFrame);
    node.count(BusEvent::LostReception);
    assert!(node.axes().all(|axis| axis.fault().is_none()));
    node.count(BusEvent::BusOff);
    assert!(node.axes().all(|axis| axis.fault() == Some(Fault::BusOff)));
}

#[test]
fn a_node_that_began_anew_says_why_until_somebody_clears_it() {
    for (restart, fault) in [
        (Restart::Panic, Fault::NodePanic),
        (Restart::HardFault, Fault::NodeHardFault),
        (Restart::Watchdog, Fault::WatchdogReset),
    ] {
        let mut bench = NodeBench::new(Simulated::new(Position::ZERO));
        bench.node.restart_after(restart);
        bench.run(5_000);
        let latched = |bench: &NodeBench<_>| bench.axis().fault();
        assert_eq!(latched(&bench), Some(fault));
        // It must not move before somebody has seen it.
        bench.hold_and_enable();
        bench.run(100_000);
        assert_eq!(latched(&bench), Some(fault));
        assert_eq!(bench.axis().state(), State::Fault);
        bench.send(control(3, Action::Clear));
        bench.run(5_000);
        assert_eq!(latched(&bench), None);
        bench.send(control(4, Action::Enable));
        bench.run(20_000);
        assert_eq!(bench.axis().state(), State::OperationEnabled);
    }
}

#[test]
fn parameters_that_are_lost_are_told_until_somebody_clears_it() {
    let mut bench = Bench::new(Limits::default(), 0.0);
    bench.axis.lose_parameters();
    bench.run(100);
    assert_eq!(bench.axis.fault(), Some(Fault::ParametersLost));
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    assert_eq!(
        bench.control(Action::Enable),
        Outcome::Rejected(Reason::FaultLatched)
    );
    assert_eq!(bench.control(Action::Clear), Outcome::Accepted);
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    bench.run(10);
    is_well(&bench);
}

/// Every frame that a node sends, from another node with the same id.
#[test]
fn a_report_in_its_own_name_is_a_double_and_no_other_frame_is() {
    for id in 0..1u16 << 11 {
        let sender = Function::try_from((id >> 6) as u8)
            .ok()
            .and_then(|function| {
                let layout = LAYOUTS.iter().find(|layout| layout.function == function)?;
                Some(layout.sender)
            });
        let own = id & 63 == u16::from(AXIS.get());
        let double = own && sender == Some(Sender::Node);
        let stop = id >> 6 == 0 && (own || id & 63 == 0);
        let expected = match (double, stop) {
            (true, _) => Some(Fault::DuplicateAxis),
            (_, true) => Some(Fault::EmergencyStop),
            _ => None,
        };
        for length in [0, 8] {
            let frame = Frame::new(id, &[0; 8][..length]).expect("a frame");
            let expected = expected.filter(|_| double || length == 0);
            let mut bench = Bench::new(Limits::default(), 0.0);
            bench.run(1);
            let _: Outcome = bench.handle(&frame);
            assert_eq!(bench.axis.fault(), expected, "{id:03X} {length}");

            let mut bench = NodeBench::new(Simulated::new(Position::ZERO));
            bench.node.handle_frame(LocalTime(0), &frame);
            assert_eq!(bench.axis().fault(), expected, "{id:03X} {length}");
        }
    }
}

#[test]
fn two_nodes_of_one_id_stop_each_other_and_say_so() {
    let mut nodes = [NodeBench::enabled(), NodeBench::enabled()];
    for bench in &mut nodes {
        bench.run(200_000);
        assert_eq!(bench.axis().fault(), None);
    }
    // Each hears the other's next feedback.
    let tell = |bench: &mut NodeBench<Simulated>| {
        while bench.node.poll_transmit(LocalTime(bench.now)).is_some() {}
        let mut sent = None;
        while sent.is_none() {
            bench.now = bench.node.next_tick().0;
            bench.node.tick(LocalTime(bench.now));
            sent = bench.node.poll_transmit(LocalTime(bench.now));
        }
        sent.expect("feedback")
    };
    let [first, second] = &mut nodes;
    let (from_first, from_second) = (tell(first), tell(second));
    first.node.handle_frame(LocalTime(first.now), &from_second);
    second.node.handle_frame(LocalTime(second.now), &from_first);
    for bench in [first, second] {
        assert_eq!(bench.axis().fault(), Some(Fault::DuplicateAxis));
        bench.run(20_000);
        assert_eq!(bench.axis().state(), State::Fault);
    }
}

/// What a host is told does not depend on who asks first: the command itself is no double.
#[test]
fn commands_to_the_axis_are_no_doubles() {
    let mut bench = resting();
    for command in [Command::IdentityRequest, Command::Stop { sequence: 1 }] {
        let frame = command.encode(Address::Axis(AXIS)).expect("fits");
        let _: Outcome = bench.axis.handle_frame(BusTime(0), &frame);
    }
    bench.run(5);
    is_well(&bench);
}

#[test]
fn feedback_and_heartbeat_come_as_often_as_they_are_set_to() {
    use canter_shared::wire::report::Report;
    let mut bench = resting();
    for (feedback, heartbeat) in [(1, 10), (20, 100), (7, 33), (200, 200)] {
        bench.set(Parameter::FeedbackPeriod, feedback);
        bench.set(Parameter::HeartbeatPeriod, heartbeat);
        bench.run(1);
        bench.reports.clear();
        let ticks = 20_000;
        bench.run(ticks);
        let count = |wanted: fn(&&Report) -> bool| bench.reports.iter().filter(wanted).count();
        for (count, period) in [
            (
                count(|report| matches!(report, Report::Feedback { .. })),
                feedback,
            ),
            (
                count(|report| matches!(report, Report::Heartbeat { .. })),
                heartbeat,
            ),
        ] {
            let expected = ticks / period as u64;
            assert!(expected.abs_diff(count as u64) <= 1, "{count} {period}");
        }
    }
}
