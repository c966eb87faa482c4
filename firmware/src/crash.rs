//! Panics and hardware faults: the drives are left alone, the reason is kept, and the node begins anew.
//!
//! A reset is the safe state: setpoints stop at once, the drives' own time-outs act, and the node
//! comes back with its axes disabled and a fault that tells why. Stopping here instead would keep the
//! state for a debugger that is hardly ever there, and take the axes off the bus until somebody pulls
//! the plug.
//!
//! The stack is at the beginning of RAM and the variables are behind it, so that one that grows too large
//! runs out of RAM and not into them. What is there belongs to the chip and not to the processor's
//! architecture (reserved addresses, an STM32G4's option bytes), so [`guard_stack`] forbids it.

use core::arch::asm;
use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;

use canter_shared::node::restart::{Crash, Restart};
use cortex_m::peripheral::{MPU, SCB};
use cortex_m_rt::exception;

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

unsafe extern "C" {
    /// The stack's lowest byte, which is RAM's: from the linker script.
    static _stack_end: u8;
    /// What is right behind the stack.
    static _stack_start: u8;
}

/// Forbids the 32 KiB below the stack, more than any function has on it: to touch them is a hard fault.
///
/// Nothing else is there that the firmware reads: the chip's own id is farther away.
pub fn guard_stack() {
    /// 0x1FFF_8000, as region 0.
    const BELOW_RAM: u32 = 0x1FFF_8000 | 1 << 4;
    /// No access, no code, 2^(14 + 1) bytes, enabled.
    const FORBIDDEN: u32 = 1 << 28 | 14 << 1 | 1;
    /// Enabled, but not for the hard fault itself; everything else is as without regions.
    const ENABLED: u32 = 1 << 2 | 1;

    // SAFETY: nobody else uses these registers, and what is allowed afterwards is all that is there.
    unsafe {
        let mpu = &*MPU::PTR;
        mpu.rbar.write(BELOW_RAM);
        mpu.rasr.write(FORBIDDEN);
        mpu.ctrl.write(ENABLED);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Keeps why, and resets the chip.
fn end(restart: Restart, place: u32) -> ! {
    let words = Crash { restart, place }.words();
    // SAFETY: see `Kept`.
    unsafe { KEPT.0.get().cast::<[u32; 4]>().write_volatile(words) };
    // The reset waits for writes that are under way.
    SCB::sys_reset()
}

/// What a panic says, and the files and lines that it could say it of, would be 12 KiB of an image. So nothing
/// looks at them, and none of it is in there: the place is an address, which `addr2line` turns into a line.
#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    let place = panicked_at();
    #[cfg(feature = "stm32")]
    defmt::error!("panic at {:x}", place);
    end(Restart::Panic, place)
}

/// Where a panic's call came from, by the chain of frames that begins with register 7.
///
/// Between that and here are functions that do nothing but call the next one.
fn panicked_at() -> u32 {
    /// More than there ever are.
    const RELAYS: usize = 8;
    let mut frame: *const [u32; 2];
    // SAFETY: it only reads a register.
    unsafe { asm!("mov {}, r7", out(reg) frame, options(nomem, nostack, preserves_flags)) };
    let mut place = 0;
    for _ in 0..RELAYS {
        if !is_on_stack(frame.addr()) || !frame.is_aligned() {
            break;
        }
        // SAFETY: it is on the stack and so in RAM.
        let [outer, back] = unsafe { frame.read_volatile() };
        place = back;
        if !is_relay(back) {
            break;
        }
        frame = outer as *const [u32; 2];
    }
    place
}

/// Whether the function that a call returns to begins with that call: `push {r7, lr}`, `mov r7, sp`, perhaps
/// a number for it, and the four bytes of the call.
fn is_relay(back: u32) -> bool {
    const BEGINS: [u16; 2] = [0xB580, 0x466F];
    unsafe extern "C" {
        static __stext: u8;
        static __etext: u8;
    }
    let code = (&raw const __stext).addr()..(&raw const __etext).addr();
    // Without the bit that tells Thumb code.
    let back = back as usize & !1;
    [8, 10].into_iter().any(|before| {
        let begins = back.wrapping_sub(before);
        // SAFETY: it is code, and so in flash.
        code.contains(&begins) && unsafe { (begins as *const [u16; 2]).read_volatile() } == BEGINS
    })
}

fn is_on_stack(address: usize) -> bool {
    let stack = (&raw const _stack_end).addr()..(&raw const _stack_start).addr();
    stack.contains(&address)
}

/// The stack may be what failed, so this takes all of it anew: nobody returns to what was on it.
// SAFETY: this is the name that the vector table asks for, and a handler with what it needs.
#[unsafe(export_name = "HardFault")]
#[unsafe(naked)]
unsafe extern "C" fn hard_fault() -> ! {
    core::arch::naked_asm!(
        "mrs r0, msp",
        "movw r1, #:lower16:_stack_start",
        "movt r1, #:upper16:_stack_start",
        "msr msp, r1",
        "b {}",
        sym after_hard_fault,
    )
}

/// `frame` is where the processor has put its registers, or would have, had the stack not been full.
extern "C" fn after_hard_fault(frame: *const [u32; 8]) -> ! {
    let place = if is_on_stack(frame.addr()) {
        // SAFETY: it is on the stack and so in RAM; the program counter is the last but one of eight.
        unsafe { (&raw const (*frame)[6]).read_volatile() }
    } else {
        frame.addr() as u32
    };
    #[cfg(feature = "stm32")]
    defmt::error!("hard fault at {:x}", place);
    end(Restart::HardFault, place)
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
