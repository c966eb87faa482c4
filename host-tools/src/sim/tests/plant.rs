use std::f64::consts::TAU;

use canter_shared::drive::{Condition, DriveCommand, Trouble};
use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::beta::Beta;
use canter_shared::motion::trapezoid::Trapezoid;
use canter_shared::motion::{Motion, Move, Profile, Setpoint, shortest_s_curve};
use canter_shared::units::{COUNTS_PER_TURN, Velocity};

use super::super::plant::Plant;
use super::*;

fn fitting(values: LimitValues) -> (Limits, PlantModel) {
    let limits = Limits::new(&values).expect("in range");
    (limits, PlantModel::fitting(&limits))
}

/// The quickest move of `angle` rad.
fn quickest(profile: Profile, angle: f64, limits: &Limits) -> Vec<Setpoint> {
    let target = Position::from_radians(angle).expect("in range");
    let duration = match profile {
        Profile::Beta => Beta::shortest(target, limits),
        Profile::SCurve => shortest_s_curve(target, limits),
        _ => Trapezoid::shortest(target, limits).map(|shape| shape.duration()),
    };
    let asked = Move {
        target,
        duration: duration.expect("short enough"),
        profile,
    };
    let mut motion = Motion::at_rest(Position::ZERO);
    let planned = motion
        .start(Tick(0), Tick(0), asked, limits)
        .expect("the least duration is allowed");
    (0..=planned.end.0 + 300)
        .map(|tick| motion.at(Tick(tick)))
        .collect()
}

fn command(setpoint: &Setpoint, enable: bool) -> DriveCommand {
    DriveCommand {
        reset: false,
        enable,
        position: setpoint.position,
        velocity: setpoint.velocity,
        acceleration: setpoint.acceleration,
    }
}

fn enabled(model: &PlantModel) -> Plant {
    let mut plant = Plant::new(model);
    for ticks in 1..=2 {
        plant.take(&command(&Setpoint::default(), true));
        let condition = plant.report().condition;
        assert_eq!(condition == Condition::Enabled, ticks == 2);
    }
    plant
}

/// The greatest distance of the shaft from its setpoint, and the last one of the encoder, in rad.
fn follow(plant: &mut Plant, setpoints: &[Setpoint]) -> (f64, f64) {
    let (mut worst, mut last): (f64, f64) = (0.0, 0.0);
    for setpoint in setpoints {
        plant.take(&command(setpoint, true));
        let off = |position: Position| (position - setpoint.position).abs().radians();
        worst = worst.max(off(plant.state().position));
        last = off(plant.report().position);
    }
    (worst, last)
}

#[test]
fn a_fitting_plant_follows_the_quickest_moves_closely() {
    let quick = LimitValues {
        velocity: 60.0,
        acceleration: 1_500.0,
        deceleration: 1_000.0,
        jerk: 200_000.0,
        ..DEFAULT_VALUES
    };
    // A tick at full speed is 20 and 60 mrad.
    for (values, bound) in [(DEFAULT_VALUES, 2e-4), (quick, 1e-3)] {
        let (limits, model) = fitting(values);
        for (profile, angle) in [
            (Profile::Beta, 6.0),
            (Profile::SCurve, -6.0),
            (Profile::Trapezoid, 6.0),
            (Profile::SCurve, 0.01),
        ] {
            let mut plant = enabled(&model);
            let (worst, last) = follow(&mut plant, &quickest(profile, angle, &limits));
            assert!(worst < bound, "{profile:?} {angle}: {worst} rad off");
            assert!(
                last < 2e-6,
                "{profile:?} {angle}: {last} rad off at the end"
            );
        }
    }
}

/// Within a count or two, and so within the millirad that a client grants.
#[test]
fn a_coarse_encoder_and_a_drive_that_knows_less_are_enough() {
    let (limits, model) = fitting(DEFAULT_VALUES);
    for encoder in [1 << 14, 1 << 17, 1 << 20] {
        let values = PlantValues {
            encoder,
            compensation: 0.8,
            ..*model.values()
        };
        let model = PlantModel::new(values).expect("in range");
        let mut plant = enabled(&model);
        let (worst, last) = follow(&mut plant, &quickest(Profile::Beta, 3.0, &limits));
        let count = TAU / f64::from(encoder);
        assert!(worst < count + 2e-4, "{encoder}: {worst} rad off");
        assert!(last < 2.0 * count, "{encoder}: {last} rad off at the end");
        let shown = plant.report().position.counts();
        assert_eq!(shown % (COUNTS_PER_TURN / i64::from(encoder)), 0);
    }
}

#[test]
fn more_than_the_motor_can_do_is_not_done() {
    let (limits, model) = fitting(DEFAULT_VALUES);
    let weak = PlantValues {
        // Half of what accelerating the inertia takes, besides the friction.
        torque: 0.5 * 0.01 * DEFAULT_VALUES.acceleration + model.values().coulomb,
        ..*model.values()
    };
    let mut plant = enabled(&PlantModel::new(weak).expect("in range"));
    let setpoints = quickest(Profile::Trapezoid, 6.0, &limits);
    let mut last = Velocity::ZERO;
    let mut most: f64 = 0.0;
    for setpoint in &setpoints[..50] {
        plant.take(&command(setpoint, true));
        let velocity = plant.state().velocity;
        most = most.max((velocity - last).radians() * 1e3);
        last = velocity;
    }
    assert!((90.0..=100.0).contains(&most), "{most} rad/s^2");
    let (worst, _) = follow(&mut plant, &setpoints[50..]);
    assert!(worst > 0.5, "{worst} rad off");
}

/// What friction does to a shaft of 10 rad/s without torque: dv/dt = -(b v + c) / J, which is at
/// rest after J / b ln(1 + b v / c) = 0.5 s ln 2 = 0.347 s.
#[test]
fn without_torque_the_shaft_coasts_to_rest() {
    let (limits, model) = fitting(DEFAULT_VALUES);
    let mut plant = enabled(&model);
    let setpoints = quickest(Profile::Trapezoid, 6.0, &limits);
    let fast = setpoints
        .iter()
        .position(|setpoint| setpoint.velocity.radians() >= 10.0)
        .expect("it gets as fast");
    follow(&mut plant, &setpoints[..=fast]);
    let mut ticks = 0;
    while plant.state().velocity != Velocity::ZERO {
        plant.take(&command(&setpoints[fast], false));
        ticks += 1;
        assert!(ticks < 1_000);
    }
    assert!((340..=360).contains(&ticks), "{ticks} ticks");
    assert_eq!(plant.report().condition, Condition::Disabled);
    let rest = plant.state();
    plant.coast(1_000);
    assert_eq!(plant.state(), rest);
}

#[test]
fn troubles_let_go_and_pass() {
    let (_, model) = fitting(DEFAULT_VALUES);
    let still = command(&Setpoint::default(), true);
    for (trouble, condition) in [
        (DriveTrouble::Fault, Condition::Faulted(Trouble::Other)),
        (DriveTrouble::Silence, Condition::Lost),
        (DriveTrouble::Disable, Condition::Disabled),
        (DriveTrouble::Blocked, Condition::Enabled),
    ] {
        let mut plant = enabled(&model);
        plant.trouble(trouble, 5);
        for _ in 0..4 {
            plant.take(&still);
            assert_eq!(plant.report().condition, condition, "{trouble:?}");
        }
        // It is over; a drive that has disabled itself waits for the order to be taken back.
        for _ in 0..10 {
            plant.take(&still);
        }
        let after = match trouble {
            DriveTrouble::Disable => Condition::Disabled,
            _ => Condition::Enabled,
        };
        assert_eq!(plant.report().condition, after, "{trouble:?}");
        plant.take(&command(&Setpoint::default(), false));
        assert_eq!(plant.report().condition, Condition::Disabled);
        for _ in 0..3 {
            plant.take(&still);
        }
        assert_eq!(plant.report().condition, Condition::Enabled, "{trouble:?}");
    }
}

#[test]
fn a_blocked_shaft_stands_still() {
    let (limits, model) = fitting(DEFAULT_VALUES);
    let mut plant = enabled(&model);
    plant.trouble(DriveTrouble::Blocked, 100);
    let setpoints = quickest(Profile::Beta, 3.0, &limits);
    follow(&mut plant, &setpoints[..99]);
    assert_eq!(plant.state(), PlantState::default());
    assert_eq!(plant.report().condition, Condition::Enabled);
}

#[test]
fn values_that_cannot_be_are_refused_by_name() {
    let (_, model) = fitting(DEFAULT_VALUES);
    let good = *model.values();
    assert_eq!(PlantModel::new(good), Ok(model));
    let refused = |values| {
        PlantModel::new(values)
            .expect_err("out of range")
            .to_string()
    };
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let words = refused(PlantValues {
            inertia: bad,
            ..good
        });
        assert!(words.contains("inertia in kg m^2"), "{words}");
        assert!(words.ends_with(&format!("but it is {bad}")), "{words}");
    }
    let words = refused(PlantValues {
        torque: 0.1,
        ..good
    });
    assert!(
        words.contains("torque in N m must be a number from 0.2 "),
        "{words}"
    );
    let words = refused(PlantValues {
        encoder: 100,
        ..good
    });
    assert!(words.contains("encoder in counts per turn"), "{words}");
}
