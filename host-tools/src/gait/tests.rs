use super::*;
use crate::robot::Robot;

const STEP: f64 = 1e-3;

fn quadruped() -> Quadruped {
    Quadruped::of(&Robot::default()).expect("four legs")
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

const TURNING: Body = Body {
    vx: 0.12,
    vy: 0.03,
    yaw_rate: 0.3,
    height: Quadruped::HEIGHT,
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
                    assert!(after.places[leg][2] > -1e-12, "{kind:?} {:?}", after.places);
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
