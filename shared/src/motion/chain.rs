//! Phases one after the other: what was solved in f64, made ready for the tick.
//!
//! What is solved is in turns, relative to where the motion starts: the limits of any axis are
//! then inside what a solver accepts, and turning it into counts is exact.

use super::phase::{COEFFICIENT_BITS, FARTHEST, Moment, Phase, Span};
use super::segments::{MOST_SEGMENTS, Segments};
use super::trajectory::{Sample, Trajectory};
use crate::time::{LONGEST_MOVE, Tick};
use crate::units::COUNTS_PER_TURN;
use heapless::Vec;

/// Phases in a row, from one tick to rest.
#[derive(Debug, Clone)]
pub(crate) struct Chain {
    /// Those that cover a tick.
    pub phases: Vec<Phase, MOST_SEGMENTS>,
    /// The tick at which it starts.
    pub start: Tick,
    /// The first tick at rest.
    pub end: Tick,
    /// Where it rests, in counts.
    pub rest: i64,
}

/// One piece for a chain: until when, how long in seconds, and what it begins with.
pub(crate) struct Piece {
    pub ends: Moment,
    pub seconds: f64,
    pub entry: Sample,
}

impl Chain {
    /// The phases of `segments`, in turns from the place `from`; they begin at `start` and end at
    /// rest at `to`, or where they lead to.
    ///
    /// `None` where they last longer than a move may, or do not fit the arithmetic, which the
    /// travel of an axis rules out.
    pub(crate) fn new(
        segments: &Segments,
        start: Tick,
        from: i64,
        to: Option<i64>,
    ) -> Option<Self> {
        let whole = Moment::from_seconds(segments.duration()).settled();
        let rest = match to {
            Some(to) => to,
            None => from.checked_add(counts(segments.end().position))?,
        };
        let pieces = segments.segments();
        // Each piece ends where the next one begins.
        let ends = pieces
            .iter()
            .skip(1)
            .map(|next| Moment::from_seconds(next.start))
            .chain([whole]);
        let pieces = pieces.iter().zip(ends).map(|(piece, ends)| Piece {
            ends,
            seconds: piece.duration,
            entry: piece.entry,
        });
        Self::of(pieces, start, from, rest)
    }

    /// The phases of `pieces` from the place `from` at `start` to rest at `rest`, in counts.
    pub(crate) fn of(
        pieces: impl Iterator<Item = Piece>,
        start: Tick,
        from: i64,
        rest: i64,
    ) -> Option<Self> {
        let far = |place: i64| place.unsigned_abs() > FARTHEST.unsigned_abs();
        if far(from) || far(rest) {
            return None;
        }
        let mut chain = Self {
            phases: Vec::new(),
            start,
            end: start,
            rest,
        };
        let mut place = from << COEFFICIENT_BITS;
        let mut begins = Moment::default();
        let mut pieces = pieces.peekable();
        while let Some(piece) = pieces.next() {
            if piece.ends <= begins {
                continue;
            }
            if piece.ends.ticks() > u64::from(LONGEST_MOVE.0) {
                return None;
            }
            let span = Span {
                start,
                from: begins,
                to: piece.ends,
                seconds: piece.seconds,
            };
            let mut phase = Phase::new(span, place, piece.entry)?;
            if pieces.peek().is_none() {
                phase.end_at(rest << COEFFICIENT_BITS);
            }
            place = phase.exit();
            begins = piece.ends;
            chain.end = phase.end();
            if phase.is_seen() {
                chain.phases.push(phase).ok()?;
            }
        }
        Some(chain)
    }

    /// The same chain as one that leaves from rest, and that can be dropped before.
    pub(crate) fn departing(mut self) -> Self {
        if let Some(first) = self.phases.first_mut() {
            first.depart();
        }
        self
    }

    /// The same chain as one whose acceleration steps.
    pub(crate) fn stepping(mut self) -> Self {
        self.phases.iter_mut().for_each(Phase::step);
        self
    }
}

/// The nearest count; saturates.
pub(crate) fn counts(turns: f64) -> i64 {
    libm::round(turns * COUNTS_PER_TURN as f64) as i64
}

/// Counts, or their rates, in turns: exact below 2^53 counts.
pub(crate) fn turns(counts: i64) -> f64 {
    counts as f64 * (1.0 / COUNTS_PER_TURN as f64)
}

/// The least and the greatest position of `segments`, relative to their start.
pub(crate) fn reach(segments: &Segments) -> (f64, f64) {
    let end = segments.end().position;
    let (mut least, mut greatest) = (end.min(0.0), end.max(0.0));
    for piece in segments.segments() {
        let Sample {
            position,
            velocity,
            acceleration,
            jerk,
        } = piece.entry;
        let mut include = |position: f64| {
            least = least.min(position);
            greatest = greatest.max(position);
        };
        include(position);
        // The position turns where v + a t + j t^2 / 2 = 0; without a change of sign from end to
        // end the velocity could still pass zero twice, where the acceleration changes its sign.
        let ramp = piece.duration * jerk;
        let exit = velocity + piece.duration * (acceleration + ramp / 2.0);
        let crosses = (velocity > 0.0) != (exit > 0.0);
        let bends = (acceleration > 0.0) != (acceleration + ramp > 0.0);
        let square = acceleration * acceleration - 2.0 * jerk * velocity;
        if square >= 0.0 && (crosses || bends) {
            // Both roots without cancellation.
            let sum = -(acceleration + libm::sqrt(square).copysign(acceleration));
            for time in [sum / jerk, 2.0 * velocity / sum] {
                if time > 0.0 && time < piece.duration {
                    include(piece.entry.after(time).position);
                }
            }
        }
    }
    (least, greatest)
}
