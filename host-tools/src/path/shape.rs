//! The curve through the waypoints: in each axis a quintic from waypoint to waypoint.
//!
//! The parameter u counts the length of the straight lines between the waypoints. A quintic has
//! position, first and second derivative of both its ends (Takahashi, Hongo, Ninomiya and Sugimoto,
//! Local path planning and motion control for AGV in positioning, 1989), so both derivatives go on
//! through each waypoint. Where a heading is given, the first derivative is its unit vector. All
//! that is left free makes the integral of the squared third derivative least: the smoothest choice
//! there is, and in a straight line it is the line. At both ends the second derivative is zero.

use super::error::PathError;
use super::waypoints::Waypoints;
use canter_shared::motion::trajectory::Sample;

/// Position and its derivatives by the parameter, of one axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Point {
    /// In rad.
    pub position: f64,
    /// By u.
    pub first: f64,
    /// By u twice.
    pub second: f64,
    /// By u three times; steps at a waypoint with a heading.
    pub third: f64,
}

impl Point {
    /// Velocity, acceleration and jerk of an axis where the parameter runs like this.
    pub fn rates(&self, law: &Sample) -> [f64; 3] {
        let Sample {
            velocity,
            acceleration,
            jerk,
            ..
        } = law;
        [
            self.first * velocity,
            self.second * velocity * velocity + self.first * acceleration,
            self.third * velocity.powi(3)
                + 3.0 * self.second * velocity * acceleration
                + self.first * jerk,
        ]
    }
}

/// The length of the first derivative of all axes: how far the path goes by u.
pub fn pace(points: &[Point]) -> f64 {
    points.iter().map(|p| p.first * p.first).sum::<f64>().sqrt()
}

/// First and second derivative at a waypoint.
type Slope = [f64; 2];

/// A curve of several axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// The parameter at each waypoint, from 0.
    knots: Vec<f64>,
    /// For each segment and axis the coefficients by powers of the share of the segment.
    pieces: Vec<Vec<[f64; 6]>>,
}

impl Shape {
    /// The curve through waypoints.
    ///
    /// # Errors
    /// [`PathError::Uneven`] where the distances differ beyond what numbers can carry.
    pub fn through(waypoints: &Waypoints) -> Result<Self, PathError> {
        let points = waypoints.points();
        let mut knots = vec![0.0];
        let mut end: f64 = 0.0;
        for pair in points.windows(2) {
            let squares = pair[0].at.iter().zip(&pair[1].at);
            let length = squares.map(|(a, b)| (b - a).powi(2)).sum::<f64>().sqrt();
            let next = end + length;
            // Else its end would be its start.
            if !(next - end > end * 1e-12 && length > 1e-9) {
                return Err(PathError::Uneven);
            }
            end = next;
            knots.push(end);
        }
        let axes = waypoints.axes().len();
        let mut pieces = vec![Vec::with_capacity(axes); points.len() - 1];
        for axis in 0..axes {
            let at: Vec<f64> = points.iter().map(|point| point.at[axis]).collect();
            let headings: Vec<Option<f64>> = points
                .iter()
                .map(|point| {
                    let heading = point.heading.as_ref()?;
                    let length = heading.iter().map(|part| part * part).sum::<f64>().sqrt();
                    Some(heading[axis] / length)
                })
                .collect();
            let slopes = smoothest(&knots, &at, &headings);
            if slopes.iter().flatten().any(|slope| !slope.is_finite()) {
                return Err(PathError::Uneven);
            }
            for (index, piece) in pieces.iter_mut().enumerate() {
                let length = knots[index + 1] - knots[index];
                let scaled = |slope: &Slope| [slope[0] * length, slope[1] * length * length];
                let distance = at[index + 1] - at[index];
                let (from, to) = (scaled(&slopes[index]), scaled(&slopes[index + 1]));
                let [third, fourth, fifth] = upper(distance, from, to);
                piece.push([at[index], from[0], from[1] / 2.0, third, fourth, fifth]);
            }
        }
        Ok(Self { knots, pieces })
    }

    /// The parameter at each waypoint, the first of them 0.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The parameter's end.
    pub fn length(&self) -> f64 {
        self.knots.last().copied().unwrap_or_default()
    }

    /// The segment that a parameter is in, from 0.
    pub fn segment(&self, parameter: f64) -> usize {
        let after = self.knots.partition_point(|knot| *knot <= parameter);
        after.saturating_sub(1).min(self.pieces.len() - 1)
    }

    /// Each axis at a parameter; before the start and after the end those.
    pub fn at(&self, parameter: f64) -> Vec<Point> {
        self.within(self.segment(parameter), parameter)
    }

    /// Each axis at a parameter, by the curve of a given segment.
    pub fn within(&self, segment: usize, parameter: f64) -> Vec<Point> {
        let start = self.knots[segment];
        let length = self.knots[segment + 1] - start;
        let share = ((parameter - start) / length).clamp(0.0, 1.0);
        let pieces = self.pieces[segment].iter();
        pieces.map(|piece| evaluate(piece, share, length)).collect()
    }
}

fn evaluate(piece: &[f64; 6], s: f64, length: f64) -> Point {
    let [c0, c1, c2, c3, c4, c5] = piece;
    Point {
        position: c0 + s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5)))),
        first: (c1 + s * (2.0 * c2 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))) / length,
        second: (2.0 * c2 + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))) / length.powi(2),
        third: (6.0 * c3 + s * (24.0 * c4 + s * 60.0 * c5)) / length.powi(3),
    }
}

/// The coefficients of s^3 to s^5 of the quintic over a length of one.
fn upper(distance: f64, [v0, a0]: Slope, [v1, a1]: Slope) -> [f64; 3] {
    let known = [distance, v0, a0, v1, a1];
    UPPER.map(|row| {
        row.iter()
            .zip(known)
            .map(|(part, value)| part * value)
            .sum()
    })
}

/// What the coefficients of s^3 to s^5 are, by distance and the slopes at both ends.
const UPPER: [[f64; 5]; 3] = [
    [10.0, -6.0, -1.5, -4.0, 0.5],
    [-15.0, 8.0, 1.5, 7.0, -1.0],
    [6.0, -3.0, -0.5, -3.0, 0.5],
];

/// The integral of (6 c3 + 24 c4 s + 60 c5 s^2)^2 over s from 0 to 1, as a form of c3, c4, c5.
const ENERGY: [[f64; 3]; 3] = [
    [36.0, 72.0, 120.0],
    [72.0, 192.0, 360.0],
    [120.0, 360.0, 720.0],
];

/// The energy as a form of distance and slopes.
fn stiffness() -> [[f64; 5]; 5] {
    let mut form = [[0.0; 5]; 5];
    for (row, values) in form.iter_mut().enumerate() {
        for (column, value) in values.iter_mut().enumerate() {
            for (one, weights) in ENERGY.iter().enumerate() {
                for (other, weight) in weights.iter().enumerate() {
                    *value += UPPER[one][row] * weight * UPPER[other][column];
                }
            }
        }
    }
    form
}

/// A form of two slopes.
type Block = [[f64; 2]; 2];

fn product(a: &Block, b: &Block) -> Block {
    let cell = |i: usize, j: usize| a[i][0] * b[0][j] + a[i][1] * b[1][j];
    [[cell(0, 0), cell(0, 1)], [cell(1, 0), cell(1, 1)]]
}

fn apply(a: &Block, x: &Slope) -> Slope {
    [
        a[0][0] * x[0] + a[0][1] * x[1],
        a[1][0] * x[0] + a[1][1] * x[1],
    ]
}

fn inverse(a: &Block) -> Block {
    let [[p, q], [r, s]] = a;
    let over = 1.0 / (p * s - q * r);
    [[s * over, -q * over], [-r * over, p * over]]
}

/// The slopes at the waypoints that make the energy least: block Gauss elimination of the equations
/// that its derivative by each free slope is zero.
fn smoothest(knots: &[f64], at: &[f64], headings: &[Option<f64>]) -> Vec<Slope> {
    let form = stiffness();
    let count = at.len();
    let mut own: Vec<Block> = vec![[[0.0; 2]; 2]; count];
    let mut next: Vec<Block> = vec![[[0.0; 2]; 2]; count];
    let mut right: Vec<Slope> = vec![[0.0; 2]; count];
    for index in 0..count - 1 {
        let length = knots[index + 1] - knots[index];
        let scale = [1.0, length, length * length];
        let energy = length.powi(-5);
        let distance = at[index + 1] - at[index];
        for row in 0..2 {
            let weight = energy * scale[row + 1];
            right[index][row] -= weight * form[row + 1][0] * distance;
            right[index + 1][row] -= weight * form[row + 3][0] * distance;
            for column in 0..2 {
                let weight = weight * scale[column + 1];
                own[index][row][column] += weight * form[row + 1][column + 1];
                own[index + 1][row][column] += weight * form[row + 3][column + 3];
                next[index][row][column] += weight * form[row + 1][column + 3];
            }
        }
    }
    for (index, heading) in headings.iter().enumerate() {
        if let Some(slope) = heading {
            fix(&mut own, &mut next, &mut right, index, 0, *slope);
        }
    }
    for index in [0, count - 1] {
        fix(&mut own, &mut next, &mut right, index, 1, 0.0);
    }
    for index in 1..count {
        let before = next[index - 1];
        let lower = [[before[0][0], before[1][0]], [before[0][1], before[1][1]]];
        let factor = product(&lower, &inverse(&own[index - 1]));
        let less = product(&factor, &before);
        let other = apply(&factor, &right[index - 1]);
        for row in 0..2 {
            right[index][row] -= other[row];
            for column in 0..2 {
                own[index][row][column] -= less[row][column];
            }
        }
    }
    let mut slopes = vec![[0.0; 2]; count];
    let mut after = [0.0; 2];
    for index in (0..count).rev() {
        let known = apply(&next[index], &after);
        let rest = [right[index][0] - known[0], right[index][1] - known[1]];
        after = apply(&inverse(&own[index]), &rest);
        slopes[index] = after;
    }
    slopes
}

/// Replaces the equation of one slope by its value.
fn fix(
    own: &mut [Block],
    next: &mut [Block],
    right: &mut [Slope],
    index: usize,
    which: usize,
    value: f64,
) {
    let other = 1 - which;
    right[index][other] -= own[index][other][which] * value;
    own[index][other][which] = 0.0;
    own[index][which][other] = 0.0;
    // The size of the others', so that the elimination stays well scaled.
    let size = own[index][which][which];
    right[index][which] = size * value;
    for row in 0..2 {
        if index + 1 < own.len() {
            right[index + 1][row] -= next[index][which][row] * value;
            next[index][which][row] = 0.0;
        }
        if index > 0 {
            right[index - 1][row] -= next[index - 1][row][which] * value;
            next[index - 1][row][which] = 0.0;
        }
    }
}
