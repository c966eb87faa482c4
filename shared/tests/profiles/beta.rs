//! Beta moves in f64.

use super::check::{derivatives, ends, limits, positive, signed, times};
use canter_shared::motion::beta::{exact, general};
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::error::ProfileError;
use canter_shared::motion::trajectory::{Sample, Trajectory};
use proptest::prelude::*;

fn any_bounds() -> impl Strategy<Value = Bounds> {
    let jerk = prop_oneof![positive(-3.0..6.0), Just(f64::INFINITY)];
    (
        positive(-3.0..3.0),
        positive(-3.0..4.0),
        positive(-3.0..4.0),
        jerk,
    )
        .prop_map(|(velocity, acceleration, deceleration, jerk)| {
            Bounds::new(velocity, acceleration, deceleration, jerk).expect("valid")
        })
}

/// Start and range; the range may be far below or above the position's own size.
fn way() -> impl Strategy<Value = (f64, f64)> {
    (signed(-3.0..3.0), signed(-12.0..12.0)).prop_map(|(from, range)| (from, from + range))
}

fn check(
    profile: &impl Trajectory,
    (from, to): (f64, f64),
    bounds: &Bounds,
) -> Result<(), TestCaseError> {
    ends(profile, Sample::at_rest(from), Sample::at_rest(to))?;
    let acceleration = bounds.slower_acceleration();
    limits(profile, bounds.velocity(), acceleration, bounds.jerk())?;
    derivatives(profile, from.abs() + to.abs(), (to - from).abs())?;
    // Nothing is left: one limit is reached.
    let peaks = profile.peaks();
    let used = (peaks.velocity / bounds.velocity())
        .max(peaks.acceleration / acceleration)
        .max(peaks.jerk / bounds.jerk());
    prop_assert!(from == to || used >= 1.0 - 1e-12, "{peaks:?}");
    // Monotone, and the second half is the first one turned round.
    let mut last = from;
    for time in times(profile) {
        let position = profile.at(time).position;
        prop_assert!(
            (position - last) * (to - from) >= 0.0,
            "turns back at {time}"
        );
        last = position;
        let mirrored = from + (to - profile.at(profile.duration() - time).position);
        let rounding = 1e-14 * (from.abs() + to.abs());
        prop_assert!(
            (position - mirrored).abs() <= rounding,
            "{position} {mirrored}"
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3_000))]

    #[test]
    fn exact_moves(way in way(), bounds in any_bounds()) {
        let profile = exact::Profile::within(way.0, way.1, &bounds).expect("valid");
        check(&profile, way, &bounds)?;
        for time in times(&profile) {
            prop_assert_eq!(profile.position_at(time), profile.at(time).position);
            prop_assert_eq!(profile.position_with(time, f64::sqrt), profile.position_at(time));
        }
    }

    #[test]
    fn moves_of_any_p(p in 2.0..=5.0f64, way in way(), bounds in any_bounds()) {
        let profile = general::Profile::within(p, way.0, way.1, &bounds).expect("valid");
        check(&profile, way, &bounds)?;
    }

    #[test]
    fn five_halves_is_the_exact_curve(way in way(), duration in positive(-6.0..6.0)) {
        let product = exact::Profile::lasting(way.0, way.1, duration).expect("valid");
        let general = general::Profile::lasting(2.5, way.0, way.1, duration).expect("valid");
        let range = (way.1 - way.0).abs();
        let rounding = 2.0 * f64::EPSILON * (way.0.abs() + way.1.abs());
        for time in times(&product) {
            let (product, general) = (product.at(time), general.at(time));
            prop_assert!((product.position - general.position).abs() <= 2e-15 * range + rounding);
            prop_assert!((product.velocity - general.velocity).abs() * duration <= 1e-14 * range);
        }
    }

    /// Mirrored, and scaled by powers of two in range and time, every bit is the same.
    #[test]
    fn mirrored_and_scaled(
        way in way(),
        duration in positive(-6.0..6.0),
        range_power in -8i32..8,
        time_power in -8i32..8,
    ) {
        let one = exact::Profile::lasting(way.0, way.1, duration).expect("valid");
        let (range, slower) = (-(2f64.powi(range_power)), 2f64.powi(time_power));
        let other = exact::Profile::lasting(range * way.0, range * way.1, slower * duration)
            .expect("valid");
        for time in times(&one) {
            let (one, other) = (one.at(time), other.at(slower * time));
            prop_assert_eq!(range * one.position, other.position);
            prop_assert_eq!(range * one.velocity, other.velocity * slower);
            prop_assert_eq!(range * one.acceleration, other.acceleration * slower.powi(2));
            prop_assert_eq!(range * one.jerk, other.jerk * slower.powi(3));
        }
    }
}

#[test]
fn without_a_range_there_is_nothing_to_do() {
    let bounds = Bounds::new(1.0, 2.0, 3.0, 4.0).expect("valid");
    let profile = exact::Profile::within(5.0, 5.0, &bounds).expect("valid");
    assert_eq!(profile.duration(), 0.0);
    assert_eq!(profile.peaks(), Default::default());
    for time in [-1.0, 0.0, 1e-300, 1.0] {
        assert_eq!(profile.at(time), Sample::at_rest(5.0));
    }
    let resting = exact::Profile::lasting(5.0, 5.0, 3.0).expect("valid");
    assert_eq!(resting.duration(), 3.0);
    assert_eq!(resting.at(1.0).position, 5.0);
}

/// Ranges far below and above the rest, forward and backward.
#[test]
fn tiny_and_huge_ranges() {
    let bounds = Bounds::new(2.0, 3.0, 3.0, f64::INFINITY).expect("valid");
    for (range, want) in [
        // sqrt(12 sqrt(3) / pi R / a)
        (
            1e-12,
            (12.0 * 3f64.sqrt() / std::f64::consts::PI * 1e-12 / 3.0).sqrt(),
        ),
        // 32 / (5 pi) R / v
        (1e12, 32.0 / (5.0 * std::f64::consts::PI) * 1e12 / 2.0),
    ] {
        for range in [range, -range] {
            let profile = exact::Profile::within(0.0, range, &bounds).expect("valid");
            assert!((profile.duration() - want).abs() <= 1e-15 * want);
            assert_eq!(profile.at(profile.duration()).position, range);
            let quarter = profile.at(0.25 * profile.duration()).position / range;
            // F(-1/2) = 1/2 + (-pi/6 - sqrt(3)/4 (33 - 26/4 + 8/16) / 15) / pi
            let want = 0.5 - (1.0 / 6.0 + 3f64.sqrt() / 4.0 * 27.0 / 15.0 / std::f64::consts::PI);
            assert!((quarter - want).abs() <= 1e-15, "{quarter}");
        }
    }
}

#[test]
fn what_is_refused() {
    for (from, to, duration, name) in [
        (f64::NAN, 0.0, 1.0, "start position"),
        (0.0, 2e15, 1.0, "stop position"),
        (0.0, 1.0, 0.0, "duration"),
        (0.0, 1.0, f64::INFINITY, "duration"),
    ] {
        match exact::Profile::lasting(from, to, duration) {
            Err(ProfileError::Value { field, .. }) => assert_eq!(field, name),
            other => panic!("{other:?}"),
        }
    }
    assert!(general::Curve::new(1.9).is_err() && general::Curve::new(5.1).is_err());
}
