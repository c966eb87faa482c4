//! `canter leg` as other programs call it: the published numbers, the way there and back, the errors.

use canter_tests::process::{Finished, Process};
use std::process::Command;

/// Runs `canter` with these arguments.
#[track_caller]
fn canter(arguments: &str) -> Finished {
    let mut command = Command::new(canter_tests::canter());
    command.args(arguments.split_whitespace());
    Process::spawn(&mut command).finish()
}

/// These numbers of the JSON document.
#[track_caller]
fn numbers(arguments: &str, names: [&str; 3]) -> [f64; 3] {
    let document = canter(&format!("--json leg {arguments}")).success().json();
    names.map(|name| document[name].as_f64().expect(name))
}

const JOINTS: [&str; 3] = ["q1", "q2", "q3"];

#[test]
fn a_foot_of_each_leg_has_the_published_angles() {
    for (leg, x, z, published) in [
        (
            "five-bar",
            -0.08,
            -0.13,
            [1.1165066201398448, 3.368452746080358, 0.0],
        ),
        (
            "five-bar",
            0.1,
            -0.19,
            [0.32657312079887246, 1.5836164222661369, 0.0],
        ),
        (
            "serial",
            0.0,
            -0.19,
            [2.480429793427442, 1.5485722751766293, 0.0],
        ),
        (
            "serial",
            -0.12,
            -0.1,
            [3.5678435209054706, 1.2161889227679836, 0.0],
        ),
    ] {
        let joints = numbers(&format!("ik --leg {leg} --x {x} --y 0 --z {z}"), JOINTS);
        for (got, expected) in joints.into_iter().zip(published) {
            assert!((got - expected).abs() < 1e-9, "{leg}: {joints:?}");
        }
    }
}

#[test]
fn fk_takes_the_angles_of_ik_back_to_the_foot() {
    for leg in ["five-bar", "serial", "rear-right"] {
        let foot = [-0.03, 0.04, -0.17];
        let [x, y, z] = foot;
        let [q1, q2, q3] = numbers(&format!("ik --leg {leg} --x {x} --y {y} --z {z}"), JOINTS);
        let back = numbers(
            &format!("fk --leg {leg} --q1 {q1} --q2 {q2} --q3 {q3}"),
            ["x", "y", "z"],
        );
        for (got, expected) in back.into_iter().zip(foot) {
            assert!((got - expected).abs() < 1e-10, "{leg}: {back:?}");
        }
    }
}

#[test]
fn words_have_units_and_angles_may_have_theirs() {
    let told = canter("leg ik --leg five-bar --x 0 --z -0.19").success();
    assert!(told.stdout.starts_with("q1 0.75297507956483"), "{told:#?}");
    assert!(told.stdout.contains(" rad (43.142 deg)\n"), "{told:#?}");
    // A quarter turn down, and straight.
    let foot = numbers("fk --leg serial --q1 90deg --q2 0.5turn", ["x", "y", "z"]);
    assert!(
        foot[0].abs() < 1e-15 && (foot[2] + 0.27).abs() < 1e-15,
        "{foot:?}"
    );
}

#[test]
fn what_is_out_of_reach_ends_with_1_and_says_by_how_much() {
    for (arguments, words) in [
        (
            "ik --leg serial --x 0 --y 0 --z -0.3",
            "30.000 mm too far from the hip",
        ),
        (
            "ik --leg serial --x 0 --y 0 --z -0.01",
            "20.000 mm too near to the hip",
        ),
        // A front motor 31 mm ahead is 31 mm nearer than the rear one.
        (
            "ik --leg five-bar --x 0.3 --y 0 --z 0",
            "71.000 mm too far from the rear motor",
        ),
        (
            "ik --leg five-bar --x 0.031 --y 0 --z -0.05",
            "10.000 mm too near to the front motor",
        ),
        (
            "ik --leg five-bar --x 0 --y -0.05 --z 0",
            "50.000 mm too near to the axis of abduction",
        ),
    ] {
        let ended = canter(&format!("leg {arguments}"));
        assert_eq!(ended.status.code(), Some(1), "{arguments}: {ended:#?}");
        assert!(ended.stderr.contains(words), "{arguments}: {ended:#?}");
        assert!(ended.stdout.is_empty(), "{arguments}: {ended:#?}");
    }
}

#[test]
fn wrong_usage_ends_with_2_and_names_the_flag() {
    for (arguments, words) in [
        ("ik --x 0 --z -0.2", "--leg"),
        ("ik --leg serial --x nan --z -0.2", "--x"),
        ("ik --leg serial --x 0 --y inf --z -0.2", "--y"),
        ("ik --leg serial --x 0 --z 1e300", "--z"),
        ("ik --leg serial --x 0", "--z"),
        (
            "ik --leg six-bar --x 0 --z -0.2",
            "five-bar, serial, front-left",
        ),
        ("fk --leg serial --q1 1 --q2 1m", "--q2"),
        ("fk --leg serial --q1 1 --q2 1e5", "--q2"),
        ("fk --leg serial --q1 nan --q2 1", "--q1"),
    ] {
        let refused = canter(&format!("leg {arguments}"));
        assert_eq!(refused.status.code(), Some(2), "{arguments}: {refused:#?}");
        assert!(refused.stderr.contains(words), "{arguments}: {refused:#?}");
        assert!(refused.stdout.is_empty(), "{arguments}: {refused:#?}");
    }
}

#[test]
fn a_robot_file_has_legs_of_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("robot.toml");
    std::fs::write(
        &file,
        "[[axis]]\nid = 4\n[[axis]]\nid = 5\n[[axis]]\nid = 6\n[[leg]]\nname = \"one\"\n\
         kind = \"serial\"\nhip = -0.05\nupper = 0.3\nlower = 0.4\naxes = [6, 5, 4]\n\
         signs = [1, -1, 1]\noffsets = [0.5, 3.0, 0.0]\nplace = [0.0, 0.0, 0.0]\n",
    )
    .expect("a file");
    let robot = format!("--robot {} --json leg", file.display());
    for leg in ["one", "serial"] {
        // A right angle at the knee: 3, 4, 5.
        let ik = canter(&format!("{robot} ik --leg {leg} --x 0 --z -0.5"));
        let document = ik.success().json();
        let number = |pointer: &str| document.pointer(pointer).and_then(|value| value.as_f64());
        let close = |pointer, expected: f64| {
            let got = number(pointer).expect(pointer);
            assert!((got - expected).abs() < 1e-12, "{pointer}: {document}");
        };
        let quarter = std::f64::consts::FRAC_PI_2;
        close("/q2", quarter);
        close("/axes/0/axis", 6.0);
        close("/axes/0/position", 0.5 + quarter + 0.8_f64.asin());
        close("/axes/1/position", 3.0 - quarter);
    }
    let ended = canter(&format!("{robot} ik --leg five-bar --x 0 --z -0.2"));
    assert_eq!(ended.status.code(), Some(2), "{ended:#?}");
    assert!(ended.stderr.contains("choose one of one"), "{ended:#?}");
}
