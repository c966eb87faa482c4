//! The emulated machine: a counter of instructions, standard output, and the way out.

use core::fmt::Display;
use core::hint::black_box;
use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use cortex_m_semihosting::{debug, hprintln};

/// TIM2's counter. QEMU clocks it with 1 GHz, and `-icount shift=0` lets 1 ns pass with each
/// instruction, so it counts instructions.
const COUNTER: *const u32 = 0x4000_0024 as *const u32;

fn counter() -> u32 {
    // SAFETY: a register of the emulated chip that is always there; reading it changes nothing.
    unsafe { COUNTER.read_volatile() }
}

/// How many instructions `call` takes, without the counting itself. At most 4e9.
///
/// The compiler knows what stands around the call: hide its input behind
/// [`core::hint::black_box`], or it may be computed before the first count.
pub fn count<T>(call: impl FnOnce() -> T) -> u32 {
    let counting = span(|| ());
    span(call).saturating_sub(counting)
}

#[inline(always)]
fn span<T>(call: impl FnOnce() -> T) -> u32 {
    let before = counter();
    let result = call();
    let after = counter();
    black_box(result);
    after.wrapping_sub(before)
}

/// Prints one result.
pub fn report(name: impl Display, value: impl Display) {
    hprintln!("{name}={value}");
}

/// Ends QEMU with success.
pub fn finish() -> ! {
    debug::exit(debug::EXIT_SUCCESS);
    unreachable!("QEMU has ended")
}

fn fail() -> ! {
    debug::exit(debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::wfi();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    hprintln!("{info}");
    fail()
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    hprintln!("hard fault: {frame:?}");
    fail()
}
