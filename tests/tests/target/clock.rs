//! What the bus clock costs.

use crate::{holds, run};

#[test]
fn the_clock_keeps_its_budget_of_instructions() {
    let results = run("measure_clock");
    // Once and twice in each tick.
    holds(&results, "clock.bus_time.most", 80);
    holds(&results, "clock.local_time.most", 140);
    // A SYNC costs most when it completes a point of the line.
    holds(&results, "clock.synchronise.most", 1_700);
    holds(&results, "clock.synchronise.mean", 400);
}
