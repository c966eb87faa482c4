//! The robot file: which axes there are and what each may do.
//!
//! ```toml
//! [[axis]]
//! id = 1
//! [axis.limits]          # what is left out keeps its default
//! velocity = 10.0        # rad/s
//! acceleration = 100.0   # rad/s^2
//! deceleration = 100.0   # rad/s^2
//! jerk = 10000.0         # rad/s^3
//! position_min = -1.6    # rad
//! position_max = 1.6     # rad
//! [axis.shaper]          # where the machine swings; without it nothing is shaped
//! kind = "zvd"           # zv, zvd or ei
//! frequency = 12.0       # Hz
//! damping = 0.02         # ratio; 0 where it is left out
//! ```
//!
//! Legs are `[[leg]]`, in `legs`.

mod legs;

pub use legs::{ChosenLeg, RobotLeg, RobotLegError, UnknownLeg};

use canter_shared::limits::{DEFAULT_VALUES, LimitError, LimitValues, Limits};
use canter_shared::motion::shaping::{ShaperKind, Shaping, ShapingError};
use canter_shared::parameter::{Parameter, Values};
use canter_shared::wire::id::{AxisId, LAST_AXIS};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Axes of the robot that is assumed where no file names one: four legs of three.
pub const DEFAULT_AXES: u8 = 12;

/// One axis of a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotAxis {
    /// Its number on the bus.
    pub id: AxisId,
    /// Its parameters.
    pub values: Values,
}

impl RobotAxis {
    /// An axis as it comes from the factory.
    pub fn new(id: AxisId) -> Self {
        let values = Values::defaults(id.get());
        Self { id, values }
    }

    /// What it may do.
    pub fn limits(&self) -> Limits {
        self.values.settings().limits
    }
}

/// A robot: its axes in the order of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    axes: Vec<RobotAxis>,
    legs: Vec<RobotLeg>,
}

/// Why a robot file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RobotError {
    /// It cannot be read.
    #[error("cannot read the robot file {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is not TOML, or not of this shape.
    #[error("the robot file {path} is not valid: {source}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Where and why.
        source: Box<toml::de::Error>,
    },
    /// An axis id is out of range or stands twice.
    #[error("the robot file {path} names axis {id}: ids are from 1 to {LAST_AXIS}, each once")]
    Axis {
        /// The file.
        path: PathBuf,
        /// The id.
        id: u8,
    },
    /// No axis at all.
    #[error("the robot file {path} has no [[axis]]")]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// A shaper is not possible.
    #[error("the robot file {path}, axis {id}: {source}")]
    Shaper {
        /// The file.
        path: PathBuf,
        /// The axis.
        id: u8,
        /// Which value, and its range.
        source: ShapingError,
    },
    /// A limit is out of range.
    #[error("the robot file {path}, axis {id}: {source}")]
    Limit {
        /// The file.
        path: PathBuf,
        /// The axis.
        id: u8,
        /// Which limit, and its range.
        source: LimitError,
    },
    /// A leg is not possible.
    #[error("the robot file {path}, leg {name}: {source}")]
    Leg {
        /// The file.
        path: PathBuf,
        /// The leg.
        name: String,
        /// Which value, and its range.
        source: RobotLegError,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    axis: Vec<FileAxis>,
    #[serde(default)]
    leg: Vec<legs::FileLeg>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileAxis {
    id: u8,
    #[serde(default)]
    limits: FileLimits,
    shaper: Option<FileShaper>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileShaper {
    kind: FileShaperKind,
    frequency: f64,
    #[serde(default)]
    damping: f64,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "lowercase")]
enum FileShaperKind {
    Zv,
    Zvd,
    Ei,
}

impl FileShaper {
    fn shaping(&self) -> Result<Shaping, ShapingError> {
        let kind = match self.kind {
            FileShaperKind::Zv => ShaperKind::Zv,
            FileShaperKind::Zvd => ShaperKind::Zvd,
            FileShaperKind::Ei => ShaperKind::Ei,
        };
        Shaping::new(kind, self.frequency, self.damping)
    }
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct FileLimits {
    velocity: Option<f64>,
    acceleration: Option<f64>,
    deceleration: Option<f64>,
    jerk: Option<f64>,
    position_min: Option<f64>,
    position_max: Option<f64>,
}

impl FileLimits {
    /// The parameters that are meant: the nearest steps, so that host and node mean the same.
    fn values(&self, id: AxisId) -> Result<Values, LimitError> {
        let default = DEFAULT_VALUES;
        // Refused by name and as written, before anything is rounded.
        Limits::new(&LimitValues {
            velocity: self.velocity.unwrap_or(default.velocity),
            acceleration: self.acceleration.unwrap_or(default.acceleration),
            deceleration: self.deceleration.unwrap_or(default.deceleration),
            jerk: self.jerk.unwrap_or(default.jerk),
            position_minimum: self.position_min.unwrap_or(default.position_minimum),
            position_maximum: self.position_max.unwrap_or(default.position_maximum),
        })?;
        let mut values = Values::defaults(id.get());
        for (parameter, value) in [
            (Parameter::VelocityLimit, self.velocity),
            (Parameter::AccelerationLimit, self.acceleration),
            (Parameter::DecelerationLimit, self.deceleration),
            (Parameter::JerkLimit, self.jerk),
            (Parameter::PositionMinimum, self.position_min),
            (Parameter::PositionMaximum, self.position_max),
        ] {
            let raw = value.and_then(|value| parameter.nearest(value));
            if let Some((changed, _)) = raw.and_then(|raw| values.with(parameter, raw).ok()) {
                values = changed;
            }
        }
        Ok(values)
    }
}

impl Robot {
    /// A robot of these axes, and no legs.
    pub fn of(axes: Vec<RobotAxis>) -> Self {
        let legs = Vec::new();
        Self { axes, legs }
    }

    /// Reads a robot file.
    ///
    /// # Errors
    /// The file's name, and what is wrong in it.
    pub fn read(path: &Path) -> Result<Self, RobotError> {
        let text = std::fs::read_to_string(path).map_err(|source| RobotError::Read {
            path: path.to_owned(),
            source,
        })?;
        Self::parse(&text, path)
    }

    fn parse(text: &str, path: &Path) -> Result<Self, RobotError> {
        let path = || path.to_owned();
        let file: File = toml::from_str(text).map_err(|source| RobotError::Syntax {
            path: path(),
            source: Box::new(source),
        })?;
        if file.axis.is_empty() {
            return Err(RobotError::Empty { path: path() });
        }
        let mut axes: Vec<RobotAxis> = Vec::new();
        for FileAxis {
            id: number,
            limits,
            shaper,
        } in &file.axis
        {
            let id = AxisId::new(*number)
                .filter(|id| axes.iter().all(|axis| axis.id != *id))
                .ok_or_else(|| RobotError::Axis {
                    path: path(),
                    id: *number,
                })?;
            let values = limits.values(id).map_err(|source| RobotError::Limit {
                path: path(),
                id: *number,
                source,
            })?;
            let values = shaper
                .as_ref()
                .map_or(Ok(values), |shaper| values.shaped(Some(&shaper.shaping()?)))
                .map_err(|source| RobotError::Shaper {
                    path: path(),
                    id: *number,
                    source,
                })?;
            axes.push(RobotAxis { id, values });
        }
        let ids: Vec<AxisId> = axes.iter().map(|axis| axis.id).collect();
        let mut legs = Vec::new();
        for leg in &file.leg {
            let leg = leg.leg(&ids, &legs).map_err(|source| RobotError::Leg {
                path: path(),
                name: leg.name.clone(),
                source,
            })?;
            legs.push(leg);
        }
        Ok(Self { axes, legs })
    }

    /// The legs, in the order of the file.
    pub fn legs(&self) -> &[RobotLeg] {
        &self.legs
    }

    /// The leg of this name, or the first of this kind: five-bar or serial. A robot without legs, or
    /// one that no file names, has the published leg of a kind that it does not have itself.
    ///
    /// # Errors
    /// Neither a name nor a kind of the robot's legs.
    pub fn leg(&self, wanted: &str, is_named: bool) -> Result<ChosenLeg<'_>, UnknownLeg> {
        legs::choose(&self.legs, is_named, wanted)
    }

    /// The axes.
    pub fn axes(&self) -> &[RobotAxis] {
        &self.axes
    }

    fn axis(&self, id: AxisId) -> Option<&RobotAxis> {
        self.axes.iter().find(|axis| axis.id == id)
    }

    /// The parameters of an axis: the defaults where the robot does not name it.
    pub fn values(&self, id: AxisId) -> Values {
        self.axis(id)
            .map_or_else(|| Values::defaults(id.get()), |axis| axis.values)
    }

    /// What an axis may do: the defaults where the robot does not name it.
    pub fn limits(&self, id: AxisId) -> Limits {
        self.values(id).settings().limits
    }

    /// What an axis's setpoints are shaped for, if anything.
    pub fn shaping(&self, id: AxisId) -> Option<Shaping> {
        self.values(id).settings().shaping
    }
}

impl Default for Robot {
    /// Twelve axes with the default limits, three for each of four serial legs.
    fn default() -> Self {
        let axes = (1..=DEFAULT_AXES)
            .filter_map(AxisId::new)
            .map(RobotAxis::new)
            .collect();
        let legs = legs::assumed();
        Self { axes, legs }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Robot, RobotError> {
        Robot::parse(text, Path::new("robot.toml"))
    }

    #[test]
    fn limits_of_a_file() {
        let robot = parse("[[axis]]\nid = 3\n[axis.limits]\nvelocity = 5.0\n").expect("valid");
        let id = AxisId::new(3).expect("in range");
        assert!((robot.limits(id).velocity().radians() - 5.0).abs() < 1e-8);
        assert_eq!(robot.axes().len(), 1);
    }

    /// A node that gets the file's parameters has the limits that the host plans with.
    #[test]
    fn limits_of_a_file_are_those_of_a_node() {
        let robot = parse(
            "[[axis]]\nid = 3\n[axis.limits]\nvelocity = 5.123456789123\njerk = 1234.56789\n\
             position_max = 3.141592653589793\n[axis.shaper]\nkind = \"zvd\"\nfrequency = 7.77777777\n",
        )
        .expect("valid");
        let id = AxisId::new(3).expect("in range");
        let settings = robot.values(id).settings();
        assert_eq!(robot.limits(id), settings.limits);
        assert_eq!(robot.shaping(id), settings.shaping);
        assert_eq!(robot.axes()[0].limits(), settings.limits);
        let position = Parameter::PositionMaximum;
        assert_eq!(robot.values(id).get(position), 3_141_592_654);
    }

    #[test]
    fn bad_files_say_what_is_wrong() {
        for (text, word) in [
            ("", "no [[axis]]"),
            ("[[axis]]\nid = 0\n", "axis 0"),
            ("[[axis]]\nid = 1\n[[axis]]\nid = 1\n", "axis 1"),
            ("[[axis]]\nid = 1\nspeed = 3\n", "speed"),
            (
                "[[axis]]\nid = 1\n[axis.limits]\njerk = -1.0\n",
                "limits.jerk",
            ),
            (
                "[[axis]]\nid = 1\n[axis.shaper]\nkind = \"zvx\"\nfrequency = 9.0\n",
                "zvx",
            ),
            (
                "[[axis]]\nid = 1\n[axis.shaper]\nkind = \"zvd\"\nfrequency = 0.1\n",
                "ZVD shaper frequency",
            ),
            (
                "[[axis]]\nid = 1\n[axis.limits]\nvelocity = nan\n",
                "limits.velocity",
            ),
        ] {
            let message = parse(text).expect_err(text).to_string();
            assert!(message.contains(word), "{message}");
        }
    }
}
