//! The beta S-curve over an array of times, against s-curve-beta's table in numpy.

use crate::rounds::{Contestant, race, report};
use canter_shared::motion::beta::exact::Profile;
use std::io::{BufRead, BufReader, Read, Write};
/// The product's own, without the rest of the command line's library, which takes long to build.
#[path = "../../../host-tools/src/profile/array.rs"]
mod array;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

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
    let mut python = Python::start(points);
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

    let theirs = python.positions();
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

/// A Python that evaluates and times itself when it is told to.
struct Python {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Python {
    fn start(points: usize) -> Self {
        let python = std::env::var_os("CANTER_BENCH_PYTHON")
            .expect("CANTER_BENCH_PYTHON names a Python: run tests/run bench");
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/src/s_curve_beta.py");
        let mut child = Command::new(python)
            .arg(script)
            // Threads that wait for work would be in everybody's way.
            .env("OPENBLAS_NUM_THREADS", "1")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the Python of CANTER_BENCH_PYTHON starts");
        let mut input = child.stdin.take().expect("it is piped");
        let output = BufReader::new(child.stdout.take().expect("it is piped"));
        writeln!(input, "{points} {DURATION} {FROM} {TO}").expect("it reads");
        Self {
            child,
            input: Some(input),
            output,
        }
    }

    /// One evaluation of the whole array; seconds.
    fn time(&mut self) -> f64 {
        let input = self.input.as_mut().expect("it was not closed yet");
        writeln!(input).expect("it reads");
        let mut line = String::new();
        self.output.read_line(&mut line).expect("it answers");
        line.trim().parse().expect("it answers with seconds")
    }

    /// What it evaluated, and the end of it.
    fn positions(mut self) -> Vec<f64> {
        self.input = None;
        let mut bytes = Vec::new();
        self.output.read_to_end(&mut bytes).expect("it answers");
        let ended = self.child.wait().expect("it ends");
        assert!(ended.success(), "the Python peer ended with {ended}");
        let (numbers, _) = bytes.as_chunks::<8>();
        numbers
            .iter()
            .map(|bytes| f64::from_le_bytes(*bytes))
            .collect()
    }
}
