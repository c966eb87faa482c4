//! `canter zero`: where axes are becomes a position of one's choice.

use crate::arguments::Zero;
use crate::commander::while_held;
use crate::context::{Context, resolve};
use anyhow::{Result, anyhow};
use canter::client::Change;
use canter_shared::parameter::Parameter;
use canter_shared::wire::id::AxisId;
use serde_json::json;

/// What became of one axis.
struct Zeroed {
    axis: AxisId,
    /// Before and after, in rad.
    offsets: [f64; 2],
    position: f64,
}

pub fn run(context: &Context, arguments: &Zero) -> Result<()> {
    let mut client = context.client()?;
    let axes = resolve(&mut client, &arguments.axes)?;
    client.check(&axes)?;
    client.listen()?;
    let zeroed = while_held(&mut client, &axes, |client| {
        let mut changes = Vec::new();
        let mut offsets = Vec::new();
        for axis in axes.iter().copied() {
            let known = client.axes().get(&axis).and_then(|known| known.position);
            let position = known
                .ok_or_else(|| anyhow!("axis {axis} does not tell where it is: check its drive"))?;
            let readings = client.read_parameters(axis, &[Parameter::DriveOffset])?;
            let raw = readings.first().map_or(0, |(_, reading)| reading.value);
            let before = Parameter::DriveOffset.in_unit(raw);
            let after = before + arguments.at - position.radians();
            changes.push(Change {
                axis,
                parameter: Parameter::DriveOffset,
                raw: raw_offset(axis, after)?,
            });
            offsets.push([before, after]);
        }
        // All or none: a leg with one joint zeroed is worse than one with none.
        client.write_parameters(&changes)?;
        if arguments.save {
            client.save_parameters(&axes)?;
        }
        // Links to drives begin anew with another offset.
        client.listen()?;
        let position = |axis| client.axes().get(axis).and_then(|known| known.position);
        let zeroed = axes.iter().zip(offsets).map(|(axis, offsets)| Zeroed {
            axis: *axis,
            offsets,
            position: position(axis).unwrap_or_default().radians(),
        });
        Ok(zeroed.collect::<Vec<_>>())
    })?;
    print(context, &zeroed, arguments.save);
    Ok(())
}

/// The offset as the axis keeps it.
fn raw_offset(axis: AxisId, offset: f64) -> Result<i64> {
    let (least, most) = Parameter::DriveOffset.range();
    let in_rad = |raw| Parameter::DriveOffset.in_unit(raw);
    Parameter::DriveOffset.nearest(offset).ok_or_else(|| {
        anyhow!(
            "{} of axis {axis} would be {offset} rad: it must be from {} to {} rad; bring the drive \
             nearer to its own zero",
            Parameter::DriveOffset.entry().name,
            in_rad(least),
            in_rad(most),
        )
    })
}

fn print(context: &Context, zeroed: &[Zeroed], saved: bool) {
    let documents = zeroed.iter().map(|zeroed| {
        json!({
            "axis": zeroed.axis.get(),
            "position": zeroed.position,
            "offset": zeroed.offsets[1],
            "offset_before": zeroed.offsets[0],
        })
    });
    context.print_json(&json!({ "axes": documents.collect::<Vec<_>>(), "saved": saved }));
    if context.json {
        return;
    }
    println!("axis  position rad  offset rad  before rad");
    for zeroed in zeroed {
        println!(
            "{:>4}  {:>12.6}  {:>10.6}  {:>10.6}",
            zeroed.axis, zeroed.position, zeroed.offsets[1], zeroed.offsets[0],
        );
    }
    if !saved {
        eprintln!("not kept over a reset: add --save, or run `canter param save`");
    }
}
