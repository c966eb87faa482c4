//! The simulated robot walks: its setpoints are what the joints were to do, and orders that would
//! break a limit are refused while it walks on.

use canter::bus::Bitrate;
use canter::client::{Client, Goal, MoveRequest, Overrides, Target};
use canter::gait::{Body, Kind, Quadruped};
use canter::robot::Robot;
use canter::sim::{Configuration, Record, SimulatedBus};
use canter::walk::joints::{axes, positions};
use canter::walk::{Order, Orders, Phase, Sequence, Settings, WalkError, Walked, preflight, walk};
use canter_shared::wire::command::ProfileKind;
use canter_shared::wire::id::AxisId;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

/// How far a setpoint may be from what its joint is to do, in rad.
const CLOSE: f64 = 50e-6;

/// The same while the gait changes: there a foot that is late has half its usual time in the air.
const CLOSE_IN_A_CHANGE: f64 = 100e-6;

const FAST: Body = Body {
    vx: 0.5,
    ..Body::standing(Quadruped::HEIGHT)
};

/// Orders at their times, and what became of them.
#[derive(Default)]
struct Script {
    orders: Vec<(f64, Order)>,
    refused: Vec<(Order, String)>,
    phases: Vec<Phase>,
}

impl Orders for Script {
    fn next(&mut self, time: f64, _: Phase) -> Option<Order> {
        let (when, order) = *self.orders.first()?;
        (when <= time).then(|| {
            self.orders.remove(0);
            order
        })
    }

    fn refused(&mut self, order: &Order, why: &WalkError) {
        self.refused.push((*order, why.to_string()));
    }

    fn passes(&mut self, _: f64, phase: Phase) {
        if self.phases.last() != Some(&phase) {
            self.phases.push(phase);
        }
    }
}

struct Robotic {
    client: Client<SimulatedBus>,
    record: Rc<RefCell<Record>>,
    axes: [AxisId; 12],
}

/// The robot that is assumed, held and enabled.
fn enabled() -> Robotic {
    let mut bus = SimulatedBus::new(&Configuration::default());
    let record = Rc::new(RefCell::new(Record::default()));
    bus.observe(record.clone());
    let mut client = Client::new(bus, 0xCA27);
    let axes = axes(&Quadruped::of(&Robot::default()).expect("four legs"));
    client.check(&axes).expect("all are there");
    client.hold(&axes).expect("nobody else is there");
    client.enable(&axes).expect("well");
    Robotic {
        client,
        record,
        axes,
    }
}

fn walked(script: &mut Script, settings: &Settings) -> (Robotic, Walked) {
    let mut robot = enabled();
    let walked = walk(&mut robot.client, &Robot::default(), settings, script);
    let walked = walked.expect("it walks");
    (robot, walked)
}

/// The setpoints from the start of the motion to its end, compared with the motion.
fn farthest(robot: &Robotic, walked: &Walked) -> f64 {
    let mut ideal = BTreeMap::new();
    let states = walked.replay.states(1e-3).expect("as it was");
    for (index, state) in states.enumerate() {
        let (_, state) = state.expect("as it was");
        ideal.insert(walked.start.0 + index as u64, positions(&state));
    }
    let mut farthest = 0.0f64;
    let mut seen = 0;
    for (_, setpoint) in &robot.record.borrow().setpoints {
        let Some(ideal) = ideal.get(&setpoint.tick.0) else {
            continue;
        };
        let joint = robot.axes.iter().position(|axis| *axis == setpoint.axis);
        let ideal = ideal[joint.expect("one of them")];
        farthest = farthest.max((setpoint.setpoint.position.radians() - ideal).abs());
        seen += 1;
    }
    assert_eq!(seen, 12 * ideal.len(), "each axis at each tick");
    farthest
}

#[test]
fn a_trot_is_walked_as_it_was_planned() {
    let settings = Settings::new(Kind::Trot.gait(), FAST);
    let mut script = Script {
        orders: vec![(4.0, Order::Stop)],
        ..Script::default()
    };
    let (robot, walked) = walked(&mut script, &settings);
    assert_eq!(
        script.phases,
        [
            Phase::StandingUp,
            Phase::Walking,
            Phase::Settling,
            Phase::SittingDown,
            Phase::Sitting,
        ]
    );
    assert_eq!(walked.replay.orders, [(4.0, Order::Stop)]);
    assert!(walked.ends.iter().all(|end| end.missing == 0));
    assert!(walked.ends.iter().all(|end| end.skew_microseconds < 100));
    let farthest = farthest(&robot, &walked);
    let planned = walked.replay.deviation().expect("as it was");
    println!("farthest from the motion: {farthest:e} rad, planned {planned:e} rad");
    assert!(farthest <= CLOSE, "{farthest}");
    assert!((farthest - planned).abs() < 1e-9, "{farthest} {planned}");
    let rejected = robot
        .client
        .axes()
        .values()
        .map(|known| known.counters.rejected);
    assert_eq!(rejected.max(), Some(0));
}

#[test]
fn an_order_that_would_break_a_limit_is_refused_and_the_robot_walks_on() {
    let slow = Body { vx: 0.2, ..FAST };
    let settings = Settings::new(Kind::Trot.gait(), slow);
    let too_fast = Order::Body(Body { vx: 3.0, ..FAST });
    let turning = Order::Body(Body {
        yaw_rate: 0.4,
        ..slow
    });
    let pace = Order::Gait(Kind::Pace.gait().expect("it walks"));
    let mut script = Script {
        orders: vec![
            (0.1, turning),
            (2.0, too_fast),
            (3.0, pace),
            (8.0, Order::Stand),
            (9.0, Order::Gait(Kind::Walk.gait().expect("it walks"))),
            (13.0, Order::Stop),
        ],
        ..Script::default()
    };
    let (robot, walked) = walked(&mut script, &settings);
    let [(order, why)] = &script.refused[..] else {
        panic!("{:?}", script.refused);
    };
    assert_eq!(*order, too_fast);
    assert!(why.contains("leg ") || why.contains("axis "), "{why}");
    assert_eq!(walked.replay.orders.len(), 5);
    let farthest = farthest(&robot, &walked);
    println!("farthest from the motion in changes of gait: {farthest:e} rad");
    assert!(farthest <= CLOSE_IN_A_CHANGE, "{farthest}");
}

#[test]
fn one_that_stands_leans_and_sits_down_again() {
    let leaning = Body {
        roll: 0.1,
        pitch: -0.1,
        ..Body::standing(Quadruped::HEIGHT)
    };
    let settings = Settings {
        begins_standing: true,
        ..Settings::new(None, leaning)
    };
    let mut script = Script {
        orders: vec![(2.0, Order::Stop)],
        ..Script::default()
    };
    let (robot, walked) = walked(&mut script, &settings);
    assert_eq!(script.phases[0], Phase::Walking);
    assert!(farthest(&robot, &walked) <= CLOSE);
}

#[test]
fn a_motion_is_the_same_however_finely_it_is_gone_through() {
    let settings = Settings::new(Kind::Gallop.gait(), Body { vx: 0.2, ..FAST });
    let mut script = Script {
        orders: vec![
            (1.7, Order::Body(Body { vx: 0.1, ..FAST })),
            (3.0, Order::Stop),
        ],
        ..Script::default()
    };
    let (_, walked) = walked(&mut script, &settings);
    let coarse: Vec<_> = walked.replay.states(0.05).expect("as it was").collect();
    let fine: Vec<_> = walked.replay.states(0.000_5).expect("as it was").collect();
    for (index, state) in coarse.iter().enumerate().take(coarse.len() - 1) {
        let (_, state) = state.as_ref().expect("as it was");
        let (_, same) = fine[100 * index].as_ref().expect("as it was");
        assert!((state.time - same.time).abs() < 1e-12);
        if state.time == same.time {
            assert_eq!(state.joints, same.joints, "{}", state.time);
        }
    }
    let (phase, last) = *fine
        .last()
        .and_then(|last| last.as_ref().ok())
        .expect("an end");
    assert_eq!((phase, last.time), (Phase::Sitting, walked.replay.duration));
    assert!(last.joints.iter().all(|joints| joints.velocity == [0.0; 3]));
}

#[test]
fn a_preflight_names_what_it_found_and_where_to_begin() {
    let mut robot = enabled();
    let settings = Settings::new(Kind::Trot.gait(), FAST);
    let look = |client: &mut Client<SimulatedBus>, rate| {
        let bitrate = Bitrate::from_bits_per_second(rate).expect("a rate");
        preflight(client, &Robot::default(), false, &settings, bitrate)
    };
    let well = look(&mut robot.client, 1_000_000).expect("well");
    assert!(!well.settings.begins_standing);
    let found: Vec<_> = well.items.iter().map(|item| item.what).collect();
    assert_eq!(
        found,
        ["robot", "axes", "faults", "limits", "pose", "motion", "bus"]
    );
    // By hand: twelve axes' knots, feedback and heartbeats, SYNC, and the host's heartbeat of 2 bytes.
    let axes = 12.0 * (100.0 + 50.0 + 10.0);
    let rate = 135.0 * (axes + 1e6 / 19_618.0) + 20.0 * 75.0;
    assert!((well.budget.rate() - rate).abs() < 1e-6);
    let full = look(&mut robot.client, 250_000).expect_err("too full");
    assert!(full.to_string().contains("250000 bit/s"), "{full}");
}

#[test]
fn a_preflight_knows_where_the_legs_are_and_sends_nobody_far() {
    let mut robot = enabled();
    let model = Robot::default();
    let settings = Settings::new(Kind::Trot.gait(), FAST);
    let quadruped = Quadruped::of(&model).expect("four legs");
    let mut go = |targets: &[f64; 12]| {
        let goals = robot.axes.iter().zip(targets);
        let request = MoveRequest {
            goals: goals
                .map(|(axis, target)| Goal {
                    axis: *axis,
                    target: Target::Absolute(*target),
                })
                .collect(),
            profile: ProfileKind::Beta,
            duration: None,
            limits: Overrides::default(),
            independent: false,
        };
        let moved = robot.client.move_together(&model, &request, |_| {});
        moved.expect("inside its limits");
        let bitrate = Bitrate::default();
        preflight(&mut robot.client, &model, false, &settings, bitrate)
    };
    let at_start = |settings: &Settings| {
        let mut sequence = Sequence::new(quadruped.clone(), settings).expect("in reach");
        positions(&sequence.advance(0.0).expect("in reach"))
    };
    let standing = Settings {
        begins_standing: true,
        ..settings
    };
    for (begins_standing, pose) in [(false, at_start(&settings)), (true, at_start(&standing))] {
        let near = pose.map(|position| position + 0.09);
        assert_eq!(
            go(&near).expect("near").settings.begins_standing,
            begins_standing
        );
        let mut far = pose;
        far[7] += 0.11;
        let error = go(&far).expect_err("too far").to_string();
        let words = format!("axis 8 (rear left) is at {:.3} rad", far[7]);
        assert!(error.contains(&words), "{error}");
        assert!(error.contains("`canter move 8=0.000`"), "{error}");
    }
}
