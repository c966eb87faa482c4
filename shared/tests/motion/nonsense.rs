//! No input makes a motion panic, whatever its bits.

use canter_shared::limits::{LimitValues, Limits};
use canter_shared::motion::{Motion, Move, Profile, shortest_s_curve};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::Position;
use proptest::prelude::*;

fn any_profile() -> impl Strategy<Value = Profile> {
    prop_oneof![
        Just(Profile::Beta),
        Just(Profile::SCurve),
        Just(Profile::Trapezoid),
        (any_u32(), any_u32()).prop_map(|(acceleration, deceleration)| {
            Profile::ShapedTrapezoid {
                acceleration: Ticks(acceleration),
                deceleration: Ticks(deceleration),
            }
        }),
    ]
}

/// Of every magnitude.
fn any_i64() -> impl Strategy<Value = i64> {
    (any::<i64>(), 0u32..64).prop_map(|(bits, shift)| bits >> shift)
}

fn any_u64() -> impl Strategy<Value = u64> {
    (any::<u64>(), 0u32..64).prop_map(|(bits, shift)| bits >> shift)
}

fn any_u32() -> impl Strategy<Value = u32> {
    (any::<u32>(), 0u32..32).prop_map(|(bits, shift)| bits >> shift)
}

/// Any limits that there can be: each value on a logarithmic scale over its range.
fn any_limits() -> impl Strategy<Value = Limits> {
    (
        -4.0..4.0f64,
        -4.0..6.0f64,
        -4.0..6.0f64,
        -4.0..9.0f64,
        -6000.0..6000.0f64,
        0.0..2000.0f64,
    )
        .prop_map(
            |(velocity, acceleration, deceleration, jerk, minimum, travel)| {
                let rate = |exponent: f64| 10f64.powf(exponent).max(1e-4);
                let maximum = (minimum + travel).min(6_280.0);
                Limits::new(&LimitValues {
                    velocity: rate(velocity).min(1e4),
                    acceleration: rate(acceleration).min(1e6),
                    deceleration: rate(deceleration).min(1e6),
                    jerk: rate(jerk).min(1e9),
                    position_minimum: minimum,
                    position_maximum: maximum,
                })
                .expect("in range")
            },
        )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn any_bits_are_survived(
        place in any_i64(),
        tick in any_u64(),
        steps in prop::collection::vec(
            (0u8..7, any_i64(), any_u32(), any_u64(), any_u64(), any_profile(), any_limits()),
            1..12,
        ),
    ) {
        let mut motion = Motion::at_rest(Position::from_counts(place));
        let mut now = tick;
        for (kind, target, duration, later, pass, profile, limits) in steps {
            let asked = Move {
                target: Position::from_counts(target),
                duration: Ticks(duration),
                profile,
            };
            match kind {
                0 => {
                    let _ = motion.stop(Tick(now), &limits);
                }
                6 => {
                    let _ = motion.quick_stop(Tick(now), &limits);
                }
                1 => {
                    let _ = motion.change_limits(Tick(now), &limits);
                }
                _ => {
                    let start = Tick(now.saturating_add(later));
                    let _ = motion.start(Tick(now), start, asked, &limits);
                    let range = asked.target - motion.target();
                    let _ = shortest_s_curve(range, &limits);
                }
            }
            now = now.saturating_add(pass);
            motion.at(Tick(now));
            motion.at(Tick(pass));
            motion.fold(Tick(now));
        }
    }

    /// The same where much is in range, so that moves are under way.
    #[test]
    fn retargets_within_any_limits_are_survived(
        limits in any_limits(),
        steps in prop::collection::vec(
            (0u8..7, 0.0..1.0f64, any_u32(), 0u32..40, any_u32(), any_profile(), any_limits()),
            1..12,
        ),
    ) {
        let (least, greatest) = (limits.position_minimum().counts(), limits.position_maximum().counts());
        let mut motion = Motion::at_rest(Position::from_counts(least));
        let (mut limits, mut now) = (limits, 5u64);
        for (kind, part, duration, later, pass, profile, others) in steps {
            let target = least + ((greatest - least) as f64 * part) as i64;
            let asked = Move {
                target: Position::from_counts(target),
                duration: Ticks(duration >> 10),
                profile,
            };
            match kind {
                0 => {
                    motion.stop(Tick(now), &limits);
                }
                6 => {
                    motion.quick_stop(Tick(now), &limits);
                }
                1 => {
                    if motion.change_limits(Tick(now), &others).is_ok() {
                        limits = others;
                    }
                }
                _ => {
                    let start = Tick(now + u64::from(later));
                    let before = motion.clone();
                    if motion.start(Tick(now), start, asked, &limits).is_err() {
                        for tick in [now, now + 1, now + 100, now + 10_000] {
                            prop_assert_eq!(motion.at(Tick(tick)), before.at(Tick(tick)));
                        }
                    } else {
                        prop_assert_eq!(motion.target(), asked.target);
                    }
                }
            }
            now += u64::from(pass >> 12);
            motion.at(Tick(now));
            motion.fold(Tick(now));
        }
    }
}
