//! What a path goes through.

use super::error::PathError;
use canter_shared::wire::id::AxisId;

/// Axes that one path may move.
pub const MOST_AXES: usize = 12;
/// Waypoints that one path may have.
pub const MOST_WAYPOINTS: usize = 10_000;
/// The greatest magnitude of a position, in rad or the caller's unit.
const FARTHEST: f64 = 1e9;
/// The least and greatest speed of a waypoint.
const SPEEDS: (f64, f64) = (1e-9, 1e9);

/// One place that a path goes through.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Waypoint {
    /// Where each axis is, in rad.
    pub at: Vec<f64>,
    /// The direction in which the path passes, one number for each axis; only their ratio counts.
    pub heading: Option<Vec<f64>>,
    /// The most speed along the path here, in rad/s: the length of the vector of velocities.
    pub speed: Option<f64>,
}

/// Waypoints that a path can go through: checked when they are made.
#[derive(Debug, Clone, PartialEq)]
pub struct Waypoints {
    axes: Vec<AxisId>,
    points: Vec<Waypoint>,
}

impl Waypoints {
    /// Waypoints of these axes, in order.
    ///
    /// # Errors
    /// No axes, more than [`MOST_AXES`] or one twice; fewer than two waypoints or more than
    /// [`MOST_WAYPOINTS`]; values that are no numbers or out of range; two waypoints after each
    /// other in one place.
    pub fn new(axes: Vec<AxisId>, points: Vec<Waypoint>) -> Result<Self, PathError> {
        let is_doubled = |(index, axis)| axes[..index].contains(axis);
        if axes.is_empty() || axes.len() > MOST_AXES || axes.iter().enumerate().any(is_doubled) {
            let names: Vec<_> = axes.iter().map(ToString::to_string).collect();
            return Err(PathError::Axes(format!("[{}]", names.join(", "))));
        }
        if points.len() < 2 || points.len() > MOST_WAYPOINTS {
            return Err(PathError::WaypointCount(points.len()));
        }
        for (index, point) in points.iter().enumerate() {
            check(point, index + 1, axes.len())?;
            if index > 0 && points[index - 1].at == point.at {
                return Err(PathError::Doubled(index + 1));
            }
        }
        Ok(Self { axes, points })
    }

    /// The axes, in the order of each waypoint's numbers.
    pub fn axes(&self) -> &[AxisId] {
        &self.axes
    }

    /// The waypoints.
    pub fn points(&self) -> &[Waypoint] {
        &self.points
    }
}

fn check(point: &Waypoint, waypoint: usize, axes: usize) -> Result<(), PathError> {
    let count = |field, values: &[f64]| match values.len() {
        count if count == axes => Ok(()),
        count => Err(PathError::Count {
            waypoint,
            field,
            count,
            axes,
        }),
    };
    let range = |field, value: f64, minimum, maximum| {
        // A NaN is in no range.
        if (minimum..=maximum).contains(&value) {
            return Ok(());
        }
        Err(PathError::Value {
            waypoint,
            field,
            value,
            minimum,
            maximum,
        })
    };
    count("at", &point.at)?;
    for value in &point.at {
        range("position", *value, -FARTHEST, FARTHEST)?;
    }
    if let Some(heading) = &point.heading {
        count("heading", heading)?;
        for value in heading {
            range("heading", *value, -FARTHEST, FARTHEST)?;
        }
        if heading.iter().all(|value| *value == 0.0) {
            return Err(PathError::NoDirection(waypoint));
        }
    }
    if let Some(speed) = point.speed {
        range("speed", speed, SPEEDS.0, SPEEDS.1)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(values: &[f64]) -> Waypoint {
        Waypoint {
            at: values.to_vec(),
            ..Waypoint::default()
        }
    }

    #[test]
    fn what_is_no_path_is_refused_by_name() {
        let axes = |ids: &[u8]| ids.iter().filter_map(|id| AxisId::new(*id)).collect();
        let refused = |ids: &[u8], points: Vec<Waypoint>| {
            let error = Waypoints::new(axes(ids), points).expect_err("refused");
            error.to_string()
        };
        let two = || vec![at(&[0.0]), at(&[1.0])];
        assert!(Waypoints::new(axes(&[3]), two()).is_ok());
        assert!(refused(&[], two()).contains("1 to 12 axes"));
        assert!(refused(&[1, 1], two()).contains("each once"));
        assert!(refused(&[1], vec![at(&[0.0])]).contains("here are 1"));
        assert!(refused(&[1, 2], two()).contains("at has 1 numbers"));
        assert!(refused(&[1], vec![at(&[0.0]), at(&[f64::NAN])]).contains("waypoint 2: position"));
        assert!(refused(&[1], vec![at(&[0.0]), at(&[0.0])]).contains("waypoint 2 is where"));
        let mut points = two();
        points[0].heading = Some(vec![0.0]);
        assert!(refused(&[1], points).contains("zero in every axis"));
        let mut points = two();
        points[1].speed = Some(0.0);
        assert!(refused(&[1], points).contains("speed must be"));
    }
}
