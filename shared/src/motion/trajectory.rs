//! What every profile in f64 can tell, whatever its shape: duration, motion at a time, peaks.
//!
//! Units are the caller's own: position in any unit, time in seconds, and the rates in that unit
//! per second, per second squared and per second cubed.

/// Multiplied instead of divided by 6, which the device does in software five times as fast.
const SIXTH: f64 = 1.0 / 6.0;

/// Position and its first three derivatives by time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// In the caller's unit.
    pub position: f64,
    /// Per second.
    pub velocity: f64,
    /// Per second squared.
    pub acceleration: f64,
    /// Per second cubed.
    pub jerk: f64,
}

impl Sample {
    /// At rest at `position`.
    pub const fn at_rest(position: f64) -> Self {
        Self::coasting(position, 0.0)
    }

    /// Passing `position` at a constant velocity.
    pub const fn coasting(position: f64, velocity: f64) -> Self {
        Self {
            position,
            velocity,
            acceleration: 0.0,
            jerk: 0.0,
        }
    }

    /// This motion `time` seconds later (earlier where negative) at constant jerk.
    pub fn after(&self, time: f64) -> Self {
        let Self {
            position,
            velocity,
            acceleration,
            jerk,
        } = *self;
        Self {
            position: position
                + time * (velocity + time * (acceleration / 2.0 + time * (jerk * SIXTH))),
            velocity: velocity + time * (acceleration + time * (jerk / 2.0)),
            acceleration: acceleration + time * jerk,
            jerk,
        }
    }
}

/// The largest magnitudes over a whole trajectory, each zero or positive.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Peaks {
    /// Per second.
    pub velocity: f64,
    /// Per second squared.
    pub acceleration: f64,
    /// Per second cubed; infinite where the acceleration steps, as a trapezoid's does.
    pub jerk: f64,
}

/// One axis's motion over time.
pub trait Trajectory {
    /// Seconds from start to end, zero or positive.
    fn duration(&self) -> f64;

    /// The motion `time` seconds after the start.
    ///
    /// Before the start and from the end on it goes on at the velocity that it has there, without
    /// acceleration; at the end itself position and velocity are exactly those that were asked
    /// for. A NaN gives a position of NaN.
    fn at(&self, time: f64) -> Sample;

    /// The largest magnitudes from start to end.
    fn peaks(&self) -> Peaks;
}

/// A trajectory that starts at a time of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Starting<T> {
    /// When it starts, in seconds.
    pub start: f64,
    /// What happens from then on.
    pub trajectory: T,
}

impl<T: Trajectory> Trajectory for Starting<T> {
    /// Seconds from its own start to its end.
    fn duration(&self) -> f64 {
        self.trajectory.duration()
    }

    /// The motion at `time` on the clock that `start` is told in.
    fn at(&self, time: f64) -> Sample {
        self.trajectory.at(time - self.start)
    }

    fn peaks(&self) -> Peaks {
        self.trajectory.peaks()
    }
}
