//! Trapezoids that take longer than they could: ramps at the limits, a slower cruise.

use super::{Approach, Forward, ROUNDING, approach, checked_ends, plan, to_rest};
use crate::motion::bounds::{Bounds, LARGEST};
use crate::motion::error::{ProfileError, checked};
use crate::motion::segments::{Builder, Segments};
use crate::motion::trajectory::{Sample, Trajectory};

/// The trapezoid that takes `duration` seconds, with ramps at the limits and the slowest cruise.
///
/// With start or stop velocities the cruise may be slower than they: the first ramp then slows
/// down at the deceleration limit, and the last speeds up at the acceleration limit. The duration
/// is met to rounding.
///
/// # Errors
/// As [`plan`]; [`ProfileError::TooShort`] with the least duration; and [`ProfileError::Value`] for
/// a duration longer than the velocities leave room for without turning back.
pub fn lasting(
    from: Sample,
    to: Sample,
    duration: f64,
    bounds: &Bounds,
) -> Result<Segments, ProfileError> {
    let quickest = plan(from, to, bounds)?;
    let forward = checked_ends(&from, &to, bounds)?;
    let shortest = quickest.duration();
    if duration < shortest * (1.0 - ROUNDING) {
        return Err(ProfileError::TooShort { duration, shortest });
    }
    let longest = forward.longest(bounds).min(LARGEST).max(shortest);
    checked("duration", duration, shortest.min(duration), longest)?;
    if duration <= shortest {
        return Ok(quickest);
    }
    let builder = Builder::new(Sample::coasting(from.position, from.velocity));
    let laid = forward.lay_slower(builder, duration, bounds);
    Ok(laid.end(to.position, to.velocity))
}

/// As [`to_rest`], but lasting `duration` seconds, with a slower cruise. What turning back takes is
/// not slower.
///
/// # Errors
/// As [`to_rest`], and [`ProfileError::TooShort`] with the least duration.
pub fn to_rest_lasting(
    from: Sample,
    target: f64,
    duration: f64,
    bounds: &Bounds,
) -> Result<Segments, ProfileError> {
    let quickest = to_rest(from, target, bounds)?;
    let shortest = quickest.duration();
    if duration < shortest * (1.0 - ROUNDING) {
        return Err(ProfileError::TooShort { duration, shortest });
    }
    checked(
        "duration",
        duration,
        shortest.min(duration),
        LARGEST.max(shortest),
    )?;
    if duration <= shortest {
        return Ok(quickest);
    }
    let Approach {
        builder, forward, ..
    } = approach(from, target, bounds)?;
    let left = duration - builder.duration();
    let laid = forward.lay_slower(builder, left, bounds);
    Ok(laid.end(target, 0.0))
}

/// A ramp: how long, and its acceleration with its sign.
#[derive(Debug, Clone, Copy)]
struct Ramp {
    duration: f64,
    rate: f64,
}

#[derive(Debug, Clone, Copy)]
struct Ramps {
    first: Ramp,
    last: Ramp,
}

impl Forward {
    /// The first and the last ramp around a cruise at `velocity`.
    fn around(&self, velocity: f64, bounds: &Bounds) -> Ramps {
        let (up, down) = (bounds.acceleration(), bounds.deceleration());
        let first = if velocity >= self.start { up } else { -down };
        let last = if velocity >= self.stop { -down } else { up };
        Ramps {
            first: Ramp {
                duration: (velocity - self.start) / first,
                rate: first,
            },
            last: Ramp {
                duration: (self.stop - velocity) / last,
                rate: last,
            },
        }
    }

    /// The whole duration with a cruise at `velocity`, which is positive.
    fn duration_at(&self, velocity: f64, bounds: &Bounds) -> f64 {
        let Ramps { first, last } = self.around(velocity, bounds);
        let way = |ramp: Ramp, other: f64| 0.5 * (other + velocity) * ramp.duration;
        let cruise = self.distance - way(first, self.start) - way(last, self.stop);
        first.duration + last.duration + cruise.max(0.0) / velocity
    }

    /// The longest duration without turning back; infinite where the move can stop on its way.
    fn longest(&self, bounds: &Bounds) -> f64 {
        let (up, down) = (bounds.acceleration(), bounds.deceleration());
        if self.start <= 0.0 || self.stop <= 0.0 {
            return f64::INFINITY;
        }
        let stopping = self.start * self.start * (0.5 / down) + self.stop * self.stop * (0.5 / up);
        let missing = stopping - self.distance;
        if missing <= 0.0 {
            return f64::INFINITY;
        }
        // The dip that leaves no cruise.
        let k = 0.5 / up + 0.5 / down;
        let lowest = libm::sqrt(missing / k).min(self.start.min(self.stop));
        (self.start - lowest) / down + (self.stop - lowest) / up
    }

    /// Lays the phases of a move of `duration` with the slowest cruise.
    fn lay_slower(&self, builder: Builder, duration: f64, bounds: &Bounds) -> Builder {
        let Ramps { first, last } = self.slower(duration, bounds);
        let cruise = (duration - first.duration) - last.duration;
        builder
            .acceleration(first.duration, self.sign * first.rate)
            .acceleration(cruise, 0.0)
            .acceleration(last.duration, self.sign * last.rate)
    }

    /// The ramps of a move of `duration`, which is between the shortest and the longest.
    ///
    /// With x the cruise velocity and s = 1 where it is above the start (stop) velocity, else -1,
    /// T x = R + s0 (x - v0)^2 / (2 a0) + s1 (x - v1)^2 / (2 a1). Of the two roots the one counts
    /// where T falls as x grows.
    fn slower(&self, duration: f64, bounds: &Bounds) -> Ramps {
        let below =
            |velocity: f64| velocity > 0.0 && self.duration_at(velocity, bounds) <= duration;
        let (up, down) = (bounds.acceleration(), bounds.deceleration());
        // s / (2 a)
        let first = if below(self.start) {
            -0.5 / down
        } else {
            0.5 / up
        };
        let last = if below(self.stop) {
            -0.5 / up
        } else {
            0.5 / down
        };
        let square = first + last;
        let linear = duration + 2.0 * (first * self.start + last * self.stop);
        let constant =
            self.distance + first * self.start * self.start + last * self.stop * self.stop;
        let root = libm::sqrt((linear * linear - 4.0 * square * constant).max(0.0));
        let velocity = if linear >= 0.0 {
            2.0 * constant / (linear + root)
        } else {
            (linear - root) / (2.0 * square)
        };
        let velocity = if velocity > 0.0 {
            velocity.min(bounds.velocity())
        } else {
            0.0
        };
        self.around(velocity, bounds)
    }
}
