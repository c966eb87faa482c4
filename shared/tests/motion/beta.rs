//! The device's beta curve against the exact one.

use canter_shared::motion::beta::{Beta, exact};
use canter_shared::motion::trajectory::Trajectory;
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::Position;
use proptest::prelude::*;

use super::watch::position;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn device_beta_is_within_1e_12_of_the_exact_curve(
        range in -6000.0..6000.0f64,
        duration in 1u32..400_000,
        part in 0.0..1.0f64,
    ) {
        let range = position(range);
        let beta = Beta::new(Tick(7), range, Ticks(duration));
        let tick = (f64::from(duration) * part) as u32;
        let got = beta.position(Tick(7 + u64::from(tick))).counts() as f64;
        let x = 2.0 * f64::from(tick) / f64::from(duration) - 1.0;
        let want = exact::shape(x).value * range.counts() as f64;
        let bound = 1e-12 * (range.counts().abs() as f64) + 0.51;
        prop_assert!((got - want).abs() <= bound, "{got} {want} at {tick}/{duration}");
    }

    #[test]
    fn device_beta_velocity_and_acceleration(
        range in -600.0..600.0f64,
        duration in 10u32..100_000,
        part in 0.0..1.0f64,
    ) {
        let range = position(range);
        let beta = Beta::new(Tick(0), range, Ticks(duration));
        let tick = (f64::from(duration) * part) as u32;
        let got = beta.at(Tick(u64::from(tick)));
        let seconds = f64::from(duration) / 1e3;
        let want = exact::Profile::lasting(0.0, range.radians(), seconds)
            .expect("valid")
            .at(f64::from(tick) / 1e3);
        let peak_velocity = beta.peak_velocity().radians();
        let peak_acceleration = beta.peak_acceleration().radians();
        prop_assert!((got.velocity.radians() - want.velocity).abs() <= 1e-9 * peak_velocity + 1e-8);
        prop_assert!(
            (got.acceleration.radians() - want.acceleration).abs() <= 1e-9 * peak_acceleration + 1e-8
        );
        prop_assert!(got.velocity.abs() <= beta.peak_velocity());
        prop_assert!(got.acceleration.abs() <= beta.peak_acceleration());
    }
}

#[test]
fn a_beta_move_is_symmetric_monotone_and_ends_exactly() {
    let range = Position::from_counts(0x1234_5678_9ABC);
    for duration in [1u32, 2, 3, 4, 5, 7, 8, 64, 1_000, 4_096, 65_537] {
        let beta = Beta::new(Tick(0), range, Ticks(duration));
        let at = |tick: u32| beta.position(Tick(u64::from(tick))).counts();
        assert_eq!(at(0), 0);
        assert_eq!(at(duration), range.counts());
        for tick in 0..duration {
            assert!(at(tick) <= at(tick + 1), "{tick} of {duration}");
            // The middle is its own mirror image and carries the polynomial's 1e-13.
            if 2 * tick != duration {
                assert_eq!(at(tick) + at(duration - tick), range.counts());
            }
        }
    }
}
