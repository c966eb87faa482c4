//! The quickest timing that keeps velocities and accelerations: one pass backward, one forward.
//!
//! With x = (du/dt)^2 and y = d2u/dt2, an axis's acceleration is q' y + q'' x: limits are linear in
//! x and y, and over a step of u with a constant y, x changes by 2 y du (Bobrow, Dubowsky and Gibson,
//! Time-optimal control of robotic manipulators along specified paths, 1985). The backward pass
//! finds the greatest x of each node from which the rest of the path can be kept to, so that every
//! deceleration comes early enough. The forward pass takes the greatest acceleration that each node
//! leaves (Pham and Pham, A new approach to time-optimal path parameterization based on
//! reachability analysis, 2018). Limits hold at both ends of each step, which keeps the timing calm
//! where an axis turns round. Between nodes they are measured, and what is over is taken off.

use super::bounds::{AxisBounds, PathBounds};
use super::error::PathError;
use super::peak::Peak;
use super::shape::{Point, Shape, pace};

/// Steps of a whole path, about.
const STEPS: usize = 3000;
/// The fewest and most steps from waypoint to waypoint.
const EACH: (usize, usize) = (16, 1000);
/// How often what is over is taken off.
const ROUNDS: usize = 20;
/// Places within a step at which limits are measured, both ends among them.
const PLACES: usize = 5;
/// What rounding may add.
const ROUNDING: f64 = 1e-9;
/// By how much a limit that is just kept may seem to be broken.
pub const NOISE: f64 = 1e-12;

/// A node of the timing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// The parameter.
    pub parameter: f64,
    /// When it is there, in s.
    pub time: f64,
    /// How fast it runs, squared.
    pub square: f64,
    /// How that changes, from here to the next node.
    pub second: f64,
    /// The segment of the step that begins here.
    pub segment: usize,
}

/// What is to be kept.
pub struct Task<'a> {
    pub shape: &'a Shape,
    pub axes: &'a [AxisBounds],
    pub path: PathBounds,
    /// The most speed at each waypoint.
    pub speeds: &'a [Option<f64>],
    pub start_speed: f64,
    pub end_speed: f64,
}

/// One limit at a node: `along` y + `bend` x is to be from `low` to `high`.
#[derive(Clone, Copy)]
struct Row {
    along: f64,
    bend: f64,
    low: f64,
    high: f64,
}

/// The limits at one end of a step.
struct Limits {
    rows: Vec<Row>,
    /// The greatest x by velocities alone.
    cap: f64,
}

/// Shares of the limits that are planned with: velocity and acceleration, of each axis and last of
/// the path.
type Shares = Vec<[f64; 2]>;

/// The length of the first derivative, and how it changes by u.
fn bent(points: &[Point]) -> (f64, f64) {
    let length = pace(points);
    let change: f64 = points.iter().map(|p| p.first * p.second).sum();
    let bend = if length > 0.0 { change / length } else { 0.0 };
    (length, bend)
}

impl Task<'_> {
    fn limits(&self, points: &[Point], shares: &Shares) -> Limits {
        let mut rows = Vec::with_capacity(points.len() + 1);
        let mut cap = f64::INFINITY;
        let fastest = |limit: f64, rate: f64| (limit / rate).powi(2);
        for ((point, bounds), [velocity, acceleration]) in points.iter().zip(self.axes).zip(shares)
        {
            let most = bounds.acceleration * acceleration;
            rows.push(Row {
                along: point.first,
                bend: point.second,
                low: -most,
                high: most,
            });
            cap = cap.min(fastest(bounds.velocity * velocity, point.first));
        }
        let (along, bend) = bent(points);
        let [velocity, acceleration] = shares[points.len()];
        if let Some(limit) = self.path.velocity {
            cap = cap.min(fastest(limit * velocity, along));
        }
        let high = self.path.acceleration.map(|limit| limit * acceleration);
        let low = self
            .path
            .meant_deceleration()
            .map(|limit| -limit * acceleration);
        if high.is_some() || low.is_some() {
            rows.push(Row {
                along,
                bend,
                low: low.unwrap_or(f64::NEG_INFINITY),
                high: high.unwrap_or(f64::INFINITY),
            });
        }
        Limits { rows, cap }
    }

    /// The timing.
    pub fn solve(&self) -> Result<Vec<Node>, PathError> {
        let grid = self.grid();
        let mut shares = vec![[1.0; 2]; self.axes.len() + 1];
        for _ in 0..ROUNDS {
            let nodes = self.pass(&grid, &shares)?;
            let over = self.over(&nodes);
            if over.iter().flatten().all(|over| *over <= 1.0 + NOISE) {
                return Ok(nodes);
            }
            for (share, over) in shares.iter_mut().zip(&over) {
                for (share, over) in share.iter_mut().zip(over) {
                    if *over > 1.0 + NOISE {
                        *share /= over * (1.0 + ROUNDING);
                    }
                }
            }
        }
        Err(PathError::NoTiming)
    }

    /// Parameter and segment of each node; the last one's segment is that before it.
    fn grid(&self) -> Vec<(f64, usize)> {
        let knots = self.shape.knots();
        let segments = knots.len() - 1;
        let each = (STEPS / segments).clamp(EACH.0, EACH.1);
        let mut grid = Vec::with_capacity(segments * each + 1);
        for segment in 0..segments {
            let (from, to) = (knots[segment], knots[segment + 1]);
            let inner = (0..each).map(|step| from + (to - from) * step as f64 / each as f64);
            grid.extend(inner.map(|parameter| (parameter, segment)));
        }
        grid.push((self.shape.length(), segments - 1));
        grid
    }

    /// The greatest x at each node by velocities and the speeds of waypoints.
    fn caps(&self, grid: &[(f64, usize)], limits: &[Limits]) -> Vec<f64> {
        let each = (grid.len() - 1) / (self.shape.knots().len() - 1);
        let mut caps: Vec<f64> = limits.iter().map(|limits| limits.cap).collect();
        for (waypoint, speed) in self.speeds.iter().enumerate() {
            if let Some(speed) = speed {
                let (parameter, segment) = grid[waypoint * each];
                let length = pace(&self.shape.within(segment, parameter));
                caps[waypoint * each] = caps[waypoint * each].min((speed / length).powi(2));
            }
        }
        // Where nothing moves, nothing bounds x; but it cannot leap.
        let finite = caps.iter().copied().filter(|cap| cap.is_finite());
        let most = 4.0 * finite.fold(0.0, f64::max);
        caps.into_iter().map(|cap| cap.min(most)).collect()
    }

    fn pass(&self, grid: &[(f64, usize)], shares: &Shares) -> Result<Vec<Node>, PathError> {
        let points: Vec<_> = grid
            .iter()
            .map(|(parameter, segment)| self.shape.within(*segment, *parameter))
            .collect();
        let limits: Vec<_> = points
            .iter()
            .map(|points| self.limits(points, shares))
            .collect();
        let mut most = self.caps(grid, &limits);
        let last = grid.len() - 1;
        let wanted = |speed: f64, node: usize| match speed {
            0.0 => 0.0,
            speed => (speed / pace(&points[node])).powi(2),
        };
        let speed = |square: f64, node: usize| square.sqrt() * pace(&points[node]);
        let end_too_fast = |square: f64| PathError::EndOutOfReach {
            speed: self.end_speed,
            fastest: speed(square, last),
        };
        let (start, end) = (wanted(self.start_speed, 0), wanted(self.end_speed, last));
        if end > most[last] * (1.0 + ROUNDING) {
            return Err(end_too_fast(most[last]));
        }
        most[last] = most[last].min(end);
        for index in (0..last).rev() {
            let step = Step::new(grid, &limits, index, most[index + 1]);
            most[index] = step.greatest(most[index]);
        }
        if start > most[0] * (1.0 + ROUNDING) {
            return Err(PathError::StartTooFast {
                speed: self.start_speed,
                fastest: speed(most[0], 0),
            });
        }
        let mut nodes: Vec<Node> = Vec::with_capacity(grid.len());
        let (mut square, mut time) = (start, 0.0);
        for index in 0..last {
            let step = Step::new(grid, &limits, index, most[index + 1]);
            let length = step.length;
            let (_, high) = step.range(square);
            let next = (square + 2.0 * length * high).clamp(0.0, most[index + 1]);
            let (parameter, segment) = grid[index];
            nodes.push(Node {
                parameter,
                time,
                square,
                second: (next - square) / (2.0 * length),
                segment,
            });
            time += 2.0 * length / (square.sqrt() + next.sqrt());
            square = next;
        }
        if !time.is_finite() {
            return Err(PathError::NoTiming);
        }
        if square < end * (1.0 - 1e-6) {
            return Err(end_too_fast(square));
        }
        nodes.push(Node {
            parameter: grid[last].0,
            time,
            square,
            second: nodes.last().map_or(0.0, |node| node.second),
            segment: grid[last].1,
        });
        Ok(nodes)
    }

    /// By how much each limit is exceeded at most: 1 is just kept.
    fn over(&self, nodes: &[Node]) -> Vec<[f64; 2]> {
        let mut peaks = vec![[Peak::default(); 2]; self.axes.len() + 1];
        for pair in nodes.windows(2) {
            let length = pair[1].parameter - pair[0].parameter;
            let second = pair[0].second;
            peaks.iter_mut().flatten().for_each(Peak::restart);
            for place in 0..PLACES {
                let ahead = length * place as f64 / (PLACES - 1) as f64;
                let square = (pair[0].square + 2.0 * second * ahead).max(0.0);
                let points = self
                    .shape
                    .within(pair[0].segment, pair[0].parameter + ahead);
                let rate = square.sqrt();
                for ((peaks, point), bounds) in peaks.iter_mut().zip(&points).zip(self.axes) {
                    let acceleration = point.first * second + point.second * square;
                    peaks[0].push((point.first * rate).abs() / bounds.velocity);
                    peaks[1].push(acceleration.abs() / bounds.acceleration);
                }
                let (along, bend) = bent(&points);
                let peaks = &mut peaks[points.len()];
                if let Some(limit) = self.path.velocity {
                    peaks[0].push(along * rate / limit);
                }
                let change = along * second + bend * square;
                let limit = if change >= 0.0 {
                    self.path.acceleration
                } else {
                    self.path.meant_deceleration()
                };
                if let Some(limit) = limit {
                    peaks[1].push(change.abs() / limit);
                }
            }
        }
        let most = peaks.iter().map(|peaks| peaks.map(|peak| peak.most()));
        most.collect()
    }
}

/// From one node to the next.
struct Step<'a> {
    length: f64,
    from: &'a [Row],
    to: &'a [Row],
    /// The greatest x at its end.
    most: f64,
}

impl<'a> Step<'a> {
    fn new(grid: &[(f64, usize)], limits: &'a [Limits], index: usize, most: f64) -> Self {
        Self {
            length: grid[index + 1].0 - grid[index].0,
            from: &limits[index].rows,
            to: &limits[index + 1].rows,
            most,
        }
    }

    /// The least and greatest y from this x on; the least is over the greatest where there is none.
    fn range(&self, square: f64) -> (f64, f64) {
        let double = 2.0 * self.length;
        let mut range = (-square / double, (self.most - square) / double);
        let ends = self.to.iter().map(|row| Row {
            along: row.along + double * row.bend,
            ..*row
        });
        for row in self.from.iter().copied().chain(ends) {
            let Row {
                along,
                bend,
                low,
                high,
            } = row;
            let rest = bend * square;
            let (one, other) = ((low - rest) / along, (high - rest) / along);
            // Without any effect of y there is nothing that it could mend.
            if along == 0.0 {
                if rest < low || rest > high {
                    return (1.0, 0.0);
                }
                continue;
            }
            range.0 = range.0.max(one.min(other));
            range.1 = range.1.min(one.max(other));
        }
        range
    }

    /// The greatest x up to `cap` that has a y. All x below it have one: the limits are convex, and
    /// at rest it is zero.
    fn greatest(&self, cap: f64) -> f64 {
        let is_possible = |square| {
            let (low, high) = self.range(square);
            low <= high
        };
        if is_possible(cap) {
            return cap;
        }
        let (mut possible, mut impossible) = (0.0, cap);
        for _ in 0..80 {
            let middle = (possible + impossible) / 2.0;
            if is_possible(middle) {
                possible = middle;
            } else {
                impossible = middle;
            }
        }
        possible
    }
}
