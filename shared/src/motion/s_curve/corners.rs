//! What a device lays in integers: when each piece begins, and the rates that it begins with.

use super::super::bounds::Bounds;
use super::super::error::ProfileError;
use super::super::segments::MOST_SEGMENTS;
use super::super::trajectory::Sample;
use super::{SignedBounds, to_rest, towards};
use heapless::Vec;

/// Where a piece of constant jerk begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Corner {
    /// Seconds after the start of the motion.
    pub start: f64,
    pub velocity: f64,
    pub acceleration: f64,
}

/// The corners of a motion to rest, in their order.
#[derive(Debug, Clone, Default)]
pub(crate) struct Corners {
    corners: Vec<Corner, MOST_SEGMENTS>,
    duration: f64,
}

impl Corners {
    pub(crate) fn corners(&self) -> &[Corner] {
        &self.corners
    }

    /// Seconds to the end.
    pub(crate) fn duration(&self) -> f64 {
        self.duration
    }

    /// Adds a piece; what [`super::Segments`] leaves out is left out here too.
    pub(super) fn add(&mut self, duration: f64, velocity: f64, acceleration: f64) {
        if duration > 0.0 {
            let corner = Corner {
                start: self.duration,
                velocity,
                acceleration,
            };
            if self.corners.push(corner).is_ok() {
                self.duration += duration;
            }
        }
    }
}

/// The corners of [`super::plan`], with its errors.
pub(crate) fn plan_corners(
    from: Sample,
    to: Sample,
    bounds: &Bounds,
) -> Result<Corners, ProfileError> {
    let bounds = towards(from, to, bounds)?;
    Ok(super::solved(from, to, &bounds)?.corners(from, to, bounds.jerk()))
}

/// The corners of [`super::to_rest`], with its errors.
pub(crate) fn to_rest_corners(
    from: Sample,
    target: f64,
    bounds: &SignedBounds,
) -> Result<Corners, ProfileError> {
    let pieces = to_rest::solved(from, target, bounds)?;
    Ok(pieces.corners(from, Sample::at_rest(target), bounds.jerk()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::segments::Segments;
    use crate::motion::trajectory::Trajectory;
    use proptest::prelude::*;

    #[track_caller]
    fn same(corners: &Corners, segments: &Segments) {
        let entries = segments.segments().iter().map(|segment| Corner {
            start: segment.start,
            velocity: segment.entry.velocity,
            acceleration: segment.entry.acceleration,
        });
        assert!(
            corners.corners().iter().copied().eq(entries),
            "{corners:?} {segments:?}"
        );
        assert_eq!(corners.duration(), segments.duration());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn corners_are_those_of_the_segments(
            velocity in -3.0..3.0f64,
            acceleration in -30.0..30.0f64,
            target in prop_oneof![-10.0..10.0f64, -0.1..0.1f64],
            limits in [0.5..2.0f64, 5.0..20.0f64, 5.0..20.0f64, 50.0..5000.0f64],
        ) {
            let [fastest, rise, fall, jerk] = limits;
            let from = Sample { velocity, acceleration, ..Sample::default() };
            let (rest, to) = (Sample::at_rest(0.0), Sample::at_rest(target));
            let signed = SignedBounds::new(fastest, -fastest, rise, -fall, jerk);
            let signed = signed.expect("limits");
            let bounds = Bounds::new(fastest, rise, fall, jerk).expect("limits");
            let corners = to_rest_corners(from, target, &signed).expect("a motion");
            same(&corners, &super::super::to_rest(from, target, &signed).expect("a motion"));
            let corners = plan_corners(rest, to, &bounds).expect("a motion");
            same(&corners, &super::super::plan(rest, to, &bounds).expect("a motion"));
        }
    }
}
