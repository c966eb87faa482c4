//! Random paths hold what they promise, seen from outside by differences.

use canter::path::*;
use canter_shared::motion::trajectory::Sample;
use canter_shared::wire::id::AxisId;
use proptest::prelude::*;

fn waypoints(places: &[Vec<f64>]) -> Result<Waypoints, PathError> {
    let axes = (1..=places[0].len() as u8)
        .filter_map(AxisId::new)
        .collect();
    let points = places.iter().map(|at| Waypoint {
        at: at.clone(),
        ..Waypoint::default()
    });
    Waypoints::new(axes, points.collect())
}

fn request(axes: usize, timing: Timing) -> Request {
    let bounds = (0..axes).map(|axis| AxisBounds {
        velocity: 2.0 + axis as f64,
        acceleration: 10.0 + 5.0 * axis as f64,
        jerk: 300.0,
        minimum: -100.0,
        maximum: 100.0,
    });
    Request {
        axes: bounds.collect(),
        path: PathBounds::default(),
        start_speed: 0.0,
        end_speed: 0.0,
        timing,
    }
}

/// Checks each axis by differences of its positions, which are means of its rates.
#[track_caller]
fn keeps(path: &TimedPath, bounds: &[AxisBounds]) {
    let step = 1e-3;
    let all: Vec<(f64, Vec<Sample>)> = path.rows(step).expect("few").collect();
    let whole = &all[..all.len() - 1];
    for (axis, bounds) in bounds.iter().enumerate() {
        let at = |index: usize| whole[index].1[axis].position;
        for index in 2..whole.len() {
            let velocity = (at(index) - at(index - 1)) / step;
            let before = (at(index - 1) - at(index - 2)) / step;
            let acceleration = (velocity - before) / step;
            assert!(
                velocity.abs() <= bounds.velocity * (1.0 + 1e-6),
                "{velocity}"
            );
            assert!(
                acceleration.abs() <= bounds.acceleration * (1.0 + 1e-6),
                "{acceleration}"
            );
        }
        for (time, samples) in &all {
            let sample = samples[axis];
            assert!(
                sample.velocity.abs() <= bounds.velocity * (1.0 + 1e-9),
                "{time}: {sample:?}"
            );
            assert!(
                sample.acceleration.abs() <= bounds.acceleration * (1.0 + 1e-9),
                "{time}: {sample:?}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn random_paths_keep_the_limits_of_every_axis(
        places in (1_usize..=4).prop_flat_map(|axes| {
            prop::collection::vec(prop::collection::vec(-3.0..3.0, axes), 2..7)
        }),
        smooth in any::<bool>(),
    ) {
        let timing = if smooth { Timing::SCurve } else { Timing::TwoPass };
        let waypoints = waypoints(&places).expect("apart");
        let request = request(places[0].len(), timing);
        let path = plan(&waypoints, &request).expect("a path");
        keeps(&path, &request.axes);
        for (share, bounds) in path.shares(&request.axes).iter().zip(&request.axes) {
            if let Some([jerk, part]) = share.jerk {
                prop_assert!(part <= 1.0 + 1e-9, "{jerk} of {}", bounds.jerk);
            }
        }
        let ends = [(0.0, places.first()), (path.duration(), places.last())];
        for (time, place) in ends {
            for (sample, wanted) in path.at(time).iter().zip(place.expect("some")) {
                prop_assert!((sample.position - wanted).abs() < 1e-9);
                prop_assert!(sample.velocity.abs() < 1e-6);
            }
        }
    }
}
