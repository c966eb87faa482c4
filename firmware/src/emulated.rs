//! What the emulated board has in place of embassy-stm32, whose start-up waits for clocks that
//! QEMU does not model: a time driver on SysTick, and two UARTs.

pub mod slcan;
pub mod time;
pub mod trace;
mod uart;
