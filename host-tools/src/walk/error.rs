//! Why a robot does not walk, and the cure.

use super::order::OrderError;
use crate::client::ClientError;
use crate::gait::GaitError;
use canter_shared::motion::stream::KnotError;
use canter_shared::units::UnitError;

/// Why a robot does not walk.
#[derive(Debug, thiserror::Error)]
pub enum WalkError {
    /// A gait, a body or a reach that cannot be.
    #[error(transparent)]
    Gait(#[from] GaitError),
    /// The bus or an axis.
    #[error(transparent)]
    Client(#[from] ClientError),
    /// A line of orders.
    #[error(transparent)]
    Order(#[from] OrderError),
    /// A position beyond what an axis can be told.
    #[error(transparent)]
    Unit(#[from] UnitError),
    /// A knot that an axis would refuse.
    #[error("axis {axis} would refuse a knot: {source}; ask for less speed or raise its limits")]
    Knot {
        /// Which axis.
        axis: u8,
        /// Why.
        source: KnotError,
    },
    /// An axis that is nowhere near where a walk may begin.
    #[error(
        "axis {axis} ({leg}) is at {position:.3} rad: a walk begins where all legs hang ({hanging:.3}), \
         sit ({sitting:.3}) or stand ({standing:.3}), each axis within {tolerance} rad; bring it there \
         by hand, or with `canter move {axis}={hanging:.3}` where nothing is in its way"
    )]
    Pose {
        /// Which axis.
        axis: u8,
        /// Its leg.
        leg: &'static str,
        /// Where it is, in rad.
        position: f64,
        /// Where it hangs.
        hanging: f64,
        /// Where it sits.
        sitting: f64,
        /// Where it stands.
        standing: f64,
        /// How far off it may be, in rad.
        tolerance: f64,
    },
    /// The bus would be too full.
    #[error(
        "the walk would take {load:.0} % of a bus of {bitrate} bit/s, and {most:.0} % are the most: \
         use a faster bus, or let the axes report less often: `canter param set feedback.period`"
    )]
    Budget {
        /// The share in percent.
        load: f64,
        /// The bus's rate in bit/s.
        bitrate: u32,
        /// The most that is allowed, in percent.
        most: f64,
    },
}

impl WalkError {
    /// Whether it says that the question was wrong, rather than that the robot cannot do it.
    pub fn is_usage(&self) -> bool {
        matches!(self, Self::Gait(error) if error.is_usage())
    }
}
