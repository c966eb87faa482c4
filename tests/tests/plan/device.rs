//! `--device` foretells the setpoints that a node sends, to the bit.

use super::{rows, summary};
use canter::client::{Client, Goal, MoveRequest, Overrides, Target};
use canter::robot::Robot;
use canter::sim::{Configuration, Record, SimulatedBus};
use canter_shared::wire::command::ProfileKind;
use canter_shared::wire::id::AxisId;
use std::cell::RefCell;
use std::rc::Rc;

/// What axis 1 of the simulated robot is given from the tick before it moves until it rests.
fn sent(profile: ProfileKind, target: f64, duration: Option<f64>, velocity: f64) -> Vec<[f64; 3]> {
    let robot = Robot::default();
    let mut bus = SimulatedBus::new(&Configuration::of(&robot));
    let record = Rc::new(RefCell::new(Record::default()));
    bus.observe(Rc::clone(&record));
    let mut client = Client::new(bus, 7);
    client.scan().expect("a robot");
    let axis = AxisId::new(1).expect("a number of an axis");
    client.hold(&[axis]).expect("free");
    client.enable(&[axis]).expect("well");
    let request = MoveRequest {
        goals: vec![Goal {
            axis,
            target: Target::Absolute(target),
        }],
        profile,
        duration,
        limits: Overrides {
            velocity: Some(velocity),
            ..Overrides::default()
        },
        independent: false,
    };
    let arrivals = client
        .move_together(&robot, &request, |_| {})
        .expect("it arrives");
    let record = record.borrow();
    let setpoints = record.setpoints.iter().map(|(_, setpoint)| setpoint);
    let own = setpoints.filter(|setpoint| setpoint.axis == axis);
    let all: Vec<[f64; 3]> = own
        .map(|setpoint| {
            let setpoint = setpoint.setpoint;
            [
                setpoint.position.radians(),
                setpoint.velocity.radians(),
                setpoint.acceleration.radians(),
            ]
        })
        .collect();
    // At the start of a curve a few ticks still round to rest: the end is where it is counted from.
    let end = all.iter().rposition(|one| one[1] != 0.0).expect("it moved") + 1;
    let ticks = arrivals[0].duration.0 as usize;
    all[end - ticks..=end].to_vec()
}

#[test]
fn the_setpoints_are_those_that_the_node_sends() {
    for (profile, name, target, duration, velocity) in [
        (ProfileKind::Beta, "beta", 1.234_567, None, 3.0),
        (ProfileKind::Beta, "beta", -2.0, Some(1.2345), 20.0),
        // 1500 ticks but for what a host has to allow for rounding on the wire.
        (
            ProfileKind::Beta,
            "beta",
            1.0,
            None,
            2.037_183_271_576 / 1.5,
        ),
        (ProfileKind::Trapezoid, "trapezoid", -0.7, None, 2.0),
        (ProfileKind::Trapezoid, "trapezoid", 3.0, Some(2.5), 5.0),
    ] {
        let sent = sent(profile, target, duration, velocity);
        let mut arguments =
            format!("--device --profile {name} --from 0 --to {target} --vmax {velocity}");
        if let Some(duration) = duration {
            arguments.push_str(&format!(" --duration {duration}"));
        }
        let foretold: Vec<[f64; 3]> = rows(&super::canter_plan(&arguments, "").success())
            .iter()
            .map(|row| [row[1], row[2], row[3]])
            .collect();
        assert_eq!(foretold.len(), sent.len(), "{arguments}");
        for (tick, (foretold, sent)) in foretold.iter().zip(&sent).enumerate() {
            assert_eq!(foretold, sent, "{arguments}: tick {tick}");
        }
    }
}

#[test]
fn setpoints_are_held_between_ticks_and_counted_in_whole_ones() {
    let arguments = "--device --from 0 --to 1 --vmax 3 --t0 1";
    let told = summary(arguments);
    assert_eq!(told["device"], true);
    // An axis's defaults where none was named.
    assert_eq!(told["limits"]["acceleration"], 200.0);
    let duration = told["duration"].as_f64().expect("seconds");
    assert_eq!((duration * 1e3).fract(), 0.0, "{duration}");
    let got = super::rows_at(arguments, [0.0, 1.1, 1.1004, 1.1009, 1.101, 99.0]);
    assert_eq!(got[0][1..], [0.0; 4]);
    assert_eq!(got[1][1..], got[2][1..]);
    assert_eq!(got[1][1..], got[3][1..]);
    assert!(got[4][1] > got[1][1]);
    // As near to the target as a frame can tell it.
    assert!(
        (got[5][1] - 1.0).abs() < 1e-6 && got[5][2] == 0.0,
        "{:?}",
        got[5]
    );
}

/// The s-curve in integers follows the one in f64, and keeps its limits.
#[test]
fn an_s_curve_is_the_same_on_the_device() {
    let arguments = "--profile s-curve --from 0 --to 2 --vmax 3 --amax 40 --dmax 25 --jmax 900";
    let told = summary(&format!("--device {arguments}"));
    let duration = told["duration"].as_f64().expect("seconds");
    let exact = summary(arguments)["duration"].as_f64().expect("seconds");
    // Up to whole ticks, and one more for what the wire may round.
    assert!(
        (exact..=exact + 2e-3).contains(&duration),
        "{duration}, {exact}"
    );
    for (key, most) in [
        ("peak_velocity", 3.0),
        ("peak_acceleration", 40.0),
        ("peak_jerk", 900.0),
    ] {
        let peak = told[key].as_f64().expect("a number");
        // The change from tick to tick of an acceleration that is rounded to counts.
        let rounding = if key == "peak_jerk" { 1e-6 } else { 0.0 };
        assert!(
            peak <= most * (1.0 + 1e-9) + rounding * most,
            "{key}: {peak}"
        );
    }
    let times = (0..).map(|tick| f64::from(tick) * 1e-3);
    let times: Vec<f64> = times.take_while(|time| *time <= duration).collect();
    let device = super::rows_at(&format!("--device {arguments}"), times.clone());
    let same = format!("{arguments} --duration {duration}");
    for (device, exact) in device.iter().zip(super::rows_at(&same, times)) {
        // The wire's microradian, and the slower cruise that both of them found.
        assert!((device[1] - exact[1]).abs() < 2e-6, "{device:?}, {exact:?}");
    }
}
