//! Whatever numbers a request has, there is an answer or an error.

use canter::profile::picture::{OWN_UNITS, Picture, samples};
use canter::profile::table::steps;
use canter::profile::vibration::Resonance;
use canter::profile::{AskedLimits, Kind, Request, plan};
use canter_shared::motion::trajectory::Trajectory;
use proptest::prelude::*;
use proptest::sample::select;

/// Often numbers that a person would write, sometimes any bits that an f64 can have.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => any::<u64>().prop_map(f64::from_bits),
        8 => -10.0..10.0,
        3 => select(vec![0.0, 1.0, -1.0, 1e-12, 1e12, -1e15, 1e-15, 0.1]),
        3 => (-15.0f64..15.0).prop_map(|exponent| 10f64.powf(exponent)),
    ]
}

/// A number without its sign, but for those that have only that.
fn limit() -> impl Strategy<Value = Option<f64>> {
    prop_oneof![
        1 => Just(None),
        8 => number().prop_map(|value| Some(value.abs())),
        1 => number().prop_map(Some),
    ]
}

fn often_zero() -> impl Strategy<Value = f64> {
    prop_oneof![8 => Just(0.0), 1 => number()]
}

fn request() -> impl Strategy<Value = Request> {
    let ends = (number(), number());
    let rates = [often_zero(), often_zero(), often_zero(), often_zero()];
    let limits = [limit(), limit(), limit(), limit()];
    let duration = prop_oneof![2 => Just(None), 1 => limit()];
    let rest = (duration, prop_oneof![8 => Just(None), 1 => limit()]);
    (select(Kind::ALL.to_vec()), ends, rates, limits, rest).prop_map(
        |(kind, (from, to), [v0, v1, a0, a1], [v, a, d, j], (duration, exponent))| Request {
            start_velocity: v0,
            stop_velocity: v1,
            start_acceleration: a0,
            stop_acceleration: a1,
            limits: AskedLimits {
                velocity: v,
                acceleration: a,
                deceleration: d,
                jerk: j,
            },
            duration,
            exponent,
            ..Request::rest_to_rest(kind, from, to)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    #[test]
    fn a_curve_or_an_error(request in request(), time in number(), frequency in number()) {
        let Ok(planned) = plan(&request) else {
            return Ok(());
        };
        let curve = planned.curve;
        let duration = curve.duration();
        prop_assert!(duration >= 0.0 && duration.is_finite(), "{duration} s");
        prop_assert_eq!(curve.at(duration).position, request.to);
        prop_assert_eq!(curve.at(duration).velocity, request.stop_velocity);
        let peaks = curve.peaks();
        prop_assert!(!peaks.velocity.is_nan() && !peaks.acceleration.is_nan());
        prop_assert!(!peaks.jerk.is_nan());
        let _anything = curve.at(time);
        if let Ok(rows) = steps(&curve, time, Some(duration / 7.0).filter(|step| *step > 0.0)) {
            prop_assert!(rows.count() <= 9);
        }
        let resonance = Resonance { frequency, damping: 0.1 };
        // What takes its time is tested elsewhere.
        if frequency.abs() * duration < 100.0 {
            let _anything = resonance.residual(&curve);
        }
        let mut picture = Picture::new("any", OWN_UNITS);
        picture.add("any", &samples(&curve, 0.0));
        picture.limit(&request.limits, request.to >= request.from);
        let _anything = picture.svg();
    }
}
