//! The emulated board's drive port: every setpoint leaves on USART2 as a record of fixed length,
//! so that a test can compare every bit.
//!
//! An axis that stands, in the state that it was in, says nothing: QEMU hands over byte by byte, and 96 000 of
//! them in a second keep a slow machine from anything else.
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

use canter_shared::axis::state::State;
use canter_shared::motion::Setpoint;
use canter_shared::node::AxisSetpoint;
use canter_shared::units::Velocity;
use stm32_metapac::USART2;

use super::uart;
use crate::node::AXES;
use crate::port::SetpointSink;

/// What every record starts with.
pub const MAGIC: u16 = 0xCA7E;

/// Bytes in one record.
pub const LENGTH: usize = 32;

/// Writes records to USART2.
pub struct Trace {
    /// What each axis said last.
    said: [Option<(State, Setpoint)>; AXES],
}

impl Trace {
    /// Switches USART2 on.
    pub fn start() -> Self {
        uart::start(USART2, false);
        Self { said: [None; AXES] }
    }
}

impl SetpointSink for Trace {
    fn put(&mut self, setpoints: &[AxisSetpoint]) {
        for (said, axis) in self.said.iter_mut().zip(setpoints) {
            let now = Some((axis.state, axis.setpoint));
            if *said != now || axis.setpoint.velocity != Velocity::ZERO {
                *said = now;
                uart::write(USART2, &record(axis));
            }
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
