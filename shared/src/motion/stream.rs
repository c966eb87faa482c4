//! Streamed motion: knots at a fixed period, Hermite pieces between them, in integers.
//!
//! A host that plans as it goes sends where to be, how fast, and perhaps with which acceleration,
//! once every period. Between two knots runs the polynomial that has both their values: a cubic for
//! position and velocity, a quintic where both know their acceleration (Biagiotti and Melchiorri,
//! Trajectory Planning for Automatic Machines and Robots, chapter 2). So setpoints are continuous in
//! velocity, and in acceleration between quintics.
//!
//! A knot is taken on only if its whole piece keeps the limits and the axis can still stop inside
//! the travel from there. Limits are strict: a host that streams at a limit must leave room for
//! the rounding of its knots' positions. With a period of n ticks, positions that are each off by a
//! count can raise the velocity by 2 * 15 / 8 * 1000 / n counts/s, and the acceleration by
//! 2 * 10 / sqrt(3) * (1000 / n)^2 counts/s^2: the peaks of a quintic over a step of two counts.

mod piece;

use super::Setpoint;
use crate::limits::Limits;
use crate::time::{TICKS_PER_SECOND, Tick, Ticks};
use crate::units::{Acceleration, Position, Velocity};
use core::fmt;
use core::num::NonZeroU8;
use heapless::Deque;
use piece::Piece;

/// Pieces that a stream holds: the one under way and 100 ms ahead of it at a period of 20 ms.
pub const LOOK_AHEAD: usize = 100 / 20 + 1;

/// Periods that one piece may span: one, and those of lost knots.
pub const LONGEST_GAP: u8 = 8;

/// The longest piece in ticks, 2040.
const LONGEST_PIECE: u16 = LONGEST_GAP as u16 * u8::MAX as u16;

/// Ticks that a stop may lose to whole ticks: its deceleration begins and ends with a ramp.
const STOP_TICKS: i64 = 2;

/// Where to be at an instant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Knot {
    /// Where to be.
    pub position: Position,
    /// How fast to pass through there.
    pub velocity: Velocity,
    /// With which acceleration; `None` leaves that to the curve.
    pub acceleration: Option<Acceleration>,
}

/// What became of a knot that is not refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pushed {
    /// The stream is longer by a piece, which bridges so many missing knots; usually none.
    Accepted {
        /// Knots whose numbers were left out.
        missing: u8,
    },
    /// Its number is that of the last knot or one before it: nothing has changed.
    Repeated,
}

/// Why a knot is refused. The stream is then as it was before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KnotError {
    /// The last knot has passed: the stream has run dry.
    TooLate {
        /// The tick of the last knot.
        ended: Tick,
    },
    /// There is no room for one more piece.
    Full {
        /// The first tick at which there is.
        room: Tick,
    },
    /// More knots are missing than one piece may bridge.
    TooManyMissing {
        /// Knots whose numbers were left out.
        missing: u8,
    },
    /// The knot, or the curve that leads there, is outside the travel.
    OutsideTravel {
        /// The position that is outside.
        position: Position,
        /// The nearest that is allowed.
        nearest: Position,
    },
    /// From the knot, no stop ends inside the travel.
    CannotStop {
        /// The knot's velocity.
        velocity: Velocity,
        /// The end of the travel that it leads to.
        edge: Position,
    },
    /// The curve to the knot breaks the velocity limit.
    TooFast {
        /// A velocity that it would have.
        velocity: Velocity,
        /// The largest that is allowed, either way.
        limit: Velocity,
    },
    /// The curve to the knot breaks the acceleration or deceleration limit.
    TooStrong {
        /// An acceleration that it would have.
        acceleration: Acceleration,
        /// The lesser of the two limits.
        limit: Acceleration,
    },
}

impl fmt::Display for KnotError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLate { ended } => write!(
                formatter,
                "knot comes after the stream has ended at tick {}: \
                 send knots earlier, then start again",
                ended.0
            ),
            Self::Full { room } => write!(
                formatter,
                "knot finds {LOOK_AHEAD} pieces waiting: send it again from tick {} on",
                room.0
            ),
            Self::TooManyMissing { missing } => write!(
                formatter,
                "knot comes after {missing} missing ones, where at most {} can be bridged: \
                 send those first",
                LONGEST_GAP - 1
            ),
            Self::OutsideTravel { position, nearest } => write!(
                formatter,
                "knot leads to {} rad outside the travel, which ends at {} rad",
                position.radians(),
                nearest.radians()
            ),
            Self::CannotStop { velocity, edge } => write!(
                formatter,
                "knot's velocity {} rad/s is too high to stop before the travel ends at {} rad: \
                 slow down earlier",
                velocity.radians(),
                edge.radians()
            ),
            Self::TooFast { velocity, limit } => write!(
                formatter,
                "curve to the knot would reach {} rad/s, where at most {} rad/s are allowed: \
                 go slower or stay farther below the limit",
                velocity.radians(),
                limit.radians()
            ),
            Self::TooStrong {
                acceleration,
                limit,
            } => write!(
                formatter,
                "curve to the knot would reach {} rad/s^2, where at most {} rad/s^2 are sure to be \
                 allowed: change the velocity more gently",
                acceleration.radians(),
                limit.radians()
            ),
        }
    }
}

impl core::error::Error for KnotError {}

/// What a piece breaks: counts, counts/s or counts/s^2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Breach {
    Travel(i64),
    Velocity(i64),
    Acceleration(i64),
}

/// A knot in counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Place {
    position: i64,
    velocity: i64,
    acceleration: Option<i64>,
}

/// A stream of knots: the pieces between those that have not passed yet.
#[derive(Debug, Clone)]
pub struct Stream {
    /// The tick of the knot that the first piece begins with.
    begins: Tick,
    period: NonZeroU8,
    /// The number of the last knot.
    number: u8,
    last: Place,
    pieces: Deque<Piece, LOOK_AHEAD>,
}

impl Stream {
    /// Begins at `start` with the setpoint of that tick, which counts as the knot of this number.
    /// The knot numbered n more is due n periods of so many ticks later.
    pub fn new(start: Tick, number: u8, state: Setpoint, period: NonZeroU8) -> Self {
        Self {
            begins: start,
            period,
            number,
            last: Place {
                position: state.position.counts(),
                velocity: state.velocity.counts(),
                acceleration: Some(state.acceleration.counts()),
            },
            pieces: Deque::new(),
        }
    }

    /// Takes on a knot, where `now` is the tick of the last setpoint. Pieces that have ended by then
    /// are dropped.
    ///
    /// Numbers count upwards and wrap. Where some are left out, one longer piece bridges the gap;
    /// the left out knots can no longer come.
    ///
    /// # Errors
    /// A knot that comes too late, too early or after too many missing ones, and one whose piece
    /// would break a limit; apart from what has ended the stream is unchanged.
    pub fn push(
        &mut self,
        now: Tick,
        number: u8,
        knot: &Knot,
        limits: &Limits,
    ) -> Result<Pushed, KnotError> {
        let ahead = number.wrapping_sub(self.number);
        if ahead == 0 || ahead > u8::MAX / 2 {
            return Ok(Pushed::Repeated);
        }
        let missing = ahead - 1;
        let ended = self.ends();
        if ended < now {
            return Err(KnotError::TooLate { ended });
        }
        if ahead > LONGEST_GAP {
            return Err(KnotError::TooManyMissing { missing });
        }
        self.drop_ended(now);
        if self.pieces.is_full() {
            let first = self.pieces.front().map_or(0, Piece::ticks);
            let room = self.begins.after(Ticks(first.into()));
            return Err(KnotError::Full { room });
        }
        let to = Place {
            position: knot.position.counts(),
            velocity: knot.velocity.counts(),
            acceleration: knot.acceleration.map(Acceleration::counts),
        };
        let ticks = u16::from(ahead) * u16::from(self.period.get());
        let outside = |counts: i64| {
            let position = Position::from_counts(counts);
            let nearest = position
                .max(limits.position_minimum())
                .min(limits.position_maximum());
            KnotError::OutsideTravel { position, nearest }
        };
        if !limits.allow(knot.position) {
            return Err(outside(to.position));
        }
        let piece = Piece::between(&self.last, &to, ticks, limits).map_err(|breach| {
            let limit = limits.velocity();
            match breach {
                Breach::Travel(position) => outside(position),
                Breach::Velocity(velocity) => KnotError::TooFast {
                    velocity: Velocity::from_counts(velocity),
                    limit,
                },
                Breach::Acceleration(acceleration) => KnotError::TooStrong {
                    acceleration: Acceleration::from_counts(acceleration),
                    limit: limits.slower_acceleration(),
                },
            }
        })?;
        can_stop(knot, limits)?;
        if self.pieces.push_back(piece).is_err() {
            return Err(KnotError::Full { room: ended });
        }
        self.last = to;
        self.number = number;
        Ok(Pushed::Accepted { missing })
    }

    fn drop_ended(&mut self, now: Tick) {
        while let Some(first) = self.pieces.front() {
            let end = self.begins.after(Ticks(first.ticks().into()));
            // The last one tells with which acceleration the stream ends.
            if end > now || self.pieces.len() == 1 {
                break;
            }
            self.begins = end;
            self.pieces.pop_front();
        }
    }

    /// The setpoint at `tick`, which must not be before the last `now` given to [`Self::push`].
    ///
    /// After the last knot's tick it stands still there: unless that knot is at rest, the owner of the
    /// stream must have begun to stop by then.
    pub fn at(&self, tick: Tick) -> Setpoint {
        let mut left = tick.since(self.begins).0;
        for piece in &self.pieces {
            let ticks = u32::from(piece.ticks());
            if left < ticks {
                let (position, velocity, acceleration) = piece.at(left);
                return setpoint(position, velocity, acceleration);
            }
            left -= ticks;
        }
        if left > 0 || self.ends_at_rest() {
            return setpoint(self.last.position, 0, 0);
        }
        let acceleration = match self.pieces.back() {
            Some(last) => last.exit_acceleration(),
            None => self.last.acceleration.unwrap_or_default(),
        };
        setpoint(self.last.position, self.last.velocity, acceleration)
    }

    /// The tick of the last knot: without another one until then, the stream has run dry.
    pub fn ends(&self) -> Tick {
        let ticks = self.pieces.iter().map(|piece| u32::from(piece.ticks()));
        self.begins.after(Ticks(ticks.sum()))
    }

    /// The number of the last knot.
    pub fn number(&self) -> u8 {
        self.number
    }

    /// Whether the axis comes to rest with the last knot, so that the stream may end there.
    pub fn ends_at_rest(&self) -> bool {
        self.last.velocity == 0
            && self
                .last
                .acceleration
                .is_none_or(|acceleration| acceleration == 0)
    }
}

fn setpoint(position: i64, velocity: i64, acceleration: i64) -> Setpoint {
    Setpoint {
        position: Position::from_counts(position),
        velocity: Velocity::from_counts(velocity),
        acceleration: Acceleration::from_counts(acceleration),
    }
}

/// Whether the deceleration limit brings the axis to rest inside the travel: v^2 / 2 d, and
/// [`STOP_TICKS`] at the full velocity.
fn can_stop(knot: &Knot, limits: &Limits) -> Result<(), KnotError> {
    let velocity = knot.velocity.counts();
    let (edge, room) = if velocity < 0 {
        let edge = limits.position_minimum();
        (edge, knot.position - edge)
    } else {
        let edge = limits.position_maximum();
        (edge, edge - knot.position)
    };
    let speed = velocity.unsigned_abs();
    let lost = speed.saturating_mul(STOP_TICKS as u64) / TICKS_PER_SECOND;
    let left = room.counts().unsigned_abs().checked_sub(lost);
    let deceleration = limits.deceleration().counts().unsigned_abs();
    let stops = left.is_some_and(|left| {
        u128::from(speed) * u128::from(speed) <= 2 * u128::from(deceleration) * u128::from(left)
    });
    if stops {
        Ok(())
    } else {
        Err(KnotError::CannotStop {
            velocity: knot.velocity,
            edge,
        })
    }
}
