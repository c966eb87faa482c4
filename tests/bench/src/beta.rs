//! The beta S-curve over an array of times, against s-curve-beta's table in numpy.

use crate::python::Python;
use crate::rounds::{Contestant, race, report};
use canter::profile::array;
use canter_shared::motion::beta::exact::Profile;

/// One move, and how many points of it.
const FROM: f64 = -3.0;
const TO: f64 = 10.0;
const DURATION: f64 = 5.354_353_608_226_971;
/// A whole move at 1 kHz, and an array that fills caches.
const POINTS: [usize; 2] = [5_355, 100_000];
const ROUNDS: usize = 41;

/// How far its table of 801 points may be from the exact curve, as a share of the range: it is
/// only asked whether both computed the same.
const TABLE_ERROR: f64 = 1e-5;

/// Times both; gives whether they agree.
pub fn run() -> bool {
    POINTS.into_iter().all(compare)
}

fn compare(points: usize) -> bool {
    // The very numbers that numpy.linspace gives.
    let step = DURATION / (points - 1) as f64;
    let mut times: Vec<f64> = (0..points).map(|at| at as f64 * step).collect();
    if let Some(last) = times.last_mut() {
        *last = DURATION;
    }
    let profile = Profile::lasting(FROM, TO, DURATION).expect("a move that can be");
    let mut positions = vec![0.0; points];
    let mut samples = vec![Default::default(); points];
    let mut python = Python::start(
        "s_curve_beta.py",
        &format!("{points} {DURATION} {FROM} {TO}"),
    );
    let contestants = vec![
        Contestant::new("canter", || {
            array::positions(&profile, &times, &mut positions);
            std::hint::black_box(&mut positions);
        }),
        Contestant::that_times_itself("s-curve-beta 0.1.2", || python.time()),
        Contestant::new("canter with velocity, acceleration and jerk", || {
            for (sample, time) in samples.iter_mut().zip(&times) {
                *sample = canter_shared::motion::trajectory::Trajectory::at(&profile, *time);
            }
            std::hint::black_box(&mut samples);
        }),
    ];
    let results = race(ROUNDS, contestants);
    let what = format!("beta, one of {points} points");
    report(&what, points, &results, &[("s-curve-beta 0.1.2", 0.5)]);

    let theirs = python.numbers();
    let worst = positions
        .iter()
        .zip(&theirs)
        .map(|(own, their)| (own - their).abs() / (TO - FROM))
        .fold(0.0, f64::max);
    let value = format!("{worst:.1e} of the range");
    let what = format!("beta over {points} points, distance from s-curve-beta");
    let bound = format!("at most {TABLE_ERROR}");
    canter_tests::measurement("bench", &what, &value, &bound);
    theirs.len() == points && worst <= TABLE_ERROR
}
