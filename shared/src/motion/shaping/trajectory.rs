//! What a shaper makes of a trajectory in f64, to plan and to compare with.

use super::design::{Impulse, Impulses, Shaping};
use crate::motion::trajectory::{Peaks, Sample, Trajectory};

/// Steps in which the peaks are looked for.
const STEPS: u32 = 4_096;

/// A trajectory after a shaper: the sum of its delayed parts, A_i inner(t - t_i).
///
/// Each value is a mean of values of the inner trajectory, so it stays inside their limits. One
/// that ends at rest ends exactly there, later by the last impulse. One that is still under way then
/// coasts, and the shaped one with it, ahead of the end that was asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaped<T> {
    inner: T,
    impulses: Impulses,
    delay: f64,
}

impl<T: Trajectory> Shaped<T> {
    /// With the impulses as they are published, at half periods.
    pub fn new(inner: T, shaping: &Shaping) -> Self {
        Self::with(inner, shaping.impulses())
    }

    /// With the impulses that a device applies, at whole ticks.
    pub fn in_ticks(inner: T, shaping: &Shaping) -> Self {
        Self::with(inner, shaping.impulses_in_ticks())
    }

    fn with(inner: T, impulses: Impulses) -> Self {
        let delay = impulses.last().map_or(0.0, |last| last.time);
        Self {
            inner,
            impulses,
            delay,
        }
    }

    /// How much later than the inner trajectory it ends, in seconds.
    pub fn delay(&self) -> f64 {
        self.delay
    }
}

impl<T: Trajectory> Trajectory for Shaped<T> {
    fn duration(&self) -> f64 {
        self.inner.duration() + self.delay
    }

    fn at(&self, time: f64) -> Sample {
        // From the end on, rounding must not bring any part back before the inner end.
        let past = time - self.duration();
        let inner = |delay: f64| {
            if past >= 0.0 {
                self.inner
                    .at(self.inner.duration() + (self.delay - delay) + past)
            } else {
                self.inner.at(time - delay)
            }
        };
        // The others as they differ from the first: where all are the same, so is their sum.
        let mut sum = inner(0.0);
        let first = sum;
        for Impulse { time, amplitude } in self.impulses.iter().skip(1) {
            let part = inner(*time);
            sum.position += amplitude * (part.position - first.position);
            sum.velocity += amplitude * (part.velocity - first.velocity);
            sum.acceleration += amplitude * (part.acceleration - first.acceleration);
            sum.jerk += amplitude * (part.jerk - first.jerk);
        }
        sum
    }

    /// Looked for in 4096 steps: as near to the largest magnitudes as those come, never above them.
    /// The jerk is infinite where that of the inner trajectory is.
    fn peaks(&self) -> Peaks {
        let mut peaks = Peaks::default();
        for step in 0..=STEPS {
            let sample = self.at(self.duration() * f64::from(step) / f64::from(STEPS));
            peaks.velocity = peaks.velocity.max(sample.velocity.abs());
            peaks.acceleration = peaks.acceleration.max(sample.acceleration.abs());
            peaks.jerk = peaks.jerk.max(sample.jerk.abs());
        }
        if self.inner.peaks().jerk == f64::INFINITY {
            peaks.jerk = f64::INFINITY;
        }
        peaks
    }
}
