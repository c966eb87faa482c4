//! `canter plan`: one move of one axis, offline.

use crate::arguments::{Plan, PlanFormat};
use crate::context::{Context, print_all, read_times};
use anyhow::Result;
use canter::profile::device::{Setpoints, TICK};
use canter::profile::picture::{OWN_UNITS, Picture, Units, evenly, samples};
use canter::profile::table::{HEADER, Row, at, steps};
use canter::profile::{Curve, Kind, PlanError, Request, plan};
use canter_shared::motion::trajectory::{Sample, Trajectory};
use serde_json::{Value, json};

/// What setpoints are in.
const DEVICE_UNITS: Units = ["rad", "rad/s", "rad/s²", "rad/s³"];

pub fn run(context: &Context, arguments: &Plan) -> Result<()> {
    let format = if context.json {
        PlanFormat::Json
    } else {
        arguments.format
    };
    let request = arguments.request();
    if request.kind == Kind::Trapezoid && request.limits.jerk.is_some() {
        eprintln!("note: a trapezoid steps its acceleration, so --jmax does not limit it");
    }
    let text = if arguments.device {
        let setpoints = Setpoints::new(&request)?;
        let request = Request {
            limits: Setpoints::limits(&request),
            ..request
        };
        match format {
            PlanFormat::Svg => {
                let drawn = evenly(&setpoints, arguments.t0);
                picture(&request, "setpoints", DEVICE_UNITS, &drawn, false)?
            }
            PlanFormat::Csv => return print_rows(arguments, &setpoints),
            PlanFormat::Json => document(arguments, &request, &setpoints, Value::Null)?,
        }
    } else {
        let curve = plan(&request)?.curve;
        match format {
            PlanFormat::Svg => {
                let drawn = samples(&curve, arguments.t0);
                let steps = curve.peaks().jerk == f64::INFINITY;
                picture(&request, request.kind.name(), OWN_UNITS, &drawn, steps)?
            }
            PlanFormat::Csv => return print_rows(arguments, &curve),
            PlanFormat::Json => document(arguments, &request, &curve, pieces(&curve))?,
        }
    };
    print_all([text].into_iter())
}

/// The rows that were asked for.
fn rows<'a, T: Trajectory>(
    arguments: &'a Plan,
    trajectory: &'a T,
) -> Result<Box<dyn Iterator<Item = Row> + 'a>> {
    let start = arguments.t0;
    if let Some(name) = &arguments.at {
        let times = read_times(name)?;
        let rows = times
            .into_iter()
            .map(move |time| at(trajectory, start, time));
        return Ok(Box::new(rows));
    }
    let step = if arguments.device {
        Some(whole_ticks(arguments.dt.unwrap_or(TICK))?)
    } else {
        arguments.dt
    };
    Ok(Box::new(steps(trajectory, start, step)?))
}

/// A step that setpoints are sent at.
fn whole_ticks(step: f64) -> Result<f64, PlanError> {
    let ticks = (step / TICK).round();
    if ticks >= 1.0 && (step / TICK - ticks).abs() < 1e-6 {
        Ok(ticks / 1e3)
    } else {
        Err(PlanError::NotWholeTicks(step))
    }
}

fn print_rows<T: Trajectory>(arguments: &Plan, trajectory: &T) -> Result<()> {
    let rows = rows(arguments, trajectory)?;
    print_all(
        [HEADER.to_owned()]
            .into_iter()
            .chain(rows.map(|row| row.csv())),
    )
}

fn picture(
    request: &Request,
    name: &str,
    units: Units,
    drawn: &[(f64, Sample)],
    steps: bool,
) -> Result<String> {
    let mut picture = Picture::new(request.kind.name(), units);
    picture.add(name, drawn);
    picture.limit(&request.limits, request.to >= request.from);
    if steps {
        picture.say_that_it_steps();
    }
    Ok(picture.svg()?)
}

fn document<T: Trajectory>(
    arguments: &Plan,
    request: &Request,
    trajectory: &T,
    pieces: Value,
) -> Result<String> {
    let peaks = trajectory.peaks();
    let duration = trajectory.duration();
    let limits = &request.limits;
    // A number that JSON has none for, such as the jerk of a step, is null.
    let mut document = json!({
        "profile": request.kind.name(),
        "duration": duration,
        "peak_velocity": peaks.velocity,
        "peak_acceleration": peaks.acceleration,
        "peak_jerk": peaks.jerk,
        "from": request.from,
        "to": request.to,
        "start": arguments.t0,
        "end": arguments.t0 + duration,
        "device": arguments.device,
        "limits": {
            "velocity": limits.velocity,
            "acceleration": limits.acceleration,
            "deceleration": limits.meant_deceleration(),
            "jerk": limits.jerk,
        },
        "pieces": pieces,
    });
    if arguments.dt.is_some() || arguments.at.is_some() {
        let rows = rows(arguments, trajectory)?;
        document["samples"] = rows.map(|row| state(row.time, &row.sample)).collect();
    }
    Ok(document.to_string())
}

fn state(time: f64, sample: &Sample) -> Value {
    // Zero has no sign for a reader.
    let unsigned = |value: f64| if value == 0.0 { 0.0 } else { value };
    json!({
        "t": time,
        "position": unsigned(sample.position),
        "velocity": unsigned(sample.velocity),
        "acceleration": unsigned(sample.acceleration),
        "jerk": unsigned(sample.jerk),
    })
}

/// The pieces of constant jerk, each with the state that it starts in, seconds after the start of
/// the move; null for a curve that has none.
fn pieces(curve: &Curve) -> Value {
    let Curve::Pieces(segments) = curve else {
        return Value::Null;
    };
    let pieces = segments.segments().iter().map(|piece| {
        let mut value = state(piece.start, &piece.entry);
        value["duration"] = json!(piece.duration);
        value
    });
    pieces.collect()
}
