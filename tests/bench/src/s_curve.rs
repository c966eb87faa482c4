//! The time-optimal s-curve, against Ruckig's C++ and its port to Rust.

use crate::cpp;
use crate::moves::{Move, Random};
use crate::rounds::{Contestant, race, report};
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::error::ProfileError;
use canter_shared::motion::s_curve;
use canter_shared::motion::segments::Segments;
use canter_shared::motion::trajectory::{Sample, Trajectory};
use rsruckig::prelude as port;

const ROUNDS: usize = 41;
/// Times at which each trajectory is evaluated.
const TIMES: usize = 50;

/// How much of a duration two solvers may disagree by.
const SAME_DURATION: f64 = 1e-9;
/// How much of the way two trajectories may disagree by, which is how far Ruckig's own samples
/// are trusted.
const SAME_POSITION: f64 = 1e-7;

/// Times the calculation of all moves and their evaluation; gives whether all agree.
pub fn run(what: &str, moves: &[Move]) -> bool {
    let agrees = calculate(what, moves);
    evaluate(what, moves) && agrees
}

fn plan(one: &Move) -> Result<Segments, ProfileError> {
    let bounds = Bounds::new(
        one.velocity_limit,
        one.acceleration_limit,
        one.acceleration_limit,
        one.jerk_limit,
    )?;
    let from = Sample {
        position: one.position,
        velocity: one.velocity,
        acceleration: one.acceleration,
        jerk: 0.0,
    };
    s_curve::plan(from, Sample::at_rest(one.target), &bounds)
}

fn input(one: &Move) -> port::InputParameter<1> {
    let mut input = port::InputParameter::new(None);
    input.current_position[0] = one.position;
    input.current_velocity[0] = one.velocity;
    input.current_acceleration[0] = one.acceleration;
    input.target_position[0] = one.target;
    input.max_velocity[0] = one.velocity_limit;
    input.max_acceleration[0] = one.acceleration_limit;
    input.max_jerk[0] = one.jerk_limit;
    input
}

type Port = port::Ruckig<1, port::ThrowErrorHandler>;

fn calculate(what: &str, moves: &[Move]) -> bool {
    let places = || vec![-1.0; moves.len()];
    let (mut own, mut theirs, mut crates, mut ported) = (places(), places(), places(), places());
    let mut ruckig = cpp::Ruckig::new(moves);
    let mut inputs: Vec<_> = moves.iter().map(wrapped).collect();
    let mut wrapper = ruckig::Ruckig::new_direct_and_offline(1);
    let mut trajectory = ruckig::Trajectory::new_direct(1);
    let port_inputs: Vec<_> = moves.iter().map(input).collect();
    let mut port = Port::new(None, 1e-3);
    let mut port_trajectory = port::Trajectory::new(None);
    let contestants = vec![
        Contestant::new("canter", || {
            for (duration, one) in own.iter_mut().zip(moves) {
                *duration = match std::hint::black_box(plan(one)) {
                    Ok(planned) => planned.duration(),
                    Err(_) => -1.0,
                };
            }
        }),
        Contestant::new("Ruckig C++", || ruckig.calculate(&mut theirs)),
        Contestant::new("crate ruckig 0.19.4", || {
            for (duration, input) in crates.iter_mut().zip(&mut inputs) {
                wrapper.calculate(input, &mut trajectory);
                *duration = trajectory.get_duration();
            }
        }),
        Contestant::new("crate rsruckig 3.0.1", || {
            for (duration, input) in ported.iter_mut().zip(&port_inputs) {
                *duration = match port.calculate(input, &mut port_trajectory) {
                    Ok(_) => port_trajectory.get_duration(),
                    Err(_) => -1.0,
                };
            }
        }),
    ];
    let results = race(ROUNDS, contestants);
    let bounds = [("Ruckig C++", 1.0)];
    let timed = format!("s-curve {what}, calculation");
    report(&timed, moves.len(), &results, &bounds);

    // Where a peer gives up, which happens at the edges of its numbers, ours must still answer.
    let mut right = own.iter().all(|duration| *duration >= 0.0);
    for (name, other) in [("Ruckig C++", &theirs), ("rsruckig", &ported)] {
        let refused = other.iter().filter(|duration| **duration < 0.0).count();
        let mut unlike = 0;
        for ((own, other), one) in own.iter().zip(other).zip(moves) {
            let same = (own - other).abs() <= SAME_DURATION * other.abs();
            if *other >= 0.0 && !same {
                unlike += 1;
                eprintln!("canter {own} s, {name} {other} s: {one:?}");
            }
        }
        let what = format!("s-curve {what}, durations unlike those of {name}");
        let value = format!("{unlike} of {}, {refused} refused there", moves.len());
        canter_tests::measurement("bench", &what, &value, "none unlike");
        right &= unlike == 0;
    }
    right
}

fn wrapped(one: &Move) -> ruckig::InputParameter {
    let mut input = ruckig::InputParameter::new(1);
    input.current_position = vec![one.position];
    input.current_velocity = vec![one.velocity];
    input.current_acceleration = vec![one.acceleration];
    input.target_position = vec![one.target];
    input.max_velocity = vec![one.velocity_limit];
    input.max_acceleration = vec![one.acceleration_limit];
    input.max_jerk = vec![one.jerk_limit];
    input
}

fn evaluate(what: &str, moves: &[Move]) -> bool {
    let planned: Result<Vec<_>, _> = moves.iter().map(plan).collect();
    let planned = match planned {
        Ok(planned) => planned,
        Err(error) => {
            eprintln!("a move cannot be planned: {error}");
            return false;
        }
    };
    // Random instants, some of them after the end, so that nobody is helped by their order.
    let mut random = Random(7);
    let times: Vec<f64> = planned
        .iter()
        .flat_map(|planned| [planned.duration(); TIMES])
        .map(|duration| random.between(0.0, 1.02) * duration)
        .collect();
    let mut ruckig = cpp::Ruckig::new(moves);
    let mut durations = vec![0.0; moves.len()];
    ruckig.calculate(&mut durations);
    let mut port = Port::new(None, 1e-3);
    let ported: Vec<_> = moves
        .iter()
        .map(|one| {
            let mut trajectory = port::Trajectory::new(None);
            // Where the port fails, whatever it holds is timed.
            let _ = port.calculate(&input(one), &mut trajectory);
            trajectory
        })
        .collect();
    let mut own = vec![[0.0; 3]; times.len()];
    let mut theirs = own.clone();
    let mut others = own.clone();
    let contestants = vec![
        Contestant::new("canter", || {
            let states = own.chunks_mut(TIMES).zip(times.chunks(TIMES));
            for (planned, (states, times)) in planned.iter().zip(states) {
                for (state, time) in states.iter_mut().zip(times) {
                    let sample = planned.at(*time);
                    *state = [sample.position, sample.velocity, sample.acceleration];
                }
            }
        }),
        Contestant::new("Ruckig C++", || ruckig.at(&times, &mut theirs)),
        Contestant::new("crate rsruckig 3.0.1", || {
            let states = others.chunks_mut(TIMES).zip(times.chunks(TIMES));
            for (trajectory, (states, times)) in ported.iter().zip(states) {
                for (state, time) in states.iter_mut().zip(times) {
                    let mut one = [(); 3].map(|()| port::DataArrayOrVec::new(None, 0.0));
                    let [position, velocity, acceleration] = &mut one;
                    let (p, v, a) = (Some(position), Some(velocity), Some(acceleration));
                    let (mut p, mut v, mut a) = (p, v, a);
                    trajectory.at_time(*time, &mut p, &mut v, &mut a, &mut None, &mut None);
                    *state = one.map(|value| value[0]);
                }
            }
        }),
    ];
    let results = race(ROUNDS, contestants);
    let timed = format!("s-curve {what}, at_time");
    report(&timed, times.len(), &results, &[("Ruckig C++", 1.0)]);

    // A retarget may go a long way to its target: the way is what its velocities could cover.
    let ways = moves.iter().zip(&planned).flat_map(|(one, planned)| {
        [(one.target - one.position).abs() + one.velocity.abs() * planned.duration(); TIMES]
    });
    let worst = ways
        .zip(own.iter().zip(&theirs))
        .zip(durations.iter().flat_map(|duration| [*duration; TIMES]))
        // What Ruckig refused has no trajectory there.
        .filter(|(_, duration)| *duration >= 0.0)
        .map(|((way, (own, their)), _)| (own[0] - their[0]).abs() / way)
        .fold(0.0, f64::max);
    let value = format!("{worst:.1e} of the way");
    let what = format!("s-curve {what}, distance from Ruckig's positions");
    let bound = format!("at most {SAME_POSITION}");
    canter_tests::measurement("bench", &what, &value, &bound);
    worst <= SAME_POSITION
}
