//! canter's profiles timed against other people's, in one run and on the same inputs.
//!
//! | file | what it holds |
//! |---|---|
//! | `beta` | the beta S-curve against s-curve-beta |
//! | `s_curve` | the time-optimal s-curve against Ruckig |
//! | `gait` | a cycle of a trot against numpy, and a trot on a bus |
//! | `moves` | what is calculated |
//! | `rounds` | timing in turns, medians, ratios |
//! | `python` | a script that computes the same |
//! | `cpp`, `ruckig.cpp` | Ruckig's C++, called directly |
//!
//! A ratio that misses its bound is printed as such; the run fails only where results disagree.

mod beta;
mod cpp;
mod gait;
mod moves;
mod python;
mod rounds;
mod s_curve;

use std::process::ExitCode;

/// Moves of each kind.
const MOVES: usize = 2_000;
const SEED: u64 = 3;

fn main() -> ExitCode {
    let results = [
        beta::run(),
        gait::run(),
        gait::trot_on_a_bus(),
        s_curve::run("from rest", &moves::from_rest(MOVES, SEED)),
        s_curve::run("retarget", &moves::retargets(MOVES, SEED)),
    ];
    if results.contains(&false) {
        eprintln!("error: canter and a peer disagree on what they computed");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
