//! What the boards with an STM32 share, on top of embassy-stm32.
//!
//! | file | what it holds |
//! |---|---|
//! | `start` | from a board's parts to running tasks |
//! | `line` | what belongs to one CAN bus: queue, counts, recovery from bus-off |
//! | `fdcan` | the controllers of an STM32G4 and H7 |
//! | `bxcan` | the controllers of an STM32F4 |
//! | `flash` | where parameters are kept |
//! | `watchdog` | what resets the chip when the control loop does not get on |
//! | `reset` | what the last reset came from |
//! | `led` | what the board's LED says |

#[cfg(feature = "bxcan")]
pub mod bxcan;
#[cfg(feature = "fdcan")]
pub mod fdcan;
pub mod flash;
pub mod led;
pub mod line;
mod reset;
mod start;
pub mod watchdog;

pub use start::{Parts, start};

/// The controllers of this board's chip.
#[cfg(feature = "bxcan")]
pub use bxcan as can;
#[cfg(feature = "fdcan")]
pub use fdcan as can;

use embassy_stm32::interrupt::Priority;

/// A priority of [`crate::priority`] as the NVIC takes it.
fn level(priority: u8) -> Priority {
    Priority::from(crate::priority::register(priority))
}
