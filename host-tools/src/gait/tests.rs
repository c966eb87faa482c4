use super::*;
use crate::robot::Robot;
use proptest::prelude::*;

const STEP: f64 = 1e-3;

fn quadruped() -> Quadruped {
    Quadruped::of(&Robot::default()).expect("twelve axes")
}

fn planner() -> Planner {
    Planner::new(quadruped(), Body::standing(Quadruped::HEIGHT)).expect("it stands")
}

fn gait(kind: Kind) -> Gait {
    kind.gait().expect("a gait that walks")
}

fn walking(kind: Kind, body: &Body) -> Planner {
    let mut planner = planner();
    planner.command(body).expect("a command");
    planner.walk(&gait(kind)).expect("a gait");
    planner
}

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
        0.18..0.21f64,
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
        let mut planner = planner();
        let mut before = planner.advance(0.0).expect("it stands");
        // A tenth of the step shows a jump ten times as clearly against the jerk.
        let step = STEP / 5.0;
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
                    let gait = Gait { stance, ..gait(Kind::ALL[kind]) };
                    planner.walk(&gait).expect("a gait");
                }
                Order::Stop => planner.stop(),
            }
        }
        prop_assert!(planner.is_standing(), "it has not stopped");
        for (foot, mount) in before.feet.iter().zip(quadruped().mounts) {
            let x = foot.velocity.iter().chain(&foot.acceleration).fold(0.0f64, |most, value| most.max(value.abs()));
            prop_assert!(x < 1e-12, "it moves: {x}");
            prop_assert!(mount.joint_motion(foot).is_ok());
        }
    }
}

const TURNING: Body = Body {
    vx: 0.3,
    vy: 0.05,
    yaw_rate: 0.4,
    height: 0.2,
    roll: 0.05,
    pitch: -0.03,
};

#[test]
fn a_steady_cycle_repeats_itself() {
    for kind in Kind::ALL.into_iter().skip(1) {
        let mut planner = walking(kind, &TURNING);
        let period = gait(kind).period;
        let states = |planner: &mut Planner, from: f64| -> Vec<State> {
            (0..100)
                .map(|part| {
                    planner
                        .advance(from + period * f64::from(part) / 100.0)
                        .expect("reach")
                })
                .collect()
        };
        let first = states(&mut planner, 6.0 * period);
        let second = states(&mut planner, 9.0 * period);
        for (one, other) in first.iter().zip(&second) {
            for (one, other) in values(one).zip(values(other)) {
                for (order, size) in [1e-10, 1e-8, 1e-6].into_iter().enumerate() {
                    assert!(
                        (one[order] - other[order]).abs() < size,
                        "{kind:?} {order}: {one:?} {other:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn feet_stand_still_and_clear_the_ground_at_their_times() {
    for kind in Kind::ALL.into_iter().skip(1) {
        let gait = gait(kind);
        let mut planner = walking(kind, &TURNING);
        let from = 4.0 * gait.period;
        let mut before = planner.advance(from).expect("reach");
        let mut grounded = [0.0; LEGS];
        let mut highest = [0.0f64; LEGS];
        let mut down = [f64::NAN; LEGS];
        for index in 1..=2_000 {
            let after = planner
                .advance(from + gait.period * f64::from(index) / 2_000.0)
                .expect("reach");
            for leg in 0..LEGS {
                highest[leg] = highest[leg].max(after.places[leg][2]);
                if after.grounded[leg] {
                    grounded[leg] += 1.0 / 2_000.0;
                    if before.grounded[leg] {
                        assert_eq!(after.places[leg], before.places[leg]);
                    } else {
                        down[leg] = f64::from(index) / 2_000.0;
                    }
                } else {
                    assert!(after.places[leg][2] >= 0.0);
                }
            }
            before = after;
        }
        for leg in 0..LEGS {
            assert!(
                (grounded[leg] - gait.duty).abs() < 2e-3,
                "{kind:?}: {grounded:?}"
            );
            assert!(
                (highest[leg] - gait.swing).abs() < 1e-5,
                "{kind:?}: {highest:?}"
            );
            let late = down[leg] - down[0] - (gait.offsets[leg] - gait.offsets[0]);
            assert!((late - late.round()).abs() < 2e-3, "{kind:?}: {down:?}");
        }
    }
}

#[test]
fn the_motion_is_the_same_however_finely_it_is_looked_at() {
    let mut fine = walking(Kind::Gallop, &TURNING);
    let mut coarse = walking(Kind::Gallop, &TURNING);
    for index in 1..=2_000 {
        let seen = fine.advance(f64::from(index) * STEP).expect("reach");
        if index == 2_000 {
            let same = coarse.advance(seen.time).expect("reach");
            for (one, other) in values(&seen).zip(values(&same)) {
                assert!((one[0] - other[0]).abs() < 1e-9, "{one:?} {other:?}");
            }
        }
    }
}

#[test]
fn what_cannot_be_is_refused_and_changes_nothing() {
    let mut planner = walking(Kind::Trot, &TURNING);
    planner.advance(1.0).expect("reach");
    let mut same = planner.clone();
    let trot = gait(Kind::Trot);
    for bad in [f64::NAN, f64::INFINITY, -1.0, 1e9] {
        assert!(
            planner
                .walk(&Gait {
                    period: bad,
                    ..trot
                })
                .is_err()
        );
        assert!(planner.walk(&Gait { duty: bad, ..trot }).is_err());
        assert!(planner.walk(&Gait { swing: bad, ..trot }).is_err());
        assert!(
            planner
                .walk(&Gait {
                    stance: bad,
                    ..trot
                })
                .is_err()
        );
        assert!(
            planner
                .walk(&Gait {
                    overlay: bad,
                    ..trot
                })
                .is_err()
        );
        assert!(
            planner
                .walk(&Gait {
                    offsets: [bad; 4],
                    ..trot
                })
                .is_err()
        );
        assert!(
            planner
                .command(&Body {
                    height: bad,
                    ..TURNING
                })
                .is_err()
        );
        assert!(planner.advance(bad).is_err());
    }
    assert_eq!(planner.advance(1.5), same.advance(1.5));
}

#[test]
fn a_foot_out_of_reach_says_which_leg_and_when() {
    let mut planner = walking(Kind::Walk, &Body { vx: 2.0, ..TURNING });
    let error = (1..4_000).find_map(|index| planner.advance(f64::from(index) * STEP).err());
    let words = error.expect("too fast for a walk").to_string();
    assert!(
        words.contains("leg ") && words.contains("mm too far"),
        "{words}"
    );
}
