//! What resets the chip when the control loop does not get on.

use embassy_stm32::Peri;
use embassy_stm32::pac;
#[cfg(not(feature = "nucleo-h743zi2"))]
use embassy_stm32::peripherals::IWDG as Peripheral;
#[cfg(feature = "nucleo-h743zi2")]
use embassy_stm32::peripherals::IWDG1 as Peripheral;
use embassy_stm32::wdg::IndependentWatchdog;

use crate::port::Watchdog;

/// The watchdog's period: 20 ticks, far above any jitter, and short enough that a drive's own
/// time-out (25 ms and more) is not the first to notice.
///
/// The LSI that clocks it is nominally 32 kHz. On an STM32G4 it is 29.5 to 34 kHz, so it bites after
/// 18.8 to 21.7 ms; on an STM32H7 31.4 to 32.6 kHz, 19.6 to 20.4 ms; on an STM32F4 17 to 47 kHz,
/// 13.6 to 37.6 ms.
const PERIOD_MICROSECONDS: u32 = 20_000;

/// The independent watchdog of the chip.
pub struct Dog(IndependentWatchdog<'static, Peripheral>);

impl Dog {
    /// Set up, and not running yet.
    pub fn new(peripheral: Peri<'static, Peripheral>) -> Self {
        let dog = Self(IndependentWatchdog::new(peripheral, PERIOD_MICROSECONDS));
        // A processor that a debugger has halted cannot feed it.
        #[cfg(feature = "nucleo-g474re")]
        pac::DBGMCU.apb1lfzr().modify(|w| w.set_iwdg(true));
        #[cfg(feature = "nucleo-f446re")]
        pac::DBGMCU.apb1fzr().modify(|w| w.set_iwdg(true));
        #[cfg(feature = "nucleo-h743zi2")]
        pac::DBGMCU.apb4fzr1().modify(|w| w.set_iwdg1(true));
        dog
    }

    /// From here on it must be fed.
    pub(super) fn unleash(&mut self) {
        self.0.unleash();
    }
}

impl Watchdog for Dog {
    fn feed(&mut self) {
        self.0.pet();
    }
}

/// Lets it wait for longer than an STM32F4 takes to erase a sector of 16 KiB, at most 0.5 s: at 47 kHz
/// 4096 x 16 / 47 000 = 1.39 s.
#[cfg(feature = "nucleo-f446re")]
pub(super) fn wait_longer() {
    set(pac::iwdg::vals::Pr::DIVIDE_BY16, 0xFFF);
}

/// As [`Dog::new`] has set it: 20 ms x 32 kHz / 4.
#[cfg(feature = "nucleo-f446re")]
pub(super) fn wait_as_usual() {
    set(
        pac::iwdg::vals::Pr::DIVIDE_BY4,
        (PERIOD_MICROSECONDS / 1_000 * 32 / 4 - 1) as u16,
    );
}

#[cfg(feature = "nucleo-f446re")]
fn set(prescaler: pac::iwdg::vals::Pr, reload: u16) {
    use pac::iwdg::vals::Key;

    let registers = pac::IWDG;
    registers.kr().write(|w| w.set_key(Key::ENABLE));
    registers.pr().write(|w| w.set_pr(prescaler));
    registers.rlr().write(|w| w.set_rl(reload));
    // They take over within five clocks of the LSI each; before that the old ones would be counted.
    loop {
        let state = registers.sr().read();
        if !state.pvu() && !state.rvu() {
            break;
        }
    }
    registers.kr().write(|w| w.set_key(Key::RESET));
}
