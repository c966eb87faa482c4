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

/// What the stack is painted with.
const PAINT: u32 = 0x5741_4C4C;

/// How far below itself [`stack`] paints, in words: 32 KiB of the machine's 128.
const PAINTED: usize = 8 * 1024;

/// How many bytes of stack `call` takes, at most 32 KiB.
#[inline(never)]
pub fn stack<T>(call: impl FnOnce() -> T) -> u32 {
    let top: *mut u32;
    // SAFETY: reads a register.
    unsafe { core::arch::asm!("mov {}, sp", out(reg) top, options(nomem, nostack)) };
    for below in 1..=PAINTED {
        // SAFETY: RAM below the stack that nobody uses: the image's own data are far below, and
        // no interrupt is on.
        unsafe { top.sub(below).write_volatile(PAINT) };
    }
    black_box(apart(call));
    for below in (1..=PAINTED).rev() {
        // SAFETY: as above.
        if unsafe { top.sub(below).read_volatile() } != PAINT {
            return 4 * below as u32;
        }
    }
    0
}

/// The call in a frame of its own, below that of the one who paints.
#[inline(never)]
fn apart<T>(call: impl FnOnce() -> T) -> T {
    call()
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
