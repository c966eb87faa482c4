//! `canter param`: what is set about the axes.

use crate::arguments::{Param, ParamAction, ParamSet};
use crate::commander::while_held;
use crate::context::{AnyClient, Context, print_all, resolve, tell_complaints};
use anyhow::{Context as _, Result};
use canter::client::{Change, ClientError, Reading};
use canter::notation::{AxisList, ParameterTextError, parameter_text};
use canter::parameter_file;
use canter_shared::parameter::{Change as When, Kind, Parameter};
use canter_shared::wire::id::{AxisId, Function};
use canter_shared::wire::reason::Reason;
use serde_json::{Value, json};
use std::path::Path;

pub fn run(context: &Context, arguments: &Param) -> Result<()> {
    match &arguments.action {
        ParamAction::Get { parameter, axis } => get(context, parameter.0, *axis),
        ParamAction::List { axis } => list(context, *axis),
        ParamAction::Set(set) => self::set(context, set),
        ParamAction::Save { axis } => commanding(context, axis, |client, axes| {
            client.save_parameters(axes)?;
            told(context, axes, "saved")
        }),
        ParamAction::Restore { axis } => commanding(context, axis, |client, axes| {
            client.restore_parameters(axes)?;
            told(context, axes, "restored")
        }),
        ParamAction::Export { axis, file } => export(context, axis, file.as_deref()),
        ParamAction::Import { file, save } => import(context, file, *save),
    }
}

/// Whether the command line was wrong, rather than that something failed.
pub fn is_usage(error: &anyhow::Error) -> bool {
    error.is::<ParameterTextError>()
}

/// A client that has heard these axes and holds none.
fn listening(context: &Context, axes: &[AxisId]) -> Result<AnyClient> {
    let mut client = context.client()?;
    client.check(axes)?;
    Ok(client)
}

/// Does something with axes that are held meanwhile.
fn commanding(
    context: &Context,
    list: &AxisList,
    work: impl FnOnce(&mut AnyClient, &[AxisId]) -> Result<()>,
) -> Result<()> {
    let mut client = context.client()?;
    let axes = resolve(&mut client, list)?;
    client.check(&axes)?;
    while_held(&mut client, &axes, |client| work(client, &axes))
}

fn get(context: &Context, parameter: Parameter, axis: AxisId) -> Result<()> {
    let mut client = listening(context, &[axis])?;
    let readings = client.read_parameters(axis, &[parameter])?;
    tell_complaints(&mut client);
    let Some((_, reading)) = readings.first() else {
        let refused = ClientError::Refused {
            axis,
            function: Function::ParameterRead,
            reason: Reason::UnknownParameter,
            detail: u8::from(parameter).into(),
        };
        return Err(refused.into());
    };
    context.print_json(&document(parameter, reading));
    if !context.json {
        let unit = parameter.entry().unit;
        let value = parameter_text(parameter, reading.value);
        println!("{value}{}{unit}", if unit.is_empty() { "" } else { " " });
    }
    Ok(())
}

fn list(context: &Context, axis: AxisId) -> Result<()> {
    let mut client = listening(context, &[axis])?;
    let readings = client.read_parameters(axis, &Parameter::ALL)?;
    tell_complaints(&mut client);
    let documents: Vec<_> = readings
        .iter()
        .map(|(parameter, reading)| document(*parameter, reading))
        .collect();
    context.print_json(&json!({ "axis": axis.get(), "parameters": documents }));
    if context.json {
        return Ok(());
    }
    let head = "name                 value               unit     saved               from                to";
    let lines = readings.iter().map(|(parameter, reading)| {
        let entry = parameter.entry();
        let text = |raw| parameter_text(*parameter, raw);
        // Only what differs catches the eye.
        let saved = if reading.saved == reading.value {
            String::new()
        } else {
            text(reading.saved)
        };
        let line = format!(
            "{:<19}  {:<18}  {:<7}  {saved:<18}  {:<18}  {}",
            entry.name,
            text(reading.value),
            entry.unit,
            text(reading.minimum),
            text(reading.maximum),
        );
        line.trim_end().to_owned()
    });
    print_all(std::iter::once(head.to_owned()).chain(lines))
}

fn document(parameter: Parameter, reading: &Reading) -> Value {
    let entry = parameter.entry();
    let value = |raw| value(parameter, raw);
    let mut document = json!({
        "name": entry.name,
        "value": value(reading.value),
        "unit": entry.unit,
        "min": value(reading.minimum),
        "max": value(reading.maximum),
        "default": value(reading.default),
        "saved": value(reading.saved),
        "changes": match entry.change {
            When::AtRest => "at rest",
            When::Disabled => "while disabled",
        },
        "meaning": entry.meaning,
    });
    if let Kind::Choice(names) = entry.kind {
        document["choices"] = json!(names);
    }
    document
}

/// A number, whole where it is; a choice by its name.
fn value(parameter: Parameter, raw: i64) -> Value {
    match parameter.entry().kind {
        Kind::Choice(_) => json!(parameter_text(parameter, raw)),
        Kind::Number { per_unit } if raw % per_unit == 0 => json!(raw / per_unit),
        Kind::Number { .. } => json!(parameter.in_unit(raw)),
    }
}

fn set(context: &Context, arguments: &ParamSet) -> Result<()> {
    let parameter = arguments.parameter.0;
    let raw = canter::notation::parameter_raw(parameter, &arguments.value)?;
    commanding(context, &arguments.axis, |client, axes| {
        let changes: Vec<_> = axes
            .iter()
            .map(|axis| Change {
                axis: *axis,
                parameter,
                raw,
            })
            .collect();
        client.write_parameters(&changes)?;
        if arguments.save {
            client.save_parameters(axes)?;
        }
        tell_changes(context, &changes, arguments.save);
        Ok(())
    })
}

fn import(context: &Context, file: &Path, save: bool) -> Result<()> {
    let changes = parameter_file::read(file)?;
    let mut axes: Vec<AxisId> = changes.iter().map(|change| change.axis).collect();
    axes.sort_unstable();
    axes.dedup();
    commanding(context, &AxisList::These(axes), |client, axes| {
        client.write_parameters(&changes)?;
        if save {
            client.save_parameters(axes)?;
        }
        tell_changes(context, &changes, save);
        Ok(())
    })
}

fn export(context: &Context, list: &AxisList, file: Option<&Path>) -> Result<()> {
    let mut client = context.client()?;
    let axes = resolve(&mut client, list)?;
    client.check(&axes)?;
    let mut values = Vec::new();
    for axis in axes {
        values.push((axis, client.read_values(axis)?));
    }
    tell_complaints(&mut client);
    let text = parameter_file::format(&values);
    let Some(path) = file else {
        print!("{text}");
        return Ok(());
    };
    std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}

fn tell_changes(context: &Context, changes: &[Change], saved: bool) {
    let documents: Vec<_> = changes
        .iter()
        .map(|change| {
            json!({
                "axis": change.axis.get(),
                "name": change.parameter.entry().name,
                "value": value(change.parameter, change.raw),
                "unit": change.parameter.entry().unit,
            })
        })
        .collect();
    context.print_json(&json!({ "changes": documents, "saved": saved }));
    if context.json {
        return;
    }
    for change in changes {
        let entry = change.parameter.entry();
        let text = parameter_text(change.parameter, change.raw);
        println!(
            "axis {}: {} = {text} {}",
            change.axis, entry.name, entry.unit
        );
    }
}

fn told(context: &Context, axes: &[AxisId], what: &str) -> Result<()> {
    let ids: Vec<u8> = axes.iter().map(|axis| axis.get()).collect();
    context.print_json(&json!({ what: ids }));
    if !context.json {
        for axis in axes {
            println!("axis {axis}: {what}");
        }
    }
    Ok(())
}
