//! Whatever the bits of the numbers: an error or an answer, never a panic, and soon.

use canter_shared::motion::beta::{exact, general};
use canter_shared::motion::bezier::Bezier;
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::polynomial::{Cubic, Quintic, Septic};
use canter_shared::motion::sync::{self, Axis, Scaled, shared_bounds};
use canter_shared::motion::trajectory::{Sample, Starting, Trajectory};
use canter_shared::motion::trapezoid::exact as trapezoid;
use proptest::prelude::*;

/// Any bits, or a number that more of the code sees because it is accepted.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        2 => any::<u64>().prop_map(f64::from_bits),
        2 => prop::sample::select(vec![
            0.0, -0.0, 1.0, -1.0, 0.5, 2.5, 1e-15, 1e15, -1e15, 1e-12, 1e12, 5e-324, f64::MAX,
            f64::MIN_POSITIVE, f64::EPSILON, f64::INFINITY, f64::NEG_INFINITY, f64::NAN,
        ]),
        4 => (-15.0..15.0f64, any::<bool>()).prop_map(|(power, negative)| {
            if negative { -(10f64.powf(power)) } else { 10f64.powf(power) }
        }),
        3 => -10.0..10.0f64,
    ]
}

fn sample() -> impl Strategy<Value = Sample> {
    [number(), number(), number(), number()].prop_map(|[position, velocity, acceleration, jerk]| {
        Sample {
            position,
            velocity,
            acceleration,
            jerk,
        }
    })
}

/// Limits that were accepted, of all magnitudes.
fn bounds() -> impl Strategy<Value = Bounds> {
    let limit = || {
        prop_oneof![
            4 => (-15.0..15.0f64).prop_map(|power| 10f64.powf(power).clamp(1e-15, 1e15)),
            2 => 0.1..10.0f64,
            1 => Just(1e15),
            1 => Just(1e-15),
        ]
    };
    let jerk = prop_oneof![limit(), Just(f64::INFINITY)];
    (limit(), limit(), limit(), jerk).prop_map(|(velocity, acceleration, deceleration, jerk)| {
        Bounds::new(velocity, acceleration, deceleration, jerk).expect("in range")
    })
}

/// Where a profile could be made it answers at any time; where the time is a number, with numbers.
fn ask<T: Trajectory, E>(made: Result<T, E>, times: &[f64]) -> Result<(), TestCaseError> {
    let Ok(made) = made else {
        return Ok(());
    };
    prop_assert!(made.duration() >= 0.0 && made.duration().is_finite());
    let peaks = made.peaks();
    prop_assert!(peaks.velocity >= 0.0 && peaks.acceleration >= 0.0 && peaks.jerk >= 0.0);
    for &time in times {
        let at = made.at(time);
        if time.abs() <= 1e100 {
            prop_assert!(
                at.position.is_finite() && at.velocity.is_finite(),
                "{at:?} at {time}"
            );
        }
    }
    prop_assert!(made.at(f64::NAN).position.is_nan());
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    #[test]
    fn limits(numbers in [number(), number(), number(), number()]) {
        let [velocity, acceleration, deceleration, jerk] = numbers;
        if let Ok(bounds) = Bounds::new(velocity, acceleration, deceleration, jerk) {
            prop_assert!(bounds.velocity() > 0.0 && bounds.jerk() > 0.0);
        }
    }

    #[test]
    fn beta_moves(
        numbers in [number(), number(), number(), number()],
        bounds in bounds(),
        times in [number(), number()],
    ) {
        let [from, to, duration, p] = numbers;
        let _ = exact::shape(p);
        ask(exact::Profile::within(from, to, &bounds), &times)?;
        ask(exact::Profile::lasting(from, to, duration), &times)?;
        ask(general::Profile::within(p, from, to, &bounds), &times)?;
        ask(general::Profile::lasting(p, from, to, duration), &times)?;
        // A p that is accepted is seen often, too.
        ask(general::Profile::lasting(2.0 + p.abs() % 3.0, from, to, duration), &times)?;
    }

    #[test]
    fn trapezoids(
        from in sample(),
        to in sample(),
        duration in number(),
        bounds in bounds(),
        other in bounds(),
        times in [number(), number()],
    ) {
        ask(trapezoid::plan(from, to, &bounds), &times)?;
        ask(trapezoid::lasting(from, to, duration, &bounds), &times)?;
        ask(trapezoid::to_rest(from, to.position, &bounds), &times)?;
        ask(trapezoid::to_rest_lasting(from, to.position, duration, &bounds), &times)?;
        ask(trapezoid::time_optimal(from, to, &bounds, &other), &times)?;
        if let Ok(trajectory) = trapezoid::to_rest(from, to.position, &bounds) {
            let starting = Starting { start: duration, trajectory };
            let _ = starting.at(times[0]);
        }
    }

    #[test]
    fn synchronised(
        ways in [(number(), number(), bounds()), (number(), number(), bounds())],
        time in number(),
    ) {
        let axes = ways.map(|(from, to, bounds)| Axis { from, to, bounds });
        for planned in sync::beta::<2>(&axes).into_iter().flatten() {
            let _ = planned.at(time);
        }
        for planned in sync::trapezoid::<2>(&axes).into_iter().flatten() {
            let _ = planned.at(time);
        }
        for planned in sync::s_curve::<2>(&axes).into_iter().flatten() {
            let _ = planned.at(time);
        }
        if let Ok(shared) = shared_bounds(&axes)
            && let Ok(unit) = exact::Profile::within(0.0, 1.0, &shared)
        {
            let _ = Scaled { from: axes[0].from, to: axes[0].to, unit }.at(time);
        }
        let _ = sync::common_duration([axes[0].from, axes[1].to, time]);
    }
}

proptest! {
    // Each case may search over many decades of durations, or for the roots of many derivatives.
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn bezier_curves(
        points in prop::collection::vec(number(), 0..20),
        tame in prop::collection::vec(-1e15..1e15f64, 0..20),
        duration in number(),
        times in [number(), number()],
    ) {
        ask(Bezier::new(&points, duration), &times)?;
        ask(Bezier::new(&tame, duration.abs().clamp(1e-15, 1e15)), &times)?;
    }

    #[test]
    fn polynomials(
        from in sample(),
        to in sample(),
        duration in number(),
        bounds in bounds(),
        times in [number(), number()],
    ) {
        ask(Cubic::new(from, to, duration), &times)?;
        ask(Quintic::new(from, to, duration), &times)?;
        ask(Septic::new(from, to, duration), &times)?;
        ask(Cubic::within(from, to, &bounds), &times)?;
        ask(Quintic::within(from, to, &bounds), &times)?;
        ask(Septic::within(from, to, &bounds), &times)?;
        let rest = |sample: Sample| Sample::at_rest(sample.position);
        ask(Septic::within(rest(from), rest(to), &bounds), &times)?;
    }
}
