//! Knots that are lost: sent again where that helps, and where it does not, a stop.

use crate::{SECONDS, all_faults, knots, robot};
use canter::client::{ClientError, Pace, StreamKnot};
use canter_shared::wire::command::Command;
use canter_shared::wire::id::{Address, AxisId};

/// Swings of 5 Hz around where they began, from rest to rest: near the limit of acceleration.
fn swings() -> impl Iterator<Item = Vec<StreamKnot>> {
    let (rate, length) = (10.0 * std::f64::consts::PI, 0.25);
    (1..=100).map(move |number| {
        let seconds = f64::from(number) * 0.02;
        // Both come in and go out over a quarter of a second.
        let near = seconds.min(SECONDS - seconds) / length;
        let u = near.clamp(0.0, 1.0);
        let share = u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
        let inward = if seconds < SECONDS / 2.0 { 1.0 } else { -1.0 };
        let growth = inward * 30.0 * u * u * (1.0 - u) * (1.0 - u) / length;
        let (sin, cos) = (rate * seconds).sin_cos();
        let height = 0.17;
        vec![
            StreamKnot {
                position: height * share * sin,
                velocity: height * (growth * sin + share * rate * cos),
            };
            12
        ]
    })
}

#[test]
fn knots_that_no_curve_may_bridge_are_sent_again() {
    let third = AxisId::new(3).expect("an axis");
    let mut lost = vec![50, 49, 48];
    let mut robot = robot(move |address, command| match command {
        Command::Knot { number, .. }
            if address == Address::Axis(third) && lost.last() == Some(&number) =>
        {
            lost.pop();
            None
        }
        _ => Some(command),
    });
    let axes = robot.axes.clone();
    let ends = robot.client.stream(&axes, Pace::default(), swings());
    let ends = ends.expect("arrives");
    assert!(ends.iter().all(|end| end.missing == 0), "{ends:?}");
    let rejected = robot.client.axes()[&third].counters.rejected;
    assert!(rejected > 0, "a curve over four periods was taken");
    assert_eq!(all_faults(&mut robot), [None; 12]);
}

#[test]
fn a_last_knot_that_is_lost_is_sent_again() {
    let mut lost = 0;
    let mut robot = robot(move |_, command| {
        // 100 knots: the last has number 100 - 64.
        let is_last = matches!(command, Command::Knot { number: 36, .. });
        lost += u32::from(is_last);
        // The same number came once before; then twelve last knots are lost, twice.
        (!is_last || lost <= 12 || lost > 36).then_some(command)
    });
    let axes = robot.axes.clone();
    let ends = robot
        .client
        .stream(&axes, Pace::default(), knots(SECONDS))
        .expect("arrives");
    assert!(ends.iter().all(|end| end.missing == 0), "{ends:?}");
    assert_eq!(all_faults(&mut robot), [None; 12]);
}

#[test]
fn a_bus_that_loses_too_much_ends_the_stream_without_a_fault() {
    let mut count = 0u32;
    let mut robot = robot(move |_, command| {
        let is_knot = matches!(command, Command::Knot { .. });
        count += u32::from(is_knot);
        (!is_knot || !count.is_multiple_of(5)).then_some(command)
    });
    let axes = robot.axes.clone();
    let error = robot
        .client
        .stream(&axes, Pace::default(), knots(SECONDS))
        .expect_err("too many");
    assert!(
        matches!(
            error,
            ClientError::Lossy {
                lost: 11,
                of: 100,
                ..
            }
        ),
        "{error}"
    );
    assert_eq!(all_faults(&mut robot), [None; 12]);
    let mut axes = robot.client.axes().values();
    assert!(axes.all(|known| known.moving == Some(false)));
}
