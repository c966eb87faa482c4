//! All joints of a quadruped in a row: leg after leg, each leg's in its own order.

use crate::gait::{LEGS, Quadruped, State};
use canter_shared::wire::id::AxisId;

/// How many joints a quadruped has.
pub const JOINTS: usize = 3 * LEGS;

/// The axes that move them.
pub fn axes(quadruped: &Quadruped) -> [AxisId; JOINTS] {
    std::array::from_fn(|index| quadruped.mounts[index / 3].leg.axes[index % 3])
}

/// Where they are, in rad.
pub fn positions(state: &State) -> [f64; JOINTS] {
    std::array::from_fn(|index| state.joints[index / 3].position[index % 3])
}

/// How fast they are, in rad/s.
pub fn velocities(state: &State) -> [f64; JOINTS] {
    std::array::from_fn(|index| state.joints[index / 3].velocity[index % 3])
}
