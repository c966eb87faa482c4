//! A motion with its time counted so that the jerk is one.
//!
//! With the time multiplied by the jerk limit J, positions are multiplied by J^2 and velocities by
//! J, and accelerations stay as they are. An acceleration then changes by as much as time passes,
//! which is what makes the solver's formulas short.

use super::super::segments::{Builder, MOST_SEGMENTS, Segments};
use super::super::trajectory::Sample;
use super::bounds::SignedBounds;
use heapless::Vec;

/// Where a motion is, in unit-jerk time.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    pub position: f64,
    pub velocity: f64,
    pub acceleration: f64,
}

impl State {
    /// `sample` seen from `origin`.
    pub fn new(sample: Sample, origin: f64, jerk: f64) -> Self {
        Self {
            position: jerk * jerk * (sample.position - origin),
            velocity: jerk * sample.velocity,
            acceleration: sample.acceleration,
        }
    }

    /// The same seen upside down.
    pub fn mirrored(self) -> Self {
        Self {
            position: -self.position,
            velocity: -self.velocity,
            acceleration: -self.acceleration,
        }
    }

    /// What comes of it after `piece`.
    pub fn after(self, piece: Piece) -> Self {
        let Piece { duration, jerk } = piece;
        let Self {
            position,
            velocity,
            acceleration,
        } = self;
        Self {
            position: position
                + duration * (velocity + duration * (acceleration / 2.0 + duration * jerk / 6.0)),
            velocity: velocity + duration * (acceleration + duration * jerk / 2.0),
            acceleration: acceleration + duration * jerk,
        }
    }
}

/// The limits in unit-jerk time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Range {
    /// The largest velocity, positive.
    pub highest: f64,
    /// The smallest velocity, negative.
    pub lowest: f64,
    /// How strongly the velocity may rise, positive.
    pub rise: f64,
    /// How strongly it may fall, positive.
    pub fall: f64,
}

impl Range {
    pub fn new(bounds: &SignedBounds) -> Self {
        Self {
            highest: bounds.jerk() * bounds.velocity_max(),
            lowest: bounds.jerk() * bounds.velocity_min(),
            rise: bounds.acceleration_max(),
            fall: -bounds.acceleration_min(),
        }
    }

    /// The same seen upside down.
    pub fn mirrored(self) -> Self {
        Self {
            highest: -self.lowest,
            lowest: -self.highest,
            rise: self.fall,
            fall: self.rise,
        }
    }
}

/// A piece of constant jerk, which is one, zero, or minus one (between them where motions are
/// blended).
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub duration: f64,
    pub jerk: f64,
}

/// Pieces in their order.
#[derive(Debug, Clone, Default)]
pub(super) struct Pieces(Vec<Piece, MOST_SEGMENTS>);

impl Pieces {
    /// Adds a piece; one that has no length is left out, and so would be one beyond what a
    /// trajectory can hold, which no plan makes.
    pub fn push(&mut self, duration: f64, jerk: f64) {
        if duration > 0.0 {
            let _full = self.0.push(Piece { duration, jerk });
        }
    }

    pub fn iter(&self) -> impl Iterator<Item = Piece> + '_ {
        self.0.iter().copied()
    }

    /// How long they last together.
    pub fn duration(&self) -> f64 {
        self.iter().fold(0.0, |sum, piece| sum + piece.duration)
    }

    /// What comes of `state` after all of them.
    pub fn carry(&self, state: State) -> State {
        self.iter().fold(state, State::after)
    }

    /// Lays them from `start` in time of this jerk.
    pub fn lay(&self, start: Sample, jerk: f64) -> Builder {
        let slow = 1.0 / jerk;
        self.iter().fold(Builder::new(start), |builder, piece| {
            builder.jerk(piece.duration * slow, piece.jerk * jerk)
        })
    }

    /// Lays them from `start` to the position and velocity of `end`.
    pub fn join(&self, start: Sample, end: Sample, jerk: f64) -> Segments {
        self.lay(start, jerk)
            .end_smoothly(end.position, end.velocity)
    }
}
