//! The motion as knots for streams, close to it between them too.
//!
//! An axis joins two knots by the cubic that has their positions and velocities. Over a period T the
//! cubic is off from a curve x by x'''' / 384 T^4 in the middle and by less on either side, always to
//! the one side while x'''' keeps its sign (Hermite interpolation; Stoer and Bulirsch,
//! Introduction to Numerical Analysis, chapter 2). So each knot is put to the curve's side by half of what
//! the worse of the two middles beside it is off: a half of the error is then left, on both sides.

use super::joints::{JOINTS, positions, velocities};
use super::order::Order;
use super::sequence::{GRID, MARKS_PER_KNOT, Phase, Sequence};
use crate::client::{Pace, StreamKnot};
use crate::gait::{GaitError, State};
use canter_shared::time::Ticks;
use std::num::NonZeroU8;

/// From knot to knot, in s.
pub(super) const PERIOD: f64 = MARKS_PER_KNOT as f64 * GRID;

/// How knots follow each other.
pub(super) const PACE: Pace = Pace {
    // 10 ms: from 20 ms the error of a trot would be 16 times as large.
    period: NonZeroU8::MIN.saturating_add(9),
    look_ahead: Ticks(100),
};

// The pace is that of the knots.
const _: () = assert!((PERIOD * 1e3) as u8 == PACE.period.get());

/// A motion as knots, the first of them at rest at time 0 and the last at rest at the end.
#[derive(Debug, Clone)]
pub(super) struct Knots {
    sequence: Sequence,
    /// The mark of the knot that comes next, and of the next middle.
    mark: u64,
    stride: u64,
    /// The motion at that knot.
    here: State,
    /// How far the cubic before it is off in its middle.
    before: [f64; JOINTS],
    /// The last knot that was given.
    given: Option<Vec<StreamKnot>>,
    is_over: bool,
}

impl Knots {
    pub(super) fn new(mut sequence: Sequence) -> Result<Self, GaitError> {
        Ok(Self {
            here: sequence.advance(0.0)?,
            sequence,
            mark: 0,
            stride: 1,
            before: [0.0; JOINTS],
            given: None,
            is_over: false,
        })
    }

    /// The time of the knot that comes next, in s: when an order that is given now is taken.
    pub(super) fn time(&self) -> f64 {
        self.mark as f64 * GRID
    }

    /// The number of the knot that comes next, 0 for the first.
    pub(super) fn number(&self) -> u64 {
        self.mark / MARKS_PER_KNOT
    }

    pub(super) fn sequence(&self) -> &Sequence {
        &self.sequence
    }

    /// The last knot that was given.
    pub(super) fn given(&self) -> Option<&[StreamKnot]> {
        self.given.as_deref()
    }

    pub(super) fn order(&mut self, order: &Order) -> Result<(), GaitError> {
        self.sequence.order(order)
    }

    /// Knots so many times as far apart from now on, for a glance ahead.
    pub(super) fn stride(&mut self, marks: u64) {
        self.stride = marks.max(1);
        self.sequence.stride(marks);
    }

    /// From knot to knot, in s.
    pub(super) fn period(&self) -> f64 {
        (MARKS_PER_KNOT * self.stride) as f64 * GRID
    }

    /// The next knot of each joint; none after the last.
    pub(super) fn next(&mut self) -> Result<Option<&[StreamKnot]>, GaitError> {
        if self.is_over {
            return Ok(None);
        }
        let here = self.here;
        if self.sequence.phase() == Phase::Sitting {
            self.is_over = true;
            self.give(&here, [0.0; JOINTS]);
            return Ok(self.given());
        }
        let middle = self.mark + self.stride;
        let middle = self.sequence.advance(middle as f64 * GRID)?;
        self.mark += MARKS_PER_KNOT * self.stride;
        self.here = self.sequence.advance(self.mark as f64 * GRID)?;
        let after = errors(&here, &middle, &self.here, self.period());
        let shift = std::array::from_fn(|joint| match self.given {
            Some(_) => 0.5 * larger(self.before[joint], after[joint]),
            // The first is where the axes rest.
            None => 0.0,
        });
        self.before = after;
        self.give(&here, shift);
        Ok(self.given())
    }

    fn give(&mut self, state: &State, shift: [f64; JOINTS]) {
        let places = positions(state).into_iter().zip(velocities(state));
        let knots = places
            .zip(shift)
            .map(|((position, velocity), shift)| StreamKnot {
                position: position + shift,
                velocity,
            });
        self.given = Some(knots.collect());
    }
}

/// The larger of two errors of one sign; of two signs, what is left of both.
fn larger(one: f64, other: f64) -> f64 {
    one.max(other).max(0.0) + one.min(other).min(0.0)
}

/// How far each joint is from the cubic in its middle.
fn errors(from: &State, middle: &State, to: &State, period: f64) -> [f64; JOINTS] {
    let [start, there, end] = [from, middle, to].map(positions);
    let (leaving, arriving) = (velocities(from), velocities(to));
    std::array::from_fn(|joint| {
        let mean = 0.5 * (start[joint] + end[joint]);
        there[joint] - (mean + period / 8.0 * (leaving[joint] - arriving[joint]))
    })
}
