//! A path with its timing: where each axis is when.

use super::bounds::{AxisBounds, PathBounds};
use super::error::PathError;
use super::jerk_limited;
use super::shape::Shape;
use super::two_pass::{Node, Task};
use super::waypoints::Waypoints;
use crate::profile::table::MOST_ROWS;
use canter_shared::motion::bounds::LARGEST;
use canter_shared::motion::segments::Segments;
use canter_shared::motion::trajectory::{Sample, Trajectory};

/// Places of each segment at which the travel is looked at.
const PLACES: usize = 200;
/// Places in time at which peaks are measured, and the fewest for each segment.
const INSTANTS: usize = 10_000;
const EACH: usize = 20;

/// How the parameter runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Timing {
    /// As quick as velocities and accelerations allow; accelerations may step.
    #[default]
    TwoPass,
    /// One S-curve along the path: jerks keep their limits too.
    SCurve,
}

/// What a path is to be like.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// What each axis may do, in the order of the waypoints' axes.
    pub axes: Vec<AxisBounds>,
    /// What the path as a whole may do.
    pub path: PathBounds,
    /// The speed along the path at the first waypoint, in rad/s.
    pub start_speed: f64,
    /// The speed along the path at the last waypoint, in rad/s.
    pub end_speed: f64,
    /// How it is timed.
    pub timing: Timing,
}

/// How one axis uses its limits: its greatest rates, and their shares of the limits.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Share {
    /// In rad/s and as a share.
    pub velocity: [f64; 2],
    /// In rad/s^2 and as a share.
    pub acceleration: [f64; 2],
    /// In rad/s^3 and as a share; `None` where the acceleration may step.
    pub jerk: Option<[f64; 2]>,
}

#[derive(Debug, Clone, PartialEq)]
enum Law {
    Nodes(Vec<Node>),
    Curve(Box<Segments>),
}

/// A path that is timed.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedPath {
    shape: Shape,
    law: Law,
    /// How many times as long it lasts as the law says.
    stretch: f64,
}

/// Plans a path: its shape, then its timing.
///
/// # Errors
/// Limits and speeds out of range, a curve that leaves an axis's travel, start and end speeds that the
/// limits do not allow.
pub fn plan(waypoints: &Waypoints, request: &Request) -> Result<TimedPath, PathError> {
    let axes = waypoints.axes();
    if request.axes.len() != axes.len() {
        let (given, wanted) = (request.axes.len(), axes.len());
        let words = format!("{given} with limits, {wanted} in the waypoints");
        return Err(PathError::Axes(words));
    }
    for (bounds, axis) in request.axes.iter().zip(axes) {
        bounds.check(*axis)?;
    }
    request.path.check()?;
    for (field, value) in [
        ("the start speed", request.start_speed),
        ("the end speed", request.end_speed),
    ] {
        if !(0.0..=LARGEST).contains(&value) {
            return Err(PathError::Speed { field, value });
        }
    }
    let shape = Shape::through(waypoints)?;
    check_travel(waypoints, &shape, &request.axes)?;
    let speeds: Vec<_> = waypoints.points().iter().map(|point| point.speed).collect();
    let task = Task {
        shape: &shape,
        axes: &request.axes,
        path: request.path,
        speeds: &speeds,
        start_speed: request.start_speed,
        end_speed: request.end_speed,
    };
    let law = match request.timing {
        Timing::TwoPass => Law::Nodes(task.solve()?),
        Timing::SCurve => Law::Curve(Box::new(jerk_limited::solve(&task)?)),
    };
    Ok(TimedPath {
        shape,
        law,
        stretch: 1.0,
    })
}

fn check_travel(
    waypoints: &Waypoints,
    shape: &Shape,
    bounds: &[AxisBounds],
) -> Result<(), PathError> {
    let places = if waypoints.points().len() > 100 {
        PLACES / 10
    } else {
        PLACES
    };
    for (segment, pair) in shape.knots().windows(2).enumerate() {
        for place in 0..=places {
            let parameter = pair[0] + (pair[1] - pair[0]) * place as f64 / places as f64;
            let points = shape.within(segment, parameter);
            for ((point, bounds), axis) in points.iter().zip(bounds).zip(waypoints.axes()) {
                let position = point.position;
                if !(bounds.minimum..=bounds.maximum).contains(&position) {
                    return Err(PathError::OutsideTravel {
                        axis: axis.get(),
                        position,
                        waypoint: segment + 1,
                        minimum: bounds.minimum,
                        maximum: bounds.maximum,
                    });
                }
            }
        }
    }
    Ok(())
}

impl TimedPath {
    /// Seconds from the first waypoint to the last.
    pub fn duration(&self) -> f64 {
        let duration = match &self.law {
            Law::Nodes(nodes) => nodes.last().map_or(0.0, |node| node.time),
            Law::Curve(curve) => curve.duration(),
        };
        duration * self.stretch
    }

    /// The curve in space.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The same path, lasting so long: every rate falls, or stays. A shorter duration than the path
    /// has is not taken.
    #[must_use]
    pub fn stretched(mut self, duration: f64) -> Self {
        let own = self.duration();
        if own > 0.0 && duration > own && duration.is_finite() {
            self.stretch *= duration / own;
        }
        self
    }

    /// Each axis every `step` seconds, and at the end exactly: the last step may be shorter.
    ///
    /// # Errors
    /// A step that makes more than [`MOST_ROWS`].
    pub fn rows(
        &self,
        step: f64,
    ) -> Result<impl Iterator<Item = (f64, Vec<Sample>)> + '_, PathError> {
        let duration = self.duration();
        let rows = duration / step + 1.0;
        // A NaN is no number of rows.
        if step > 0.0 && rows <= MOST_ROWS as f64 {
            return Ok(self.samples(step));
        }
        Err(PathError::TooManyRows {
            step,
            duration,
            rows,
            most: MOST_ROWS,
        })
    }

    fn samples(&self, step: f64) -> impl Iterator<Item = (f64, Vec<Sample>)> + '_ {
        let duration = self.duration();
        let count = (duration / step - 1e-9).ceil().max(1.0) as usize;
        // A step of 0.001 s is a thousandth: dividing by 1000 gives the times that people write.
        let each = (1.0 / step).round();
        let is_part = each >= 1.0 && (1.0 / each) == step;
        let time = move |index: usize| {
            let index = index as f64;
            if is_part { index / each } else { index * step }
        };
        let times = (0..count).map(time).chain([duration]);
        times.map(|time| (time, self.at(time)))
    }

    /// Each axis `time` seconds after the start. Before that it is at the start, and after the end
    /// at the end, each with the rates that it has there.
    pub fn at(&self, time: f64) -> Vec<Sample> {
        let time = time / self.stretch;
        let (segment, law) = match &self.law {
            Law::Nodes(nodes) => along(nodes, time),
            Law::Curve(curve) => {
                let law = curve.at(time.clamp(0.0, curve.duration()));
                (self.shape.segment(law.position), law)
            }
        };
        let points = self.shape.within(segment, law.position);
        let slower = 1.0 / self.stretch;
        let samples = points.iter().map(|point| {
            let [velocity, acceleration, jerk] = point.rates(&law);
            Sample {
                position: point.position,
                velocity: velocity * slower,
                acceleration: acceleration * slower.powi(2),
                jerk: jerk * slower.powi(3),
            }
        });
        samples.collect()
    }

    /// How each axis uses its limits.
    pub fn shares(&self, bounds: &[AxisBounds]) -> Vec<Share> {
        let duration = self.duration();
        let mut peaks = vec![[0.0_f64; 3]; bounds.len()];
        let instants = INSTANTS.max(EACH * self.shape.knots().len());
        for instant in 0..=instants {
            let time = duration * instant as f64 / instants as f64;
            for (peak, sample) in peaks.iter_mut().zip(self.at(time)) {
                let rates = [sample.velocity, sample.acceleration, sample.jerk];
                for (peak, rate) in peak.iter_mut().zip(rates) {
                    *peak = peak.max(rate.abs());
                }
            }
        }
        let is_smooth = matches!(self.law, Law::Curve(_));
        let shares = peaks.iter().zip(bounds).map(|([v, a, j], bounds)| Share {
            velocity: [*v, v / bounds.velocity],
            acceleration: [*a, a / bounds.acceleration],
            jerk: is_smooth.then_some([*j, j / bounds.jerk]),
        });
        shares.collect()
    }
}

/// The segment that nodes are in at a time, and the parameter there.
fn along(nodes: &[Node], time: f64) -> (usize, Sample) {
    let time = time.max(0.0);
    let after = nodes.partition_point(|node| node.time <= time);
    let index = after.saturating_sub(1).min(nodes.len() - 2);
    let (node, next) = (nodes[index], nodes[index + 1]);
    let elapsed = (time - node.time).min(next.time - node.time);
    let rate = node.square.sqrt();
    let law = Sample {
        position: node.parameter + elapsed * (rate + elapsed * node.second / 2.0),
        velocity: (rate + elapsed * node.second).max(0.0),
        acceleration: node.second,
        jerk: 0.0,
    };
    if time >= next.time {
        // The very end, without what rounding adds up.
        let end = Sample {
            position: next.parameter,
            velocity: next.square.sqrt(),
            ..law
        };
        return (node.segment, end);
    }
    (node.segment, law)
}
