//! `canter foot`: one cycle of one foot, or all presets side by side.

use crate::arguments::{Foot, FootFormat};
use crate::context::{Context, print_all, read_times};
use anyhow::{Context as _, Result, bail};
use canter::foot::compare::{Row, compare, picture};
use canter::foot::{Cycle, CycleRequest};
use canter::leg::{JointMotion, Leg};
use canter::profile::table::number;
use serde_json::{Value, json};

const HEADER: [&str; 8] = ["t", "phase", "x", "z", "vx", "vz", "ax", "az"];
const JOINTS: [&str; 9] = [
    "q1", "q2", "q3", "dq1", "dq2", "dq3", "ddq1", "ddq2", "ddq3",
];
/// The columns of a comparison, the first of them the name.
const COMPARED: [&str; 7] = [
    "preset",
    "peak_velocity",
    "peak_acceleration",
    "clearance",
    "ground_speed",
    "velocity_jump",
    "acceleration_jump",
];

pub fn run(context: &Context, arguments: &Foot) -> Result<()> {
    let asked = if context.json {
        Some(FootFormat::Json)
    } else {
        arguments.format
    };
    let request = arguments.request();
    let Some(preset) = arguments.preset else {
        let rows = compare(&request)?;
        let lines = match asked.unwrap_or(FootFormat::Text) {
            FootFormat::Text => text(&rows),
            FootFormat::Csv => csv(&rows),
            FootFormat::Json => vec![comparison(&request, &rows).to_string()],
            FootFormat::Svg => vec![picture(rows.iter().map(|row| &row.cycle))?],
        };
        return print_all(lines.into_iter());
    };
    let cycle = Cycle::new(preset, &request)?;
    let format = asked.unwrap_or(FootFormat::Csv);
    if format == FootFormat::Svg {
        return print_all([picture([&cycle])?].into_iter());
    }
    let leg = arguments.leg.map(Leg::from);
    // All rows before the first is printed: a foot out of reach leaves no half of a table.
    let times = times(arguments, &cycle)?;
    let rows: Vec<Vec<f64>> = times
        .iter()
        .map(|time| values(&cycle, leg.as_ref(), *time))
        .collect::<Result<_>>()?;
    let named = times.iter().zip(&rows);
    let names = &HEADER[2..];
    let names = names.iter().chain(JOINTS.iter().filter(|_| leg.is_some()));
    match format {
        FootFormat::Json => {
            let samples = named.map(|(time, row)| {
                let mut sample = json!({ "t": time, "phase": cycle.phase(*time).0.name() });
                for (name, value) in names.clone().zip(row) {
                    sample[*name] = json!(value);
                }
                sample
            });
            let mut document = asked_for(&request);
            document["preset"] = json!(cycle.preset().name());
            document["samples"] = samples.collect();
            print_all([document.to_string()].into_iter())
        }
        FootFormat::Text => {
            bail!("--format text is for the comparison: leave out --preset, or name csv")
        }
        FootFormat::Csv | FootFormat::Svg => {
            let head = HEADER[..2].iter().chain(names).copied();
            let head = head.collect::<Vec<_>>().join(",");
            let lines = named.map(|(time, row)| {
                let mut cells = vec![number(*time), cycle.phase(*time).0.name().to_owned()];
                cells.extend(row.iter().copied().map(number));
                cells.join(",")
            });
            print_all([head].into_iter().chain(lines))
        }
    }
}

/// The times that were asked for.
fn times(arguments: &Foot, cycle: &Cycle) -> Result<Vec<f64>> {
    let Some(name) = &arguments.at else {
        let last = arguments.samples - 1;
        let share = |at: u32| cycle.period() * f64::from(at) / f64::from(last);
        return Ok((0..=last).map(share).collect());
    };
    read_times(name)
}

/// The foot at a time, and the joints where a leg is named.
fn values(cycle: &Cycle, leg: Option<&Leg>, time: f64) -> Result<Vec<f64>> {
    let foot = cycle.at(time);
    let mut values = Vec::new();
    for [x, _, z] in [foot.position, foot.velocity, foot.acceleration] {
        values.extend([x, z]);
    }
    if let Some(leg) = leg {
        let JointMotion {
            position,
            velocity,
            acceleration,
        } = leg
            .joint_motion(&foot)
            .with_context(|| format!("--leg, at {time} s"))?;
        values.extend([position, velocity, acceleration].concat());
    }
    Ok(values)
}

fn numbers(row: &Row) -> [f64; 6] {
    [
        row.peak_velocity,
        row.peak_acceleration,
        row.clearance,
        row.ground_speed,
        row.velocity_jump,
        row.acceleration_jump,
    ]
}

fn csv(rows: &[Row]) -> Vec<String> {
    let mut lines = vec![COMPARED.join(",")];
    for row in rows {
        let mut cells = vec![row.cycle.preset().to_string()];
        cells.extend(numbers(row).map(number));
        lines.push(cells.join(","));
    }
    lines
}

/// A table with two heads: what, and in which unit.
fn text(rows: &[Row]) -> Vec<String> {
    let line = |name: &str, cells: [String; 6]| {
        let cells = cells.map(|cell| format!("{cell:>13}"));
        format!("{name:<9}{}", cells.concat())
    };
    let heads = [
        "velocity",
        "acceleration",
        "clearance",
        "over ground",
        "jump of v",
        "jump of a",
    ];
    let units = ["m/s", "m/s^2", "mm", "m/s", "m/s", "m/s^2"];
    let mut lines = vec![
        line("preset", heads.map(str::to_owned)),
        line("", units.map(str::to_owned)),
    ];
    for row in rows {
        let mut cells = numbers(row);
        cells[2] *= 1e3;
        lines.push(line(
            row.cycle.preset().name(),
            cells.map(|value| format!("{value:.3}")),
        ));
    }
    lines.push(String::new());
    lines.push(
        "velocity and acceleration are peaks; over ground: at touch-down or lift-off; jumps: \
         between stance and swing"
            .to_owned(),
    );
    lines
}

fn asked_for(request: &CycleRequest) -> Value {
    json!({
        "speed": request.speed,
        "period": request.period,
        "overlay": request.overlay,
        "swing": request.swing,
        "stance": request.stance,
        "height": request.height,
    })
}

fn comparison(request: &CycleRequest, rows: &[Row]) -> Value {
    let entry = |row: &Row| {
        let mut entry = json!({ "preset": row.cycle.preset().name() });
        for (name, value) in COMPARED[1..].iter().zip(numbers(row)) {
            entry[*name] = json!(value);
        }
        entry
    };
    let mut document = asked_for(request);
    document["presets"] = rows.iter().map(entry).collect();
    document
}
