//! The command line of `path`.

use canter::notation::{rate, seconds};
use canter::path::{PathBounds, Timing};
use clap::{Args, ValueEnum};

#[derive(Args)]
pub struct Path {
    /// The waypoints, as CSV or TOML; - is stdin.
    #[arg(value_name = "FILE")]
    pub file: String,
    /// How it is timed.
    #[arg(long, value_enum, default_value_t = PathProfile::TwoPass)]
    pub profile: PathProfile,
    /// The most speed along the path, in rad/s: the length of the vector of velocities.
    #[arg(long, value_name = "RATE", value_parser = rate, allow_hyphen_values = true)]
    pub vmax: Option<f64>,
    /// How fast that speed may rise, in rad/s^2.
    #[arg(long, value_name = "RATE", value_parser = rate, allow_hyphen_values = true)]
    pub amax: Option<f64>,
    /// How fast it may fall, in rad/s^2; as the rise without it.
    #[arg(long, value_name = "RATE", value_parser = rate, allow_hyphen_values = true)]
    pub dmax: Option<f64>,
    /// The most jerk of all axes together, in rad/s^3; for --profile s-curve.
    #[arg(long, value_name = "RATE", value_parser = rate, allow_hyphen_values = true)]
    pub jmax: Option<f64>,
    /// The speed at the first waypoint, in rad/s.
    #[arg(long, value_name = "RATE", value_parser = speed, allow_hyphen_values = true, default_value_t = 0.0, hide_default_value = true)]
    pub v0: f64,
    /// The speed at the last waypoint, in rad/s.
    #[arg(long, value_name = "RATE", value_parser = speed, allow_hyphen_values = true, default_value_t = 0.0, hide_default_value = true)]
    pub v1: f64,
    /// A row every so many seconds; 0.001 without it. JSON has rows only with it.
    #[arg(long, value_name = "S", value_parser = seconds, allow_hyphen_values = true)]
    pub dt: Option<f64>,
    /// How it is printed.
    #[arg(long, value_enum, default_value_t = PathFormat::Csv)]
    pub format: PathFormat,
    /// Move the axes to the first waypoint, then along the path, as a stream of knots.
    #[arg(long, conflicts_with_all = ["dt", "format", "v0", "v1"])]
    pub run: bool,
    /// With --run: enable the axes first where they are not.
    #[arg(long, requires = "run")]
    pub enable: bool,
}

impl Path {
    /// What the path as a whole may do.
    pub fn bounds(&self) -> PathBounds {
        PathBounds {
            velocity: self.vmax,
            acceleration: self.amax,
            deceleration: self.dmax,
            jerk: self.jmax,
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PathProfile {
    /// As quick as velocities and accelerations allow.
    TwoPass,
    /// One S-curve along the path, which keeps limits of the jerk too.
    SCurve,
}

impl From<PathProfile> for Timing {
    fn from(profile: PathProfile) -> Self {
        match profile {
            PathProfile::TwoPass => Self::TwoPass,
            PathProfile::SCurve => Self::SCurve,
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PathFormat {
    /// Rows of t, then position, velocity and acceleration of each axis.
    Csv,
    /// One document: duration, and how each axis uses its limits; rows where --dt asks for them.
    Json,
    /// A picture with the limits drawn in.
    Svg,
}

fn speed(text: &str) -> Result<f64, String> {
    match text.trim().parse() {
        Ok(0.0) => Ok(0.0),
        _ => rate(text).map_err(|error| error.to_string()),
    }
}
