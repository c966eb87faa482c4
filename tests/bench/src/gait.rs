//! One cycle of a trot planned for every joint at 1 kHz, against the same formulas in numpy; and what
//! a trot takes of a bus.

use crate::python::Python;
use crate::rounds::{Contestant, median, race};
use canter::demo::perform;
use canter::gait::{Body, Gait, Kind, Planner, Quadruped, State};
use canter::leg::Leg;
use canter::robot::Robot;
use canter::sim::Configuration;
use canter_tests::measurement;
use std::fmt::Write;

/// Points of a cycle: one for each millisecond.
const RATE: f64 = 1e3;
/// In m/s.
const FORWARD: f64 = 0.5;
/// What a cycle may take, in ms.
const MOST: f64 = 2.0;
const ROUNDS: usize = 101;
/// From here on, in s, the trot is steady.
const STEADY: f64 = 3.0;

/// How far both may be from each other, in rad, rad/s and rad/s^2: it is only asked whether they
/// computed the same.
const AGREED: [f64; 3] = [1e-9, 1e-7, 1e-5];

/// Times both; gives whether they agree.
pub fn run() -> bool {
    let quadruped = Quadruped::of(&Robot::default()).expect("it has four legs");
    let gait = Kind::Trot.gait().expect("it walks");
    let points = (gait.period * RATE).round() as usize;
    let mut planner = trot(&quadruped, &gait);
    planner.advance(STEADY).expect("it reaches");
    let begin = planner.touch_down(0).expect("it walks");
    planner.advance(begin).expect("it reaches");

    let mut states = Vec::with_capacity(points);
    let mut python = Python::start("gait_cycle.py", &question(&quadruped, &gait, points));
    let contestants = vec![
        Contestant::new("canter", || {
            states.clear();
            let mut planner = planner.clone();
            for point in 0..points {
                let time = begin + (point as f64 + 0.5) * gait.period / points as f64;
                states.push(planner.advance(time).expect("it reaches"));
            }
            std::hint::black_box(&mut states);
        }),
        Contestant::that_times_itself("numpy", || python.time()),
    ];
    let times = race(ROUNDS, contestants);
    let what = "trot, one cycle of 12 joints at 1 kHz";
    for one in &times {
        let milliseconds = 1e3 * median(one.seconds.iter().copied());
        let (missed, bound) = match one.name {
            "canter" if milliseconds > MOST => (" MISSED", format!("at most {MOST}")),
            "canter" => ("", format!("at most {MOST}")),
            _ => ("", "-".to_owned()),
        };
        let value = format!("{milliseconds:.3} ms{missed}");
        measurement("bench", &format!("{what}, {}", one.name), &value, &bound);
    }
    agree(&states, &python.numbers())
}

/// What the demonstration's trot takes of the bus, and how far it is from the ideal; gives whether
/// there was one.
pub fn trot_on_a_bus() -> bool {
    let robot = Robot::default();
    let performance = perform(&robot, &Configuration::of(&robot), |_| {}).expect("it performs");
    let Some(walk) = performance.measure(&robot).walk else {
        return false;
    };
    let what = "trot of 12 axes, 2.5 Hz, 0.5 m/s";
    let note = |what: &str, value: f64, most: f64, unit: &str| {
        let missed = if value > most { " MISSED" } else { "" };
        let value = format!("{value:.1} {unit}{missed}");
        measurement("bench", what, &value, &format!("at most {most} {unit}"));
    };
    note(&format!("{what}: bus load"), 100.0 * walk.load, 40.0, "%");
    let deviation = format!("{what}: setpoints from the ideal");
    note(&deviation, 1e6 * walk.deviation, 50.0, "urad");
    true
}

fn trot(quadruped: &Quadruped, gait: &Gait) -> Planner {
    let body = Body {
        vx: FORWARD,
        ..Body::standing(Quadruped::HEIGHT)
    };
    let mut planner = Planner::new(quadruped.clone(), body).expect("it stands");
    planner.walk(gait).expect("it walks");
    planner
}

/// What numpy is told.
fn question(quadruped: &Quadruped, gait: &Gait, points: usize) -> String {
    let mut words = format!(
        "{points} {} {} {} {} {FORWARD}",
        gait.period,
        gait.duty,
        gait.swing,
        Quadruped::HEIGHT
    );
    for (mount, offset) in quadruped.mounts.iter().zip(gait.offsets) {
        let leg = &mount.leg;
        let Leg::Serial(serial) = leg.kinematics else {
            unreachable!("the assumed robot's legs are serial");
        };
        let lengths = serial.lengths();
        let numbers = [offset, lengths.hip, lengths.upper, lengths.lower];
        for number in numbers.into_iter().chain(leg.signs).chain(leg.offsets) {
            // Writing to a string cannot fail.
            let _ = write!(words, " {number}");
        }
    }
    words
}

/// Whether numpy's rows, three for each axis, are what the states say.
fn agree(states: &[State], theirs: &[f64]) -> bool {
    let points = states.len();
    if theirs.len() != 36 * points {
        return false;
    }
    let mut worst = [0.0f64; 3];
    for (point, state) in states.iter().enumerate() {
        for axis in 0..12 {
            let joints = &state.joints[axis / 3];
            let own = [joints.position, joints.velocity, joints.acceleration];
            for (order, own) in own.iter().enumerate() {
                let their = theirs[(3 * axis + order) * points + point];
                worst[order] = worst[order].max((own[axis % 3] - their).abs());
            }
        }
    }
    let value = format!(
        "{:.0e} rad, {:.0e} rad/s, {:.0e} rad/s^2",
        worst[0], worst[1], worst[2]
    );
    let bound = format!(
        "at most {:.0e}, {:.0e}, {:.0e}",
        AGREED[0], AGREED[1], AGREED[2]
    );
    measurement("bench", "trot, distance from numpy", &value, &bound);
    worst.iter().zip(AGREED).all(|(worst, most)| *worst <= most)
}
