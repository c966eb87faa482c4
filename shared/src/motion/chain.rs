//! Phases one after the other: what was solved in f64, made ready for the tick.
//!
//! What is solved is in turns, relative to where the motion starts: the limits of any axis are
//! then inside what a solver accepts, and turning it into counts is exact.

use super::phase::{COEFFICIENT_BITS, FARTHEST, Moment, Phase, Rates, Span};
use crate::limits::Limits;
use crate::time::{LONGEST_MOVE, Tick};
use crate::units::{COUNTS_PER_TURN, Position, product};
use heapless::Vec;

/// A change of velocity, a cruise and a stop: the longest chain there is.
pub(crate) const MOST_PHASES: usize = 7;

/// Phases in a row, from one tick to rest.
#[derive(Debug, Clone)]
pub(crate) struct Chain {
    /// Those that cover a tick.
    pub phases: Vec<Phase, MOST_PHASES>,
    /// The tick at which it starts.
    pub start: Tick,
    /// The first tick at rest.
    pub end: Tick,
    /// Where it starts, in counts.
    from: i64,
    /// Where it rests, in counts.
    pub rest: i64,
    /// The least and the greatest place on its way, raised by [`COEFFICIENT_BITS`].
    reach: (i64, i64),
}

/// One piece for a chain: until when, and the rates that it begins and ends with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    pub ends: Moment,
    pub entry: Rates,
    pub exit: Rates,
}

impl Chain {
    /// Without phases, at rest at the place `from`, in counts.
    ///
    /// A chain is a kibibyte: it is laid where it stands and not handed around.
    pub(crate) fn new(start: Tick, from: i64) -> Self {
        Self {
            phases: Vec::new(),
            start,
            end: start,
            from,
            rest: from,
            reach: (0, 0),
        }
    }

    /// Lays the phases of `pieces` to rest at `to`, or where they lead to, in counts.
    ///
    /// `None`, and the chain is of no use, where they last longer than a move may, or do not fit
    /// the arithmetic, which the travel of an axis rules out.
    ///
    /// There is one of it for whatever makes pieces: it is a kibibyte of flash.
    #[inline(never)]
    pub(crate) fn lay(&mut self, pieces: &[Piece], to: Option<i64>) -> Option<()> {
        let far = |place: i64| place.unsigned_abs() > FARTHEST.unsigned_abs();
        if far(self.from) || to.is_some_and(far) {
            return None;
        }
        self.rest = to.unwrap_or(self.from);
        let mut place = self.from << COEFFICIENT_BITS;
        self.reach = (place, place);
        let mut begins = Moment::default();
        let whole = pieces.iter().map(|piece| piece.ends).max();
        for piece in pieces {
            // What takes no time is left out.
            if piece.ends <= begins {
                continue;
            }
            let is_last = Some(piece.ends) == whole;
            let mut ends = piece.ends;
            if is_last && ends.settled() > begins {
                ends = ends.settled();
            }
            if ends.ticks() > u64::from(LONGEST_MOVE.0) {
                return None;
            }
            let span = Span {
                start: self.start,
                from: begins,
                to: ends,
            };
            let mut phase = Phase::new(span, place, piece.entry, piece.exit)?;
            if is_last {
                if to.is_none() {
                    self.rest = phase.exit_position();
                }
                phase.end_at(self.rest << COEFFICIENT_BITS);
            }
            let (least, greatest) = phase.reach();
            self.reach = (self.reach.0.min(least), self.reach.1.max(greatest));
            place = phase.exit();
            begins = ends;
            self.end = phase.end();
            if phase.is_seen() {
                self.phases.push(phase).ok()?;
            }
        }
        Some(())
    }

    /// Whether it stays inside the travel. Outside of it, the way back in belongs to it.
    pub(crate) fn stays(&self, limits: &Limits) -> bool {
        self.stays_beside(limits, 0)
    }

    /// The same with so many counts more at both ends.
    pub(crate) fn stays_beside(&self, limits: &Limits, counts: i64) -> bool {
        let (least, greatest) = self.reach;
        // A place inside a count is one that rounds to it.
        let half = (2 * counts + 1) << (COEFFICIENT_BITS - 1);
        let raised = |place: Position, from: fn(i64, i64) -> i64| {
            product(from(place.counts(), self.from), 1 << COEFFICIENT_BITS)
        };
        least >= raised(limits.position_minimum(), i64::min) - half
            && greatest < raised(limits.position_maximum(), i64::max) + half
    }

    /// Marks it as one that leaves from rest, and that can be dropped before.
    pub(crate) fn depart(&mut self) {
        if let Some(first) = self.phases.first_mut() {
            first.depart();
        }
    }

    /// Marks it as one whose acceleration steps.
    pub(crate) fn step(&mut self) {
        self.phases.iter_mut().for_each(Phase::step);
    }
}

/// Counts, or their rates, in turns: exact below 2^53 counts.
pub(crate) fn turns(counts: i64) -> f64 {
    counts as f64 * (1.0 / COUNTS_PER_TURN as f64)
}
