//! Trapezoids that are stretched to a duration.

use super::check::{continuous, ends, senses};
use super::to_rest::retargets;
use super::trapezoid::{check, moves, scale};
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::error::ProfileError;
use canter_shared::motion::trajectory::{Sample, Trajectory};
use canter_shared::motion::trapezoid::exact::{lasting, plan, to_rest, to_rest_lasting};
use proptest::prelude::*;

fn slower() -> impl Strategy<Value = f64> {
    prop_oneof![Just(1.0), 1.0..1.001f64, 1.0..10.0f64, 1.0..1e6f64]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    #[test]
    fn between_velocities((from, to, bounds) in moves(), slower in slower()) {
        let Ok(quickest) = plan(from, to, &bounds) else {
            return Ok(());
        };
        let shortest = quickest.duration();
        let duration = shortest * slower;
        let stretched = match lasting(from, to, duration, &bounds) {
            Ok(stretched) => stretched,
            Err(ProfileError::Value { field: "duration", maximum, .. }) => {
                // Both velocities leave no time to stop in between.
                prop_assert!(from.velocity * to.velocity > 0.0 && maximum < duration);
                let longest = lasting(from, to, maximum, &bounds).expect("said to be possible");
                check(&longest, from, to, &bounds)?;
                return Ok(());
            }
            Err(other) => return Err(TestCaseError::fail(format!("{other}"))),
        };
        // A dip by less than the rounding of a velocity takes that much of its time.
        let dip = f64::EPSILON * bounds.velocity() / bounds.slower_acceleration();
        prop_assert!((stretched.duration() - duration).abs() <= 1e-12 * duration + 4.0 * dip);
        check(&stretched, from, to, &bounds)?;
        // Never against the direction unless a velocity is.
        let forward = (to.position - from.position).signum();
        if forward * from.velocity >= 0.0 && forward * to.velocity >= 0.0 {
            senses(&stretched, &bounds)?;
            for segment in stretched.segments() {
                let rounding = 1e-12 * stretched.peaks().velocity;
                prop_assert!(forward * segment.entry.velocity >= -rounding, "{segment:?}");
            }
        }
        let error = lasting(from, to, shortest * 0.999, &bounds);
        if shortest > 0.0 {
            prop_assert!(
                matches!(error, Err(ProfileError::TooShort { shortest: told, .. }) if told == shortest),
                "{error:?}"
            );
        }
    }

    #[test]
    fn to_rest_from_any_velocity((from, target, bounds) in retargets(), slower in slower()) {
        let shortest = to_rest(from, target, &bounds).expect("valid").duration();
        let duration = shortest * slower;
        let stretched = to_rest_lasting(from, target, duration, &bounds).expect("long enough");
        prop_assert!((stretched.duration() - duration).abs() <= 1e-12 * duration);
        let to = Sample::at_rest(target);
        ends(&stretched, from, to)?;
        continuous(&stretched, scale(&from, &to, &bounds))?;
        senses(&stretched, &bounds)?;
        let peak = from.velocity.abs().max(bounds.velocity());
        prop_assert!(stretched.peaks().velocity <= peak * (1.0 + 1e-9));
        if shortest > 0.0 {
            let error = to_rest_lasting(from, target, shortest * 0.999, &bounds);
            let too_short = matches!(error, Err(ProfileError::TooShort { .. }));
            prop_assert!(too_short, "{error:?}");
        }
    }
}

#[test]
fn edges() {
    let bounds = Bounds::new(2.0, 4.0, 4.0, f64::INFINITY).expect("valid");
    // Without a range an axis rests for as long as the others move.
    let resting = lasting(Sample::at_rest(1.0), Sample::at_rest(1.0), 3.0, &bounds).expect("valid");
    assert_eq!(
        (resting.duration(), resting.at(1.5)),
        (3.0, Sample::at_rest(1.0))
    );
    // R = v T - v^2 / a: 1 = 2 v - v^2 / 4, v = 4 - sqrt(12).
    let slow = lasting(Sample::at_rest(0.0), Sample::at_rest(1.0), 2.0, &bounds).expect("valid");
    let cruise = slow.peaks().velocity;
    assert!((cruise - (4.0 - 12f64.sqrt())).abs() < 1e-15, "{cruise}");
    // A waypoint that is passed at a velocity cannot be waited for in front of it ...
    let (from, to) = (Sample::coasting(0.0, 2.0), Sample::coasting(0.5, 2.0));
    let error = lasting(from, to, 10.0, &bounds).expect_err("no room to stop");
    assert!(
        matches!(
            error,
            ProfileError::Value {
                field: "duration",
                ..
            }
        ),
        "{error}"
    );
    // ... unless there is room: v^2 / (2 a) + v^2 / (2 d) = 1.
    let to = Sample::coasting(1.0, 2.0);
    let waits = lasting(from, to, 10.0, &bounds).expect("room to stop");
    assert_eq!(waits.at(5.0), Sample::at_rest(0.5));
}
