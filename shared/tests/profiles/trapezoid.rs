//! The quickest trapezoid between two velocities.

use super::check::{continuous, derivatives, ends, limits, rates, signed, times};
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::error::ProfileError;
use canter_shared::motion::segments::Segments;
use canter_shared::motion::trajectory::{Sample, Trajectory};
use canter_shared::motion::trapezoid::exact::{plan, time_optimal};
use proptest::prelude::*;

/// Start, stop and limits; the velocities are fractions of the limit, zero and the limit among them.
pub fn moves() -> impl Strategy<Value = (Sample, Sample, Bounds)> {
    let part = || prop_oneof![2 => -1.0..=1.0f64, 1 => Just(0.0), 1 => Just(1.0), 1 => Just(-1.0)];
    let range = prop_oneof![9 => signed(-9.0..6.0), 1 => Just(0.0)];
    (signed(-3.0..3.0), range, part(), part(), rates()).prop_map(|(from, range, v0, v1, bounds)| {
        let limit = bounds.velocity();
        (
            Sample::coasting(from, v0 * limit),
            Sample::coasting(from + range, v1 * limit),
            bounds,
        )
    })
}

/// Positions that a move passes are of this size.
pub fn scale(from: &Sample, to: &Sample, bounds: &Bounds) -> f64 {
    let fastest = from
        .velocity
        .abs()
        .max(to.velocity.abs())
        .max(bounds.velocity());
    let slower = bounds.slower_acceleration();
    let ramp = fastest.powi(2).min(
        from.velocity.powi(2)
            + to.velocity.powi(2)
            + (to.position - from.position).abs() * bounds.acceleration().max(slower),
    );
    from.position.abs() + to.position.abs() + ramp / slower
}

pub fn check(
    planned: &Segments,
    from: Sample,
    to: Sample,
    bounds: &Bounds,
) -> Result<(), TestCaseError> {
    ends(planned, from, to)?;
    let either = bounds.acceleration().max(bounds.deceleration());
    limits(planned, bounds.velocity(), either, f64::INFINITY)?;
    let scale = scale(&from, &to, bounds);
    derivatives(planned, scale, 0.0)?;
    continuous(planned, scale)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    #[test]
    fn quickest_moves((from, to, bounds) in moves()) {
        let planned = match plan(from, to, &bounds) {
            Ok(planned) => planned,
            Err(error) => {
                check_refusal(from, to, &bounds, error)?;
                return Ok(());
            }
        };
        check(&planned, from, to, &bounds)?;
        // The ramps' limits go by the direction of travel.
        let forward = (to.position - from.position).signum();
        for segment in planned.segments() {
            let along = forward * segment.entry.acceleration;
            if to.position != from.position {
                prop_assert!(along <= bounds.acceleration() && -along <= bounds.deceleration());
            }
        }
        // It turns around at most where a velocity is against the direction.
        prop_assert!(planned.segments().len() <= 3);
    }

    /// With limits that are the same both ways nothing is quicker.
    #[test]
    fn plan_is_time_optimal((from, to, bounds) in moves()) {
        let slower = bounds.slower_acceleration();
        let bounds =
            Bounds::new(bounds.velocity(), slower, slower, f64::INFINITY).expect("valid");
        let optimal = time_optimal(from, to, &bounds, &bounds).expect("inside the limits");
        check(&optimal, from, to, &bounds)?;
        // A range that is the rounding of the positions may be taken as none.
        let size = from.position.abs() + to.position.abs();
        let none = (to.position - from.position).abs() <= 1e-14 * size;
        if let (false, Ok(planned)) = (none, plan(from, to, &bounds)) {
            let (planned, optimal) = (planned.duration(), optimal.duration());
            prop_assert!((planned - optimal).abs() <= 1e-9 * optimal, "{planned} {optimal}");
        }
    }

    /// A target that the straight ramp reaches but for rounding is not taken the long way round,
    /// whatever the direction.
    #[test]
    fn straight_ramps(from in signed(-2.0..2.0), v0 in 0.01..1.0f64, v1 in 0.01..1.0f64, bounds in rates()) {
        let limit = bounds.velocity();
        for sign in [1.0, -1.0] {
            let (v0, v1) = (sign * v0 * limit, sign * v1 * limit);
            let forward = sign > 0.0;
            let rate = if (v1 > v0) == forward { bounds.acceleration() } else { bounds.deceleration() };
            let way = (v1 * v1 - v0 * v0) / (2.0 * rate) * if v1 > v0 { 1.0 } else { -1.0 };
            let (start, stop) = (Sample::coasting(from, v0), Sample::coasting(from + way, v1));
            let turned = Bounds::new(
                limit,
                bounds.deceleration(),
                bounds.acceleration(),
                f64::INFINITY,
            )
            .expect("valid");
            let (up, down) = if forward { (&bounds, &turned) } else { (&turned, &bounds) };
            let optimal = time_optimal(start, stop, up, down).expect("inside the limits");
            let want = (v1 - v0).abs() / rate;
            // Rounding of the positions is gone through at the velocities' own pace.
            let rounding = 4.0 * f64::EPSILON * (from.abs() + way.abs()) / (0.01 * limit);
            let error = (optimal.duration() - want).abs();
            prop_assert!(error <= 1e-9 * want + 4.0 * rounding, "{} {want}", optimal.duration());
        }
    }

    /// Run backwards, acceleration is deceleration.
    #[test]
    fn reversed((from, to, bounds) in moves()) {
        let swapped = Bounds::new(
            bounds.velocity(),
            bounds.deceleration(),
            bounds.acceleration(),
            f64::INFINITY,
        )
        .expect("valid");
        let back = |sample: Sample| Sample::coasting(sample.position, -sample.velocity);
        if from.position == to.position {
            return Ok(());
        }
        let reversed = plan(back(to), back(from), &swapped);
        match (plan(from, to, &bounds), reversed) {
            (Ok(planned), Ok(reversed)) => {
                let duration = planned.duration();
                prop_assert!((reversed.duration() - duration).abs() <= 1e-12 * duration);
                let rounding = 1e-13 * scale(&from, &to, &bounds);
                for time in times(&planned) {
                    let one = planned.at(time).position;
                    let other = reversed.at(reversed.duration() - time).position;
                    prop_assert!((one - other).abs() <= rounding, "{one} {other} at {time}");
                }
            }
            (Err(_), Err(_)) => {}
            other => prop_assert!(false, "{other:?}"),
        }
    }

    /// Mirrored, and scaled by powers of two in range and time, every bit is the same.
    #[test]
    fn mirrored_and_scaled(
        (from, to, bounds) in moves(),
        range_power in -8i32..8,
        time_power in -8i32..8,
    ) {
        let (range, slower) = (2f64.powi(range_power), 2f64.powi(time_power));
        let (velocity, rate) = (range / slower, range / slower.powi(2));
        let other = |sample: Sample| {
            Sample::coasting(-range * sample.position, -velocity * sample.velocity)
        };
        let wider = Bounds::new(
            velocity * bounds.velocity(),
            rate * bounds.acceleration(),
            rate * bounds.deceleration(),
            f64::INFINITY,
        )
        .expect("valid");
        match (plan(from, to, &bounds), plan(other(from), other(to), &wider)) {
            (Ok(one), Ok(two)) => {
                prop_assert_eq!(one.duration() * slower, two.duration());
                for time in times(&one) {
                    let (one, two) = (one.at(time), two.at(time * slower));
                    prop_assert_eq!(-range * one.position, two.position);
                    prop_assert_eq!(-velocity * one.velocity, two.velocity);
                }
            }
            (Err(one), Err(two)) => {
                prop_assert_eq!(core::mem::discriminant(&one), core::mem::discriminant(&two));
            }
            other => prop_assert!(false, "{other:?}"),
        }
    }
}

/// What an error says can be reached can be, and a little more cannot.
fn check_refusal(
    from: Sample,
    to: Sample,
    bounds: &Bounds,
    error: ProfileError,
) -> Result<(), TestCaseError> {
    let (accepted, more) = match error {
        ProfileError::StartTooFast { velocity, fastest } => {
            prop_assert_eq!(velocity, from.velocity);
            prop_assert!(fastest.abs() < velocity.abs() && fastest * velocity >= 0.0);
            let with = |velocity| plan(Sample::coasting(from.position, velocity), to, bounds);
            (with(fastest), with(fastest * 1.001))
        }
        ProfileError::StopOutOfReach {
            velocity,
            reachable,
        } => {
            prop_assert_eq!(velocity, to.velocity);
            prop_assert!(reachable.abs() < velocity.abs() && reachable * velocity >= 0.0);
            let with = |velocity| plan(from, Sample::coasting(to.position, velocity), bounds);
            (with(reachable), with(reachable * 1.001))
        }
        other => return Err(TestCaseError::fail(format!("{other}"))),
    };
    prop_assert!(accepted.is_ok(), "{accepted:?} after {error:?}");
    // A range that is hardly more than the rounding of the positions leaves room for more.
    let size = from.position.abs() + to.position.abs();
    if (to.position - from.position).abs() > 1e-12 * size {
        prop_assert!(more.is_err(), "{more:?} after {error:?}");
    }
    Ok(())
}

#[test]
fn edges() {
    let bounds = Bounds::new(2.0, 4.0, 4.0, f64::INFINITY).expect("valid");
    let rest = Sample::at_rest;
    // Nothing to do.
    let nothing = plan(rest(3.0), rest(3.0), &bounds).expect("valid");
    assert_eq!((nothing.duration(), nothing.segments().len()), (0.0, 0));
    assert_eq!(nothing.at(0.0), rest(3.0));
    let coasting = Sample::coasting(3.0, -1.5);
    assert_eq!(
        plan(coasting, coasting, &bounds).expect("valid").duration(),
        0.0
    );
    // Just no cruise: v^2 = a R.
    let boundary = plan(rest(0.0), rest(1.0), &bounds).expect("valid");
    assert_eq!((boundary.duration(), boundary.peaks().velocity), (1.0, 2.0));
    // Start and stop at the limit.
    let through = plan(
        Sample::coasting(0.0, 2.0),
        Sample::coasting(10.0, 2.0),
        &bounds,
    );
    let through = through.expect("valid");
    assert_eq!((through.duration(), through.segments().len()), (5.0, 1));
    assert_eq!(through.peaks().jerk, 0.0);
    // Just enough to stop.
    let stop = plan(Sample::coasting(0.0, 2.0), rest(0.5), &bounds).expect("valid");
    assert_eq!((stop.duration(), stop.segments().len()), (0.5, 1));
    // Out of reach.
    let error = plan(rest(0.0), Sample::coasting(0.125, 1.5), &bounds).expect_err("too short");
    let want = ProfileError::StopOutOfReach {
        velocity: 1.5,
        reachable: 1.0,
    };
    assert_eq!(error, want);
    let error = plan(Sample::coasting(0.0, -1.5), rest(-0.125), &bounds).expect_err("too short");
    let want = ProfileError::StartTooFast {
        velocity: -1.5,
        fastest: -1.0,
    };
    assert_eq!(error, want);
    // Tiny and huge.
    for range in [1e-12, -1e-12, 1e12, -1e12] {
        let planned = plan(rest(0.0), rest(range), &bounds).expect("valid");
        let want = if range.abs() < 1.0 {
            2.0 * (range.abs() / 4.0).sqrt()
        } else {
            range.abs() / 2.0 + 0.5
        };
        assert!((planned.duration() - want).abs() <= 1e-15 * want);
        assert_eq!(planned.at(planned.duration()).position, range);
    }
}
