//! Plays the scenario and prints what came of it; a test plays it on the host and compares.
#![no_std]
#![no_main]

use canter_images::{finish, report, scenario};
use cortex_m_rt::entry;

#[entry]
fn main() -> ! {
    let outcome = scenario::play();
    report("scenario.setpoints", outcome.setpoints);
    report("scenario.frames", outcome.frames);
    report("scenario.moved", outcome.moved);
    report("scenario.accepted", outcome.accepted);
    report("scenario.refused", outcome.refused);
    report("scenario.retargets", outcome.retargets);
    finish()
}
