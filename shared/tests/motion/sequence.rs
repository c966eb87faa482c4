//! Random sequences of everything that changes a motion, every tick of them watched.

use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::beta::Beta;
use canter_shared::motion::trapezoid::Trapezoid;
use canter_shared::motion::{Motion, Move, Profile, shortest_s_curve};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::{COUNTS_PER_RADIAN, Position};
use proptest::prelude::*;

use super::watch::{Watch, limits_strategy};

/// What happens next, and how many ticks pass then.
#[derive(Debug, Clone)]
struct Step {
    what: What,
    ticks: u32,
}

#[derive(Debug, Clone)]
enum What {
    Move {
        profile: Profile,
        /// A part of the travel.
        target: f64,
        /// Times the shortest duration from rest.
        slower: f64,
        later: u64,
    },
    Stop,
    QuickStop,
    /// Velocity, acceleration, deceleration and jerk, times what they are.
    Limits([f64; 4]),
}

fn step(profiles: &'static [Profile]) -> impl Strategy<Value = Step> {
    let moves = (
        prop::sample::select(profiles),
        0.0..1.0f64,
        1.0..3.0f64,
        prop_oneof![Just(0u64), 0..30u64],
    )
        .prop_map(|(profile, target, slower, later)| What::Move {
            profile,
            target,
            slower,
            later,
        });
    let limits = prop::array::uniform4(0.3..1.7f64).prop_map(What::Limits);
    // A quick stop takes no notice of the jerk limit, as a trapezoid does not.
    let stops = if profiles.contains(&Profile::Trapezoid) {
        vec![What::Stop, What::QuickStop]
    } else {
        vec![What::Stop]
    };
    let what = prop_oneof![6 => moves, 1 => prop::sample::select(stops), 1 => limits];
    (what, 0u32..400).prop_map(|(what, ticks)| Step { what, ticks })
}

fn scaled(limits: &Limits, by: [f64; 4]) -> Limits {
    let [velocity, acceleration, deceleration, jerk] = by;
    Limits::new(&LimitValues {
        velocity: limits.velocity().radians() * velocity,
        acceleration: limits.acceleration().radians() * acceleration,
        deceleration: limits.deceleration().radians() * deceleration,
        jerk: limits.jerk().radians() * jerk,
        position_minimum: limits.position_minimum().radians(),
        position_maximum: limits.position_maximum().radians(),
    })
    .expect("in range")
}

fn shortest(profile: Profile, range: Position, limits: &Limits) -> Option<Ticks> {
    match profile {
        Profile::Beta => Beta::shortest(range, limits),
        Profile::SCurve => shortest_s_curve(range, limits),
        _ => Trapezoid::shortest(range, limits).map(|shortest| shortest.duration()),
    }
}

/// Plays `steps` from the middle of the travel, and then waits for the rest.
fn play(limits: Limits, steps: Vec<Step>, travel_first: bool) -> Result<(), TestCaseError> {
    let (least, greatest) = (limits.position_minimum(), limits.position_maximum());
    let middle = Position::from_counts((least.counts() + greatest.counts()) / 2);
    let mut motion = Motion::at_rest(middle);
    let mut watch = Watch::new(limits);
    watch.travel_first = travel_first;
    watch.last = motion.at(Tick(0));
    let (mut limits, mut now) = (limits, 1_000u64);
    let mut target = None;
    let mut lowered = false;
    for Step { what, ticks } in steps {
        // A stop takes more jerk rather than pass a limit. Moves that were planned with the limits that
        // hold never ask for that; a limit that was lowered may.
        if lowered && !matches!(what, What::Limits(_)) {
            watch.steps |= watch.carries_over_a_limit();
        }
        match what {
            What::Stop => {
                let rest = motion.stop(Tick(now), &limits);
                prop_assert!(motion.end().is_none_or(|end| end <= rest));
                prop_assert!(
                    travel_first || rest.0 <= now + watch.longest_stop(),
                    "{rest:?} {now}"
                );
                watch.adds_no_speed();
                target = None;
            }
            What::QuickStop => {
                let smooth = motion.clone().stop(Tick(now), &limits);
                let rest = motion.quick_stop(Tick(now), &limits);
                prop_assert!(motion.end().is_none_or(|end| end <= rest));
                prop_assert!(
                    travel_first || rest.0 <= now + watch.longest_stop(),
                    "{rest:?} {now}"
                );
                // It keeps a lowered limit at once, and a smooth one takes back what is above it.
                let above = watch.last.acceleration.abs() > limits.deceleration();
                prop_assert!(above || rest <= smooth, "{rest:?} {smooth:?}");
                target = None;
                watch.steps = true;
            }
            What::Limits(by) => {
                let others = scaled(&limits, by);
                let before = motion.target();
                if motion.change_limits(Tick(now), &others).is_ok() {
                    limits = others;
                    watch.change_limits(others);
                    lowered = true;
                }
                prop_assert_eq!(motion.target(), before);
            }
            What::Move {
                profile,
                target: part,
                slower,
                later,
            } => {
                let span = (greatest - least).counts() as f64;
                // So far at most that a test ends some day.
                let reach = (limits.velocity().radians() * 2.0 * COUNTS_PER_RADIAN).min(span / 2.0);
                let goal = if travel_first {
                    least.counts() + (span * part) as i64
                } else {
                    middle.counts() + (reach * (2.0 * part - 1.0)) as i64
                };
                let goal = Position::from_counts(goal);
                let Some(least) = shortest(profile, goal - motion.target(), &limits) else {
                    continue;
                };
                let asked = Move {
                    target: goal,
                    duration: Ticks((f64::from(least.0) * slower) as u32),
                    profile,
                };
                let start = Tick(now + later);
                if let Ok(planned) = motion.start(Tick(now), start, asked, &limits) {
                    prop_assert_eq!(motion.target(), goal);
                    prop_assert!(planned.start >= start, "{planned:?} {start:?}");
                    prop_assert!(motion.end().is_none_or(|end| end <= planned.end));
                    target = Some(goal);
                    watch.steps |= profile == Profile::Trapezoid;
                }
            }
        }
        watch.run(&mut motion, now, now + u64::from(ticks))?;
        now += u64::from(ticks);
        if !motion.is_moving(Tick(now)) {
            (watch.steps, lowered) = (false, false);
        }
    }
    let end = motion.end().map_or(now, |end| end.0.max(now));
    watch.run(&mut motion, now, (end + 2).min(now + 300_000))?;
    if end + 2 <= now + 300_000 {
        let rest = motion.at(Tick(end));
        prop_assert_eq!(rest.velocity.counts(), 0);
        prop_assert_eq!(rest.acceleration.counts(), 0);
        if let Some(target) = target {
            prop_assert_eq!(rest.position, target);
        }
        prop_assert_eq!(rest, motion.at(Tick(end + 1)));
    }
    Ok(())
}

const SMOOTH: &[Profile] = &[Profile::Beta, Profile::SCurve];
const ALL: &[Profile] = &[Profile::Beta, Profile::SCurve, Profile::Trapezoid];

/// Found by chance: an acceleration that the lowered jerk limit cannot take back inside the lowered
/// velocity limit. The stop takes four times the jerk, and stays below that speed.
#[test]
fn a_stop_under_lowered_limits_takes_more_jerk_rather_than_pass_the_velocity_limit() {
    let curve = |target: f64| What::Move {
        profile: Profile::SCurve,
        target,
        slower: 1.0,
        later: 0,
    };
    let steps = [
        (curve(0.85), 297),
        (curve(0.9), 200),
        (What::Limits([0.49, 0.3, 0.3, 0.3]), 0),
        (What::Stop, 0),
    ];
    let limits = Limits::new(&LimitValues {
        velocity: 82.7,
        acceleration: 94.5,
        deceleration: 8.05,
        jerk: 147.3,
        ..DEFAULT_VALUES
    })
    .expect("in range");
    let steps = steps.map(|(what, ticks)| Step { what, ticks });
    play(limits, steps.to_vec(), false).expect("every limit is kept");
}

/// Found by chance: a stop for the end of the travel that takes more jerk, and then a curve that would have
/// stood still, and gone back, with more acceleration than the speed may rise with.
#[test]
fn a_curve_that_turns_back_keeps_the_limit_of_acceleration_rather_than_that_of_jerk() {
    let to_the_end = |profile, slower| What::Move {
        profile,
        target: 0.0,
        slower,
        later: 0,
    };
    let steps = [
        (to_the_end(Profile::SCurve, 2.267_721_338_567_777), 104),
        (to_the_end(Profile::Trapezoid, 1.0), 340),
        (to_the_end(Profile::Beta, 1.0), 68),
        (to_the_end(Profile::SCurve, 1.0), 0),
    ];
    let limits = Limits::new(&LimitValues {
        velocity: 154.647,
        acceleration: 110.513,
        deceleration: 337.584,
        jerk: 1_067.536,
        position_minimum: -17.224_8,
        position_maximum: 17.224_8,
    })
    .expect("in range");
    let steps = steps.map(|(what, ticks)| Step { what, ticks });
    play(limits, steps.to_vec(), true).expect("every limit is kept");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    /// Beta moves, s-curves, stops and limits: the jerk is limited throughout.
    #[test]
    fn smooth_moves_keep_every_limit(
        limits in limits_strategy(),
        steps in prop::collection::vec(step(SMOOTH), 1..12),
    ) {
        play(limits, steps, false)?;
    }

    #[test]
    fn all_moves_keep_every_limit(
        limits in limits_strategy(),
        steps in prop::collection::vec(step(ALL), 1..12),
    ) {
        play(limits, steps, false)?;
    }

    /// In a narrow travel that is used to its ends: it comes before the jerk.
    #[test]
    fn no_move_leaves_the_travel(
        limits in limits_strategy(),
        travel in 0.01..20.0f64,
        steps in prop::collection::vec(step(ALL), 1..12),
    ) {
        let narrow = Limits::new(&LimitValues {
            velocity: limits.velocity().radians(),
            acceleration: limits.acceleration().radians(),
            deceleration: limits.deceleration().radians(),
            jerk: limits.jerk().radians(),
            position_minimum: -travel,
            position_maximum: travel,
        })
        .expect("in range");
        play(narrow, steps, true)?;
    }
}
