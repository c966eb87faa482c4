//! What is sent, whatever else is waiting.

use super::bench::{AXIS, Bench, beta, control, frame};
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::axis::{Axis, Outcome};
use canter_shared::drive::simulated::Simulated;
use canter_shared::drive::{Condition, Drive, DriveReport};
use canter_shared::limits::Limits;
use canter_shared::time::{BusTime, Tick};
use canter_shared::units::{Position, Velocity};
use canter_shared::wire::command::{Action, Command};
use canter_shared::wire::id::Address;
use canter_shared::wire::report::Report;

/// All that waits to be sent.
fn drain(axis: &mut Axis) -> Vec<Report> {
    core::iter::from_fn(|| axis.poll_transmit())
        .filter_map(|frame| Report::decode(&frame).ok().flatten())
        .map(|(_, report)| report)
        .collect()
}

/// An axis that is enabled at tick 20 and whose queue nobody empties.
fn enabled() -> (Axis, Simulated) {
    let mut axis = Axis::new(AXIS, Limits::default());
    let mut drive = Simulated::new(Position::ZERO);
    for tick in 1..=20 {
        if tick == 5 {
            for command in [control(1, Action::Hold), control(2, Action::Enable)] {
                let outcome = axis.handle_frame(BusTime(tick * 1_000), &frame(command));
                assert_eq!(outcome, Outcome::Accepted);
            }
        }
        step(&mut axis, &mut drive, tick);
    }
    assert_eq!(axis.state(), State::OperationEnabled);
    drain(&mut axis);
    (axis, drive)
}

fn step(axis: &mut Axis, drive: &mut Simulated, tick: u64) {
    axis.handle_drive(drive.report());
    axis.tick(Tick(tick), BusTime(tick * 1_000));
    drive.command(Tick(tick), axis.drive_command());
}

fn flood(axis: &mut Axis) {
    for sequence in 0..20 {
        let stop = Command::Stop { sequence }.encode(Address::All);
        let outcome = axis.handle_frame(BusTime(0), &stop.expect("fits"));
        assert_eq!(outcome, Outcome::Accepted);
    }
}

#[test]
fn the_fault_comes_through_a_full_queue() {
    let (mut axis, _) = enabled();
    flood(&mut axis);
    let stop = Command::EmergencyStop.encode(Address::All).expect("fits");
    assert_eq!(axis.handle_frame(BusTime(0), &stop), Outcome::Accepted);
    let reports = drain(&mut axis);
    let fault = Report::Fault {
        fault: Fault::EmergencyStop.into(),
        time: BusTime(20_000),
    };
    assert_eq!(reports.first(), Some(&fault), "{reports:?}");
}

#[test]
fn started_comes_through_a_full_queue() {
    let (mut axis, mut drive) = enabled();
    flood(&mut axis);
    let outcome = axis.handle_frame(BusTime(20_000), &frame(beta(3, 1.0, 1_000)));
    assert_eq!(outcome, Outcome::Planning);
    assert_eq!(axis.plan(), Some(Outcome::Accepted));
    step(&mut axis, &mut drive, 21);
    let reports = drain(&mut axis);
    let started = Report::Started {
        sequence: 3,
        time: BusTime(21_000),
    };
    assert!(reports.contains(&started), "{reports:?}");
}

#[test]
fn eight_answers_wait_and_the_ninth_is_dropped() {
    let (mut axis, _) = enabled();
    flood(&mut axis);
    let reports = drain(&mut axis);
    let answered: Vec<u8> = reports
        .iter()
        .filter_map(|report| match report {
            Report::Acknowledgement { sequence, .. } => Some(*sequence),
            _ => None,
        })
        .collect();
    assert_eq!(answered, (0..8).collect::<Vec<u8>>());
}

#[test]
fn only_the_first_fault_is_told_once() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    for _ in 0..3 {
        assert_eq!(bench.send(Command::EmergencyStop), Outcome::Accepted);
        bench.run(5);
    }
    bench.condition = Some(Condition::Lost);
    bench.run(5);
    let faults = bench.reports.iter();
    let faults = faults.filter(|report| matches!(report, Report::Fault { .. }));
    assert_eq!(faults.count(), 1);
}

#[test]
fn refusals_are_counted() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    for _ in 0..300 {
        let _: Outcome = bench.go(5_000.0 / 5.0 + 1.0, 1_000);
    }
    bench.reports.clear();
    bench.run(200);
    let rejected = bench.reports.iter().rev().find_map(|report| match report {
        Report::Heartbeat { rejected, .. } => Some(*rejected),
        _ => None,
    });
    assert_eq!(rejected, Some((300 % 256) as u8));
}

#[test]
fn feedback_and_heartbeat_come_at_their_rates() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    bench.reports.clear();
    bench.run(1_000);
    let count = |wanted: fn(&Report) -> bool| bench.reports.iter().filter(|r| wanted(r)).count();
    assert_eq!(
        count(|report| matches!(report, Report::Feedback { .. })),
        50
    );
    assert_eq!(
        count(|report| matches!(report, Report::Heartbeat { .. })),
        10
    );
}

/// A velocity of less than half a step is told as none, in both directions.
#[test]
fn feedback_is_rounded_to_the_nearest_step() {
    let step = 1 << 18;
    for (counts, steps) in [
        (1, 0),
        (-1, 0),
        (step / 2 - 1, 0),
        (-step / 2, 0),
        (step / 2, 1),
        (-step / 2 - 1, -1),
        (7 * step, 7),
        (-7 * step, -7),
    ] {
        let mut axis = Axis::new(AXIS, Limits::default());
        axis.handle_drive(DriveReport {
            condition: Condition::Disabled,
            position: Position::ZERO,
            velocity: Velocity::from_counts(counts),
        });
        axis.tick(Tick(1), BusTime(1_000));
        let told = drain(&mut axis)
            .into_iter()
            .find_map(|report| match report {
                Report::Feedback { velocity, .. } => Some(velocity),
                _ => None,
            });
        assert_eq!(told, Some(Velocity::from_counts(steps * step)), "{counts}");
    }
}
