//! Streams of knots: a host that plans as it goes, and what happens when it does not keep up.
//!
//! A stream begins at rest and takes over at its start, as a planned motion does. Knots are looked
//! at and taken on at once, without planning. It ends at rest with the last knot, or it is stopped,
//! or it runs dry: then it brakes by itself, and the axis latches the fault.

use super::answer::Refusal;
use super::command::LONGEST_LEAD;
use super::fault::Fault;
use super::{Axis, Departure, Outcome};
use crate::motion::Setpoint;
use crate::motion::stream::{CubicStream, Knot, KnotError, Pushed};
use crate::time::{Tick, Ticks};
use crate::units::{Position, Velocity};
use crate::wire::id::Function;
use crate::wire::layout::POSITION_STEP;
use crate::wire::reason::Reason;
use core::num::NonZeroU8;

/// What the numbers of knots count to on the wire: 6 bits.
const NUMBERS: u8 = 64;

/// Half of the numbers: one that is ahead by less than this is new.
const AHEAD: u8 = NUMBERS / 2;

impl Axis {
    /// Takes on a stream that leaves `start` from rest.
    pub(super) fn begin_stream(
        &mut self,
        start: Tick,
        period: u8,
        number: u8,
        sequence: u8,
    ) -> Result<u32, Refusal> {
        self.ready()?;
        if self.is_moving() {
            return Err((Reason::Moving, 0));
        }
        let first = self.tick.after(Ticks(1));
        if start < first {
            return Err((Reason::TooLate, first.since(start).0));
        }
        let period = match NonZeroU8::new(period) {
            Some(period) if start.since(self.tick) <= LONGEST_LEAD => period,
            _ => return Err((Reason::BadValue, 0)),
        };
        // What is only checked so far would be checked from where the axis no longer is.
        self.call_off_stages((Reason::Moving, 0));
        let rest = Setpoint {
            position: self.course.at(self.tick).position,
            ..Setpoint::default()
        };
        let stream = CubicStream::new(start, number, rest, period);
        self.course
            .splice_stream(stream, Departure { sequence, start });
        self.telemetry.hasten();
        Ok(0)
    }

    /// Takes the next knot. It is answered where it is refused, and where knots before it are missing.
    pub(super) fn take_knot(
        &mut self,
        position: Position,
        velocity: Velocity,
        number: u8,
    ) -> Outcome {
        let answer = match self.push_knot(position, velocity, number) {
            Ok(Pushed::Repeated) => return Outcome::Repeated,
            Ok(Pushed::Accepted { missing: 0 }) => return Outcome::Accepted,
            Ok(Pushed::Accepted { missing }) => Ok(missing.into()),
            Err(refusal) => Err(refusal),
        };
        self.answer(Function::Knot, number, answer)
    }

    fn push_knot(
        &mut self,
        position: Position,
        velocity: Velocity,
        number: u8,
    ) -> Result<Pushed, Refusal> {
        let now = self.tick;
        let limits = self.planning_limits();
        let stream = self
            .course
            .stream_mut()
            .filter(|stream| !stream.is_closed());
        let stream = stream.ok_or((Reason::NotStreaming, 0))?;
        // The stream's own numbers have two bits more, which wrap with those of the wire.
        let last = stream.number();
        let ahead = number.wrapping_sub(last) % NUMBERS;
        if ahead == 0 || ahead >= AHEAD {
            return Ok(Pushed::Repeated);
        }
        let knot = Knot {
            position: limits.snap(position, POSITION_STEP),
            velocity,
            acceleration: None,
        };
        let pushed = stream.push(now, last.wrapping_add(ahead), &knot, &limits);
        pushed.map_err(|error| match error {
            KnotError::TooLate { ended } => (Reason::TooLate, now.since(ended).0),
            KnotError::Full { room } => (Reason::StreamFull, room.since(now).0),
            KnotError::TooManyMissing { missing } => (Reason::KnotsMissing, missing.into()),
            KnotError::OutsideTravel { .. } => (Reason::OutsideTravel, 0),
            KnotError::CannotStop { .. } => (Reason::CannotStop, 0),
            KnotError::TooFast { .. } => (Reason::TooFast, 0),
            KnotError::TooStrong { .. } => (Reason::TooStrong, 0),
        })
    }

    /// Notices that the stream has run dry, unless it was to be stopped anyway. It brakes already.
    pub(super) fn watch_stream(&mut self) {
        let stream = self.course.running_stream();
        if stream.is_some_and(|stream| !stream.is_closed() && stream.has_run_dry(self.tick)) {
            self.raise(Fault::StreamUnderrun);
        }
    }
}
