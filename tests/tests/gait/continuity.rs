//! Gaits: whatever is asked of the planner and whenever, no joint jumps.

use canter::gait::{Body, Gait, Kind, Planner, Quadruped, State};
use canter::robot::Robot;
use proptest::prelude::*;

/// Every value of every joint.
fn values(state: &State) -> impl Iterator<Item = [f64; 3]> + '_ {
    state.joints.iter().flat_map(|joints| {
        (0..3).map(|axis| {
            [
                joints.position[axis],
                joints.velocity[axis],
                joints.acceleration[axis],
            ]
        })
    })
}

/// How far ahead a rate is compared with what it is the rate of, in s.
const SHORT: f64 = 1e-6;

/// The velocities and accelerations are those of the positions and velocities, and the
/// accelerations do not jump.
fn joined(before: &Planner, from: &State, to: &State) -> Result<(), TestCaseError> {
    let soon = before.clone().advance(from.time + SHORT);
    let soon = soon.map_err(|error| TestCaseError::fail(error.to_string()))?;
    for (axis, (one, other)) in values(from).zip(values(&soon)).enumerate() {
        let (name, time) = (axis + 1, from.time);
        let velocity = (other[0] - one[0]) / SHORT - one[1];
        let acceleration = (other[1] - one[1]) / SHORT - one[2];
        prop_assert!(
            velocity.abs() < 2e-3,
            "axis {name} at {time}: its velocity is {velocity} off"
        );
        prop_assert!(
            acceleration.abs() < 0.2,
            "axis {name} at {time}: its acceleration is {acceleration} off"
        );
    }
    for (axis, (one, other)) in values(from).zip(values(to)).enumerate() {
        if (other[2] - one[2]).abs() > 1.0 {
            no_jump(before.clone(), from, to, axis)?;
        }
    }
    Ok(())
}

/// Halves the time again and again, towards the larger change of the acceleration: of a change
/// nothing is left, of a jump all of it.
fn no_jump(
    mut planner: Planner,
    from: &State,
    to: &State,
    axis: usize,
) -> Result<(), TestCaseError> {
    let acceleration = |state: &State| values(state).nth(axis).map_or(0.0, |value| value[2]);
    let (mut early, mut late) = (from.time, to.time);
    let (mut low, mut high) = (acceleration(from), acceleration(to));
    for _ in 0..18 {
        let time = 0.5 * (early + late);
        let mut ahead = planner.clone();
        let state = ahead
            .advance(time)
            .map_err(|error| TestCaseError::fail(error.to_string()))?;
        let middle = acceleration(&state);
        if (middle - low).abs() > (high - middle).abs() {
            (late, high) = (time, middle);
        } else {
            (early, low, planner) = (time, middle, ahead);
        }
    }
    let jump = high - low;
    prop_assert!(
        jump.abs() < 0.02,
        "axis {} at {late}: its acceleration jumps by {jump}",
        axis + 1
    );
    Ok(())
}

#[derive(Debug, Clone)]
enum Order {
    Command(Body),
    Walk(usize, f64),
    Stop,
}

fn orders() -> impl Strategy<Value = Vec<(f64, Order)>> {
    let command = (
        -0.12..0.12f64,
        -0.05..0.05f64,
        -0.25..0.25f64,
        0.24..0.3f64,
        -0.05..0.05f64,
        -0.05..0.05f64,
    );
    let command = command.prop_map(|(vx, vy, yaw_rate, height, roll, pitch)| {
        Order::Command(Body {
            vx,
            vy,
            yaw_rate,
            height,
            roll,
            pitch,
        })
    });
    let order = prop_oneof![
        4 => command,
        3 => (1..7usize, 0.0..0.003f64).prop_map(|(kind, stance)| Order::Walk(kind, stance)),
        1 => Just(Order::Stop),
    ];
    prop::collection::vec((0.0..1.5f64, order), 1..12)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(5))]

    #[test]
    fn whatever_is_asked_no_joint_jumps(orders in orders()) {
        let quadruped = Quadruped::of(&Robot::default()).expect("four legs");
        let mut planner = Planner::new(quadruped, Body::standing(Quadruped::HEIGHT)).expect("it stands");
        let mut before = planner.advance(0.0).expect("it stands");
        let step = 1e-3;
        let mut index = 0u32;
        let mut until = 0.0;
        for (pause, order) in orders.into_iter().chain([(1.0, Order::Stop), (4.0, Order::Stop)]) {
            until += pause;
            while f64::from(index + 1) * step <= until {
                index += 1;
                let earlier = planner.clone();
                let after = planner.advance(f64::from(index) * step).map_err(|error| TestCaseError::fail(error.to_string()))?;
                joined(&earlier, &before, &after)?;
                before = after;
            }
            match order {
                Order::Command(body) => planner.command(&body).expect("in range"),
                Order::Walk(kind, stance) => {
                    let gait = Gait { stance, ..Kind::ALL[kind].gait().expect("it walks") };
                    planner.walk(&gait).expect("a gait");
                }
                Order::Stop => planner.stop(),
            }
        }
        prop_assert!(planner.is_standing(), "it has not stopped");
        for foot in &before.feet {
            for value in foot.velocity.iter().chain(&foot.acceleration) {
                prop_assert!(value.abs() < 1e-12, "it moves: {value}");
            }
        }
    }
}
