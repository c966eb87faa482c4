//! Bezier curves.

use super::check::{derivatives, limits, positive, times};
use canter_shared::motion::bezier::{Bezier, MOST_POINTS};
use canter_shared::motion::error::ProfileError;
use canter_shared::motion::trajectory::Trajectory;
use proptest::prelude::*;

fn curves() -> impl Strategy<Value = (Vec<f64>, f64)> {
    let points = prop::collection::vec(-10.0..10.0f64, 2..=MOST_POINTS);
    (points, positive(-3.0..3.0))
}

/// The sum of Bernstein polynomials, straight from their definition.
fn bernstein(points: &[f64], u: f64) -> f64 {
    let degree = points.len() as i32 - 1;
    let mut binomial = 1.0;
    let mut sum = 0.0;
    for (index, point) in (0..).zip(points) {
        sum += binomial * u.powi(index) * (1.0 - u).powi(degree - index) * point;
        binomial *= f64::from(degree - index) / f64::from(index + 1);
    }
    sum
}

/// The points of the curve's derivative by time.
fn hodograph(points: &[f64], duration: f64) -> Vec<f64> {
    let degree = points.len() as f64 - 1.0;
    let neighbours = points.iter().zip(points.iter().skip(1));
    neighbours
        .map(|(a, b)| degree * (b - a) / duration)
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn sum_hodograph_and_ends((points, duration) in curves()) {
        let curve = Bezier::new(&points, duration).expect("valid");
        prop_assert_eq!((curve.degree(), curve.points()), (points.len() - 1, &points[..]));
        // Three derivatives, each a curve of its own.
        let mut rates = vec![points.clone()];
        for _ in 0..3 {
            rates.push(hodograph(rates.last().expect("one"), duration));
        }
        for time in times(&curve) {
            let at = curve.at(time);
            let u = time / duration;
            let mut scale = 0.0f64;
            for (got, points) in
                [at.position, at.velocity, at.acceleration, at.jerk].into_iter().zip(&rates)
            {
                let want = bernstein(points, u);
                // A derivative has the digits that differences of the one before it leave.
                let before = curve.degree() as f64 * scale / duration;
                scale = points.iter().fold(before, |most, point| most.max(point.abs()));
                prop_assert!((got - want).abs() <= 1e-12 * scale.max(1e-300), "{got} {want}");
            }
            // Inside the points, as each is a mean of them.
            let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(low, high), point| {
                (low.min(*point), high.max(*point))
            });
            prop_assert!(at.position >= low - 1e-14 && at.position <= high + 1e-14);
        }
        let (start, end) = (curve.at(0.0), curve.at(duration));
        prop_assert_eq!(Some(&start.position), points.first());
        prop_assert_eq!(Some(&end.position), points.last());
        // Tangents at the ends.
        let first = rates[1][0];
        let last = *rates[1].last().expect("at least one");
        prop_assert!((start.velocity - first).abs() <= 1e-14 * first.abs());
        prop_assert!((end.velocity - last).abs() <= 1e-14 * last.abs());
        let beyond = curve.at(2.0 * duration);
        let want = end.position + end.velocity * duration;
        prop_assert!((beyond.position - want).abs() <= 1e-13 * (want.abs() + 1.0));
        prop_assert_eq!(beyond.acceleration, 0.0);
        limits(&curve, f64::MAX, f64::MAX, f64::INFINITY)?;
        derivatives(&curve, 100.0, 1_000.0)?;
    }

    /// Run backwards every bit is the same.
    #[test]
    fn backwards((points, duration) in curves()) {
        let one = Bezier::new(&points, duration).expect("valid");
        let turned: Vec<_> = points.iter().rev().copied().collect();
        let two = Bezier::new(&turned, duration).expect("valid");
        for time in times(&one) {
            let (one, two) = (one.at(time), two.at(duration - time));
            prop_assert!((one.position - two.position).abs() <= 1e-13);
        }
    }

    /// Raising the degree leaves the curve as it is.
    #[test]
    fn degree_elevation((points, duration) in curves()) {
        if points.len() == MOST_POINTS {
            return Ok(());
        }
        let count = points.len();
        let mut raised = vec![points[0]];
        for index in 1..count {
            let part = index as f64 / count as f64;
            raised.push(part * points[index - 1] + (1.0 - part) * points[index]);
        }
        raised.push(points[count - 1]);
        let one = Bezier::new(&points, duration).expect("valid");
        let two = Bezier::new(&raised, duration).expect("valid");
        for time in times(&one) {
            let difference = one.at(time).position - two.at(time).position;
            prop_assert!(difference.abs() <= 1e-12);
        }
    }
}

#[test]
fn what_is_refused() {
    let field = |points: &[f64], duration| match Bezier::new(points, duration) {
        Err(ProfileError::Value { field, .. }) => field,
        other => panic!("{other:?}"),
    };
    assert_eq!(field(&[], 1.0), "number of control points");
    assert_eq!(field(&[1.0], 1.0), "number of control points");
    assert_eq!(
        field(&[1.0; MOST_POINTS + 1], 1.0),
        "number of control points"
    );
    assert_eq!(field(&[1.0, f64::NAN], 1.0), "control point");
    assert_eq!(field(&[1.0, 2.0], 0.0), "duration");
}
