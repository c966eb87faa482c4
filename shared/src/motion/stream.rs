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
//!
//! A stream whose last knot passes in motion has run dry: it brakes by itself from that knot's tick
//! on, see `brake`.

//! | file | what it holds |
//! |---|---|
//! | `stretch` | a knot that was taken on, in 24 bytes |
//! | `shape` | the derivatives between two knots in Bernstein form |
//! | `check` | whether they keep the limits |
//! | `piece` | the polynomials between two knots, and their values |
//! | `brake` | how a stream that has run dry comes to rest |
//! | `error` | why a knot is refused |

mod brake;
mod check;
mod error;
mod piece;
mod shape;
mod stretch;

pub use error::KnotError;

use super::Setpoint;
use crate::limits::Limits;
use crate::time::{TICKS_PER_SECOND, Tick, Ticks};
use crate::units::{Acceleration, Position, Velocity};
use brake::Brake;
use core::num::NonZeroU8;
use heapless::Deque;
use piece::Piece;
use shape::Divisor;
use stretch::{Place, Stretch};

/// Stretches that a stream holds: the one under way and 100 ms ahead of it at a period of 10 ms.
pub const LOOK_AHEAD: usize = 100 / 10 + 1;

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

/// What a piece breaks: counts, counts/s or counts/s^2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Breach {
    Travel(i64),
    Velocity(i64),
    Acceleration(i64),
}

/// A stream whose knots may know their acceleration.
pub type Stream = AnyStream<true>;

/// A stream whose knots leave the acceleration to the curve, as those do that come over a bus: a device that
/// knows no other needs no quintics, which are 2 KiB.
pub type CubicStream = AnyStream<false>;

/// A stream of knots: those that have not passed yet, and the piece under way.
#[derive(Debug, Clone)]
pub struct AnyStream<const QUINTIC: bool> {
    /// The tick of the knot that the first stretch begins with.
    begins: Tick,
    /// That knot.
    from: Place,
    /// The tick of the last knot: from there on it brakes.
    ends: Tick,
    period: NonZeroU8,
    /// The period, to divide by: a stretch over missing knots is longer.
    length: Divisor,
    /// The number of the last knot.
    number: u8,
    last: Place,
    /// The acceleration that leads up to the last knot.
    exit: i64,
    brake: Brake,
    /// Whether no knot is taken on any more.
    closed: bool,
    stretches: Deque<Stretch, LOOK_AHEAD>,
    /// The piece of the first stretch, once that is under way: a tick asks it, and it takes long to make.
    piece: Option<Piece>,
}

impl<const QUINTIC: bool> AnyStream<QUINTIC> {
    /// Begins at `start` with the setpoint of that tick, which counts as the knot of this number.
    /// The knot numbered n more is due n periods of so many ticks later.
    pub fn new(start: Tick, number: u8, state: Setpoint, period: NonZeroU8) -> Self {
        let from = place(state);
        Self {
            begins: start,
            from,
            ends: start,
            period,
            length: Divisor::new(period.get().into()),
            number,
            last: from,
            exit: state.acceleration.counts(),
            brake: Brake::AT_ONCE,
            closed: false,
            stretches: Deque::new(),
            piece: None,
        }
    }

    /// Takes on a knot, where `now` is the tick of the last setpoint. Stretches that have ended by then
    /// are dropped.
    ///
    /// Numbers count upwards and wrap. Where some are left out, one longer piece bridges the gap;
    /// the left out knots can no longer come.
    ///
    /// # Errors
    /// A knot that comes too late, too early or after too many missing ones, and one whose piece
    /// would break a limit; apart from what has ended the stream is unchanged. A stream that is closed
    /// finds every knot too late.
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
        let ended = self.ends;
        if ended < now || self.closed {
            return Err(KnotError::TooLate { ended });
        }
        if ahead > LONGEST_GAP {
            return Err(KnotError::TooManyMissing { missing });
        }
        self.drop_ended(now);
        if self.stretches.is_full() {
            let room = self.first_ends().unwrap_or(ended);
            return Err(KnotError::Full { room });
        }
        let to = Place {
            position: knot.position.counts(),
            velocity: knot.velocity.counts(),
            acceleration: knot
                .acceleration
                .filter(|_| QUINTIC)
                .map(Acceleration::counts),
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
        let exit = check::check::<QUINTIC>(&self.last, &to, ticks, &self.length, limits).map_err(
            |breach| {
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
            },
        )?;
        can_stop(knot, limits)?;
        let stretch = Stretch::new(&to, ahead);
        if self.stretches.push_back(stretch).is_err() {
            return Err(KnotError::Full { room: ended });
        }
        self.ends = ended.after(Ticks(ticks.into()));
        self.exit = exit;
        self.brake = Brake::new(to.position, to.velocity, limits);
        self.last = to;
        self.number = number;
        Ok(Pushed::Accepted { missing })
    }

    /// Goes on to `now`, the tick of the next setpoint: what has ended is dropped, and the piece of the
    /// stretch that is entered is made. Without this, [`Self::at`] makes it each time.
    pub fn advance(&mut self, now: Tick) {
        self.drop_ended(now);
        if self.piece.is_none()
            && now >= self.begins
            && let Some(first) = self.stretches.front()
        {
            let (to, ticks) = (first.to(), first.ticks(self.period));
            Piece::make::<QUINTIC>(&mut self.piece, &self.from, &to, ticks, &self.length);
        }
    }

    /// When the first stretch ends.
    fn first_ends(&self) -> Option<Tick> {
        let ticks = self.stretches.front()?.ticks(self.period);
        // Asked in every tick. Bus time does not come to its end in 65 s more.
        Some(Tick(self.begins.0.wrapping_add(ticks.into())))
    }

    fn drop_ended(&mut self, now: Tick) {
        while let Some(end) = self.first_ends().filter(|end| *end <= now) {
            if let Some(first) = self.stretches.pop_front() {
                self.from = first.to();
            }
            self.begins = end;
            self.piece = None;
        }
    }

    /// Takes no more knots: it goes on to the last one that it has.
    pub fn close(&mut self) {
        self.closed = true;
    }

    /// Whether it takes no more knots.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Closes the stream and ends it at `tick`, which is not before the last `now` given to [`Self::push`] or
    /// [`Self::advance`]: from there on it brakes. One that has ended by then is left as it is.
    pub fn cut(&mut self, tick: Tick, limits: &Limits) {
        self.closed = true;
        if tick < self.ends {
            let state = self.at(tick);
            self.ends = tick;
            self.last = place(state);
            self.exit = state.acceleration.counts();
            self.brake = Brake::new(self.last.position, self.last.velocity, limits);
        }
    }

    /// The setpoint at `tick`, which must not be before the last `now` given to [`Self::push`] or
    /// [`Self::advance`].
    ///
    /// After the last knot's tick it brakes to rest with the deceleration limit.
    pub fn at(&self, tick: Tick) -> Setpoint {
        let last = &self.last;
        if tick >= self.ends {
            let elapsed = tick.since(self.ends).0;
            if self.ends_at_rest() {
                return setpoint(last.position, 0, 0);
            }
            if elapsed > 0 {
                let (position, velocity, acceleration) =
                    self.brake.at(last.position, last.velocity, elapsed);
                return setpoint(position, velocity, acceleration);
            }
            // Where another knot may still follow, there is no deceleration yet.
            return setpoint(last.position, last.velocity, self.exit);
        }
        let elapsed = tick.since(self.begins).0;
        if let Some(piece) = &self.piece
            && elapsed < piece.ticks()
        {
            return piece.at(elapsed);
        }
        self.ahead(elapsed)
    }

    /// The setpoint before the last knot where no piece is there yet.
    #[cold]
    fn ahead(&self, elapsed: u32) -> Setpoint {
        let (mut before, mut left) = (None, elapsed);
        for stretch in &self.stretches {
            let ticks = stretch.ticks(self.period);
            if left < u32::from(ticks) {
                let from = before.map_or(self.from, Stretch::to);
                let mut piece = None;
                Piece::make::<QUINTIC>(&mut piece, &from, &stretch.to(), ticks, &self.length);
                if let Some(piece) = piece {
                    return piece.at(left);
                }
            }
            left -= u32::from(ticks);
            before = Some(stretch);
        }
        // The stretches reach up to the end: this is never the case.
        setpoint(self.last.position, self.last.velocity, 0)
    }

    /// The tick of the last knot: without another one until then, the stream has run dry.
    pub fn ends(&self) -> Tick {
        self.ends
    }

    /// Whether the stream has passed its last knot in motion by `tick`.
    pub fn has_run_dry(&self, tick: Tick) -> bool {
        self.ends < tick && !self.ends_at_rest()
    }

    /// Whether the setpoint still changes, or will, after `tick` though no other knot comes.
    pub fn is_moving(&self, tick: Tick) -> bool {
        let braked = || {
            self.brake
                .has_ended(self.last.velocity, tick.since(self.ends).0)
        };
        tick < self.ends || !self.ends_at_rest() && !braked()
    }

    /// The first tick at rest if no other knot comes.
    pub fn rests(&self) -> Tick {
        if self.ends_at_rest() {
            self.ends
        } else {
            self.ends.after(self.brake.ticks(self.last.velocity))
        }
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

fn place(state: Setpoint) -> Place {
    Place {
        position: state.position.counts(),
        velocity: state.velocity.counts(),
        acceleration: Some(state.acceleration.counts()),
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
    let stops = |left: u64| {
        // Mostly there is more room than needed, and 2^-20 of everything tells.
        let above = (speed >> 20) + 1;
        let (strength, room) = (deceleration >> 20, left >> 20);
        // Speeds and ways are below 2^44, decelerations below 2^50.
        above * above <= 2 * strength * room
            || u128::from(speed) * u128::from(speed)
                <= 2 * u128::from(deceleration) * u128::from(left)
    };
    if left.is_some_and(stops) {
        Ok(())
    } else {
        Err(KnotError::CannotStop {
            velocity: knot.velocity,
            edge,
        })
    }
}
