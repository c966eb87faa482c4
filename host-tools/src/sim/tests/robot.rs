use canter_shared::axis::state::State;
use canter_shared::wire::id::Function;
use canter_shared::wire::reason::Reason;

use super::*;

#[test]
fn one_seed_gives_the_same_bytes_and_another_does_not() {
    let run = |seed| {
        let mut host = Host::seeded(seed);
        host.move_all();
        let setpoints = host.record.borrow().setpoints.clone();
        (host.log(), setpoints)
    };
    let (log, setpoints) = run(1);
    assert_eq!(run(1), (log.clone(), setpoints.clone()));
    let (other_log, other_setpoints) = run(2);
    assert_ne!(log, other_log);
    assert_ne!(setpoints, other_setpoints);
}

#[test]
fn twelve_axes_are_held_enabled_moved_and_arrive() {
    let mut host = Host::seeded(1);
    host.move_all();
    let answers = |wanted: Function| {
        let answer = |(_, _, report): &&(BusTime, AxisId, Report)| {
            matches!(report, Report::Acknowledgement { function, reason, .. }
                if *function == wanted && *reason == Reason::Accepted)
        };
        host.heard.iter().filter(answer).count()
    };
    assert_eq!(answers(Function::Control), 24);
    assert_eq!(answers(Function::StageBeta), 12);
    assert_eq!(answers(Function::Trigger), 12);
    let mut started = Vec::new();
    for axis in (1..=12).filter_map(AxisId::new) {
        let last = host
            .heard
            .iter()
            .rev()
            .find_map(|(_, from, report)| match report {
                Report::Feedback {
                    position, moving, ..
                } if *from == axis => Some((*position, *moving)),
                _ => None,
            });
        let (position, moving) = last.expect("feedback");
        assert!(!moving, "axis {axis}");
        // The encoder of 2^20 counts shows the nearest of its own.
        let off = (position - target(axis)).abs();
        assert!(
            off <= Position::from_counts(1 << 11),
            "axis {axis}: {off:?}"
        );
        started.extend(
            host.heard
                .iter()
                .filter_map(|(_, from, report)| match report {
                    Report::Started { time, .. } if *from == axis => Some(time.0),
                    _ => None,
                }),
        );
    }
    assert_eq!(started.len(), 12);
}

/// What a move really is: when, in true time, each axis left.
#[test]
fn the_axes_leave_together_in_true_time() {
    let mut host = Host::seeded(1);
    host.wait(3_000_000);
    host.move_all();
    let record = host.record.borrow();
    let mut left = Vec::new();
    for axis in (1..=12).filter_map(AxisId::new) {
        let leaves = record.setpoints.iter().find(|(_, setpoint)| {
            setpoint.axis == axis && setpoint.setpoint.velocity.counts() != 0
        });
        left.push(leaves.expect("every axis moves").0.0);
    }
    let skew = left.iter().max().expect("12 axes") - left.iter().min().expect("12 axes");
    assert!(skew < 20_000, "skew {skew} ns");
}

#[test]
fn each_axis_has_one_setpoint_for_each_tick() {
    let mut host = Host::seeded(4);
    host.move_all();
    let record = host.record.borrow();
    for axis in (1..=12).filter_map(AxisId::new) {
        let ticks: Vec<Tick> = record
            .setpoints
            .iter()
            .filter(|(_, setpoint)| setpoint.axis == axis)
            .map(|(_, setpoint)| setpoint.tick)
            .collect();
        assert!(ticks.len() > 1_000);
        assert!(ticks.windows(2).all(|pair| pair[1].0 == pair[0].0 + 1));
    }
    let last = record.setpoints.last().map(|(_, setpoint)| setpoint.state);
    assert_eq!(last, Some(State::OperationEnabled));
}

#[test]
fn sync_brings_the_clocks_together() {
    for seed in 0..8 {
        let mut host = Host::seeded(seed);
        host.wait(4_000_000);
        let mut worst = (0, 0);
        for _ in 0..300 {
            host.wait(10_007);
            let now = host.bus.now().0 as i64;
            let late: Vec<i64> = host
                .bus
                .node_times()
                .map(|time| now - time.0 as i64)
                .collect();
            let most = *late.iter().max().expect("12 nodes");
            let least = *late.iter().min().expect("12 nodes");
            worst = (worst.0.max(most - least), worst.1.max(most.abs()));
        }
        // Against each other; all are late by the frame that carries SYNC, 111 to 135 bits.
        assert!(worst.0 <= 20, "seed {seed}: apart by {} us", worst.0);
        assert!(worst.1 <= 155, "seed {seed}: late by {} us", worst.1);
    }
}
