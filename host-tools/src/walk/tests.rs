use super::*;
use crate::gait::{Body, Gait, GaitError, Kind, Quadruped};
use crate::robot::Robot;
use foresight::Foresight;
use knots::Knots;

fn quadruped() -> Quadruped {
    Quadruped::of(&Robot::default()).expect("four legs")
}

fn settings(kind: Kind, vx: f64) -> Settings {
    let body = Body {
        vx,
        ..Body::standing(Quadruped::HEIGHT)
    };
    Settings::new(kind.gait(), body)
}

fn knots(settings: &Settings) -> Knots {
    Knots::new(Sequence::new(quadruped(), settings).expect("it sits")).expect("it sits")
}

/// Up to a stop, and the seat.
fn replay(settings: Settings, mut orders: Vec<(f64, Order)>, stop: f64) -> Replay {
    orders.push((stop, Order::Stop));
    Replay {
        quadruped: quadruped(),
        settings,
        orders,
        duration: 60.0,
    }
}

#[test]
fn setpoints_of_a_steady_gait_are_within_50_microrad_of_its_motion() {
    for kind in Kind::ALL.into_iter().skip(1) {
        let vx = if kind == Kind::Walk { 0.3 } else { 0.5 };
        let replay = replay(settings(kind, vx), Vec::new(), 4.0);
        let deviation = replay.deviation().expect("within limits");
        println!("{}: {deviation:.2e} rad at {vx} m/s", kind.name());
        assert!(deviation <= 25e-6, "{kind:?}: {deviation}");
    }
    // Steps that do not begin and end at knots.
    for period in [0.393, 0.397, 0.407, 0.413] {
        let mut settings = settings(Kind::Trot, 0.5);
        settings.gait = settings.gait.map(|gait| Gait { period, ..gait });
        let replay = replay(settings, Vec::new(), 4.0);
        let deviation = replay.deviation().expect("within limits");
        println!("trot of {period} s: {deviation:.2e} rad");
        assert!(deviation <= 50e-6, "{period}: {deviation}");
    }
}

/// What foresight lets through no axis refuses, whatever the moment of the cycle; and what it refuses is
/// not far from what an axis refuses.
#[test]
fn foresight_lets_through_what_axes_take_and_little_less() {
    let foresight = Foresight::new(&quadruped());
    let walk = Order::Gait(Kind::Walk.gait().expect("it walks"));
    let (mut both, mut cautious) = (0, 0);
    for moment in 0..3 {
        for step in 0..10 {
            let settings = settings(Kind::Trot, 0.31 + 0.01 * f64::from(step));
            let time = 2.0 + 0.13 * f64::from(moment);
            let mut knots = knots(&settings);
            while knots.time() < time {
                knots.next().expect("a trot").expect("a knot");
            }
            let seen = foresight.look(&knots, Some(&walk));
            let taken = replay(settings, vec![(knots.time(), walk)], 8.0).deviation();
            assert!(taken.is_ok() || seen.is_err(), "{settings:?} {taken:?}");
            both += u32::from(seen.is_ok());
            cautious += u32::from(seen.is_err() && taken.is_ok());
        }
    }
    println!("of 30 changes {both} are let through, {cautious} refused that axes would take");
    assert!(both > 5 && both < 25 && cautious <= 6, "{both} {cautious}");
}

#[test]
fn slow_gaits_are_looked_at_too() {
    let mut slow = settings(Kind::Walk, 0.01);
    slow.gait = slow.gait.map(|gait| Gait {
        period: 20.0,
        ..gait
    });
    let foresight = Foresight::new(&quadruped());
    foresight.look_at_stops(&knots(&slow), 2).expect("slow");
    slow.body.vx = 0.05;
    let seen = foresight.look_at_stops(&knots(&slow), 2);
    assert!(
        matches!(seen, Err(WalkError::Gait(GaitError::Leg { .. }))),
        "{seen:?}"
    );
}

#[test]
fn a_stop_on_the_way_up_sits_down_again() {
    let mut sequence = Sequence::new(quadruped(), &settings(Kind::Trot, 0.5)).expect("it sits");
    sequence.advance(0.3).expect("up");
    sequence.order(&Order::Stop).expect("a stop");
    let mut phases = Vec::new();
    for index in 30..400 {
        let state = sequence.advance(0.01 * f64::from(index)).expect("there");
        assert_eq!(state.grounded, [true; 4], "it never walks");
        if phases.last() != Some(&sequence.phase()) {
            phases.push(sequence.phase());
        }
    }
    let up = [
        Phase::StandingUp,
        Phase::Settling,
        Phase::SittingDown,
        Phase::Sitting,
    ];
    assert_eq!(phases, up);
}

#[test]
fn what_cannot_be_is_refused_and_changes_nothing() {
    let settings = settings(Kind::Trot, 0.2);
    let mut sequence = Sequence::new(quadruped(), &settings).expect("it sits");
    sequence.advance(2.0).expect("up");
    let mut same = sequence.clone();
    for bad in [f64::NAN, f64::INFINITY, -1.0, 1e9] {
        assert!(sequence.advance(bad).is_err());
        let height = Body::standing(bad);
        assert!(sequence.order(&Order::Body(height)).is_err());
    }
    assert_eq!(sequence.advance(3.0), same.advance(3.0));
    for (bad, word) in [
        (
            Settings {
                sitting: f64::NAN,
                ..settings
            },
            "the height",
        ),
        (
            Settings {
                sitting: 0.6,
                ..settings
            },
            "too far",
        ),
        (
            Settings {
                gait: None,
                ..settings
            },
            "stand goes nowhere",
        ),
    ] {
        let error = Sequence::new(quadruped(), &bad)
            .expect_err(word)
            .to_string();
        assert!(error.contains(word), "{error}");
    }
}
