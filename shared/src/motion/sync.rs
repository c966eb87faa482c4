//! Several axes that leave together and arrive together.
//!
//! There are two ways. Each axis may keep a shape of its own and be stretched to the longest
//! duration, within its own limits: [`beta()`], [`trapezoid()`] and [`s_curve()`] from a list of axes,
//! or [`common_duration`] of any profiles. Or all share one shape, so that a tool moves on a
//! straight line: a unit move from 0 to 1 within [`shared_bounds`], [`Scaled`] to each axis.

use super::beta::exact::Profile;
use super::bounds::{Bounds, LARGEST, checked_position};
use super::error::{ProfileError, checked};
use super::s_curve::{self, SignedBounds};
use super::segments::Segments;
use super::trajectory::{Peaks, Sample, Trajectory};
use super::trapezoid;
use heapless::Vec;

/// What one axis is to do: from rest to rest, within its limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// Where it rests before.
    pub from: f64,
    /// Where it rests after.
    pub to: f64,
    /// Its own limits.
    pub bounds: Bounds,
}

/// The longest of the durations, zero without any.
pub fn common_duration(durations: impl IntoIterator<Item = f64>) -> f64 {
    durations.into_iter().fold(0.0, f64::max)
}

/// Plans each axis as quickly as it can, and again for the longest duration of all.
fn together<T: Trajectory, const N: usize>(
    axes: &[Axis],
    quickest: impl Fn(&Axis) -> Result<T, ProfileError>,
    lasting: impl Fn(&Axis, f64) -> Result<T, ProfileError>,
) -> Result<Vec<T, N>, ProfileError> {
    checked("number of axes", axes.len() as f64, 0.0, N as f64)?;
    let mut longest = 0.0;
    for axis in axes {
        longest = common_duration([longest, quickest(axis)?.duration()]);
    }
    let mut planned = Vec::new();
    for axis in axes {
        // There is room, as was checked.
        let _ = planned.push(lasting(axis, longest)?);
    }
    Ok(planned)
}

/// Beta moves, all of the longest duration.
///
/// # Errors
/// [`ProfileError::Value`] for a position that is not a number or beyond 1e15, and for more than N
/// axes.
pub fn beta<const N: usize>(axes: &[Axis]) -> Result<Vec<Profile, N>, ProfileError> {
    together(
        axes,
        |axis| Profile::within(axis.from, axis.to, &axis.bounds),
        |axis, duration| Profile::lasting(axis.from, axis.to, duration),
    )
}

/// Trapezoids with each axis's own ramps and the slowest cruise.
///
/// # Errors
/// As [`beta`].
pub fn trapezoid<const N: usize>(axes: &[Axis]) -> Result<Vec<Segments, N>, ProfileError> {
    let ends = |axis: &Axis| (Sample::at_rest(axis.from), Sample::at_rest(axis.to));
    together(
        axes,
        |axis| {
            let (from, to) = ends(axis);
            trapezoid::exact::plan(from, to, &axis.bounds)
        },
        |axis, duration| {
            let (from, to) = ends(axis);
            trapezoid::exact::lasting(from, to, duration, &axis.bounds)
        },
    )
}

/// S-curves with each axis's own acceleration and jerk and a slower cruise.
///
/// # Errors
/// As [`beta`], and [`ProfileError::Value`] for an axis without a jerk limit.
pub fn s_curve<const N: usize>(axes: &[Axis]) -> Result<Vec<Segments, N>, ProfileError> {
    together(
        axes,
        |axis| {
            s_curve::plan(
                Sample::at_rest(axis.from),
                Sample::at_rest(axis.to),
                &axis.bounds,
            )
        },
        |axis, duration| {
            let signed = if axis.to < axis.from {
                SignedBounds::backward(&axis.bounds)
            } else {
                SignedBounds::forward(&axis.bounds)
            }?;
            s_curve::lasting(Sample::at_rest(axis.from), axis.to, duration, &signed)
        },
    )
}

/// The limits of the unit move from 0 to 1 that all axes share: of each limit the least over the
/// axes of limit / range, and at most 1e15. An axis that stays where it is does not count, but that a
/// limit of its jerk is one for all.
///
/// # Errors
/// [`ProfileError::Value`] for a position that is not a number or beyond 1e15, and for a limit that
/// comes to less than 1e-15 of a range.
pub fn shared_bounds(axes: &[Axis]) -> Result<Bounds, ProfileError> {
    let [mut velocity, mut acceleration, mut deceleration] = [LARGEST; 3];
    let mut jerk = f64::INFINITY;
    for Axis { from, to, bounds } in axes {
        let range = (checked_position("stop position", *to)?
            - checked_position("start position", *from)?)
        .abs();
        // Without a range a limit is infinite, and not the least.
        velocity = velocity.min(bounds.velocity() / range);
        acceleration = acceleration.min(bounds.acceleration() / range);
        deceleration = deceleration.min(bounds.deceleration() / range);
        if bounds.jerk().is_finite() {
            jerk = jerk.min(bounds.jerk() / range).min(LARGEST);
        }
    }
    Bounds::new(velocity, acceleration, deceleration, jerk)
}

/// A move from 0 to 1 that is carried to a range of its own, at the same times.
#[derive(Debug, Clone, PartialEq)]
pub struct Scaled<T> {
    /// Where the unit move is at 0.
    pub from: f64,
    /// Where the unit move is at 1.
    pub to: f64,
    /// The move that all share.
    pub unit: T,
}

impl<T: Trajectory> Trajectory for Scaled<T> {
    fn duration(&self) -> f64 {
        self.unit.duration()
    }

    fn at(&self, time: f64) -> Sample {
        let unit = self.unit.at(time);
        let range = self.to - self.from;
        Sample {
            // From the nearer end, so that both are exact.
            position: if unit.position < 0.5 {
                self.from + range * unit.position
            } else {
                self.to - range * (1.0 - unit.position)
            },
            velocity: range * unit.velocity,
            acceleration: range * unit.acceleration,
            jerk: range * unit.jerk,
        }
    }

    fn peaks(&self) -> Peaks {
        let range = (self.to - self.from).abs();
        if range == 0.0 {
            return Peaks::default();
        }
        let unit = self.unit.peaks();
        Peaks {
            velocity: range * unit.velocity,
            acceleration: range * unit.acceleration,
            jerk: range * unit.jerk,
        }
    }
}
