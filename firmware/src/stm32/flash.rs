//! Where parameters are kept, on each chip.
//!
//! | board | slots | erasing one takes | meanwhile |
//! |---|---|---|---|
//! | nucleo-g474re | the last two pages of 2 KiB of the second bank | some 22 ms | everything goes on |
//! | nucleo-f446re | sectors 1 and 2 of 16 KiB | 0.25 s, at most 0.5 s | the processor stands still |
//! | nucleo-h743zi2 | the last two sectors of 128 KiB of the second bank | 1 to 2 s | everything goes on |
//!
//! Where everything goes on, the image is in the other bank, from which the processor reads while one
//! is erased or written: neither the 1 kHz task nor the watchdog waits for that, only the storage task
//! does. A node is saved only while all of its axes are without torque, so that a processor that stands
//! still leads nothing astray.

use canter_shared::parameter::flash::ERASED;
use embassy_stm32::Peri;
use embassy_stm32::flash::{Blocking, Error, FLASH_SIZE, Flash};
use embassy_stm32::peripherals::FLASH;
use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

/// From the flash's beginning to the first slot, in bytes.
#[cfg(feature = "nucleo-g474re")]
pub const SLOTS: u32 = 512 * 1024 - 2 * SLOT;
/// Bytes of a slot: a page.
#[cfg(feature = "nucleo-g474re")]
pub const SLOT: u32 = 2 * 1024;

/// From the flash's beginning to the first slot, in bytes: build.rs leaves room behind the vector table.
#[cfg(feature = "nucleo-f446re")]
pub const SLOTS: u32 = SLOT;
/// Bytes of a slot: a sector.
#[cfg(feature = "nucleo-f446re")]
pub const SLOT: u32 = 16 * 1024;

/// From the flash's beginning to the first slot, in bytes.
#[cfg(feature = "nucleo-h743zi2")]
pub const SLOTS: u32 = 2048 * 1024 - 2 * SLOT;
/// Bytes of a slot: a sector.
#[cfg(feature = "nucleo-h743zi2")]
pub const SLOT: u32 = 128 * 1024;

/// The chip's flash, with what this chip needs around it.
pub struct ParameterFlash(Peri<'static, FLASH>);

impl ParameterFlash {
    /// The whole flash; only the slots are written.
    pub fn new(flash: Peri<'static, FLASH>) -> Self {
        Self(flash)
    }

    /// The library's driver, which on an STM32G4 panics where the flash is one bank.
    ///
    /// # Errors
    /// It is one bank: nothing can be kept.
    fn driver(&mut self) -> Result<Flash<'_, Blocking>, Error> {
        if has_slots() {
            Ok(Flash::new_blocking(self.0.reborrow()))
        } else {
            Err(Error::Protected)
        }
    }
}

/// On the other chips there is nothing to choose.
#[cfg(not(feature = "nucleo-g474re"))]
fn has_slots() -> bool {
    true
}

/// Whether the option bit DBANK is set, as the chip comes. Without it pages are other ones, and the
/// processor would stand still while they are erased. The node does its work all the same, with its
/// defaults; only a save is refused.
#[cfg(feature = "nucleo-g474re")]
fn has_slots() -> bool {
    embassy_stm32::pac::FLASH.optr().read().dbank()
}

impl ErrorType for ParameterFlash {
    type Error = Error;
}

impl ReadNorFlash for ParameterFlash {
    const READ_SIZE: usize = <Flash as ReadNorFlash>::READ_SIZE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Error> {
        match self.driver() {
            Ok(mut driver) => forgiving(|| driver.blocking_read(offset, bytes)),
            Err(_) => {
                bytes.fill(ERASED);
                Ok(())
            }
        }
    }

    fn capacity(&self) -> usize {
        FLASH_SIZE
    }
}

impl NorFlash for ParameterFlash {
    const WRITE_SIZE: usize = <Flash as NorFlash>::WRITE_SIZE;
    // An STM32F4 has sectors of several sizes, and the library says the largest.
    const ERASE_SIZE: usize = SLOT as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Error> {
        let mut driver = self.driver()?;
        standing_still(|| driver.blocking_erase(from, to))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Error> {
        let mut driver = self.driver()?;
        standing_still(|| driver.blocking_write(offset, bytes))
    }
}

/// On the other chips the processor goes on.
#[cfg(not(feature = "nucleo-f446re"))]
fn standing_still<T>(work: impl FnOnce() -> T) -> T {
    work()
}

/// One bank only: the processor stands still while it is erased or written, so the watchdog has to wait.
#[cfg(feature = "nucleo-f446re")]
fn standing_still<T>(work: impl FnOnce() -> T) -> T {
    use embassy_stm32::pac;

    super::watchdog::wait_longer();
    // What the cache holds of a sector is not true any more once that is erased.
    pac::FLASH.acr().modify(|w| w.set_dcen(false));
    let result = work();
    pac::FLASH.acr().modify(|w| w.set_dcrst(true));
    pac::FLASH.acr().modify(|w| {
        w.set_dcrst(false);
        w.set_dcen(true);
    });
    super::watchdog::wait_as_usual();
    result
}

/// On an STM32F4 there are no check bits; for an STM32G4 see [`crate::crash`].
#[cfg(not(feature = "nucleo-h743zi2"))]
fn forgiving<T>(read: impl FnOnce() -> T) -> T {
    read()
}

/// A word of flash whose programming was cut short has no valid check bits, and to read it is a bus
/// fault. Such a slot is not whole, which the store finds by its own check: so the read goes on, with
/// whatever is there.
#[cfg(feature = "nucleo-h743zi2")]
fn forgiving<T>(read: impl FnOnce() -> T) -> T {
    use cortex_m::peripheral::SCB;

    /// CCR.BFHFNMIGN: code of a hard fault's priority goes on after a bus fault of its own data.
    const IGNORE_BUS_FAULTS: u32 = 1 << 8;

    // SAFETY: nobody else writes this register after the start, and all of it is read and written back.
    let configuration = unsafe { &(*SCB::PTR).ccr };
    // SAFETY: between the two a bus fault of a read is passed over. FAULTMASK raises the priority to a
    // hard fault's and holds everything else off, for some microseconds.
    unsafe {
        core::arch::asm!("cpsid f");
        configuration.modify(|ccr| ccr | IGNORE_BUS_FAULTS);
    }
    let result = read();
    // SAFETY: as above; the read has ended before the barrier does.
    unsafe {
        cortex_m::asm::dsb();
        configuration.modify(|ccr| ccr & !IGNORE_BUS_FAULTS);
        core::arch::asm!("cpsie f");
    }
    result
}

/// Whether the non-maskable interrupt that is being answered came from a word of the parameters' bank;
/// then it is cleared.
#[cfg(feature = "nucleo-g474re")]
pub fn forgives() -> bool {
    use embassy_stm32::pac;

    let state = pac::FLASH.eccr().read();
    let forgives = (state.eccd() || state.eccd2()) && state.bk_ecc();
    if forgives {
        // The flags are cleared by writing them back.
        pac::FLASH.eccr().write_value(state);
    }
    forgives
}
