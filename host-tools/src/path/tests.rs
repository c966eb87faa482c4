//! Shapes, timings and refusals of known paths, and the published planner's segments.

use super::planar::{End, Planar, Search};
use super::*;
use crate::robot::Robot;
use canter_shared::motion::trajectory::{Sample, Trajectory};
use canter_shared::wire::id::AxisId;

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

#[test]
fn the_curve_goes_through_the_waypoints_with_continuous_derivatives() {
    let places = [
        vec![0.0, 0.0],
        vec![1.0, 0.5],
        vec![1.2, 2.0],
        vec![-1.0, 0.3],
    ];
    let mut points = waypoints(&places).expect("apart").points().to_vec();
    points[2].heading = Some(vec![-3.0, 4.0]);
    let axes = [1, 2].into_iter().filter_map(AxisId::new).collect();
    let waypoints = Waypoints::new(axes, points).expect("fine");
    let shape = shape::Shape::through(&waypoints).expect("a curve");
    for (index, place) in places.iter().enumerate().take(3).skip(1) {
        let knot = shape.knots()[index];
        let (before, after) = (shape.within(index - 1, knot), shape.within(index, knot));
        for axis in 0..2 {
            let (before, after) = (before[axis], after[axis]);
            assert!((after.position - place[axis]).abs() < 1e-12);
            assert!((before.position - after.position).abs() < 1e-12);
            assert!((before.first - after.first).abs() < 1e-10);
            assert!((before.second - after.second).abs() < 1e-9);
            // Without a heading the smoothest curve has a third derivative that goes on, too.
            let step = (before.third - after.third).abs();
            assert!(index == 2 || step < 1e-8, "{step}");
        }
    }
    let headed = shape.at(shape.knots()[2]);
    assert!((headed[0].first + 0.6).abs() < 1e-12 && (headed[1].first - 0.8).abs() < 1e-12);
}

/// A straight line is a trapezoid of the slowest axis: way / velocity + velocity / acceleration.
#[test]
fn a_straight_line_is_as_quick_as_a_trapezoid() {
    let waypoints = waypoints(&[vec![0.0, 0.0], vec![4.0, 1.0]]).expect("apart");
    let request = request(2, Timing::TwoPass);
    let path = plan(&waypoints, &request).expect("a path");
    let best = 4.0 / 2.0 + 2.0 / 10.0;
    assert!(
        (path.duration() - best).abs() < best * 1e-3,
        "{} {best}",
        path.duration()
    );
    let shares = path.shares(&request.axes);
    assert!(shares[0].velocity[1] > 0.999 && shares[0].acceleration[1] > 0.999);
}

#[test]
fn speeds_at_start_end_and_waypoints_and_path_limits_are_kept() {
    let places = [vec![0.0, 0.0], vec![1.0, 1.0], vec![2.0, 1.0]];
    let mut points = waypoints(&places).expect("apart").points().to_vec();
    points[1].speed = Some(0.3);
    let axes = [1, 2].into_iter().filter_map(AxisId::new).collect();
    let waypoints = Waypoints::new(axes, points).expect("fine");
    let mut request = request(2, Timing::TwoPass);
    (request.start_speed, request.end_speed) = (0.5, 0.25);
    request.path.velocity = Some(0.8);
    request.path.acceleration = Some(1.5);
    let path = plan(&waypoints, &request).expect("a path");
    let speed = |samples: &[Sample]| {
        let squares = samples
            .iter()
            .map(|sample| sample.velocity * sample.velocity);
        squares.sum::<f64>().sqrt()
    };
    assert!((speed(&path.at(0.0)) - 0.5).abs() < 1e-9);
    assert!((speed(&path.at(path.duration())) - 0.25).abs() < 1e-6);
    let speeds: Vec<f64> = path
        .rows(1e-3)
        .expect("few")
        .map(|(_, row)| speed(&row))
        .collect();
    assert!(speeds.iter().all(|speed| *speed <= 0.8 * (1.0 + 1e-9)));
    assert!(
        speeds[..speeds.len() - 1]
            .windows(2)
            .all(|pair| (pair[1] - pair[0]).abs() <= 1.5e-3 + 1e-9)
    );
    let near = |row: &[Sample]| (row[0].position - 1.0).abs() < 1e-3;
    let slow = path
        .rows(1e-3)
        .expect("few")
        .find(|(_, row)| near(row))
        .expect("passed");
    assert!(speed(&slow.1) < 0.31, "{}", speed(&slow.1));
    request.start_speed = 50.0;
    let error = plan(&waypoints, &request).expect_err("too fast");
    assert!(matches!(error, PathError::StartTooFast { .. }), "{error}");
    (request.start_speed, request.end_speed) = (0.0, 50.0);
    let error = plan(&waypoints, &request).expect_err("too fast");
    assert!(matches!(error, PathError::EndOutOfReach { .. }), "{error}");
}

#[test]
fn a_curve_outside_the_travel_is_refused() {
    let waypoints = waypoints(&[vec![0.0], vec![3.0]]).expect("apart");
    let mut request = request(1, Timing::TwoPass);
    request.axes[0].maximum = 2.0;
    let error = plan(&waypoints, &request).expect_err("outside");
    assert!(
        matches!(error, PathError::OutsideTravel { axis: 1, .. }),
        "{error}"
    );
}

#[test]
fn a_robots_limits_are_those_of_its_axes() {
    let axes: Vec<_> = [1, 2].into_iter().filter_map(AxisId::new).collect();
    let bounds = AxisBounds::of(&Robot::default(), &axes);
    assert!((bounds[1].velocity - 20.0).abs() < 1e-6 && (bounds[1].jerk - 20_000.0).abs() < 1e-3);
}

fn table(text: &str) -> Vec<Vec<f64>> {
    let rows = text.lines().skip(1);
    let numbers = rows.map(|row| row.split(',').map(|cell| cell.parse().expect("a number")));
    numbers.map(Iterator::collect).collect()
}

#[test]
fn the_published_planners_segments_are_found_and_its_fault_is_not() {
    let cases = table(include_str!("../../../tests/vectors/quintic2d_cases.csv"));
    let points = table(include_str!("../../../tests/vectors/quintic2d_points.csv"));
    for case in &cases {
        let end = |from: usize| End {
            x: case[from],
            y: case[from + 1],
            heading: case[from + 2].to_radians(),
            speed: case[from + 3],
            acceleration: case[from + 4],
        };
        let (from, to) = (end(1), end(6));
        let search = Search::published(case[11], case[12]);
        let found = Planar::search(&from, &to, &search);
        if case[16] == 0.0 {
            let error = found.expect_err("it breaks its limits");
            let PathError::NoDuration { needed, .. } = error else {
                panic!("{error}");
            };
            // 10 / sqrt(3) * way / T^2 = limit.
            let expected = (10.0 / 3.0_f64.sqrt() * 2000.0 / 0.1).sqrt();
            assert!((needed - expected).abs() < 1e-2, "{needed} {expected}");
            continue;
        }
        let found = found.expect("a duration");
        assert_eq!(found.x.duration(), case[14]);
        let (acceleration, jerk) = found.peaks();
        assert!(acceleration <= case[11] && jerk <= case[12]);
        for point in points.iter().filter(|point| point[0] == case[0]) {
            let (x, y) = (found.x.at(point[1]), found.y.at(point[1]));
            assert!((x.position - point[2]).abs() < 1e-9, "{point:?}");
            assert!((y.position - point[3]).abs() < 1e-9, "{point:?}");
            assert!(
                (x.velocity.hypot(y.velocity) - point[5]).abs() < 1e-9,
                "{point:?}"
            );
        }
        let shortest = Planar::shortest(&from, &to, &search).expect("a duration");
        assert!(shortest.x.duration() < case[14]);
        let (acceleration, jerk) = shortest.peaks();
        assert!(acceleration <= case[11] && jerk <= case[12]);
    }
}
