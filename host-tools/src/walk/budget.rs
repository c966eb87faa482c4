//! What a stream, feedback, SYNC and heartbeats take of the bus.

use super::error::WalkError;
use super::knots::PACE;
use crate::bus::Bitrate;
use crate::client::{HEARTBEAT_PERIOD, SYNC_PERIOD};
use crate::robot::Robot;
use crate::sim::bits::longest;
use canter_shared::time::Ticks;
use canter_shared::wire::id::{AxisId, Function};
use canter_shared::wire::layout::Layout;

/// The greatest share of a bus that is planned for: what is left is for faults, other hosts' questions
/// and frames that are sent again.
const MOST: f64 = 0.8;

/// What one kind of frame takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Which frames.
    pub what: &'static str,
    /// How many in one second, of all senders.
    pub frames: f64,
    /// Bits of each at worst, with stuff bits and the space to the next frame.
    pub bits: u32,
}

impl Share {
    fn of(what: &'static str, function: Function, frames: f64) -> Self {
        let length = Layout::of(function).map_or(8, |layout| layout.length);
        Self {
            what,
            frames,
            bits: longest(length),
        }
    }

    /// In bit/s.
    pub fn rate(&self) -> f64 {
        self.frames * f64::from(self.bits)
    }
}

/// What a walk takes of the bus at worst, while nothing goes wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    /// The bus's bit rate.
    pub bitrate: Bitrate,
    /// Who takes what.
    pub shares: Vec<Share>,
}

impl Budget {
    /// The budget of a stream to these axes, which report as often as the robot's parameters say.
    pub fn new(robot: &Robot, axes: &[AxisId], bitrate: Bitrate) -> Self {
        let often = |ticks: Ticks| 1.0 / ticks.seconds();
        let all = |often: &dyn Fn(AxisId) -> f64| axes.iter().map(|axis| often(*axis)).sum();
        let settings = |axis| robot.values(axis).settings();
        let beacon = |microseconds: u64| 1e6 / microseconds as f64;
        let shares = vec![
            Share::of(
                "knots",
                Function::Knot,
                all(&|_| 1e3 / f64::from(PACE.period.get())),
            ),
            Share::of(
                "feedback",
                Function::Feedback,
                all(&|axis| often(settings(axis).feedback_period)),
            ),
            Share::of(
                "heartbeats",
                Function::Heartbeat,
                all(&|axis| often(settings(axis).heartbeat_period)),
            ),
            Share::of("SYNC", Function::Sync, beacon(SYNC_PERIOD)),
            Share::of(
                "the host's heartbeat",
                Function::HostHeartbeat,
                beacon(HEARTBEAT_PERIOD),
            ),
        ];
        Self { bitrate, shares }
    }

    /// In bit/s.
    pub fn rate(&self) -> f64 {
        self.shares.iter().map(Share::rate).sum()
    }

    /// The share of the bus, 1 for all of it.
    pub fn load(&self) -> f64 {
        self.rate() / f64::from(self.bitrate.bits_per_second())
    }

    /// Whether it leaves a fifth of the bus free.
    ///
    /// # Errors
    /// It does not.
    pub fn check(&self) -> Result<(), WalkError> {
        if self.load() <= MOST {
            return Ok(());
        }
        Err(WalkError::Budget {
            load: 1e2 * self.load(),
            bitrate: self.bitrate.bits_per_second(),
            most: 1e2 * MOST,
        })
    }
}
