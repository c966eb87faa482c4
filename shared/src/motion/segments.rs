//! A trajectory of pieces of constant jerk: what s-curves, trapezoids and stops are made of.
//!
//! Each piece is evaluated from where the one before it ends, so position and velocity are
//! continuous to the bit there (unless the planner knows the entry more exactly); the last one is
//! evaluated backwards from the end that was asked for, so that the end is exact and the curve
//! near it keeps its digits.

use super::trajectory::{Peaks, Sample, Trajectory};
use heapless::Vec;

/// Pieces that a trajectory may have: two that bring it back inside its limits, three that speed
/// up, a cruise, three that slow down, and one to spare.
pub const MOST_SEGMENTS: usize = 10;

/// A piece of constant jerk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Seconds from the start of the trajectory to that of the piece.
    pub start: f64,
    /// Seconds that the piece lasts, positive.
    pub duration: f64,
    /// The motion at its start; its jerk holds for the whole piece.
    pub entry: Sample,
}

/// Pieces of constant jerk, one after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Segments {
    start: Sample,
    segments: Vec<Segment, MOST_SEGMENTS>,
    duration: f64,
    /// What the last piece ends with; its jerk is that of the piece.
    last: Sample,
    steps: bool,
}

/// Lays piece after piece.
#[derive(Debug, Clone)]
pub struct Builder {
    start: Sample,
    segments: Vec<Segment, MOST_SEGMENTS>,
    duration: f64,
    now: Sample,
    steps: bool,
}

impl Builder {
    /// Begins with the position, velocity and acceleration of `start`.
    pub fn new(start: Sample) -> Self {
        Self {
            start,
            segments: Vec::new(),
            duration: 0.0,
            now: start,
            steps: false,
        }
    }

    /// Goes on for `duration` seconds at a constant jerk.
    ///
    /// A duration that is not positive, and a piece beyond [`MOST_SEGMENTS`], which no planner
    /// makes, is left out.
    #[must_use]
    pub fn jerk(mut self, duration: f64, jerk: f64) -> Self {
        let entry = Sample { jerk, ..self.now };
        self.lay(duration, entry, entry.after(duration));
        self
    }

    /// Goes on for `duration` seconds at a constant acceleration, to which it steps.
    #[must_use]
    pub fn acceleration(mut self, duration: f64, acceleration: f64) -> Self {
        if duration > 0.0 {
            self.steps |= self.now.acceleration != acceleration;
            self.now.acceleration = acceleration;
        }
        self.jerk(duration, 0.0)
    }

    /// Goes on for `duration` seconds from `entry`, at its jerk and to `exit`.
    ///
    /// For a planner that knows both ends of its pieces, perhaps better than the sum of rounded
    /// pieces tells: the entry must be where the motion has come to but for rounding.
    ///
    /// A duration that is not positive, and a piece beyond [`MOST_SEGMENTS`], is left out.
    pub fn lay(&mut self, duration: f64, entry: Sample, exit: Sample) {
        if duration > 0.0 {
            let segment = Segment {
                start: self.duration,
                duration,
                entry,
            };
            if self.segments.push(segment).is_ok() {
                self.now = exit;
                self.duration += duration;
            }
        }
    }

    /// The motion that has been laid so far ends with.
    pub fn now(&self) -> Sample {
        self.now
    }

    /// Seconds that have been laid so far.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Ends at exactly this position and velocity, which what was laid must have come to but for
    /// rounding. The acceleration that is left there is kept by the last piece.
    pub fn end(self, position: f64, velocity: f64) -> Segments {
        let jerk = self.segments.last().map_or(0.0, |last| last.entry.jerk);
        let ends = self.now.acceleration;
        Segments {
            start: self.start,
            segments: self.segments,
            duration: self.duration,
            last: Sample {
                position,
                velocity,
                acceleration: ends,
                jerk,
            },
            steps: self.steps,
        }
    }

    /// Ends at exactly this position and velocity and without acceleration, which a chain of
    /// jerks comes to but for rounding.
    pub fn end_smoothly(mut self, position: f64, velocity: f64) -> Segments {
        self.now.acceleration = 0.0;
        self.end(position, velocity)
    }
}

impl Segments {
    /// The pieces in their order.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// What the trajectory begins with.
    pub fn start(&self) -> Sample {
        self.start
    }

    /// Where it ends and how fast; from there on it coasts.
    pub fn end(&self) -> Sample {
        Sample::coasting(self.last.position, self.last.velocity)
    }
}

impl Trajectory for Segments {
    fn duration(&self) -> f64 {
        self.duration
    }

    fn at(&self, time: f64) -> Sample {
        if time < 0.0 || self.segments.is_empty() && time < self.duration {
            let coasting = Sample::coasting(self.start.position, self.start.velocity);
            return coasting.after(time);
        }
        if time >= self.duration {
            return self.end().after(time - self.duration);
        }
        // An only piece is seen from its end, but for the start itself.
        if let (0.0, Some(first)) = (time, self.segments.first()) {
            return first.entry;
        }
        // Those that have begun are counted, which takes no guess at which one it will be; a NaN
        // finds the first.
        let after = self.segments.iter().skip(1);
        let begun = after.filter(|segment| time >= segment.start).count();
        match self.segments.get(begun) {
            Some(segment) if begun + 1 < self.segments.len() => {
                segment.entry.after(time - segment.start)
            }
            _ => self.last.after(time - self.duration),
        }
    }

    fn peaks(&self) -> Peaks {
        let mut peaks = Peaks {
            velocity: self.start.velocity.abs().max(self.last.velocity.abs()),
            acceleration: self.last.acceleration.abs(),
            jerk: if self.steps { f64::INFINITY } else { 0.0 },
        };
        for Segment {
            duration, entry, ..
        } in &self.segments
        {
            peaks.velocity = peaks.velocity.max(entry.velocity.abs());
            peaks.acceleration = peaks.acceleration.max(entry.acceleration.abs());
            peaks.jerk = peaks.jerk.max(entry.jerk.abs());
            // The velocity turns where the acceleration passes zero.
            let turn = -entry.acceleration / entry.jerk;
            if turn > 0.0 && turn < *duration {
                peaks.velocity = peaks.velocity.max(entry.after(turn).velocity.abs());
            }
        }
        peaks
    }
}
