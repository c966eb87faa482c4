//! Every fault with every reaction: how the axis comes to rest, what is latched, and that nothing
//! moves afterwards.

use super::bench::{AXIS, Bench, stopping_ticks, turns};
use super::planner::{Planner, answers};
use canter_shared::axis::Outcome;
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::drive::{Condition, Trouble};
use canter_shared::limits::Limits;
use canter_shared::parameter::{Parameter, Reaction};
use canter_shared::time::Ticks;
use canter_shared::units::{Position, Velocity};
use canter_shared::wire::command::{Action, Command, ProfileKind};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;
use proptest::prelude::*;

/// The faults that leave a choice and that an axis in motion can run into.
pub const CHOICES: [Fault; 7] = [
    Fault::HostTimeout,
    Fault::FollowingError,
    Fault::OutsideTravel,
    Fault::Overspeed,
    Fault::FeedbackRange,
    Fault::BusOff,
    Fault::DuplicateAxis,
];

pub const REACTIONS: [Reaction; 3] = [
    Reaction::ControlledStop,
    Reaction::QuickStop,
    Reaction::Disable,
];

/// Makes the trouble that leads to a fault.
pub fn trouble(bench: &mut Bench, fault: Fault) {
    match fault {
        Fault::EmergencyStop => {
            assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
        }
        Fault::HostTimeout => bench.beats = false,
        Fault::DriveLost => bench.condition = Some(Condition::Lost),
        Fault::FollowingError => bench.shift = turns(0.25),
        Fault::OutsideTravel => bench.shift = turns(1_005.0),
        Fault::Overspeed => bench.rush = Velocity::from_radians(50.0).expect("in range"),
        Fault::FeedbackRange => bench.shift = turns(1_030.0),
        Fault::BusOff => {
            bench.axis.lose_bus();
            bench.planner.act(&mut bench.axis);
        }
        Fault::DuplicateAxis => {
            let report = Report::Started {
                sequence: 0,
                time: bench.now(),
            };
            assert_eq!(bench.handle(&report.encode(AXIS)), Outcome::Ignored);
        }
        Fault::ParametersLost => bench.axis.lose_parameters(),
        Fault::EnableTimeout
        | Fault::StreamUnderrun
        | Fault::NodePanic
        | Fault::NodeHardFault
        | Fault::WatchdogReset => panic!("{fault:?} is tested elsewhere"),
        of_drive => {
            let mut troubles = Trouble::ALL.into_iter();
            let trouble = troubles.find(|trouble| Fault::from(*trouble) == of_drive);
            bench.condition = Some(Condition::Faulted(trouble.expect("a drive's own")));
        }
    }
}

/// Ends all trouble.
pub fn mend(bench: &mut Bench) {
    bench.beats = true;
    bench.condition = None;
    bench.shift = Position::ZERO;
    bench.rush = Velocity::ZERO;
}

/// At 15 rad/s and more, with this reaction to everything that leaves a choice.
fn moving(reaction: Reaction) -> Bench {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    for parameter in [
        Parameter::HostReaction,
        Parameter::FollowingReaction,
        Parameter::BusReaction,
    ] {
        bench.set(parameter, u8::from(reaction).into());
    }
    assert_eq!(bench.go(10.0, 7_000), Outcome::Accepted);
    bench.run(3_000);
    assert!(bench.velocity() > 15.0, "{}", bench.velocity());
    bench.reports.clear();
    bench
}

/// Runs until a fault is latched, at most for a second.
#[track_caller]
fn until_latched(bench: &mut Bench) {
    for _ in 0..1_000 {
        if bench.axis.fault().is_some() {
            return;
        }
        bench.step();
    }
    panic!("nothing was latched");
}

/// Nothing moves from here on, without torque, until somebody clears and enables.
#[track_caller]
fn ends_in(bench: &mut Bench, fault: Fault) {
    assert_eq!(bench.axis.state(), State::Fault);
    assert_eq!(bench.axis.fault(), Some(fault));
    assert!(!bench.command.enable);
    let told = |report: &&Report| matches!(report, Report::Fault { .. });
    let faults: Vec<_> = bench.reports.iter().filter(told).collect();
    assert!(
        matches!(faults[..], [Report::Fault { fault: number, .. }] if *number == u8::from(fault)),
        "{faults:?}"
    );
    bench.stays(300);
    mend(bench);
    bench.stays(300);
    assert_eq!(bench.axis.fault(), Some(fault));
    // A silent host has lost the axis.
    let _: Outcome = bench.control(Action::Hold);
    let latched = Outcome::Rejected(Reason::FaultLatched);
    assert_eq!(bench.control(Action::Enable), latched);
    assert_eq!(bench.go(0.0, 5_000), latched);
    bench.stays(300);
    assert_eq!(bench.control(Action::Clear), Outcome::Accepted);
    for _ in 0..300 {
        bench.step();
        assert!(!bench.command.enable);
        assert_eq!(bench.velocity(), 0.0);
    }
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    bench.run(10);
    assert_eq!(bench.axis.state(), State::OperationEnabled);
    let place = bench.setpoint.position;
    assert!((place - bench.drive_position()).abs() < turns(1e-6));
    bench.stays(1_000);
    assert_eq!(bench.go(1.0, 5_000), Outcome::Accepted);
}

/// The axis is in its reaction: it comes to rest as that says.
#[track_caller]
fn comes_to_rest(bench: &mut Bench, reaction: Reaction) {
    let limits = *bench.axis.limits();
    let (deceleration, jerk) = (limits.deceleration().radians(), limits.jerk().radians());
    if reaction == Reaction::Disable {
        assert_eq!(bench.axis.state(), State::Fault);
        return;
    }
    assert_eq!(bench.axis.state(), State::FaultReactionActive);
    let (speed, place) = (bench.velocity(), bench.place());
    let most = match reaction {
        Reaction::QuickStop => (speed / deceleration * 1e3).ceil() as u64 + 1,
        _ => stopping_ticks(speed, &limits),
    };
    let begin = bench.tick;
    while bench.axis.is_moving() {
        let before = bench.setpoint.acceleration.radians();
        bench.step();
        assert!(
            bench.tick - begin <= most,
            "{} of {most}",
            bench.tick - begin
        );
        assert!(bench.command.enable || !bench.axis.is_moving());
        let now = bench.setpoint.acceleration.radians();
        if reaction == Reaction::ControlledStop {
            assert!((now - before).abs() <= jerk * 1.001e-3, "{before} {now}");
        } else if bench.tick > begin + 1 && bench.velocity() != 0.0 {
            assert!((now + deceleration).abs() < 1e-6, "{now}");
        }
    }
    if reaction == Reaction::QuickStop {
        let way = (bench.place() - place) * std::f64::consts::TAU;
        let most = speed * speed / (2.0 * deceleration) + 1e-6;
        assert!((0.0..=most).contains(&way), "{way} {most}");
    }
    bench.run(1);
}

#[test]
fn every_fault_ends_as_its_reaction_says() {
    for fault in CHOICES {
        for reaction in REACTIONS {
            let mut bench = moving(reaction);
            trouble(&mut bench, fault);
            until_latched(&mut bench);
            assert_eq!(bench.axis.fault(), Some(fault), "{reaction:?}");
            comes_to_rest(&mut bench, reaction);
            // A frame or the owner comes between two ticks: torque goes at the next one.
            bench.run(1);
            ends_in(&mut bench, fault);
        }
    }
}

#[test]
fn faults_without_a_choice_end_as_they_must() {
    for (fault, reaction) in [
        (Fault::EmergencyStop, Reaction::ControlledStop),
        (Fault::ParametersLost, Reaction::ControlledStop),
        (Fault::DriveLost, Reaction::Disable),
        (Fault::DriveFault, Reaction::Disable),
    ] {
        for set in REACTIONS {
            let mut bench = moving(set);
            trouble(&mut bench, fault);
            until_latched(&mut bench);
            assert_eq!(bench.axis.fault(), Some(fault));
            comes_to_rest(&mut bench, reaction);
            bench.run(1);
            ends_in(&mut bench, fault);
        }
    }
}

/// The second one hardens the reaction, and never softens it; the first one stays the cause.
#[test]
fn a_second_trouble_hardens_the_reaction_and_is_not_latched() {
    for first in REACTIONS {
        for second in REACTIONS {
            for after in [0, 1, 5, 20, 60] {
                let mut bench = moving(second);
                // The host's reaction is the first one's.
                let stop = Command::Stop { sequence: 0 };
                assert_eq!(bench.send(stop), Outcome::Accepted);
                bench.ticks_to_rest(1_000);
                bench.set(Parameter::HostReaction, u8::from(first).into());
                bench.set(Parameter::BusReaction, u8::from(second).into());
                assert_eq!(bench.go(14.0, 9_000), Outcome::Accepted);
                bench.run(3_500);
                bench.reports.clear();
                trouble(&mut bench, Fault::HostTimeout);
                until_latched(&mut bench);
                bench.run(after);
                trouble(&mut bench, Fault::DuplicateAxis);
                if bench.axis.is_moving() || first.max(second) == Reaction::Disable {
                    comes_to_rest(&mut bench, first.max(second));
                }
                bench.run(200);
                ends_in(&mut bench, Fault::HostTimeout);
            }
        }
    }
}

/// The harder stop does not wait for the softer one: not while that is to be planned, nor while it is
/// being planned, nor once it waits for its splice.
#[test]
fn a_quick_stop_takes_the_place_of_a_controlled_one_that_has_not_begun() {
    for (lead, delay) in [(0, 0), (20, 0), (12, 10), (20, 10), (100, 0)] {
        for after in [0, 1, 2, 4] {
            let mut bench = Bench::enabled(Limits::default(), 0.0);
            // A controlled stop takes much longer than a quick one.
            bench.set(Parameter::JerkLimit, 400 * 10_000);
            bench.set(Parameter::BusReaction, 1);
            assert_eq!(bench.go(10.0, 9_000), Outcome::Accepted);
            bench.run(4_000);
            let quick = (bench.velocity() / 200.0 * 1e3).ceil() as u64 + 2;
            assert!(quick > 40, "{quick}");
            bench.planner = Planner::slow(lead, delay);
            trouble(&mut bench, Fault::EmergencyStop);
            bench.run(after);
            trouble(&mut bench, Fault::DuplicateAxis);
            let most = quick + u64::from(lead) + 2 * u64::from(delay) + 4;
            bench.ticks_to_rest(most);
            bench.run(1);
            bench
                .reports
                .retain(|report| matches!(report, Report::Fault { .. }));
            bench.planner = Planner::default();
            ends_in(&mut bench, Fault::EmergencyStop);
        }
    }
}

/// A bus full of another node's reports must not keep the planner busy.
#[test]
fn the_same_trouble_again_leaves_nothing_to_plan() {
    for reaction in [Reaction::ControlledStop, Reaction::QuickStop] {
        let mut bench = moving(reaction);
        trouble(&mut bench, Fault::DuplicateAxis);
        bench.run(2);
        let frame = Report::Started {
            sequence: 0,
            time: bench.now(),
        }
        .encode(AXIS);
        let outcome = bench.axis.handle_frame(bench.now(), &frame);
        assert_eq!(outcome, Outcome::Ignored);
        assert!(bench.axis.is_moving());
        assert!(!bench.axis.has_plan(), "{reaction:?}");
    }
}

#[test]
fn a_stop_and_an_emergency_stop_do_not_soften_a_quick_stop() {
    for command in [Command::EmergencyStop, Command::Stop { sequence: 3 }] {
        for after in [0, 1, 2, 10, 40] {
            let mut bench = moving(Reaction::QuickStop);
            trouble(&mut bench, Fault::BusOff);
            let begin = bench.tick;
            let quick = (bench.velocity() / 200.0 * 1e3).ceil() as u64 + 2;
            bench.run(after);
            assert_eq!(bench.send(command), Outcome::Accepted);
            bench.ticks_to_rest(500);
            assert!(
                bench.tick - begin <= quick,
                "{} {quick}",
                bench.tick - begin
            );
            bench.run(1);
            ends_in(&mut bench, Fault::BusOff);
        }
    }
}

/// The default of following.reaction: what a drive that does not follow is told does not help.
#[test]
fn the_defaults_disable_a_drive_that_does_not_follow_and_stop_for_the_rest() {
    for fault in CHOICES {
        let mut bench = Bench::enabled(Limits::default(), 0.0);
        assert_eq!(bench.go(10.0, 7_000), Outcome::Accepted);
        bench.run(3_000);
        trouble(&mut bench, fault);
        until_latched(&mut bench);
        let disables = fault.reaction() == Some(Parameter::FollowingReaction);
        let expected = if disables {
            State::Fault
        } else {
            State::FaultReactionActive
        };
        assert_eq!(bench.axis.state(), expected, "{fault:?}");
    }
}

/// A move that is being planned, one that waits for its splice and one that is staged.
#[test]
fn no_reaction_leaves_anything_to_come() {
    for reaction in REACTIONS {
        for lead in [0, 5, 20] {
            let mut bench = moving(reaction);
            bench.planner = Planner::slow(lead, 3);
            let _: Outcome = bench.go(0.0, 7_000);
            bench.run(2);
            trouble(&mut bench, Fault::BusOff);
            bench.run(2_000);
            ends_in_place(&mut bench);
        }
        let mut bench = moving(reaction);
        let group = bench.stage(0.0, 7_000);
        trouble(&mut bench, Fault::BusOff);
        bench.run(500);
        assert_eq!(bench.trigger(group, 10), Outcome::Ignored);
        ends_in_place(&mut bench);
    }
}

#[track_caller]
fn ends_in_place(bench: &mut Bench) {
    assert_eq!(bench.axis.state(), State::Fault);
    let answers = answers(bench);
    let refused = |(_, reason): &(u8, Reason)| *reason == Reason::FaultLatched;
    assert!(
        answers
            .iter()
            .all(|answer| refused(answer) || answer.1 == Reason::Accepted)
    );
    bench.stays(1_000);
}

/// In mid-move of every kind, at any tick.
fn stopped_quickly(bench: &mut Bench, after: u64) -> Result<(), TestCaseError> {
    bench.run(after);
    let limits = *bench.axis.limits();
    let (speed, place) = (bench.velocity().abs(), bench.setpoint.position);
    trouble(bench, Fault::BusOff);
    let begin = bench.tick;
    let deceleration = limits.deceleration().radians();
    let most = (speed / deceleration * 1e3).ceil() as u64 + 1;
    while bench.axis.is_moving() {
        bench.step();
        prop_assert!(bench.tick - begin <= most, "{} {most}", bench.tick - begin);
    }
    let way = (bench.setpoint.position - place).abs().radians();
    let most = speed * speed / (2.0 * deceleration) + 1e-6;
    prop_assert!(way <= most, "{way} {most}");
    bench.run(2);
    prop_assert_eq!(bench.axis.state(), State::Fault);
    bench.stays(100);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn a_quick_stop_takes_the_time_and_the_way_of_the_deceleration_limit(
        profile in prop::sample::select(vec![ProfileKind::Beta, ProfileKind::Trapezoid, ProfileKind::SCurve]),
        targets in prop::collection::vec((-3.0..3.0f64, 1.0..2.0f64, 0u64..1_500), 1..4),
        deceleration in 5.0..500.0f64,
    ) {
        let mut bench = Bench::enabled(Limits::default(), 0.0);
        bench.set(Parameter::DecelerationLimit, (deceleration * 1e6) as i64);
        bench.set(Parameter::BusReaction, 1);
        let last = targets.len() - 1;
        for (index, (target, slower, after)) in targets.into_iter().enumerate() {
            let duration = ((target.abs() * 1_000.0 + 900.0) * slower) as u32;
            let sequence = bench.next();
            let _: Outcome = bench.send(Command::Move {
                profile,
                staged: false,
                target: turns(target),
                duration: Ticks(duration),
                sequence,
            });
            if index == last {
                stopped_quickly(&mut bench, after)?;
            } else {
                bench.run(after);
            }
        }
    }
}
