//! The command line of `leg`.

use canter::notation::angle;
use clap::{Args, Subcommand};

#[derive(Args)]
pub struct LegArguments {
    #[command(subcommand)]
    pub action: LegAction,
}

#[derive(Subcommand)]
pub enum LegAction {
    /// The joint angles of a foot that is here, as its hip sees it.
    Ik(LegFoot),
    /// Where the foot is with the joints at these angles.
    Fk(LegJoints),
}

#[derive(Args)]
pub struct LegFoot {
    /// Which leg: five-bar, serial, or the name of one in the robot file.
    #[arg(long, value_name = "LEG")]
    pub leg: String,
    /// Forward, in m.
    #[arg(long, value_name = "M", value_parser = metres, allow_hyphen_values = true)]
    pub x: f64,
    /// To the left, in m.
    #[arg(long, value_name = "M", value_parser = metres, allow_hyphen_values = true, default_value_t = 0.0)]
    pub y: f64,
    /// Up, in m: a standing foot has a negative z.
    #[arg(long, value_name = "M", value_parser = metres, allow_hyphen_values = true)]
    pub z: f64,
}

#[derive(Args)]
pub struct LegJoints {
    /// Which leg: five-bar, serial, or the name of one in the robot file.
    #[arg(long, value_name = "LEG")]
    pub leg: String,
    /// The front motor of a five-bar, the thigh of a serial leg.
    #[arg(long, value_name = "ANGLE", value_parser = joint, allow_hyphen_values = true)]
    pub q1: f64,
    /// The rear motor of a five-bar, the knee of a serial leg.
    #[arg(long, value_name = "ANGLE", value_parser = joint, allow_hyphen_values = true)]
    pub q2: f64,
    /// The abduction.
    #[arg(long, value_name = "ANGLE", value_parser = joint, allow_hyphen_values = true, default_value_t = 0.0)]
    pub q3: f64,
}

fn metres(text: &str) -> Result<f64, String> {
    let most = canter::leg::FARTHEST_FOOT;
    match text.trim().parse::<f64>() {
        // A NaN is in no range.
        Ok(value) if value.abs() <= most => Ok(value),
        _ => Err(format!("it must be a number from -{most} to {most} m")),
    }
}

fn joint(text: &str) -> Result<f64, String> {
    let most = canter::leg::LARGEST_JOINT;
    let radians = angle(text).map_err(|error| error.to_string())?;
    if radians.abs() <= most {
        Ok(radians)
    } else {
        Err(format!("it must be an angle from -{most} to {most} rad"))
    }
}
