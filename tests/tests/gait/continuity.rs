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

/// Two states a short time apart agree as a motion of continuous acceleration does: the way
/// is that of both velocities, and the acceleration has not jumped.
fn joined(before: &State, after: &State, most_jerk: f64) -> Result<(), TestCaseError> {
    let step = after.time - before.time;
    for (axis, (from, to)) in values(before).zip(values(after)).enumerate() {
        let way = to[0] - from[0] - 0.5 * step * (from[1] + to[1]);
        let change = to[1] - from[1] - 0.5 * step * (from[2] + to[2]);
        let jump = to[2] - from[2];
        prop_assert!(
            way.abs() < most_jerk * step.powi(3) / 6.0 + 1e-10,
            "axis {} way {way} at {}",
            axis + 1,
            after.time
        );
        prop_assert!(
            change.abs() < most_jerk * step.powi(2) / 2.0 + 1e-8,
            "axis {} velocity {change} at {}",
            axis + 1,
            after.time
        );
        prop_assert!(
            jump.abs() < most_jerk * step,
            "axis {} acceleration {jump} at {}",
            axis + 1,
            after.time
        );
    }
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
        -0.25..0.25f64,
        -0.1..0.1f64,
        -0.6..0.6f64,
        0.16..0.19f64,
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
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn whatever_is_asked_no_joint_jumps(orders in orders()) {
        let quadruped = Quadruped::of(&Robot::default()).expect("four legs");
        let mut planner = Planner::new(quadruped, Body::standing(Quadruped::HEIGHT)).expect("it stands");
        let mut before = planner.advance(0.0).expect("it stands");
        let step = 2e-4;
        let mut index = 0u32;
        let mut until = 0.0;
        for (pause, order) in orders.into_iter().chain([(1.0, Order::Stop), (6.0, Order::Stop)]) {
            until += pause;
            while f64::from(index + 1) * step <= until {
                index += 1;
                let after = planner.advance(f64::from(index) * step).map_err(|error| TestCaseError::fail(error.to_string()))?;
                joined(&before, &after, 1.5e5)?;
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
