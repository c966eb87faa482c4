//! Both legs against the published planner's numbers and against themselves.

use super::*;

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
