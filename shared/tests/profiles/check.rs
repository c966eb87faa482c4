//! Checks that any trajectory must pass.

use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::segments::Segments;
use canter_shared::motion::trajectory::{Sample, Trajectory};
use proptest::prelude::*;

/// Places at which a trajectory is looked at.
const PLACES: u32 = 64;

/// A number whose magnitude is 10 to the power of something in this range, of either sign.
pub fn signed(powers: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    (positive(powers), any::<bool>())
        .prop_map(|(value, negative)| if negative { -value } else { value })
}

/// A positive number of any magnitude in this range of powers of ten.
pub fn positive(powers: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    powers.prop_map(|power| 10f64.powf(power))
}

/// Limits of many magnitudes, without one of jerk.
pub fn rates() -> impl Strategy<Value = Bounds> {
    (
        positive(-3.0..3.0),
        positive(-3.0..4.0),
        positive(-3.0..4.0),
    )
        .prop_map(|(velocity, acceleration, deceleration)| {
            Bounds::new(velocity, acceleration, deceleration, f64::INFINITY).expect("valid")
        })
}

/// Times from before the start to after the end, both ends among them.
pub fn times(trajectory: &impl Trajectory) -> impl Iterator<Item = f64> {
    let duration = trajectory.duration();
    (0..=PLACES).map(move |place| duration * f64::from(place) / f64::from(PLACES))
}

/// Position and velocity at both ends to the bit, and coasting beyond.
pub fn ends(trajectory: &impl Trajectory, from: Sample, to: Sample) -> Result<(), TestCaseError> {
    let duration = trajectory.duration();
    prop_assert!(duration >= 0.0, "{duration}");
    let end = trajectory.at(duration);
    prop_assert_eq!((end.position, end.velocity), (to.position, to.velocity));
    if duration > 0.0 {
        let start = trajectory.at(0.0);
        prop_assert_eq!(
            (start.position, start.velocity),
            (from.position, from.velocity)
        );
    }
    for beyond in [1.0, 1e6] {
        let before = trajectory.at(-beyond);
        let want = from.position - from.velocity * beyond;
        prop_assert!(
            (before.position - want).abs() <= 1e-15 * want.abs(),
            "{before:?}"
        );
        prop_assert_eq!((before.velocity, before.acceleration), (from.velocity, 0.0));
        let after = trajectory.at(duration + beyond);
        // The sum of duration and what is beyond was rounded.
        let beyond = (duration + beyond) - duration;
        let want = to.position + to.velocity * beyond;
        prop_assert!(
            (after.position - want).abs() <= 1e-15 * want.abs(),
            "{after:?}"
        );
        prop_assert_eq!((after.velocity, after.acceleration), (to.velocity, 0.0));
    }
    Ok(())
}

/// No sample is over a peak that the trajectory tells, nor a peak over these limits.
pub fn limits(
    trajectory: &impl Trajectory,
    velocity: f64,
    acceleration: f64,
    jerk: f64,
) -> Result<(), TestCaseError> {
    let peaks = trajectory.peaks();
    for (peak, limit) in [
        (peaks.velocity, velocity),
        (peaks.acceleration, acceleration),
        (peaks.jerk, jerk),
    ] {
        prop_assert!(peak <= limit * (1.0 + 1e-9), "{peaks:?} over {limit}");
    }
    for time in times(trajectory) {
        let at = trajectory.at(time);
        for (value, peak) in [
            (at.velocity, peaks.velocity),
            (at.acceleration, peaks.acceleration),
            (at.jerk, peaks.jerk),
        ] {
            prop_assert!(
                value.abs() <= peak * (1.0 + 1e-9),
                "{at:?} at {time}: {peaks:?}"
            );
        }
    }
    Ok(())
}

/// Positions differ by what the velocity gives, and velocities by what the acceleration gives, but
/// for what the next derivative bends in a short time, and for rounding: of positions of the size of
/// `scale`, and of velocities that add up terms of the size of `way` over the duration.
pub fn derivatives(
    trajectory: &impl Trajectory,
    scale: f64,
    way: f64,
) -> Result<(), TestCaseError> {
    let duration = trajectory.duration();
    let peaks = trajectory.peaks();
    let step = duration * 1e-4;
    if step == 0.0 {
        return Ok(());
    }
    for place in 1..PLACES {
        let time = duration * f64::from(place) / f64::from(PLACES);
        let (before, at, after) = (
            trajectory.at(time - step),
            trajectory.at(time),
            trajectory.at(time + step),
        );
        let rounding = 1e-15 * scale;
        let slope = (after.position - before.position) / (2.0 * step);
        let bend = (peaks.jerk * step * step / 6.0).min(peaks.acceleration * step);
        let bound = 1.01 * bend + (rounding + 1e-15 * peaks.velocity * duration) / step;
        prop_assert!(
            (slope - at.velocity).abs() <= bound,
            "{at:?} at {time}: {slope} +- {bound}"
        );
        let slope = (after.velocity - before.velocity) / (2.0 * step);
        let bend = (peaks.jerk * step).min(2.0 * peaks.acceleration);
        let rounding = 1e-15 * (peaks.velocity + way / duration);
        let bound = 1.01 * bend + rounding / step + 1e-11 * peaks.acceleration;
        prop_assert!(
            (slope - at.acceleration).abs() <= bound,
            "{at:?} at {time}: {slope} +- {bound}"
        );
    }
    Ok(())
}

/// Where one piece ends the next begins, but for rounding of positions of this scale; and the last
/// ends where the motion does.
pub fn continuous(segments: &Segments, scale: f64) -> Result<(), TestCaseError> {
    let peak = segments.peaks();
    let starts = segments
        .segments()
        .iter()
        .skip(1)
        .map(|segment| segment.start);
    for time in starts.chain([0.0, segments.duration()]) {
        let step = 4.0 * f64::EPSILON * time.max(1e-3 * segments.duration());
        let (before, after) = (segments.at(time - step), segments.at(time + step));
        let jump = (after.position - before.position).abs();
        let bound = 1e-14 * scale + 4.0 * peak.velocity * step;
        prop_assert!(
            jump <= bound,
            "position jumps by {jump} at {time}, over {bound}"
        );
        let jump = (after.velocity - before.velocity).abs();
        let bound = 1e-14 * peak.velocity + 4.0 * peak.acceleration * step;
        prop_assert!(
            jump <= bound,
            "velocity jumps by {jump} at {time}, over {bound}"
        );
    }
    Ok(())
}

/// Accelerations by sense: each piece of a trapezoid speeds up or slows down within its limit.
pub fn senses(segments: &Segments, bounds: &Bounds) -> Result<(), TestCaseError> {
    for segment in segments.segments() {
        let entry = segment.entry;
        let middle = entry.after(0.5 * segment.duration);
        let limit = if middle.velocity * entry.acceleration > 0.0 {
            bounds.acceleration()
        } else {
            bounds.deceleration()
        };
        prop_assert!(
            entry.acceleration.abs() <= limit * (1.0 + 1e-9),
            "{segment:?}"
        );
    }
    Ok(())
}
