//! Upside down, in other units, and backwards in time, a motion is the same.

use super::random::{Size, any_case, inside_case};
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::s_curve::{SignedBounds, plan, time_optimal};
use canter_shared::motion::trajectory::{Sample, Trajectory};
use proptest::prelude::*;

fn mirrored(bounds: &SignedBounds) -> SignedBounds {
    SignedBounds::new(
        -bounds.velocity_min(),
        -bounds.velocity_max(),
        -bounds.acceleration_min(),
        -bounds.acceleration_max(),
        bounds.jerk(),
    )
    .expect("valid as before")
}

fn negated(sample: Sample) -> Sample {
    Sample {
        position: -sample.position,
        velocity: -sample.velocity,
        acceleration: -sample.acceleration,
        jerk: -sample.jerk,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    /// To the bit: every formula is used for both directions.
    #[test]
    fn upside_down((bounds, from, to) in any_case(), part in 0.0..1.0f64) {
        let curve = time_optimal(from, to, &bounds).expect("a valid case");
        let other = time_optimal(negated(from), negated(to), &mirrored(&bounds)).expect("a valid case");
        prop_assert_eq!(curve.duration(), other.duration());
        let time = part * curve.duration();
        prop_assert_eq!(curve.at(time), negated(other.at(time)));
    }

    /// Powers of two change no digit, so neither may the units of length and time.
    #[test]
    fn in_other_units(
        (bounds, from, to) in inside_case(), length in -6..6i32, time in -3..3i32, part in 0.0..1.0f64,
    ) {
        let (length, time) = (2f64.powi(length), 2f64.powi(time));
        let scaled = |sample: Sample| Sample {
            position: sample.position * length,
            velocity: sample.velocity * length / time,
            acceleration: sample.acceleration * length / (time * time),
            jerk: sample.jerk * length / (time * time * time),
        };
        let other_bounds = SignedBounds::new(
            bounds.velocity_max() * length / time,
            bounds.velocity_min() * length / time,
            bounds.acceleration_max() * length / (time * time),
            bounds.acceleration_min() * length / (time * time),
            bounds.jerk() * length / (time * time * time),
        ).expect("in range");
        let curve = time_optimal(from, to, &bounds).expect("a valid case");
        let other = time_optimal(scaled(from), scaled(to), &other_bounds).expect("a valid case");
        let close = |a: f64, b: f64, size: f64| (a - b).abs() <= 1e-9 * size;
        prop_assert!(close(curve.duration() * time, other.duration(), other.duration()));
        let size = Size::of(&other);
        let (one, two) = (scaled(curve.at(part * curve.duration())), other.at(part * other.duration()));
        prop_assert!(close(one.position, two.position, size.position), "{one:?} {two:?}");
        prop_assert!(close(one.velocity, two.velocity, size.velocity), "{one:?} {two:?}");
    }

    #[test]
    fn backwards_in_time((bounds, from, to) in inside_case(), part in 0.0..1.0f64) {
        // Backwards a start without acceleration is an end like any other.
        let from = Sample { acceleration: 0.0, ..from };
        let turned = |sample: Sample| Sample { velocity: -sample.velocity, ..sample };
        let turned_bounds = SignedBounds::new(
            -bounds.velocity_min(), -bounds.velocity_max(),
            bounds.acceleration_max(), bounds.acceleration_min(), bounds.jerk(),
        ).expect("valid as before");
        let curve = time_optimal(from, to, &bounds).expect("a valid case");
        let back = time_optimal(turned(to), turned(from), &turned_bounds).expect("a valid case");
        let duration = curve.duration();
        prop_assert!((duration - back.duration()).abs() <= 1e-9 * duration, "{duration} {}", back.duration());
        let size = Size::of(&curve);
        let (one, two) = (curve.at(part * duration), back.at((1.0 - part) * back.duration()));
        prop_assert!((one.position - two.position).abs() <= 1e-7 * size.position, "{one:?} {two:?}");
        prop_assert!((one.velocity + two.velocity).abs() <= 1e-7 * size.velocity, "{one:?} {two:?}");
    }

    /// A person's limits mean the same forward and backward.
    #[test]
    fn forward_and_backward((bounds, from, to) in any_case()) {
        let limits = Bounds::new(
            bounds.velocity_max().max(-bounds.velocity_min()),
            bounds.acceleration_max(), -bounds.acceleration_min(), bounds.jerk(),
        ).expect("in range");
        // Without a way to go it has no direction.
        let to = Sample {
            position: if to.position == 0.0 { 1.0 } else { to.position },
            ..to
        };
        let one = plan(from, to, &limits).expect("a valid case");
        let two = plan(negated(from), negated(to), &limits).expect("a valid case");
        prop_assert_eq!(one.duration(), two.duration());
    }

    /// Velocity is the slope of position, and acceleration that of velocity.
    #[test]
    fn derivatives_are_what_differences_tend_to((bounds, from, to) in any_case(), part in 0.0..1.0f64) {
        let curve = time_optimal(from, to, &bounds).expect("a valid case");
        for piece in curve.segments() {
            // Central differences of a cubic are off by jerk step^2 / 6, and of a parabola by
            // nothing.
            let step = piece.duration / 8.0;
            let time = piece.start + step + part * (piece.duration - 2.0 * step);
            let [before, at, after] = [time - step, time, time + step].map(|time| curve.at(time));
            let size = Size::of(&curve);
            let slope = (after.position - before.position) / (2.0 * step) - at.jerk * step * step / 6.0;
            // What the rounding of times and positions does to a difference over such a step.
            let noise = 1e-15 * (1.0 + curve.duration() / step);
            let room = noise * (8.0 * size.velocity + size.position / step);
            prop_assert!((slope - at.velocity).abs() <= room + 1e-9 * size.velocity, "{slope} {at:?} {curve:?}");
            let slope = (after.velocity - before.velocity) / (2.0 * step);
            let room = noise * (8.0 * size.acceleration + size.velocity / step);
            prop_assert!((slope - at.acceleration).abs() <= room + 1e-9 * size.acceleration, "{slope} {at:?} {curve:?}");
        }
    }
}
