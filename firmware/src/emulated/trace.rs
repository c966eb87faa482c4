//! The emulated board's drive port: every setpoint leaves on USART2 as a record of fixed length,
//! so that a test can compare every bit.
//!
//! | bytes | what, little-endian |
//! |---|---|
//! | 0..2 | [`MAGIC`] |
//! | 2 | axis |
//! | 3 | state, as in the heartbeat |
//! | 4..8 | the tick's lower 32 bits |
//! | 8..16 | position, i64 |
//! | 16..24 | velocity, i64 |
//! | 24..32 | acceleration, i64 |

use canter_shared::node::AxisSetpoint;
use stm32_metapac::USART2;

use super::uart;
use crate::port::SetpointSink;

/// What every record starts with.
pub const MAGIC: u16 = 0xCA7E;

/// Bytes in one record.
pub const LENGTH: usize = 32;

/// Writes records to USART2.
pub struct Trace(());

impl Trace {
    /// Switches USART2 on.
    pub fn start() -> Self {
        uart::start(USART2, false);
        Self(())
    }
}

impl SetpointSink for Trace {
    fn put(&mut self, setpoints: &[AxisSetpoint]) {
        for setpoint in setpoints {
            uart::write(USART2, &record(setpoint));
        }
    }
}

fn record(axis: &AxisSetpoint) -> [u8; LENGTH] {
    let head = u64::from(MAGIC)
        | u64::from(axis.axis.get()) << 16
        | (axis.state as u64) << 24
        | axis.tick.0 << 32;
    let words = [
        head,
        axis.setpoint.position.counts() as u64,
        axis.setpoint.velocity.counts() as u64,
        axis.setpoint.acceleration.counts() as u64,
    ];
    let mut record = [0; LENGTH];
    for (bytes, word) in record.chunks_exact_mut(8).zip(words) {
        bytes.copy_from_slice(&word.to_le_bytes());
    }
    record
}
