//! Streams of knots: a host that plans as it goes, and what happens when it does not keep up.

use super::answer::Refusal;
use super::{Axis, Outcome};
use crate::time::Tick;
use crate::units::{Position, Velocity};
use crate::wire::reason::Reason;

impl Axis {
    /// Takes on a stream that leaves `start` from rest.
    pub(super) fn begin_stream(
        &mut self,
        _start: Tick,
        _period: u8,
        _number: u8,
    ) -> Result<u32, Refusal> {
        Err((Reason::BadValue, 0))
    }

    /// Takes the next knot. It is answered where it is refused, and where knots before it are missing.
    pub(super) fn take_knot(
        &mut self,
        _position: Position,
        _velocity: Velocity,
        _number: u8,
    ) -> Outcome {
        Outcome::Ignored
    }
}
