//! What may be asked of a robot under way, and how it is written.

use crate::gait::{Body, Gait};

/// What is asked of a robot under way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Order {
    /// Other velocities, height or lean.
    Body(Body),
    /// Another gait.
    Gait(Gait),
    /// Settle, stand, sit down. Nothing is obeyed after it.
    Stop,
}
