//! The knots that are out, and when each is due.

use super::losses::Losses;
use super::{Pace, StreamKnot};
use crate::client::ClientError;
use crate::client::link::after;
use canter_shared::time::{BusTime, Tick};
use canter_shared::units::{Position, Velocity};
use canter_shared::wire::command::{Command, wire_position, wire_velocity};
use canter_shared::wire::id::AxisId;
use std::collections::VecDeque;

/// Knots are numbered from 0 to 63.
const NUMBERS: u64 = 64;

/// What has been sent to one axis.
pub(super) struct Sent {
    pub axis: AxisId,
    /// The knot that is to be sent next, counted from 1.
    pub next: u64,
    /// So much later than the others', in microseconds: the axis had no room when they were due.
    pub delay: u64,
    pub missing: u32,
    pub losses: Losses,
    /// The last knot that was refused and sent again with those before it, 0 for none, and how often.
    pub asked_again: (u64, u32),
    /// Where the last knot is, and whether it is at rest there.
    pub last: (Position, bool),
}

/// When each knot is due.
#[derive(Clone, Copy)]
pub(super) struct Timing {
    pub start: Tick,
    pub pace: Pace,
}

impl Timing {
    /// When the axes are to pass the knot of this number.
    pub fn due(&self, number: u64) -> BusTime {
        after(self.start.time(), number * self.pace.period())
    }

    /// When it is to be sent.
    pub fn departs(&self, number: u64) -> BusTime {
        BusTime(self.due(number).0.saturating_sub(self.pace.look_ahead()))
    }
}

/// A stream under way.
pub(super) struct Stream {
    pub sequence: u8,
    pub timing: Timing,
    pub sent: Vec<Sent>,
    /// Knots of all axes that an axis may still ask for again, the first of them numbered `first`.
    pub window: VecDeque<Vec<Command>>,
    pub first: u64,
    /// Whether there are no more.
    pub complete: bool,
}

impl Stream {
    /// The knot that comes after those that are there.
    pub fn following(&self) -> u64 {
        self.first + self.window.len() as u64
    }

    /// The latest knot that has this number in its frame.
    pub fn latest(&self, number: u8) -> u64 {
        let last = self.following() - 1;
        let back = (last % NUMBERS + NUMBERS - u64::from(number) % NUMBERS) % NUMBERS;
        last.saturating_sub(back)
    }

    /// Takes one more knot for each axis.
    pub fn take(&mut self, knots: &[StreamKnot]) -> Result<(), ClientError> {
        if knots.len() != self.sent.len() {
            return Err(ClientError::KnotCount {
                axes: self.sent.len(),
                knots: knots.len(),
            });
        }
        let number = (self.following() % NUMBERS) as u8;
        let mut commands = Vec::with_capacity(knots.len());
        for (knot, sent) in knots.iter().zip(&mut self.sent) {
            let axis = sent.axis;
            let quantity = |source| ClientError::Quantity { axis, source };
            let position = wire_position(Position::from_radians(knot.position).map_err(quantity)?);
            let velocity = wire_velocity(Velocity::from_radians(knot.velocity).map_err(quantity)?);
            sent.last = (position, velocity == Velocity::ZERO);
            commands.push(Command::Knot {
                position,
                velocity,
                number,
            });
        }
        self.window.push_back(commands);
        Ok(())
    }

    /// Forgets knots whose time has long passed: nobody asks for them any more.
    pub fn forget(&mut self, now: BusTime) {
        while !self.window.is_empty()
            && after(self.timing.due(self.first), self.timing.pace.look_ahead()) < now
            && self.sent.iter().all(|sent| sent.next > self.first)
        {
            self.window.pop_front();
            self.first += 1;
        }
    }
}
