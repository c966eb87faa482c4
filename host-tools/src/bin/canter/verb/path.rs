//! `canter path`: through waypoints, offline or as a stream.

use crate::arguments::{Path, PathFormat};
use crate::commander;
use crate::context::{AnyClient, Context, print_all};
use anyhow::{Context as _, Result, bail};
use canter::client::{Goal, MoveRequest, Overrides, Pace, StreamEnd, Target};
use canter::path::knots::knots;
use canter::path::picture::svg;
use canter::path::{AxisBounds, Request, TimedPath, Waypoints, file, plan};
use canter::profile::table::number;
use canter::robot::Robot;
use canter_shared::motion::trajectory::Sample;
use canter_shared::wire::command::ProfileKind;
use canter_shared::wire::id::AxisId;
use serde_json::{Value, json};
use std::io::Read;

/// What a file may hold at most, in bytes: more than any path that is accepted.
const LARGEST_FILE: u64 = 16 << 20;

/// Rows are so many seconds apart where nothing else is said.
const USUAL_STEP: f64 = 0.001;

pub fn run(context: &Context, arguments: &Path) -> Result<()> {
    let name = &arguments.file;
    let waypoints = file::parse(&read(name)?).with_context(|| name.clone())?;
    if arguments.run {
        return stream(context, arguments, &waypoints);
    }
    let request = request(arguments, &context.robot, waypoints.axes());
    let path = plan(&waypoints, &request)?;
    let format = if context.json {
        PathFormat::Json
    } else {
        arguments.format
    };
    let text = match format {
        PathFormat::Csv => return print_rows(arguments, &waypoints, &path),
        PathFormat::Json => document(arguments, &waypoints, &request, &path)?.to_string(),
        PathFormat::Svg => svg(&path, waypoints.axes(), &request.axes, request.timing)?,
    };
    print_all([text].into_iter())
}

fn read(name: &str) -> Result<String> {
    let source: Box<dyn Read> = if name == "-" {
        Box::new(std::io::stdin())
    } else {
        let file = std::fs::File::open(name);
        Box::new(file.with_context(|| format!("cannot read the path {name}"))?)
    };
    let mut text = String::new();
    source
        .take(LARGEST_FILE + 1)
        .read_to_string(&mut text)
        .with_context(|| format!("cannot read the path {name}"))?;
    if text.len() as u64 > LARGEST_FILE {
        bail!("the path {name} is over {LARGEST_FILE} bytes: leave waypoints out");
    }
    Ok(text)
}

fn request(arguments: &Path, robot: &Robot, axes: &[AxisId]) -> Request {
    Request {
        axes: AxisBounds::of(robot, axes),
        path: arguments.bounds(),
        start_speed: arguments.v0,
        end_speed: arguments.v1,
        timing: arguments.profile.into(),
    }
}

fn print_rows(arguments: &Path, waypoints: &Waypoints, path: &TimedPath) -> Result<()> {
    let names = waypoints.axes().iter().flat_map(|axis| {
        ["position", "velocity", "acceleration"].map(|name| format!("{name}_{axis}"))
    });
    let header: Vec<String> = ["t".to_owned()].into_iter().chain(names).collect();
    let rows = path.rows(arguments.dt.unwrap_or(USUAL_STEP))?;
    let lines = rows.map(|(time, samples)| {
        let cells = samples
            .iter()
            .flat_map(|sample| [sample.position, sample.velocity, sample.acceleration].map(number));
        let cells: Vec<String> = [number(time)].into_iter().chain(cells).collect();
        cells.join(",")
    });
    print_all([header.join(",")].into_iter().chain(lines))
}

fn document(
    arguments: &Path,
    waypoints: &Waypoints,
    request: &Request,
    path: &TimedPath,
) -> Result<Value> {
    let shares = path.shares(&request.axes);
    let axes = waypoints.axes().iter().zip(&shares).map(|(axis, share)| {
        json!({
            "axis": axis.get(),
            "peak_velocity": share.velocity[0],
            "velocity_share": share.velocity[1],
            "peak_acceleration": share.acceleration[0],
            "acceleration_share": share.acceleration[1],
            // The acceleration of two passes may step: there is no number for its jerk.
            "peak_jerk": share.jerk.map(|jerk| jerk[0]),
            "jerk_share": share.jerk.map(|jerk| jerk[1]),
        })
    });
    let mut document = json!({
        "duration": path.duration(),
        "waypoints": waypoints.points().len(),
        "length": path.shape().length(),
        "axes": axes.collect::<Vec<_>>(),
    });
    if let Some(step) = arguments.dt {
        let rows = path.rows(step)?.map(|(time, samples)| {
            let list = |value: fn(&Sample) -> f64| samples.iter().map(value).collect::<Vec<_>>();
            json!({
                "t": time,
                "position": list(|sample| sample.position),
                "velocity": list(|sample| sample.velocity),
                "acceleration": list(|sample| sample.acceleration),
            })
        });
        document["samples"] = rows.collect();
    }
    Ok(document)
}

fn stream(context: &Context, arguments: &Path, waypoints: &Waypoints) -> Result<()> {
    let axes = waypoints.axes();
    let mut client = commander::client(context, axes)?;
    let (ends, duration) = commander::while_held(&mut client, axes, |client| {
        follow(context, arguments, waypoints, client)
    })?;
    tell(context, waypoints, &ends, duration);
    Ok(())
}

/// Moves along a path with axes that are held; all is planned before anything moves.
fn follow(
    context: &Context,
    arguments: &Path,
    waypoints: &Waypoints,
    client: &mut AnyClient,
) -> Result<(Vec<StreamEnd>, f64)> {
    let axes = waypoints.axes();
    let robot = &*commander::robot(context, client, axes)?;
    let request = request(arguments, robot, axes);
    let path = plan(waypoints, &request)?;
    let pace = Pace::default();
    let period = f64::from(pace.period.get()) / 1000.0;
    let (knots, duration) = knots(&path, axes, &request.axes, period)?;
    commander::enable(context, client, axes, arguments.enable)?;
    let goals = axes.iter().zip(&waypoints.points()[0].at);
    let approach = MoveRequest {
        goals: goals
            .map(|(axis, position)| Goal {
                axis: *axis,
                target: Target::Absolute(*position),
            })
            .collect(),
        profile: ProfileKind::Beta,
        duration: None,
        limits: Overrides::default(),
        independent: false,
    };
    client
        .move_together(robot, &approach, |_| {})
        .context("on the way to the first waypoint")?;
    Ok((client.stream(axes, pace, knots)?, duration))
}

fn tell(context: &Context, waypoints: &Waypoints, ends: &[StreamEnd], duration: f64) {
    let last = waypoints.points().last();
    let targets = last.map_or(&[][..], |point| &point.at);
    let axes: Vec<Value> = ends
        .iter()
        .zip(targets)
        .map(|(end, target)| {
            json!({
                "axis": end.axis.get(),
                "target": target,
                "position": end.position,
                "start_us": end.start.0,
                "skew_us": end.skew_microseconds,
                "missing_knots": end.missing,
            })
        })
        .collect();
    context.print_json(&json!({ "duration": duration, "axes": axes }));
    if context.json {
        return;
    }
    let points = waypoints.points().len();
    println!("path done: {points} waypoints in {duration:.3} s");
    println!("axis    target rad  position rad  start skew us  missing knots");
    for (end, target) in ends.iter().zip(targets) {
        println!(
            "{:>4}  {:>12.6}  {:>12.6}  {:>13}  {:>13}",
            end.axis, target, end.position, end.skew_microseconds, end.missing,
        );
    }
}
