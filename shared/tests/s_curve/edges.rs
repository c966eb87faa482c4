//! Where one case of the solver borders on another.

use super::random::{bounds, hangs_together, inside, keeps, velocity};
use canter_shared::motion::s_curve::{SignedBounds, change_velocity, lasting, time_optimal};
use canter_shared::motion::segments::Builder;
use canter_shared::motion::trajectory::{Sample, Trajectory};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    /// A target just where the direct change of velocity ends is reached by it: the last digit
    /// asks for no loop.
    #[test]
    fn at_the_end_of_the_direct_change(
        (bounds, from, velocity) in bounds().prop_flat_map(|bounds| {
            (Just(bounds), inside(&bounds), velocity(&bounds))
        }),
        releases in any::<bool>(),
    ) {
        // A mere release of the acceleration has no lobe at all.
        let release = from.acceleration * from.acceleration.abs() / (2.0 * bounds.jerk());
        let released = (from.velocity + release)
            .clamp(bounds.velocity_min(), bounds.velocity_max());
        let velocity = if releases { released } else { velocity };
        let direct = change_velocity(from, velocity, &bounds).expect("a valid case");
        if releases && release != 0.0 && released == from.velocity + release {
            let shortest = from.acceleration.abs() / bounds.jerk();
            let longer = direct.duration() - shortest;
            // The velocity's last digits take this long at the acceleration of the start.
            let rounding = 1e-14 * velocity.abs() / from.acceleration.abs();
            prop_assert!(longer.abs() <= 1e-12 * shortest + rounding, "{longer} {direct:?}");
        }
        let curve = time_optimal(from, direct.end(), &bounds).expect("a valid case");
        let longer = curve.duration() - direct.duration();
        prop_assert!(longer.abs() <= 1e-6 * direct.duration(), "{longer} {direct:?} {curve:?}");
    }

    /// A target a little beyond the place of the quickest stop, in a little more time.
    #[test]
    fn a_little_beyond_the_stop(
        (bounds, from) in bounds().prop_flat_map(|bounds| (Just(bounds), inside(&bounds))),
        beyond in -6.0..0.5f64,
        longer in -6.0..0.5f64,
        ahead in any::<bool>(),
    ) {
        let stop = change_velocity(from, 0.0, &bounds).expect("a valid case").end().position;
        let beyond = stop.abs() * 10f64.powf(beyond);
        let rest = Sample::at_rest(if ahead { stop + beyond } else { stop - beyond });
        let shortest = time_optimal(from, rest, &bounds).expect("a valid case").duration();
        let duration = shortest * (1.0 + 10f64.powf(longer));
        let curve = lasting(from, rest.position, duration, &bounds).expect("long enough");
        prop_assert!((curve.duration() - duration).abs() <= 1e-11 * duration);
        hangs_together(&curve, from, rest)?;
        keeps(&curve, &bounds)?;
    }

    /// A braking that gets less hard in between may get farther for a while, then less far: the
    /// first way to the target counts.
    #[test]
    fn before_the_hill(
        strength in 0.1..10.0f64,
        peak in 0.0..1.0f64,
        deeper in 0.0..1.0f64,
        hold in prop_oneof![Just(0.0), 0.0..1.0f64],
        margin in 0.001..0.3f64,
    ) {
        // With a jerk of one; magnitudes of accelerations below zero.
        let peak = peak * strength;
        let trough = peak + deeper * strength;
        // A trough that is held is the limit, which the start keeps too.
        let hold = if trough >= strength { hold * strength } else { 0.0 };
        let limit = if hold > 0.0 { trough } else { 10.0 * strength };
        // What is reached grows up to this peak where 2 u^2 - u x + 2 P is above zero.
        let squares = trough * trough - peak * peak + 2.0 * hold * trough / 2.0;
        let falls = |u: f64| u * (u * u + squares).sqrt().min(limit) - 2.0 * u * u;
        let steps = (0..=100).map(|step| peak + (strength - peak) * f64::from(step) / 100.0);
        let begin = steps.map(falls).fold(0.0, f64::max) / 2.0 + margin * strength * strength;
        let from = Sample {
            acceleration: -strength,
            ..Sample::coasting(0.0, begin + strength * strength / 2.0)
        };
        let way = Builder::new(from)
            .jerk(strength - peak, 1.0)
            .jerk(trough - peak, -1.0)
            .jerk(hold, 0.0)
            .jerk(trough, 1.0);
        let (duration, to) = (way.duration(), Sample { acceleration: 0.0, ..way.now() });
        let wide = 1e6 * strength * strength;
        let lowest = if hold > 0.0 { -limit } else { -10.0 * strength };
        let bounds = SignedBounds::new(wide, -wide, 10.0 * strength, lowest, 1.0).expect("in range");
        let curve = time_optimal(from, to, &bounds).expect("a valid case");
        prop_assert!((curve.duration() - duration).abs() <= 1e-7 * duration, "{} {duration} {curve:?}", curve.duration());
    }
}
