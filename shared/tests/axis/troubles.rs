//! Troubles of every kind, at any tick, one after the other, with any reaction to each: the first
//! one is the cause, the hardest reaction so far holds, and the end is rest without torque.

use super::bench::{Bench, stopping_ticks, turns};
use super::planner::Planner;
use super::reaction::{CHOICES, trouble};
use canter_shared::axis::Outcome;
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::limits::Limits;
use canter_shared::parameter::{Parameter, Reaction};
use canter_shared::time::Ticks;
use canter_shared::wire::command::{Command, ProfileKind};
use proptest::prelude::*;
use std::cell::Cell;

/// Everything that can go wrong with an axis that is enabled, those without a choice among it.
fn faults() -> Vec<Fault> {
    let mut faults = CHOICES.to_vec();
    faults.extend([Fault::EmergencyStop, Fault::DriveLost, Fault::DriveFault]);
    faults
}

#[derive(Debug, Clone)]
struct Case {
    /// Velocity, acceleration, deceleration in rad and seconds, and the jerk as a multiple.
    limits: [f64; 4],
    /// To host, following and bus.
    reactions: [Reaction; 3],
    profile: ProfileKind,
    target: f64,
    slower: f64,
    /// When each begins, after the one before.
    troubles: Vec<(u64, Fault)>,
}

fn case() -> impl Strategy<Value = Case> {
    // Where torque goes at once there is nothing left to see.
    let reaction = || {
        prop_oneof![
            3 => Just(Reaction::ControlledStop),
            3 => Just(Reaction::QuickStop),
            1 => Just(Reaction::Disable),
        ]
    };
    let profiles = vec![
        ProfileKind::Beta,
        ProfileKind::Trapezoid,
        ProfileKind::SCurve,
    ];
    let rates = (2.0..30.0f64, 10.0..400.0f64, 10.0..100.0f64, 2.0..200.0f64);
    let first = (0u64..900, prop::sample::select(faults()));
    let more = (0u64..30, prop::sample::select(faults()));
    (
        rates,
        [reaction(), reaction(), reaction()],
        prop::sample::select(profiles),
        -3.0..3.0f64,
        1.0..3.0f64,
        (first, prop::collection::vec(more, 0..4)),
    )
        .prop_map(
            |(rates, reactions, profile, target, slower, (first, more))| Case {
                limits: [rates.0, rates.1, rates.2, rates.3],
                reactions,
                profile,
                target,
                slower,
                troubles: [first].into_iter().chain(more).collect(),
            },
        )
}

fn enabled(case: &Case) -> Bench {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let [velocity, acceleration, deceleration, times] = case.limits;
    let jerk = acceleration.max(deceleration) * times;
    for (parameter, value, steps) in [
        (Parameter::VelocityLimit, velocity, 1e9),
        (Parameter::AccelerationLimit, acceleration, 1e6),
        (Parameter::DecelerationLimit, deceleration, 1e6),
        (Parameter::JerkLimit, jerk, 1e4),
    ] {
        bench.set(parameter, (value * steps) as i64);
    }
    for (parameter, reaction) in [
        (Parameter::HostReaction, case.reactions[0]),
        (Parameter::FollowingReaction, case.reactions[1]),
        (Parameter::BusReaction, case.reactions[2]),
    ] {
        bench.set(parameter, u8::from(reaction).into());
    }
    let shortest = case.target.abs() * 20.0 / velocity + 0.5;
    let sequence = bench.next();
    let _: Outcome = bench.send(Command::Move {
        profile: case.profile,
        staged: false,
        target: turns(case.target),
        duration: Ticks((shortest * case.slower * 1e3) as u32),
        sequence,
    });
    bench
}

fn reaction(case: &Case, fault: Fault) -> Reaction {
    match fault.reaction() {
        Some(Parameter::HostReaction) => case.reactions[0],
        Some(Parameter::FollowingReaction) => case.reactions[1],
        Some(Parameter::BusReaction) => case.reactions[2],
        _ if matches!(fault, Fault::DriveLost | Fault::DriveFault) => Reaction::Disable,
        _ => Reaction::ControlledStop,
    }
}

/// Those that are there at the next tick at the latest; silence and a drive that is away take time.
fn comes_at_once(fault: Fault) -> bool {
    !matches!(fault, Fault::HostTimeout | Fault::FollowingError)
}

/// Gives the reaction that the axis came to, and whether that was harder than the first one.
fn play(case: &Case) -> Result<(Reaction, bool), TestCaseError> {
    let mut bench = enabled(case);
    let limits = *bench.axis.limits();
    let mut cause = None;
    let mut harshest: Option<(Reaction, u64)> = None;
    let mut hardened = false;
    for (after, fault) in &case.troubles {
        let watched = bench.tick + after;
        while bench.tick < watched {
            bench.step();
            if cause.is_none() && bench.axis.fault().is_some() {
                // Its time was up before the next one came.
                cause = bench.axis.fault();
                let reaction = reaction(case, cause.expect("a fault"));
                let most = most_ticks(&bench, reaction, &limits);
                harshest = Some((reaction, bench.tick + most));
            }
        }
        trouble(&mut bench, *fault);
        if comes_at_once(*fault) {
            bench.step();
            prop_assert!(bench.axis.fault().is_some(), "{fault:?}");
            cause = cause.or(bench.axis.fault());
            let reaction = reaction(case, *fault);
            if harshest.is_none_or(|(harshest, _)| harshest < reaction) {
                hardened |= harshest.is_some() && bench.axis.state() != State::Fault;
                let most = most_ticks(&bench, reaction, &limits);
                harshest = Some((reaction, bench.tick + most));
            }
            if harshest.is_some_and(|(harshest, _)| harshest == Reaction::Disable) {
                prop_assert_eq!(bench.axis.state(), State::Fault);
            }
        }
        prop_assert_eq!(bench.axis.fault(), cause);
    }
    for _ in 0..1_000 {
        if cause.is_some() {
            break;
        }
        bench.step();
        cause = bench.axis.fault();
        if let Some(fault) = cause {
            let reaction = reaction(case, fault);
            let most = most_ticks(&bench, reaction, &limits);
            harshest = Some((reaction, bench.tick + most));
        }
    }
    let (harshest, end) = harshest.expect("something has gone wrong");
    while bench.axis.state() != State::Fault {
        prop_assert_eq!(bench.axis.state(), State::FaultReactionActive);
        prop_assert!(bench.tick <= end, "{harshest:?} at {} of {end}", bench.tick);
        bench.step();
    }
    prop_assert_eq!(bench.axis.fault(), cause);
    bench.stays(400);
    prop_assert!(!bench.command.enable);
    prop_assert_eq!(bench.axis.state(), State::Fault);
    Ok((harshest, hardened))
}

/// Ticks until rest and one more, in which torque goes, from what the axis does now.
fn most_ticks(bench: &Bench, reaction: Reaction, limits: &Limits) -> u64 {
    match reaction {
        Reaction::ControlledStop => {
            // An acceleration is taken back first, and carries the axis on to a higher speed.
            let acceleration = bench.setpoint.acceleration.abs().radians();
            let back = acceleration / limits.jerk().radians();
            let speed = bench.velocity().abs() + 0.5 * acceleration * back;
            stopping_ticks(speed, limits) + (back * 1e3).ceil() as u64 + 1
        }
        Reaction::QuickStop => {
            let seconds = bench.velocity().abs() / limits.deceleration().radians();
            (seconds * 1e3).ceil() as u64 + 2
        }
        Reaction::Disable => 0,
    }
}

#[test]
fn all_troubles_end_in_rest_with_the_first_one_latched() {
    let seen = Cell::new([0u32; 4]);
    let config = ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(2_000)
    };
    proptest!(config, |(case in case())| {
        let (reaction, hardened) = play(&case)?;
        let mut counts = seen.get();
        counts[usize::from(u8::from(reaction))] += 1;
        counts[3] += u32::from(hardened);
        seen.set(counts);
    });
    // A test in which nothing hardens proves little.
    assert!(
        seen.get().iter().all(|count| *count > 50),
        "{:?}",
        seen.get()
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    /// With a planner that is late or loses plans, the stop is late too; the bench holds every
    /// setpoint to the limits, and the end is the same.
    #[test]
    fn a_late_planner_changes_nothing_but_the_time(
        case in case(),
        lead in 0u32..8,
        delays in prop::collection::vec(prop_oneof![9 => (0u8..60).prop_map(Some), 1 => Just(None)], 1..8),
    ) {
        let mut bench = enabled(&case);
        // Some plan comes back some day.
        let mut delays = delays;
        delays.push(Some(0));
        let mut first = None;
        for (after, fault) in &case.troubles {
            bench.run(*after);
            bench.planner = Planner::erratic(lead, delays.clone());
            trouble(&mut bench, *fault);
            first = first.or(bench.axis.fault());
        }
        let mut left = 5_000;
        while bench.axis.state() != State::Fault && left > 0 {
            bench.step();
            first = first.or(bench.axis.fault());
            left -= 1;
        }
        prop_assert_eq!(bench.axis.state(), State::Fault);
        prop_assert_eq!(first.is_some(), true);
        bench.stays(200);
    }
}
