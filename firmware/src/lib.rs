//! canter's node on a microcontroller.
//!
//! Everything that decides is in `canter-shared`; this crate wires peripherals to it. The tasks
//! are the same on every board:
//!
//! | module | what it holds |
//! |---|---|
//! | [`port`] | what a board must bring: a CAN bus, a drive port, a watchdog |
//! | `stm32` | what the boards with an STM32 share: controllers, watchdog, flash, LED, the start |
//! | `emulated` | what the emulated board has in their place |
//! | [`bit_timing`] | how long a bit is, and where it is sampled |
//! | [`crash`] | what is done about panics and hardware faults |
//! | [`memory`] | copies and fills that take little flash |
//! | [`node`] | the node that the tasks share, and the lock around it |
//! | [`control`] | the 1 kHz task |
//! | [`bus`] | the receive and the transmit task |
//! | [`planning`] | the planning task |
//! | [`storage`] | the storage task |
//! | [`priority`] | who may interrupt whom |
//!
//! A board is one file in `src/bin/`: clocks and pins. Exactly one board's feature is on in a build.
#![no_std]

/// How many boards' features are on.
const BOARDS: usize = cfg!(feature = "nucleo-g474re") as usize
    + cfg!(feature = "nucleo-f446re") as usize
    + cfg!(feature = "nucleo-h743zi2") as usize
    + cfg!(feature = "emulated") as usize;
const _: () = assert!(
    BOARDS == 1,
    "choose one board by its feature: `nucleo-g474re` (the default), or with `--no-default-features` \
     `nucleo-f446re`, `nucleo-h743zi2` or `emulated`"
);

pub mod bit_timing;
pub mod bus;
pub mod control;
pub mod crash;
#[cfg(feature = "emulated")]
pub mod emulated;
pub mod memory;
pub mod node;
pub mod planning;
pub mod port;
pub mod priority;
#[cfg(feature = "stm32")]
pub mod stm32;
pub mod storage;

use canter_shared::time::LocalTime;

/// This device's own clock, now.
pub fn now() -> LocalTime {
    LocalTime(embassy_time::Instant::now().as_micros())
}
