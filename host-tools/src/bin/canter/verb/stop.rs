//! `canter stop` and `estop`: anybody may.

use super::status;
use crate::context::{Context, resolve, tell_complaints};
use anyhow::Result;
use canter::notation::AxisList;

pub fn run(context: &Context, list: &AxisList) -> Result<()> {
    let mut client = context.client()?;
    let axes = resolve(&mut client, list)?;
    client.stop(&axes)?;
    tell_complaints(&mut client);
    status::print(context, &client, &axes);
    Ok(())
}

pub fn emergency(context: &Context, list: &AxisList) -> Result<()> {
    let mut client = context.client()?;
    let axes = match list {
        AxisList::All => None,
        AxisList::These(axes) => Some(axes.as_slice()),
    };
    // Nothing is asked first: the stop goes out at once.
    client.emergency_stop(axes)?;
    tell_complaints(&mut client);
    let stopped: Vec<_> = match axes {
        Some(axes) => axes.to_vec(),
        None => client.axes().keys().copied().collect(),
    };
    status::print(context, &client, &stopped);
    Ok(())
}
