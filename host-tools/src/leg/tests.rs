//! Both legs against the published planner's numbers and against themselves.

use super::*;
use std::f64::consts::PI;

const LEGS: [Leg; 2] = [
    Leg::FiveBar(FiveBar::PUBLISHED),
    Leg::Serial(Serial::PUBLISHED),
];

/// The same legs on the robot's right.
fn right(leg: Leg) -> Leg {
    match leg {
        Leg::FiveBar(mut leg) => {
            leg.lengths.hip *= -1.0;
            Leg::FiveBar(leg)
        }
        Leg::Serial(mut leg) => {
            leg.lengths.hip *= -1.0;
            Leg::Serial(leg)
        }
    }
}

/// Rows beside the plane are left out: there the planner does not agree with itself. So are rows that
/// it moved into a reach of its own first, which shows in an abduction.
#[test]
fn the_published_planner_in_the_plane() {
    let text = include_str!("../../../tests/vectors/foot_ik.csv");
    let (mut compared, mut beyond, mut worst) = ([0; 3], 0, 0.0_f64);
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |index: usize| cells[index].parse::<f64>().expect("a number");
        let (upper, foot) = (number(1), [number(2), number(3), number(4)]);
        let (which, leg) = match (cells[0], cells[1]) {
            ("5bar", "0.1") => (0, LEGS[0]),
            ("5bar", _) => {
                let lengths = FiveBarLengths {
                    upper,
                    ..FiveBar::PUBLISHED.lengths
                };
                (1, Leg::FiveBar(FiveBar::new(lengths).expect("lengths")))
            }
            _ => (2, LEGS[1]),
        };
        if foot[1] != 0.0 {
            continue;
        }
        if !cells[8].is_empty() {
            let error = leg.joints(foot).expect_err("out of reach");
            assert!(matches!(error, LegError::TooFar { .. }), "{line}: {error}");
            continue;
        }
        // It shortens a serial leg of more than 250 mm, which no column shows.
        let shortened = which == 2 && foot[0].hypot(foot[2]) > 0.25 + 1e-9;
        if number(7).abs() > 1e-9 || shortened {
            continue;
        }
        // One row has a foot 242.7 mm from a motor whose links are 240 mm long; it gives angles all
        // the same.
        let from_front = (foot[0] - FiveBar::PUBLISHED.lengths.motor_offset).hypot(foot[2]);
        if which == 1 && from_front > upper + 0.16 {
            let error = leg.joints(foot).expect_err("out of reach").to_string();
            assert!(
                error.contains("2.695 mm too far from the front motor"),
                "{error}"
            );
            beyond += 1;
            continue;
        }
        let joints = leg.joints(foot).expect(line);
        for (got, expected) in joints.into_iter().zip([number(5), number(6), number(7)]) {
            worst = worst.max((got - expected).abs());
            assert!((got - expected).abs() < 1e-9, "{line}: {joints:?}");
        }
        compared[which] += 1;
    }
    println!("compared {compared:?}, worst {worst:e} rad");
    assert!(compared.iter().all(|count| *count >= 30), "{compared:?}");
    assert_eq!(beyond, 1);
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f64>().sqrt()
}

#[test]
fn forward_after_inverse_is_the_foot_in_the_whole_workspace() {
    for leg in LEGS.into_iter().chain(LEGS.map(right)) {
        let (mut reached, mut worst) = (0, 0.0_f64);
        let grid = |index: i32| f64::from(index) * 0.011 + 0.000_3;
        for x in -30..=30 {
            for y in -35..=35 {
                for z in -30..=30 {
                    let foot = [x, y, z].map(grid);
                    let Ok(joints) = leg.joints(foot) else {
                        continue;
                    };
                    let back = leg.foot(joints).expect("joints of the inverse");
                    worst = worst.max(distance(foot, back));
                    assert!(distance(foot, back) < 1e-10, "{leg:?}: {foot:?}, {back:?}");
                    reached += 1;
                }
            }
        }
        println!("{leg:?}: {reached} feet, worst {worst:e} m");
        assert!(reached > 20_000, "{leg:?}: {reached}");
    }
}

/// A foot on an ellipse that goes through all three dimensions, and how it moves there.
fn on_an_ellipse(time: f64) -> FootMotion {
    let swing = [(0.04, 0.3), (0.02, 1.1), (0.03, 2.0)];
    let middle = [0.01, 0.005, -0.18];
    let rate = 5.0;
    let each = |order: u8| {
        [0, 1, 2].map(|axis: usize| {
            let (size, phase) = swing[axis];
            let (sin, cos) = (rate * time + phase).sin_cos();
            match order {
                0 => middle[axis] + size * sin,
                1 => size * rate * cos,
                _ => -size * rate * rate * sin,
            }
        })
    };
    FootMotion {
        position: each(0),
        velocity: each(1),
        acceleration: each(2),
    }
}

/// Differences over eight neighbours, whose error is of the order of the eighth power of the step.
#[test]
fn rates_and_accelerations_are_the_derivatives() {
    let (step, mut worst) = (4e-3, [0.0_f64; 2]);
    let weights = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    for leg in LEGS.into_iter().chain(LEGS.map(right)) {
        let at = |time| leg.joint_motion(&on_an_ellipse(time)).expect("in reach");
        for index in 0..200 {
            let time = f64::from(index) * 0.01;
            let motion = at(time);
            let mut differences = [[0.0; 3]; 2];
            for (neighbour, weight) in (1_u8..).zip(weights) {
                let away = f64::from(neighbour) * step;
                let (after, before) = (at(time + away), at(time - away));
                let pairs = [
                    (after.position, before.position),
                    (after.velocity, before.velocity),
                ];
                for (sums, (after, before)) in differences.iter_mut().zip(pairs) {
                    for (sum, (after, before)) in sums.iter_mut().zip(after.iter().zip(before)) {
                        *sum += weight / step * (after - before);
                    }
                }
            }
            let exact = [motion.velocity, motion.acceleration];
            for (worst, (differences, exact)) in worst.iter_mut().zip(differences.iter().zip(exact))
            {
                for (difference, exact) in differences.iter().zip(exact) {
                    let error = (difference - exact).abs() / exact.abs().max(1.0);
                    *worst = worst.max(error);
                }
            }
        }
    }
    println!(
        "rates off by {:e}, accelerations by {:e}",
        worst[0], worst[1]
    );
    assert!(worst.iter().all(|worst| *worst < 1e-10), "{worst:?}");
}

#[test]
fn joints_that_move_as_told_move_the_foot_as_asked() {
    for leg in LEGS.into_iter().chain(LEGS.map(right)) {
        for index in 0..200 {
            let asked = on_an_ellipse(f64::from(index) * 0.01);
            let joints = leg.joint_motion(&asked).expect("in reach");
            let got = leg.foot_motion(&joints).expect("not singular");
            assert!(distance(got.position, asked.position) < 1e-12);
            assert!(distance(got.velocity, asked.velocity) < 1e-11);
            assert!(distance(got.acceleration, asked.acceleration) < 1e-9);
            let jacobian = leg.jacobian(joints.position).expect("not singular");
            let by_jacobian = jacobian.map(|row| {
                let products = row.iter().zip(joints.velocity).map(|(a, b)| a * b);
                products.sum()
            });
            assert!(distance(by_jacobian, asked.velocity) < 1e-11);
        }
    }
}

#[test]
fn knees_bend_as_documented() {
    let foot = [0.02, 0.03, -0.18];
    for leg in LEGS.into_iter().chain(LEGS.map(right)) {
        let joints = leg.joints(foot).expect("in reach");
        let limb = leg.limb(joints).expect("joints of the inverse");
        let foot_at = if let Leg::FiveBar(_) = leg {
            assert!(limb[1][0] > limb[0][0].max(limb[2][0]), "{limb:?}");
            assert!(limb[3][0] < limb[4][0].min(limb[2][0]), "{limb:?}");
            limb[2]
        } else {
            assert!(limb[1][0] < limb[0][0].min(limb[2][0]), "{limb:?}");
            limb[2]
        };
        assert!(distance(foot_at, foot) < 1e-12, "{limb:?}");
    }
    // A foot to the left is a positive abduction on either side of the body.
    for leg in LEGS.into_iter().chain(LEGS.map(right)) {
        let joints = leg.joints([0.0, 0.02, -0.18]).expect("in reach");
        assert!(joints[2] > 0.0, "{joints:?}");
    }
}

/// A foot that goes round comes back to the same angles without a jump between branches.
#[test]
fn joints_follow_the_foot_without_a_jump() {
    for leg in LEGS {
        let at = |index: i32| {
            let motion = on_an_ellipse(f64::from(index) * 1e-3);
            leg.joints(motion.position).expect("in reach")
        };
        for index in 0..2_000 {
            assert!(distance(at(index), at(index + 1)) < 0.02, "{index}");
        }
    }
}

#[test]
fn a_singular_leg_has_no_rates_but_a_reason() {
    let moving = |position: [f64; 3]| FootMotion {
        position,
        velocity: [0.1, 0.0, 0.1],
        ..FootMotion::default()
    };
    let told = |leg: Leg, foot: [f64; 3]| {
        leg.joints(foot).expect("a place that it reaches");
        let error = leg.joint_motion(&moving(foot)).expect_err("singular");
        assert!(matches!(error, LegError::Singular { .. }), "{error}");
        error.to_string()
    };
    assert!(told(LEGS[1], [0.0, 0.0, -0.27]).contains("straight"));
    assert!(told(LEGS[1], [0.0, 0.0, -0.03]).contains("folded"));
    assert!(told(LEGS[1], [0.2, 0.0, 0.0]).contains("level with the hip"));
    // Straight down from the front motor.
    let below = [0.031, 0.0, -0.26 + 1e-9];
    assert!(LEGS[0].joint_motion(&moving(below)).is_err());
    // Both knees in one place, and too far apart.
    let lean = 0.31_f64.asin();
    let together = [PI / 2.0 + lean, PI / 2.0 - lean, 0.0];
    let error = LEGS[0].jacobian(together).expect_err("singular");
    assert!(error.to_string().contains("in one line"), "{error}");
    let wide = FiveBarLengths {
        motor_offset: 0.1,
        ..FiveBar::PUBLISHED.lengths
    };
    let wide = Leg::FiveBar(FiveBar::new(wide).expect("lengths"));
    let apart = wide.foot([0.0, PI, 0.0]).expect_err("too far apart");
    assert!(apart.to_string().contains("80.000 mm more"), "{apart}");
}

#[test]
fn bad_numbers_are_refused_by_name() {
    for leg in LEGS {
        for bad in [f64::NAN, f64::INFINITY, -1e300, 1e4 + 1.0] {
            let error = leg.joints([0.0, bad, -0.2]).expect_err("bad");
            assert!(error.to_string().starts_with("y = "), "{error}");
            let error = leg.foot([1.0, 2.0, bad]).expect_err("bad");
            assert!(error.to_string().starts_with("q3 = "), "{error}");
            assert!(leg.jacobian([bad, 2.0, 0.0]).is_err());
            assert!(leg.limb([bad, 2.0, 0.0]).is_err());
        }
        let motion = FootMotion {
            acceleration: [0.0, 0.0, f64::NAN],
            ..on_an_ellipse(0.0)
        };
        let error = leg.joint_motion(&motion).expect_err("bad").to_string();
        assert!(error.contains("the acceleration along z"), "{error}");
    }
    for upper in [f64::NAN, 0.0, -0.1, 11.0] {
        let lengths = SerialLengths {
            upper,
            ..Serial::PUBLISHED.lengths
        };
        let error = Serial::new(lengths).expect_err("bad").to_string();
        assert!(error.contains("from 0.001 to 10 m"), "{error}");
    }
}
