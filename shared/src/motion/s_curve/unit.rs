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
        let Piece { duration, jerk, .. } = piece;
        let from = Sample {
            position: self.position,
            velocity: self.velocity,
            acceleration: self.acceleration,
            jerk,
        };
        let Sample {
            position,
            velocity,
            acceleration,
            ..
        } = from.after(duration);
        Self {
            position,
            velocity,
            acceleration,
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
    /// The larger magnitude of start and target, whose digits their difference has.
    pub farthest: f64,
    /// A time that the way back inside the limits leaves, see `brake`.
    pub margin: f64,
}

impl Range {
    pub fn new(bounds: &SignedBounds, start: f64, target: f64) -> Self {
        Self {
            highest: bounds.jerk() * bounds.velocity_max(),
            lowest: bounds.jerk() * bounds.velocity_min(),
            rise: bounds.acceleration_max(),
            fall: -bounds.acceleration_min(),
            farthest: bounds.jerk() * bounds.jerk() * start.abs().max(target.abs()),
            margin: margin(bounds),
        }
    }

    /// The same seen upside down.
    pub fn mirrored(self) -> Self {
        Self {
            highest: -self.lowest,
            lowest: -self.highest,
            rise: self.fall,
            fall: self.rise,
            ..self
        }
    }
}

/// 2.2e-14 s, a hundred times the rounding of a second: as Ruckig does, so that durations agree.
/// Less where the limits of acceleration would notice.
fn margin(bounds: &SignedBounds) -> f64 {
    let limit = bounds.acceleration_max().min(-bounds.acceleration_min());
    (2.2e-14 * bounds.jerk()).min(1e-7 * limit)
}

/// A piece of constant jerk, which is one, zero, or minus one (between them where motions are
/// blended).
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub duration: f64,
    pub jerk: f64,
    /// The acceleration that it begins with, free of what rounding adds up to.
    pub acceleration: f64,
    /// The velocity, where it is constant.
    pub cruise: Option<f64>,
}

impl Piece {
    /// A piece that is not a cruise.
    pub fn new(duration: f64, jerk: f64, acceleration: f64) -> Self {
        Self {
            duration,
            jerk,
            acceleration,
            cruise: None,
        }
    }

    /// A piece of constant velocity.
    pub fn cruise(duration: f64, velocity: f64) -> Self {
        Self {
            cruise: Some(velocity),
            ..Self::new(duration, 0.0, 0.0)
        }
    }
}

/// Pieces in their order.
#[derive(Debug, Clone, Default)]
pub(super) struct Pieces(Vec<Piece, MOST_SEGMENTS>);

impl Pieces {
    /// Adds a piece; one that has no length is left out, and so would be one beyond what a
    /// trajectory can hold, which no plan makes.
    pub fn push(&mut self, piece: Piece) {
        if piece.duration > 0.0 {
            let _full = self.0.push(piece);
        }
    }

    pub fn as_slice(&self) -> &[Piece] {
        &self.0
    }

    /// All upside down where `sign` is -1.
    pub fn signed(mut self, sign: f64) -> Self {
        for piece in &mut self.0 {
            piece.jerk *= sign;
            piece.acceleration *= sign;
            piece.cruise = piece.cruise.map(|velocity| velocity * sign);
        }
        self
    }

    /// How long they last together.
    pub fn duration(&self) -> f64 {
        self.0.iter().fold(0.0, |sum, piece| sum + piece.duration)
    }

    /// What comes of `state` after all of them.
    pub fn carry(&self, state: State) -> State {
        self.0
            .iter()
            .fold(state, |state, piece| state.after(*piece))
    }

    /// Lays them from `start` to the position and velocity of `end`.
    ///
    /// Before a cruise they are laid from the start on and after it from the end backwards, so
    /// that both ends are as exact as they can be. What rounding adds up to is left to the
    /// cruise: its length is far greater than that.
    pub fn join(&self, start: Sample, end: Sample, jerk: f64) -> Segments {
        let scale = Scale::new(jerk);
        let mut builder = Builder::new(start);
        let cruise = self.0.iter().position(|piece| piece.cruise.is_some());
        let (before, after) = self
            .0
            .split_at_checked(cruise.map_or(self.0.len(), |cruise| cruise + 1))
            .unwrap_or((&self.0, &[]));
        for piece in before {
            scale.lay(&mut builder, piece);
        }
        let mut laid: Vec<(f64, Sample, Sample), MOST_SEGMENTS> = Vec::new();
        let mut exit = Sample {
            acceleration: 0.0,
            ..end
        };
        for piece in after.iter().rev() {
            let duration = piece.duration * scale.slow;
            exit.jerk = piece.jerk * jerk;
            let entry = Sample {
                acceleration: piece.acceleration,
                ..exit.after(-duration)
            };
            let _full = laid.push((duration, entry, exit));
            exit = entry;
        }
        for (duration, entry, exit) in laid.iter().rev() {
            builder.lay(*duration, *entry, *exit);
        }
        builder.end_smoothly(end.position, end.velocity)
    }

    /// Lays them from `start` to wherever they lead with this velocity.
    pub fn lead(&self, start: Sample, velocity: f64, jerk: f64) -> Segments {
        let scale = Scale::new(jerk);
        let mut builder = Builder::new(start);
        for piece in &self.0 {
            scale.lay(&mut builder, piece);
        }
        let position = builder.now().position;
        builder.end_smoothly(position, velocity)
    }
}

/// From unit-jerk time back to seconds.
struct Scale {
    jerk: f64,
    /// Seconds per unit of time.
    slow: f64,
}

impl Scale {
    fn new(jerk: f64) -> Self {
        Self {
            jerk,
            slow: 1.0 / jerk,
        }
    }

    fn lay(&self, builder: &mut Builder, piece: &Piece) {
        let now = builder.now();
        let duration = piece.duration * self.slow;
        let velocity = piece.cruise.map(|velocity| velocity * self.slow);
        let entry = Sample {
            position: now.position,
            velocity: velocity.unwrap_or(now.velocity),
            acceleration: piece.acceleration,
            jerk: piece.jerk * self.jerk,
        };
        let exit = match velocity {
            Some(velocity) => Sample {
                position: entry.position + duration * velocity,
                ..entry
            },
            None => entry.after(duration),
        };
        builder.lay(duration, entry, exit);
    }
}
