//! What the measuring images share.
//!
//! They run on QEMU's netduinoplus2 machine, a Cortex-M4F, and talk through semihosting:
//!
//! ```text
//! qemu-system-arm -M netduinoplus2 -kernel IMAGE -nographic -monitor none -serial none \
//!     -icount shift=0 -semihosting-config enable=on,target=native
//! ```
//!
//! Each result is a line `name=value` on standard output, and the exit status is 0 only when an
//! image got to its end.
#![no_std]

pub mod scenario;

#[cfg(target_arch = "arm")]
mod machine;
// What the product's images copy with: it counts in every figure.
#[cfg(target_arch = "arm")]
#[path = "../../../firmware/src/memory.rs"]
mod memory;
#[cfg(target_arch = "arm")]
mod spread;

#[cfg(target_arch = "arm")]
pub use machine::{count, finish, report, stack};
#[cfg(target_arch = "arm")]
pub use spread::Spread;
