//! How much of its stack the node's image needs.

use canter_tests::measurement;

use super::exercise::Exercise;
use crate::emulated::Emulated;
use crate::image::{self, elf::Symbols};

/// What no program of ours writes.
const PAINT: u32 = 0xC0FF_EE5A;

/// Words in one message to the debugger.
const CHUNK: usize = 256;

/// The stack of the smallest board, the NUCLEO-G474RE: see firmware/build.rs.
const SMALLEST: u32 = 64 * 1024;

/// Half of it is kept: interrupts that no run has met at the worst moment, and what the boards' controllers take.
const RESERVE: u32 = 32 * 1024;

/// From the first instruction on, through all that a node can be asked.
#[test]
fn the_smallest_board_has_twice_the_stack_that_a_node_was_seen_to_need() {
    let (mut node, mut debugger) = Emulated::start_with_debugger();
    let symbols = Symbols::read(&image::path("emulated"));
    let end = symbols.address("_stack_end");
    let start = symbols.address("_stack_start");
    debugger.stop();
    debugger.reset(symbols.address("Reset"));
    let chunks = || (end..start).step_by(4 * CHUNK);
    for chunk in chunks() {
        debugger.set_words(chunk, &[PAINT; CHUNK]);
    }
    debugger.go();
    let mut heard = 0;
    node.report_over_resets("a node", |_, _| {
        heard += 1;
        heard > 10
    });

    // What the start took, before anything is asked.
    let mut deepest = || {
        debugger.stop();
        let lowest = chunks().find_map(|chunk| {
            let words = debugger.words(chunk, CHUNK);
            let used = words.iter().position(|word| *word != PAINT)?;
            Some(chunk + 4 * used as u32)
        });
        debugger.go();
        start - lowest.expect("the image has a stack")
    };
    let started = deepest();
    let mut exercise = Exercise::new(&mut node);
    exercise.run();
    // It was worth the while.
    assert!(exercise.accepted > 200, "{}", exercise.accepted);
    assert!(exercise.retargets > 50, "{}", exercise.retargets);
    assert!(exercise.dry > 0);
    assert_eq!(exercise.saves, 4);
    let worst = deepest();
    let bound = SMALLEST - RESERVE;
    let bounded = format!("<= {bound} B, of {SMALLEST} B on the smallest board");
    measurement(
        "target",
        "stack, at the start",
        &format!("{started} B"),
        &bounded,
    );
    measurement(
        "target",
        "stack, worst in use",
        &format!("{worst} B"),
        &bounded,
    );
    assert!(worst <= bound, "{worst} B are over {bound} B");
    assert!(worst > started, "what was asked needs more than to wait");
}
