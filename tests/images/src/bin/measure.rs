//! Counts the instructions of the core's inner functions.
#![no_std]
#![no_main]

use canter_images::{count, finish, report};
use cortex_m_rt::entry;

/// A known number of instructions, to see that the count is right.
#[inline(always)]
fn nops_1000() {
    // SAFETY: does nothing, a thousand times.
    unsafe { core::arch::asm!(".rept 1000", "nop", ".endr", options(nomem, nostack)) };
}

#[entry]
fn main() -> ! {
    report("calibration.nops_1000", count(nops_1000));
    finish()
}
