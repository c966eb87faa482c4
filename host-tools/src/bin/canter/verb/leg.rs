//! `canter leg`: a foot's joints and a leg's foot, offline.

use crate::arguments::LegAction;
use crate::context::{Context, print_all};
use anyhow::Result;
use canter::profile::table::number;
use canter::robot::{ChosenLeg, UnknownLeg};
use serde_json::{Map, Value, json};

pub fn run(context: &Context, action: &LegAction) -> Result<()> {
    let chosen = |name: &str| context.robot.leg(name, context.robot_is_named);
    match action {
        LegAction::Ik(asked) => {
            let leg = chosen(&asked.leg)?;
            let joints = leg.kinematics.joints([asked.x, asked.y, asked.z])?;
            let values = [("q1", joints[0]), ("q2", joints[1]), ("q3", joints[2])];
            if context.json {
                return print_document(&asked.leg, &values, axes(&leg, joints));
            }
            print_all(values.into_iter().map(|(name, angle)| {
                let degrees = angle.to_degrees();
                format!("{name} {} rad ({degrees:.3} deg)", number(angle))
            }))
        }
        LegAction::Fk(asked) => {
            let joints = [asked.q1, asked.q2, asked.q3];
            let foot = chosen(&asked.leg)?.kinematics.foot(joints)?;
            let values = [("x", foot[0]), ("y", foot[1]), ("z", foot[2])];
            if context.json {
                return print_document(&asked.leg, &values, None);
            }
            print_all(
                values
                    .into_iter()
                    .map(|(name, place)| format!("{name} {} m", number(place))),
            )
        }
    }
}

/// Whether an error says that the command line was wrong.
pub fn is_usage(error: &anyhow::Error) -> bool {
    error.is::<UnknownLeg>()
}

/// Where the axes are that move a leg of the robot, by its signs and offsets.
fn axes(leg: &ChosenLeg, joints: [f64; 3]) -> Option<Value> {
    let mounted = leg.mounted?;
    let positions = mounted.axis_positions(joints);
    let axes = mounted.axes.iter().zip(positions);
    let axes =
        axes.map(|(axis, position)| json!({"axis": axis.get(), "position": unsigned(position)}));
    Some(axes.collect())
}

fn print_document(leg: &str, values: &[(&str, f64)], axes: Option<Value>) -> Result<()> {
    let mut document = Map::new();
    document.insert("leg".to_owned(), json!(leg));
    for (name, value) in values {
        document.insert((*name).to_owned(), json!(unsigned(*value)));
    }
    if let Some(axes) = axes {
        document.insert("axes".to_owned(), axes);
    }
    print_all([Value::Object(document).to_string()].into_iter())
}

/// Zero has no sign for a reader.
fn unsigned(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value }
}
