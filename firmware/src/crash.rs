//! Panics and hardware faults: the drives are left alone, the reason is kept, and the node begins anew.
//!
//! A reset is the safe state: setpoints stop at once, the drives' own time-outs act, and the node
//! comes back with its axes disabled and a fault that tells why. Stopping here instead would keep the
//! state for a debugger that is hardly ever there, and take the axes off the bus until somebody pulls
//! the plug.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;

use canter_shared::node::restart::{Crash, Restart};
use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};

/// Words that neither a reset nor the start-up code touches.
struct Kept(UnsafeCell<MaybeUninit<[u32; 4]>>);

// SAFETY: `take` runs once, before anything else does; `keep` is the last thing that runs at all. An
// interrupt of its own that fails meanwhile leaves words that are no crash, or its own.
unsafe impl Sync for Kept {}

#[unsafe(link_section = ".uninit.crash")]
static KEPT: Kept = Kept(UnsafeCell::new(MaybeUninit::uninit()));

/// How the run before ended, if it crashed; asked once, when the board starts.
pub fn take() -> Option<Crash> {
    let kept = KEPT.0.get().cast::<[u32; 4]>();
    // SAFETY: it is there, aligned, and any bits are numbers; volatile, because the compiler takes it
    // for uninitialised.
    let words = unsafe { kept.read_volatile() };
    // SAFETY: as above.
    unsafe { kept.write_volatile([0; 4]) };
    Crash::from_words(words)
}

/// Keeps why, and resets the chip.
fn end(restart: Restart, place: u32) -> ! {
    let words = Crash { restart, place }.words();
    // SAFETY: see `Kept`.
    unsafe { KEPT.0.get().cast::<[u32; 4]>().write_volatile(words) };
    // The reset waits for writes that are under way.
    SCB::sys_reset()
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    let line = info.location().map_or(0, |location| {
        #[cfg(feature = "stm32")]
        defmt::error!("panic at {}:{}", location.file(), location.line());
        location.line()
    });
    end(Restart::Panic, line)
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    #[cfg(feature = "stm32")]
    defmt::error!("hard fault at {:x}", frame.pc());
    end(Restart::HardFault, frame.pc())
}

#[exception]
unsafe fn DefaultHandler(number: i16) {
    #[cfg(feature = "stm32")]
    defmt::error!("unexpected interrupt {}", number);
    end(Restart::HardFault, number as u32)
}

/// On an STM32G4 a word of flash whose programming was cut short has no valid check bits, and to read it
/// brings this interrupt. In the parameters' bank that is no reason for a reset, which would only read
/// it again: the store finds by its own check that the slot is not whole, and takes the other one.
#[exception]
unsafe fn NonMaskableInt() {
    #[cfg(feature = "nucleo-g474re")]
    if crate::stm32::flash::forgives() {
        return;
    }
    end(Restart::HardFault, 0)
}
