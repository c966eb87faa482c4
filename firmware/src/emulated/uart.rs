//! The little that QEMU models of a UART: data, and whether some is there.

use stm32_metapac::usart::Usart;

/// Switches the UART on, with an interrupt for each byte where `receive` is set.
///
/// No baud rate: QEMU hands bytes over as they come.
pub fn start(uart: Usart, receive: bool) {
    uart.cr1().write(|w| {
        w.set_ue(true);
        w.set_te(true);
        w.set_re(receive);
        w.set_rxneie(receive);
    });
}

/// Sends all of `bytes`, polling: QEMU takes a byte at once.
pub fn write(uart: Usart, bytes: &[u8]) {
    for byte in bytes {
        while !uart.sr().read().txe() {}
        uart.dr().write(|w| w.set_dr(u16::from(*byte)));
    }
}

/// The byte that has come, if one has.
pub fn read(uart: Usart) -> Option<u8> {
    let full = uart.sr().read().rxne();
    full.then(|| uart.dr().read().dr() as u8)
}
