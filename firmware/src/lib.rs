//! canter's node on a microcontroller.
//!
//! Everything that decides is in `canter-shared`; this crate wires peripherals to it. The tasks
//! are the same on every board:
//!
//! | module | what it holds |
//! |---|---|
//! | [`port`] | what a board must bring: a CAN bus, a drive port, a watchdog |
//! | [`node`] | the node that the tasks share, and the lock around it |
//! | [`control`] | the 1 kHz task |
//! | [`bus`] | the receive and the transmit task |
//! | [`planning`] | the planning task |
//! | [`storage`] | the storage task |
//! | [`priority`] | who may interrupt whom |
//!
//! A board is one file in `src/bin/`: clocks, pins, interrupts, and thin `#[task]` wrappers,
//! because a task cannot be generic. Exactly one board's feature is on in a build.
#![no_std]

#[cfg(all(feature = "nucleo-g474re", feature = "emulated"))]
compile_error!(
    "features `nucleo-g474re` and `emulated` exclude each other: for the emulated board, build \
     with `--no-default-features --features emulated`"
);
#[cfg(not(any(feature = "nucleo-g474re", feature = "emulated")))]
compile_error!("choose a board: feature `nucleo-g474re` (the default) or `emulated`");

pub mod bus;
pub mod control;
#[cfg(feature = "emulated")]
pub mod emulated;
pub mod node;
pub mod planning;
pub mod port;
pub mod priority;
pub mod storage;

use canter_shared::time::LocalTime;

/// This device's own clock, now.
pub fn now() -> LocalTime {
    LocalTime(embassy_time::Instant::now().as_micros())
}
