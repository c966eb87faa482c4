//! What the last reset came from.

use embassy_stm32::pac;

/// What the last reset came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, defmt::Format)]
pub(super) enum Cause {
    /// The watchdog.
    Watchdog,
    /// The program itself, or a debugger.
    Software,
    /// Power came, or fell too low.
    Power,
    /// The reset pin.
    Pin,
}

/// Reads the chip's flags, and clears them for the next time.
pub(super) fn cause() -> Cause {
    #[cfg(not(feature = "nucleo-h743zi2"))]
    let register = pac::RCC.csr();
    #[cfg(feature = "nucleo-h743zi2")]
    let register = pac::RCC.rsr();
    let flags = register.read();
    register.modify(|w| w.set_rmvf(true));

    #[cfg(feature = "nucleo-g474re")]
    let (watchdog, power) = (flags.iwdgrstf(), flags.borrstf());
    #[cfg(feature = "nucleo-f446re")]
    let (watchdog, power) = (flags.wdgrstf(), flags.porrstf() || flags.borrstf());
    #[cfg(feature = "nucleo-h743zi2")]
    let (watchdog, power) = (flags.iwdg1rstf(), flags.porrstf() || flags.borrstf());
    // Power sets others too, and every reset pulls the pin, so that is the last to be believed.
    if power {
        Cause::Power
    } else if watchdog {
        Cause::Watchdog
    } else if flags.sftrstf() {
        Cause::Software
    } else {
        Cause::Pin
    }
}
