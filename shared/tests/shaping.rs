//! Input shaping: the mode stays at rest, limits are kept, the target and the delay are exact.

#[path = "shaping/mass.rs"]
mod mass;

use canter_shared::motion::beta::{Beta, exact};
use canter_shared::motion::shaping::{
    CAPACITY, HIGHEST_FREQUENCY, LARGEST_DAMPING, Shaped, Shaper, ShaperKind, Shaping,
    ShapingError, TOLERANCE,
};
use canter_shared::motion::trajectory::{Peaks, Sample, Trajectory};
use canter_shared::motion::{Setpoint, segments};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::{Acceleration, COUNTS_PER_TURN, Position, Velocity};
use core::f64::consts::TAU;
use mass::{residual, vibration};
use proptest::prelude::*;

const KINDS: [ShaperKind; 3] = [ShaperKind::Zv, ShaperKind::Zvd, ShaperKind::Ei];

/// A beta move's setpoints, from the tick before it leaves until `after` ticks at rest.
fn beta(range: i64, duration: u32, after: u32) -> Vec<Setpoint> {
    let beta = Beta::new(Tick(0), Position::from_counts(range), Ticks(duration));
    (0..=duration + after)
        .map(|tick| beta.at(Tick(tick.into())))
        .collect()
}

fn shaped(shaper: &mut Shaper, setpoints: &[Setpoint]) -> Vec<Setpoint> {
    setpoints
        .iter()
        .map(|setpoint| shaper.shape(*setpoint))
        .collect()
}

fn modes() -> impl Strategy<Value = (ShaperKind, f64, f64)> {
    (0usize..3, 0.0..=1.0f64, 0.0..=LARGEST_DAMPING).prop_map(|(kind, part, damping)| {
        let kind = KINDS[kind];
        let lowest = kind.lowest_frequency(damping);
        let frequency = lowest * (HIGHEST_FREQUENCY / lowest).powf(part);
        (kind, frequency.clamp(lowest, HIGHEST_FREQUENCY), damping)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn the_impulses_leave_the_mode_at_rest((kind, frequency, damping) in modes()) {
        let shaping = Shaping::new(kind, frequency, damping).expect("in range");
        for impulses in [shaping.impulses(), shaping.impulses_in_ticks()] {
            let sum: f64 = impulses.iter().map(|impulse| impulse.amplitude).sum();
            prop_assert!((sum - 1.0).abs() < 1e-14, "{sum}");
            prop_assert!(impulses.iter().all(|impulse| impulse.amplitude > 0.0));
            prop_assert!(impulses.iter().is_sorted_by(|a, b| a.time < b.time));
            prop_assert_eq!(impulses[0].time, 0.0);
        }
        for in_ticks in [false, true] {
            let left = vibration(&shaping, in_ticks, frequency, damping);
            let most = if kind == ShaperKind::Ei { TOLERANCE } else { 0.0 };
            prop_assert!(left <= most + 1e-12, "{left}");
        }
        let published = shaping.impulses().last().expect("impulses").time;
        let late = shaping.delay().seconds() - published;
        prop_assert!((-1e-12..2.001e-3).contains(&late), "{late}");
        prop_assert!(shaping.delay().0 as usize <= CAPACITY);
    }

    /// Known bands: Singhose, Seering and Singer give ZV, ZVD and EI an insensitivity of 0.06, 0.29
    /// and 0.40 for 5 % without damping, and damping only widens it.
    #[test]
    fn a_wrong_frequency_is_forgiven((_, frequency, damping) in modes(), off in -1.0..1.0f64) {
        let frequency = frequency.clamp(6.1, 240.0);
        let shapings = KINDS.map(|kind| Shaping::new(kind, frequency, damping).expect("in range"));
        for in_ticks in [false, true] {
            let left = |kind: usize, off: f64| {
                vibration(&shapings[kind], in_ticks, frequency * (1.0 + off), damping)
            };
            prop_assert!(left(0, off * 0.031) <= 0.05, "ZV {}", left(0, off * 0.031));
            prop_assert!(left(1, off * 0.142) <= 0.05, "ZVD {}", left(1, off * 0.142));
            prop_assert!(left(2, off * 0.199) <= 0.0501, "EI {}", left(2, off * 0.199));
            // Within a third of the frequency ZVD is better than ZV: it is ZV twice.
            let off = off / 3.0;
            prop_assert!(left(1, off) <= left(0, off) + 1e-12);
            // And the farther off, the worse.
            prop_assert!(left(0, off * 0.9) <= left(0, off) + 1e-12);
            prop_assert!(left(1, off * 0.9) <= left(1, off) + 1e-12);
        }
    }

}

proptest! {
    // Each case is a whole move.
    #![proptest_config(ProptestConfig::with_cases(500))]

    /// The device's shaper on a device's move, felt by a mass on a spring.
    #[test]
    fn a_shaped_move_leaves_the_mass_at_rest(
        (kind, frequency, damping) in modes(),
        duration in 20u32..1_200,
        backward: bool,
    ) {
        // 500 turns, so that the rounding to counts is below 1e-12 of it.
        let range = if backward { -500 } else { 500 } * COUNTS_PER_TURN;
        let mut shaper = Shaper::new(kind, frequency, damping).expect("in range");
        let delay = shaper.delay().0;
        let setpoints = beta(range, duration, delay);
        let out = shaped(&mut shaper, &setpoints);
        let left = residual(&out, frequency, damping);
        // As a part of the range; what there would be without the shaper, at the same time.
        let without = residual(&setpoints, frequency, damping);
        let allowed = if kind == ShaperKind::Ei {
            // At its first arrival the swing was larger by what has died down since.
            residual(&beta(range, duration, 0), frequency, damping) * TOLERANCE
        } else {
            0.0
        };
        prop_assert!(left <= allowed + 1e-9 * 500.0, "{left} of {without}");
        // The target and the delay are exact.
        prop_assert_eq!(out[out.len() - 1], setpoints[setpoints.len() - 1]);
        prop_assert!(shaper.is_settled());
        // The last part of a step, however small, comes with the delay and not before.
        let step = Setpoint { position: Position::from_counts(1 << 50), ..Setpoint::default() };
        shaper.reset(Position::ZERO);
        for _ in 0..delay {
            prop_assert!(shaper.shape(step) != step);
        }
        prop_assert_eq!(shaper.shape(step), step);
    }

    /// The device's integers are the host's sum over the same impulses.
    #[test]
    fn the_device_equals_the_trajectory_in_f64(
        (kind, frequency, damping) in modes(),
        turns in -100.0..100.0f64,
        duration in 30u32..2_000,
    ) {
        let range = (turns * COUNTS_PER_TURN as f64) as i64;
        let shaping = Shaping::new(kind, frequency, damping).expect("in range");
        let mut shaper = Shaper::none();
        shaper.change(Some(&shaping)).expect("at rest");
        let seconds = f64::from(duration) / 1e3;
        let curve = exact::Profile::lasting(0.0, range as f64, seconds).expect("valid");
        let host = Shaped::in_ticks(Curve(curve), &shaping);
        prop_assert!((host.duration() - seconds - shaping.delay().seconds()).abs() < 1e-12);
        // 32 / (5 pi) R / T and 12 sqrt(3) / pi R / T^2.
        let fastest = 2.04 * range.abs() as f64 / seconds;
        let strongest = 6.62 * range.abs() as f64 / (seconds * seconds);
        for (tick, got) in shaped(&mut shaper, &beta(range, duration, CAPACITY as u32))
            .iter()
            .enumerate()
        {
            let want = host.at(tick as f64 / 1e3);
            let error = got.position.counts() as f64 - want.position;
            // The curve itself is good for 1e-12 of its range.
            prop_assert!(error.abs() <= 1.5 + 2e-12 * range.abs() as f64, "position {error}");
            let error = got.velocity.counts() as f64 - want.velocity;
            prop_assert!(error.abs() <= 2.0 + 1e-7 * fastest, "velocity {error}");
            let error = got.acceleration.counts() as f64 - want.acceleration;
            prop_assert!(error.abs() <= 2.0 + 1e-7 * strongest, "acceleration {error}");
        }
    }

    /// Whatever comes in, what goes out is between the least and the greatest of the recent.
    #[test]
    fn every_range_is_kept(
        (kind, frequency, damping) in modes(),
        inputs in prop::collection::vec(
            (any::<i64>(), any::<i64>(), any::<i64>(), 0u32..63, 1usize..40), 60
        ),
    ) {
        let mut shaper = Shaper::new(kind, frequency, damping).expect("in range");
        let delay = shaper.delay().0 as usize;
        let mut seen = vec![Setpoint::default(); delay];
        for (position, velocity, acceleration, shift, times) in inputs {
            // Every magnitude up to that of a limit; beyond it, nothing is promised but no panic.
            let within = |value: i64| (value >> shift) % (1 << 50);
            for _ in 0..times {
                let setpoint = Setpoint {
                    position: Position::from_counts(within(position)),
                    velocity: Velocity::from_counts(within(velocity)),
                    acceleration: Acceleration::from_counts(within(acceleration)),
                };
                seen.push(setpoint);
                let out = shaper.shape(setpoint);
                let recent = &seen[seen.len() - 1 - delay..];
                let range = |part: fn(&Setpoint) -> i64| {
                    let values = recent.iter().map(part);
                    values.clone().min().expect("one")..=values.max().expect("one")
                };
                prop_assert!(range(|s| s.position.counts()).contains(&out.position.counts()));
                // Rounded towards zero.
                let toward = |range: std::ops::RangeInclusive<i64>| {
                    (*range.start()).min(0)..=(*range.end()).max(0)
                };
                let velocity = toward(range(|s| s.velocity.counts()));
                prop_assert!(velocity.contains(&out.velocity.counts()));
                let acceleration = toward(range(|s| s.acceleration.counts()));
                prop_assert!(acceleration.contains(&out.acceleration.counts()));
                let same = recent.iter().all(|other| *other == setpoint);
                prop_assert!(!same || out.position == setpoint.position);
                let still = (setpoint.velocity, setpoint.acceleration) == Default::default();
                prop_assert!(!(same && still) || (shaper.is_settled() && out == setpoint));
            }
        }
    }

    #[test]
    fn no_input_panics(
        bits: [u64; 2],
        kind in 0usize..3,
        inputs in prop::collection::vec((any::<i64>(), any::<i64>(), any::<i64>()), 200),
    ) {
        let [frequency, damping] = bits.map(f64::from_bits);
        for (frequency, damping) in [(frequency, damping), (frequency, 0.1), (30.0, damping), (30.0, 0.1)] {
            match Shaper::new(KINDS[kind], frequency, damping) {
                Ok(mut shaper) => {
                    for (position, velocity, acceleration) in &inputs {
                        shaper.shape(Setpoint {
                            position: Position::from_counts(*position),
                            velocity: Velocity::from_counts(*velocity),
                            acceleration: Acceleration::from_counts(*acceleration),
                        });
                    }
                    shaper.reset(Position::from_counts(inputs[0].0));
                }
                Err(error) => {
                    prop_assert!(error.to_string().contains("must be a number from"));
                }
            }
        }
    }
}

/// The exact beta curve as a trajectory.
struct Curve(exact::Profile);

impl Trajectory for Curve {
    fn duration(&self) -> f64 {
        self.0.duration()
    }
    fn at(&self, time: f64) -> Sample {
        self.0.at(time)
    }
    fn peaks(&self) -> Peaks {
        Peaks::default()
    }
}

/// How wide the band around the frequency is in which the vibration stays at or below 5 %.
fn insensitivity(kind: ShaperKind) -> f64 {
    let shaping = Shaping::new(kind, 20.0, 0.0).expect("in range");
    let inside = |off: &i32| {
        vibration(&shaping, true, 20.0 * (1.0 + f64::from(*off) / 1e4), 0.0) <= TOLERANCE + 1e-9
    };
    let above = (0..).take_while(inside).count();
    let below = (0..).map(|off: i32| -off).take_while(inside).count();
    (above + below) as f64 / 1e4
}

#[test]
fn insensitivity_is_the_published_one() {
    for (kind, published) in KINDS.into_iter().zip([0.06, 0.29, 0.40]) {
        let found = insensitivity(kind);
        assert!((found - published).abs() < 0.005, "{kind}: {found}");
    }
}

/// The amplitudes that Singer and Seering print for ZV and ZVD, and Singhose, Seering and Singer
/// for EI, without damping.
#[test]
fn amplitudes_are_the_published_ones() {
    for (kind, amplitudes) in [
        (ShaperKind::Zv, &[0.5, 0.5][..]),
        (ShaperKind::Zvd, &[0.25, 0.5, 0.25]),
        (ShaperKind::Ei, &[0.2625, 0.475, 0.2625]),
    ] {
        let shaping = Shaping::new(kind, 10.0, 0.0).expect("in range");
        // Half a period is 50 whole ticks.
        for impulses in [shaping.impulses(), shaping.impulses_in_ticks()] {
            assert_eq!(impulses.len(), amplitudes.len());
            for (index, (impulse, amplitude)) in impulses.iter().zip(amplitudes).enumerate() {
                assert!((impulse.amplitude - amplitude).abs() < 1e-14, "{impulse:?}");
                assert!(
                    (impulse.time - 0.05 * index as f64).abs() < 1e-14,
                    "{impulse:?}"
                );
            }
        }
        assert_eq!(shaping.delay(), Ticks(50 * (amplitudes.len() as u32 - 1)));
    }
    // With damping: K = exp(-zeta pi / sqrt(1 - zeta^2)) = 0.7292 for zeta = 0.1.
    let shaping = Shaping::new(ShaperKind::Zv, 10.0, 0.1).expect("in range");
    let impulses = shaping.impulses();
    let ratio = impulses[1].amplitude / impulses[0].amplitude;
    assert!((ratio - 0.729_247_6).abs() < 1e-6, "{ratio}");
    assert!((impulses[1].time - 0.05 / 0.99f64.sqrt()).abs() < 1e-15);
}

/// The mode that is not at a whole tick: rounding the delay, as is often done, leaves a swing.
#[test]
fn splitting_onto_two_ticks_beats_rounding() {
    let (frequency, damping) = (47.3, 0.03);
    let shaping = Shaping::new(ShaperKind::Zv, frequency, damping).expect("in range");
    let mut rounded = 0.0;
    let mut phase = (0.0f64, 0.0f64);
    for impulse in shaping.impulses() {
        let time = (impulse.time * 1e3).round() / 1e3;
        let natural = TAU * frequency;
        let growth = impulse.amplitude * (damping * natural * time).exp();
        let (sine, cosine) = (natural * (1.0 - damping * damping).sqrt() * time).sin_cos();
        phase = (phase.0 + growth * cosine, phase.1 + growth * sine);
        rounded = phase.0.hypot(phase.1);
    }
    assert!(rounded > 0.03, "{rounded}");
    assert!(vibration(&shaping, true, frequency, damping) < 1e-14);
}

#[test]
fn without_a_shaper_setpoints_pass_as_they_are() {
    let mut shaper = Shaper::none();
    assert_eq!(shaper.delay(), Ticks(0));
    for setpoint in beta(3 * COUNTS_PER_TURN, 500, 3) {
        assert_eq!(shaper.shape(setpoint), setpoint);
        assert!(shaper.is_settled());
    }
}

#[test]
fn a_shaper_is_changed_at_rest_only() {
    let zv = Shaping::new(ShaperKind::Zv, 10.0, 0.05).expect("in range");
    let ei = Shaping::new(ShaperKind::Ei, 25.0, 0.05).expect("in range");
    let start = Position::from_counts(5 * COUNTS_PER_TURN);
    let mut shaper = Shaper::none();
    shaper.reset(start);
    shaper.change(Some(&zv)).expect("at rest");
    let moved = |setpoint: &Setpoint| Setpoint {
        position: setpoint.position + start,
        ..*setpoint
    };
    let setpoints: Vec<_> = beta(COUNTS_PER_TURN, 300, zv.delay().0)
        .iter()
        .map(moved)
        .collect();
    let (last, before) = setpoints.split_last().expect("setpoints");
    assert_eq!(shaper.shape(before[0]), before[0]);
    for setpoint in &before[1..] {
        shaper.shape(*setpoint);
        assert!(!shaper.is_settled());
        assert_eq!(shaper.change(Some(&ei)), Err(ShapingError::Moving));
        assert_eq!(shaper.change(None), Err(ShapingError::Moving));
        assert_eq!(shaper.delay(), zv.delay());
    }
    assert_eq!(shaper.shape(*last), *last);
    for shaping in [Some(&ei), None, Some(&zv)] {
        shaper.change(shaping).expect("at rest");
        assert!(shaper.is_settled());
        assert_eq!(shaper.shape(*last), *last);
    }
    // Passing through what still moves.
    shaper.change(None).expect("at rest");
    shaper.shape(setpoints[150]);
    assert_eq!(shaper.change(Some(&ei)), Err(ShapingError::Moving));
    shaper.reset(start);
    assert_eq!(shaper.change(Some(&ei)), Ok(()));
    assert_eq!(shaper.shape(before[0]), before[0]);
}

#[test]
fn a_shaper_forgets_where_the_axis_was_while_setpoints_passed() {
    let zv = Shaping::new(ShaperKind::Zv, 10.0, 0.05).expect("in range");
    let mut shaper = Shaper::none();
    let setpoints = beta(COUNTS_PER_TURN, 300, 1);
    shaped(&mut shaper, &setpoints);
    shaper.change(Some(&zv)).expect("at rest");
    let rest = setpoints[setpoints.len() - 1];
    for _ in 0..=CAPACITY {
        assert_eq!(shaper.shape(rest), rest);
    }
}

#[test]
fn errors_name_field_value_range_and_cure() {
    let says = |kind, frequency, damping| {
        Shaping::new(kind, frequency, damping)
            .expect_err("refused")
            .to_string()
    };
    assert_eq!(
        says(ShaperKind::Zvd, 3.0, 0.0),
        "ZVD shaper frequency must be a number from 5.208333333333333 to 250 Hz, but it is 3: \
         a ZV shaper goes down to half of the minimum"
    );
    assert_eq!(
        says(ShaperKind::Zv, f64::NAN, 0.0),
        "ZV shaper frequency must be a number from 2.6041666666666665 to 250 Hz, but it is NaN"
    );
    assert_eq!(
        says(ShaperKind::Ei, 10.0, 0.6),
        "shaper damping ratio must be a number from 0 to 0.5, but it is 0.6: \
         what is damped more needs no shaper"
    );
    for kind in KINDS {
        for damping in (0..=5_000).map(|part| LARGEST_DAMPING * f64::from(part) / 5e3) {
            let lowest = kind.lowest_frequency(damping);
            let shaping = Shaping::new(kind, lowest, damping).expect("the lowest itself");
            assert!(shaping.delay().0 as usize <= CAPACITY);
            assert!(vibration(&shaping, true, lowest, damping) <= TOLERANCE + 1e-12);
            assert!(Shaping::new(kind, lowest * 0.999, damping).is_err());
            assert!(Shaping::new(kind, HIGHEST_FREQUENCY, damping).is_ok());
        }
    }
}

/// A shaped trajectory in f64 starts and ends exactly, and passes no peak of what it shapes.
#[test]
fn a_shaped_trajectory_keeps_ends_and_peaks() {
    let trapezoid = segments::Builder::new(Sample::at_rest(-0.3))
        .acceleration(0.2, 10.0)
        .acceleration(0.31, 0.0)
        .acceleration(0.1, -20.0)
        .end(0.7123, 0.0);
    let smooth = segments::Builder::new(Sample::at_rest(0.1))
        .jerk(0.1, 500.0)
        .jerk(0.2, -500.0)
        .jerk(0.1, 500.0)
        .end_smoothly(1.1, 0.0);
    for kind in KINDS {
        let shaping = Shaping::new(kind, 17.7, 0.04).expect("in range");
        for (inner, start, end) in [
            (trapezoid.clone(), -0.3, 0.7123),
            (smooth.clone(), 0.1, 1.1),
        ] {
            for shaped in [
                Shaped::new(inner.clone(), &shaping),
                Shaped::in_ticks(inner.clone(), &shaping),
            ] {
                let duration = shaped.duration();
                assert_eq!(duration, inner.duration() + shaped.delay());
                assert_eq!(shaped.at(0.0).position, start);
                assert_eq!(shaped.at(-1.0), Sample::at_rest(start));
                assert_eq!(shaped.at(duration), Sample::at_rest(end));
                assert_eq!(shaped.at(duration + 3.0), Sample::at_rest(end));
                assert!(shaped.at(f64::NAN).position.is_nan());
                let (peaks, most) = (shaped.peaks(), inner.peaks());
                assert!(peaks.velocity <= most.velocity && peaks.velocity > 0.5 * most.velocity);
                assert!(peaks.acceleration <= most.acceleration);
                assert!(peaks.jerk <= most.jerk && peaks.jerk > 0.0);
                assert_eq!(peaks.jerk.is_infinite(), most.jerk.is_infinite());
            }
        }
    }
}
