//! A servo drive with the machine behind it.

use canter_shared::units::{Position, Velocity};

/// Where a shaft really is, whatever its encoder says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PlantState {
    /// Where it is.
    pub position: Position,
    /// How fast it turns.
    pub velocity: Velocity,
}
