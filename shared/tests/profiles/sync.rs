//! Axes that move together.

use super::check::{ends, limits, positive, signed, times};
use canter_shared::motion::beta::exact::Profile;
use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::error::ProfileError;
use canter_shared::motion::sync::{self, Axis, Scaled, shared_bounds};
use canter_shared::motion::trajectory::{Sample, Trajectory};
use canter_shared::motion::{s_curve, trapezoid};
use proptest::prelude::*;

fn axes() -> impl Strategy<Value = Vec<Axis>> {
    let range = prop_oneof![9 => signed(-3.0..3.0), 1 => Just(0.0)];
    let rates = (
        positive(-1.0..2.0),
        positive(-1.0..3.0),
        positive(-1.0..3.0),
        positive(0.0..5.0),
    );
    let axis = (signed(-2.0..2.0), range, rates).prop_map(|(from, range, rates)| Axis {
        from,
        to: from + range,
        bounds: Bounds::new(rates.0, rates.1, rates.2, rates.3).expect("valid"),
    });
    prop::collection::vec(axis, 1..7)
}

/// All last as long as `longest`, and each keeps its own limits.
fn together<T: Trajectory>(
    axes: &[Axis],
    planned: &[T],
    longest: f64,
    jerks: bool,
) -> Result<(), TestCaseError> {
    prop_assert_eq!(axes.len(), planned.len());
    for (axis, planned) in axes.iter().zip(planned) {
        let duration = planned.duration();
        prop_assert!(
            (duration - longest).abs() <= 1e-9 * longest,
            "{duration} {longest}"
        );
        ends(
            planned,
            Sample::at_rest(axis.from),
            Sample::at_rest(axis.to),
        )?;
        let bounds = &axis.bounds;
        let either = bounds.acceleration().max(bounds.deceleration());
        let jerk = if jerks { bounds.jerk() } else { f64::INFINITY };
        limits(planned, bounds.velocity(), either, jerk)?;
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn each_with_its_own_shape(axes in axes()) {
        let quickest = |axis: &Axis| {
            (Sample::at_rest(axis.from), Sample::at_rest(axis.to), axis.bounds)
        };
        let longest = |duration: &dyn Fn(&Axis) -> f64| sync::common_duration(axes.iter().map(duration));
        let beta = longest(&|axis| {
            Profile::within(axis.from, axis.to, &axis.bounds).expect("valid").duration()
        });
        together(&axes, &sync::beta::<6>(&axes).expect("valid"), beta, true)?;
        let trapezoid = longest(&|axis| {
            let (from, to, bounds) = quickest(axis);
            trapezoid::exact::plan(from, to, &bounds).expect("valid").duration()
        });
        together(&axes, &sync::trapezoid::<6>(&axes).expect("valid"), trapezoid, false)?;
        let s_curve = longest(&|axis| {
            let (from, to, bounds) = quickest(axis);
            s_curve::plan(from, to, &bounds).expect("valid").duration()
        });
        together(&axes, &sync::s_curve::<6>(&axes).expect("valid"), s_curve, true)?;
    }

    /// On a straight line: at any time all have the same part of their way behind them.
    #[test]
    fn on_a_straight_line(axes in axes()) {
        let shared = shared_bounds(&axes).expect("valid");
        let unit = s_curve::plan(Sample::at_rest(0.0), Sample::at_rest(1.0), &shared).expect("valid");
        let mut used: f64 = 0.0;
        for axis in &axes {
            let scaled = Scaled { from: axis.from, to: axis.to, unit: unit.clone() };
            ends(&scaled, Sample::at_rest(axis.from), Sample::at_rest(axis.to))?;
            let bounds = &axis.bounds;
            let either = bounds.acceleration().max(bounds.deceleration());
            limits(&scaled, bounds.velocity(), either, bounds.jerk())?;
            for time in times(&unit) {
                let at = scaled.at(time);
                let along = (axis.to - axis.from).signum() * at.acceleration;
                prop_assert!(along <= bounds.acceleration() * (1.0 + 1e-9));
                prop_assert!(-along <= bounds.deceleration() * (1.0 + 1e-9));
                let want = axis.from + (axis.to - axis.from) * unit.at(time).position;
                let rounding = 1e-15 * (axis.from.abs() + axis.to.abs());
                prop_assert!((at.position - want).abs() <= 2.0 * rounding);
            }
            let peaks = scaled.peaks();
            used = used
                .max(peaks.velocity / bounds.velocity())
                .max(peaks.acceleration / bounds.slower_acceleration())
                .max(peaks.jerk / bounds.jerk());
        }
        // One limit of one axis is reached.
        prop_assert!(used >= 1.0 - 1e-9 || axes.iter().all(|axis| axis.from == axis.to), "{used}");
    }
}

#[test]
fn edges() {
    assert_eq!(sync::common_duration([]), 0.0);
    assert_eq!(sync::common_duration([0.25, 2.0, 1.0]), 2.0);
    let bounds = Bounds::new(1.0, 2.0, 4.0, 8.0).expect("valid");
    let axis = |to| Axis {
        from: 0.0,
        to,
        bounds,
    };
    // The longest range has the least limits of the unit move.
    let shared = shared_bounds(&[axis(1.0), axis(-4.0), axis(0.0)]).expect("valid");
    assert_eq!(shared, Bounds::new(0.25, 0.5, 1.0, 2.0).expect("valid"));
    // The end is exact where start and range do not add up to it.
    let (from, to) = (0.1, -3.0 / 7.0);
    assert_ne!(from + (to - from), to);
    let unit = Profile::within(0.0, 1.0, &bounds).expect("valid");
    let scaled = Scaled { from, to, unit };
    assert_eq!(scaled.at(scaled.duration()), Sample::at_rest(to));
    let error = sync::beta::<1>(&[axis(1.0), axis(2.0)]).expect_err("no room");
    let want = ProfileError::Value {
        field: "number of axes",
        value: 2.0,
        minimum: 0.0,
        maximum: 1.0,
    };
    assert_eq!(error, want);
    assert!(sync::trapezoid::<4>(&[axis(f64::NAN)]).is_err());
}
