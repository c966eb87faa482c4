//! Random limits and states, and what every s-curve is held to.

use canter_shared::motion::s_curve::SignedBounds;
use canter_shared::motion::segments::Segments;
use canter_shared::motion::trajectory::{Sample, Trajectory};
use proptest::prelude::*;

/// Ten to the power of anything in between.
pub fn magnitude(from: f64, to: f64) -> impl Strategy<Value = f64> {
    (from..to).prop_map(|power| 10f64.powf(power))
}

/// A magnitude with either sign, or zero.
pub fn signed(from: f64, to: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => Just(0.0),
        5 => magnitude(from, to),
        5 => magnitude(from, to).prop_map(|value| -value),
    ]
}

/// Limits in which velocity, acceleration and jerk meet in all proportions, in units of length
/// and time of many sizes.
pub fn bounds() -> impl Strategy<Value = SignedBounds> {
    let shape = [(); 4].map(|()| magnitude(-1.5, 1.5));
    (magnitude(-5.0, 5.0), magnitude(-1.5, 1.5), shape).prop_map(
        |(length, time, [up, down, rise, fall])| {
            SignedBounds::new(
                up * length / time,
                -down * length / time,
                rise * length / (time * time),
                -fall * length / (time * time),
                length / (time * time * time),
            )
            .expect("in range")
        },
    )
}

/// The times in which these limits change the acceleration and the velocity, together.
pub fn scale(bounds: &SignedBounds) -> f64 {
    let rate = bounds.acceleration_max().max(-bounds.acceleration_min());
    let fast = bounds.velocity_max().max(-bounds.velocity_min());
    rate / bounds.jerk() + (fast / bounds.jerk()).sqrt() + fast / rate
}

/// A velocity inside the limits, at either of them now and then.
pub fn velocity(bounds: &SignedBounds) -> impl Strategy<Value = f64> + use<> {
    let (low, high) = (bounds.velocity_min(), bounds.velocity_max());
    prop_oneof![
        1 => Just(0.0),
        1 => Just(low),
        1 => Just(high),
        9 => low..high,
    ]
}

/// A start at zero and inside the limits, also once its acceleration is released.
pub fn inside(bounds: &SignedBounds) -> impl Strategy<Value = Sample> + use<> {
    let bounds = *bounds;
    (velocity(&bounds), -1.0..1.0f64, any::<bool>()).prop_map(move |(velocity, share, rests)| {
        let up = (2.0 * bounds.jerk() * (bounds.velocity_max() - velocity)).sqrt();
        let down = (2.0 * bounds.jerk() * (velocity - bounds.velocity_min())).sqrt();
        let most = bounds.acceleration_max().min(up);
        let least = bounds.acceleration_min().max(-down);
        let acceleration = if share > 0.0 {
            share * most
        } else {
            -share * least
        };
        Sample {
            acceleration: if rests { 0.0 } else { acceleration },
            ..Sample::coasting(0.0, velocity)
        }
    })
}

/// A start at zero, outside the limits as often as not.
pub fn anywhere(bounds: &SignedBounds) -> impl Strategy<Value = Sample> + use<> {
    let bounds = *bounds;
    let fast = bounds.velocity_max().max(-bounds.velocity_min());
    let rate = bounds.acceleration_max().max(-bounds.acceleration_min());
    (signed(-2.0, 1.0), signed(-2.0, 1.0)).prop_map(move |(velocity, acceleration)| Sample {
        acceleration: acceleration * rate,
        ..Sample::coasting(0.0, velocity * fast)
    })
}

/// Limits and a start at zero with a velocity above them, also once its acceleration is released.
pub fn too_fast() -> impl Strategy<Value = (SignedBounds, Sample)> {
    (bounds(), 1.0..5.0f64, -1.0..1.0f64).prop_map(|(bounds, over, share)| {
        let velocity = bounds.velocity_max() * over;
        let down = (2.0 * bounds.jerk() * (velocity - bounds.velocity_max())).sqrt();
        let limit = if share > 0.0 {
            bounds.acceleration_max()
        } else {
            down.min(-bounds.acceleration_min())
        };
        let from = Sample {
            acceleration: share * limit,
            ..Sample::coasting(0.0, velocity)
        };
        (bounds, from)
    })
}

/// A displacement, from far less to far more than the limits need to show.
pub fn displacement(bounds: &SignedBounds) -> impl Strategy<Value = f64> + use<> {
    let natural = scale(bounds) * bounds.velocity_max().max(-bounds.velocity_min());
    signed(-4.0, 2.0).prop_map(move |share| share * natural)
}

/// Limits, a start inside them and a target with a velocity inside them.
pub fn inside_case() -> impl Strategy<Value = (SignedBounds, Sample, Sample)> {
    bounds().prop_flat_map(|bounds| {
        let target = (displacement(&bounds), velocity(&bounds))
            .prop_map(|(position, velocity)| Sample::coasting(position, velocity));
        (Just(bounds), inside(&bounds), target)
    })
}

/// The same from anywhere.
pub fn any_case() -> impl Strategy<Value = (SignedBounds, Sample, Sample)> {
    bounds().prop_flat_map(|bounds| {
        let target = (displacement(&bounds), velocity(&bounds))
            .prop_map(|(position, velocity)| Sample::coasting(position, velocity));
        (Just(bounds), anywhere(&bounds), target)
    })
}

/// The largest displacement and rates that occur, to measure errors by.
pub struct Size {
    pub position: f64,
    pub velocity: f64,
    pub acceleration: f64,
}

impl Size {
    pub fn of(curve: &Segments) -> Self {
        let start = curve.start().position;
        let mut size = Self {
            position: (curve.end().position - start).abs(),
            velocity: curve.end().velocity.abs(),
            acceleration: 0.0,
        };
        for piece in curve.segments() {
            for time in [0.0, 0.25, 0.5, 0.75, 1.0] {
                let at = piece.entry.after(time * piece.duration);
                size.position = size.position.max((at.position - start).abs());
                size.velocity = size.velocity.max(at.velocity.abs());
                size.acceleration = size.acceleration.max(at.acceleration.abs());
            }
        }
        size
    }
}

/// Begins and ends exactly as asked, and is continuous at every change of pieces.
pub fn hangs_together(curve: &Segments, from: Sample, to: Sample) -> Result<(), TestCaseError> {
    let size = Size::of(curve);
    prop_assert_eq!(
        curve.end(),
        Sample {
            acceleration: 0.0,
            jerk: 0.0,
            ..to
        }
    );
    let last = curve.at(curve.duration());
    prop_assert_eq!(
        (last.position, last.velocity, last.acceleration),
        (to.position, to.velocity, 0.0)
    );
    let mut before = from;
    let mut time = 0.0;
    for piece in curve.segments() {
        let entry = piece.entry;
        let lengths = size.position + 1e-3 * from.position.abs();
        prop_assert!(
            (entry.position - before.position).abs() <= 1e-11 * lengths,
            "{before:?} {piece:?} {curve:?}"
        );
        prop_assert!(
            (entry.velocity - before.velocity).abs() <= 1e-11 * size.velocity,
            "{before:?} {piece:?} {curve:?}"
        );
        prop_assert!(
            (entry.acceleration - before.acceleration).abs() <= 1e-11 * size.acceleration,
            "{before:?} {piece:?} {curve:?}"
        );
        prop_assert!((piece.start - time).abs() <= 1e-12 * curve.duration());
        before = entry.after(piece.duration);
        time = piece.start + piece.duration;
    }
    prop_assert!(
        (before.position - to.position).abs() <= 1e-11 * size.position,
        "{before:?} {curve:?}"
    );
    prop_assert!(
        (before.velocity - to.velocity).abs() <= 1e-11 * size.velocity,
        "{before:?} {curve:?}"
    );
    prop_assert!(
        before.acceleration.abs() <= 1e-11 * size.acceleration,
        "{before:?} {curve:?}"
    );
    Ok(())
}

/// Keeps the limits at every instant, for a start inside them.
pub fn keeps(curve: &Segments, bounds: &SignedBounds) -> Result<(), TestCaseError> {
    const SLACK: f64 = 1.0 + 1e-9;
    for piece in curve.segments() {
        let entry = piece.entry;
        prop_assert!(entry.jerk.abs() <= bounds.jerk() * SLACK);
        let turn = -entry.acceleration / entry.jerk;
        let turn = if turn > 0.0 && turn < piece.duration {
            turn
        } else {
            0.0
        };
        let middle = piece.start + piece.duration / 2.0;
        for at in [
            entry,
            entry.after(turn),
            entry.after(piece.duration),
            curve.at(middle),
        ] {
            let (velocity, acceleration) = (at.velocity, at.acceleration);
            prop_assert!(
                velocity <= bounds.velocity_max() * SLACK,
                "{at:?} {curve:?}"
            );
            prop_assert!(
                velocity >= bounds.velocity_min() * SLACK,
                "{at:?} {curve:?}"
            );
            prop_assert!(
                acceleration <= bounds.acceleration_max() * SLACK,
                "{at:?} {curve:?}"
            );
            prop_assert!(
                acceleration >= bounds.acceleration_min() * SLACK,
                "{at:?} {curve:?}"
            );
        }
    }
    Ok(())
}
