//! What the boards' images leave for the stack, and what guards it.

use std::fs;

use canter_tests::measurement;

use super::frame;
use crate::image::{self, elf::Symbols};
use crate::{IMAGES, RAM, Sizes};

/// What `tests/run target` holds the stack of a running node against: see tests/tests/target/stack.rs.
const SMALLEST: u32 = 64 * 1024;

/// Below the stack so many bytes are forbidden (firmware/src/crash.rs): a function that took more could
/// reach over them.
const FORBIDDEN: u32 = 32 * 1024;

#[test]
fn the_stack_is_before_the_variables_and_no_function_reaches_over_its_guard() {
    for name in IMAGES {
        let path = image::path(name);
        let symbols = Symbols::read(&path);
        let end = symbols.address("_stack_end");
        let start = symbols.address("_stack_start");
        assert_eq!(end, RAM, "{name}: below the stack there must be no RAM");
        let stack = start - end;
        let variables = symbols.address("__sdata").min(symbols.address("__sbss"));
        assert!(
            variables >= start,
            "{name}: variables at {variables:x} are in the stack"
        );
        let file = fs::read(&path).expect("the image can be read");
        let behind = symbols.address("__euninit") - start;
        assert!(
            behind >= Sizes::of(&file).ram,
            "{name}: not all variables are behind the stack"
        );
        let bounded = format!(">= {SMALLEST} B");
        measurement(
            "firmware",
            &format!("{name} stack"),
            &format!("{stack} B"),
            &bounded,
        );
        assert!(stack >= SMALLEST, "{name}: {stack} B of stack are too few");

        let largest = frame::largest(&file);
        measurement(
            "firmware",
            &format!("{name} largest frame"),
            &format!("{} B", largest.bytes),
            &format!("<= {FORBIDDEN} B"),
        );
        println!("it is of {}", largest.function);
        assert!(largest.bytes <= FORBIDDEN, "{name}: {largest:?}");
    }
}
