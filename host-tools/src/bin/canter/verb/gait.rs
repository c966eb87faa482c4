//! `canter gait`: the gaits, and walks, offline and on the robot.
//!
//! | file | what it holds |
//! |---|---|
//! | `run` | a walk on the robot, and what is printed of it |
//! | `pilot` | who leads it: a script, a person, or nobody |
//! | `lines` | orders by lines |
//! | `keys` | orders by keys |
//! | `signals` | what a person's Ctrl-C means |

mod keys;
mod lines;
mod pilot;
mod run;
mod signals;

use crate::arguments::{GaitAction, GaitFormat, GaitPlan};
use crate::context::{Context, print_all};
use anyhow::Result;
use canter::gait::{
    Body, Course, Gait, GaitError, Kind, LEG_NAMES, Peaks, Quadruped, Request, State, svg,
};
use canter::profile::table::number;
use canter::walk::WalkError;
use serde_json::{Value, json};

/// A custom gait that does not say when its feet come down.
#[derive(Debug, thiserror::Error)]
#[error("custom needs --offsets A,B,C,D: when each foot comes down, as shares of the cycle")]
struct NoOffsets;

pub fn run(context: &Context, action: &GaitAction) -> Result<()> {
    match action {
        GaitAction::List => list(context),
        GaitAction::Plan(arguments) => plan(context, arguments),
        GaitAction::Run(arguments) => run::run(context, arguments),
    }
}

/// Whether an error says that the command line was wrong.
pub fn is_usage(error: &anyhow::Error) -> bool {
    error.is::<NoOffsets>()
        || error.downcast_ref().is_some_and(GaitError::is_usage)
        || error.downcast_ref().is_some_and(WalkError::is_usage)
}

fn list(context: &Context) -> Result<()> {
    if context.json {
        let gaits = Kind::ALL.map(|kind| {
            json!({"name": kind.name(), "words": kind.words(), "gait": kind.gait().map(|gait| numbers(&gait))})
        });
        return print_all([json!({ "gaits": gaits }).to_string()].into_iter());
    }
    let head = format!(
        "{:<8}{:<24}{:>8}{:>6}{:>10}  what it is",
        "gait", "feet come down at", "period", "duty", "swing"
    );
    let rows = Kind::ALL.into_iter().map(|kind| match kind.gait() {
        Some(gait) => format!(
            "{:<8}{:<24}{:>6} s{:>6}{:>7} mm  {}",
            kind.name(),
            gait.offsets.map(number).join(", "),
            number(gait.period),
            number(gait.duty),
            number(1e3 * gait.swing),
            kind.words()
        ),
        None => format!(
            "{:<8}{:<24}{:>8}{:>6}{:>10}  {}",
            kind.name(),
            "-",
            "-",
            "-",
            "-",
            kind.words()
        ),
    });
    let last =
        "custom  by --offsets: front left, front right, rear left, rear right; the rest as a trot";
    print_all([head].into_iter().chain(rows).chain([last.to_owned()]))
}

fn numbers(gait: &Gait) -> Value {
    json!({
        "offsets": gait.offsets,
        "period": gait.period,
        "duty": gait.duty,
        "overlay": gait.overlay,
        "swing": gait.swing,
        "stance": gait.stance,
    })
}

fn body(body: &Body) -> Value {
    json!({
        "vx": body.vx,
        "vy": body.vy,
        "yaw_rate": body.yaw_rate,
        "height": body.height,
        "roll": body.roll,
        "pitch": body.pitch,
    })
}

fn plan(context: &Context, arguments: &GaitPlan) -> Result<()> {
    let request = arguments.request().ok_or(NoOffsets)?;
    let course = Course::new(Quadruped::of(&context.robot)?, &request)?;
    // Nothing is printed of a walk that some axis may not do.
    let peaks = course.peaks_within_limits()?;
    let format = if context.json {
        GaitFormat::Json
    } else {
        arguments.format
    };
    match format {
        GaitFormat::Csv => print_all(
            [header(&course)].into_iter().chain(
                course
                    .rows()?
                    .map_while(Result::ok)
                    .map(|state| row(&state)),
            ),
        ),
        GaitFormat::Json => {
            let mut document = summary(arguments.options.name.name(), &request, &peaks);
            if arguments.dt.is_some() {
                let rows = course.rows()?.map_while(Result::ok);
                document["samples"] = rows.map(|state| sample(&course, &state)).collect();
            }
            print_all([document.to_string()].into_iter())
        }
        GaitFormat::Svg => print_all([svg(&course, arguments.options.name.name())?].into_iter()),
    }
}

fn header(course: &Course) -> String {
    let mut names = vec!["t".to_owned()];
    for mount in &course.quadruped().mounts {
        for axis in mount.leg.axes {
            let axis = axis.get();
            names.push(format!(
                "position_{axis},velocity_{axis},acceleration_{axis}"
            ));
        }
    }
    for leg in LEG_NAMES {
        let leg = leg.replace(' ', "_");
        names.push(format!("{leg}_x,{leg}_y,{leg}_z,{leg}_grounded"));
    }
    names.push("body_x,body_y,body_yaw".to_owned());
    names.join(",")
}

fn row(state: &State) -> String {
    let mut cells = vec![number(state.time)];
    for joints in &state.joints {
        for joint in 0..3 {
            let values = [joints.position, joints.velocity, joints.acceleration];
            cells.extend(values.map(|values| number(values[joint])));
        }
    }
    for (foot, grounded) in state.feet.iter().zip(state.grounded) {
        cells.extend(foot.position.map(number));
        cells.push(u8::from(grounded).to_string());
    }
    cells.extend([state.pose.x, state.pose.y, state.pose.yaw].map(number));
    cells.join(",")
}

fn summary(name: &str, request: &Request, peaks: &Peaks) -> Value {
    let axes = peaks.axes.iter().map(|axis| {
        json!({
            "axis": axis.axis,
            "leg": axis.leg,
            "position_min": axis.position[0],
            "position_max": axis.position[1],
            "peak_velocity": axis.velocity,
            "peak_acceleration": axis.acceleration,
            "velocity_share": axis.velocity_share,
            "acceleration_share": axis.acceleration_share,
        })
    });
    let axes: Value = axes.collect();
    let feet = LEG_NAMES.iter().zip(peaks.clearance);
    let feet: Value = feet
        .map(|(leg, height)| json!({"leg": leg, "clearance": height}))
        .collect();
    json!({
        "gait": name,
        "pattern": request.gait.as_ref().map(numbers),
        "body": body(&request.body),
        "steady": request.steady,
        "duration": peaks.duration,
        "axes": axes,
        "feet": feet,
    })
}

fn sample(course: &Course, state: &State) -> Value {
    let mut axes = Vec::new();
    for (mount, joints) in course.quadruped().mounts.iter().zip(&state.joints) {
        for (joint, axis) in mount.leg.axes.iter().enumerate() {
            axes.push(json!({
                "axis": axis.get(),
                "position": joints.position[joint],
                "velocity": joints.velocity[joint],
                "acceleration": joints.acceleration[joint],
            }));
        }
    }
    let feet = state.feet.iter().zip(state.grounded).zip(LEG_NAMES).map(|((foot, grounded), leg)| {
        json!({"leg": leg, "position": foot.position, "grounded": grounded})
    });
    let feet: Value = feet.collect();
    let pose = &state.pose;
    json!({"t": state.time, "axes": axes, "feet": feet, "body": {"x": pose.x, "y": pose.y, "yaw": pose.yaw}})
}
