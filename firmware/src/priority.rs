//! Who may interrupt whom, as NVIC priorities of 16 levels: a lower number wins.
//!
//! | priority | who | for how long |
//! |---|---|---|
//! | 0 | the time driver: makes tasks ready | about 1 us |
//! | 1 | the CAN interrupt | about 1 us for each frame |
//! | 2 | takes a frame out of the hardware and notes the time | about 2 us for each frame |
//! | 4 | the 1 kHz task | one tick |
//! | 8 | receive task, transmit task | 2000 instructions for each frame and axis |
//! | 12 | planning task: works out changes of motion | up to 0.6 ms for each axis |
//! | 14 | storage task: erases and writes flash | some 30 ms for each save |
//! | thread | sleeps | |
//!
//! What stands above the 1 kHz task is bounded by the bus: 1 Mbit/s carries at most one frame in
//! 47 us, so it costs the tick at most 4 us in each 47. In return a SYNC is stamped when it comes
//! and not after a tick, and a FIFO of three frames (141 us) does not overflow during one.

/// The CAN peripheral's own interrupt.
pub const CAN_INTERRUPT: u8 = 1;

/// The executor that only moves frames from the hardware into a queue.
pub const RECEPTION: u8 = 2;

/// The executor of the 1 kHz task, and the ceiling of the node's lock.
pub const CONTROL: u8 = 4;

/// The executor of the receive and the transmit task.
pub const BUS: u8 = 8;

/// The executor of the planning task: below all that must not wait.
pub const PLANNING: u8 = 12;

/// The executor of the storage task, which waits for the flash: below planning, so that a stop that
/// comes meanwhile is planned at once.
pub const STORAGE: u8 = 14;

/// The priority as the NVIC's registers and BASEPRI take it: in the upper 4 of 8 bits.
pub const fn register(priority: u8) -> u8 {
    priority << 4
}
