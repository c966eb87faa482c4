//! `canter enable`, `disable` and `clear`.

use super::status;
use crate::context::{Context, resolve, tell_complaints};
use anyhow::Result;
use canter::notation::AxisList;

/// What is to become of the axes.
#[derive(Clone, Copy)]
pub enum Change {
    Enable,
    Disable,
    Clear,
}

pub fn run(context: &Context, change: Change, list: &AxisList) -> Result<()> {
    let mut client = context.client()?;
    let axes = resolve(&mut client, list)?;
    client.check(&axes)?;
    client.hold(&axes)?;
    let changed = match change {
        Change::Enable => client.enable(&axes),
        Change::Disable => client.disable(&axes),
        Change::Clear => client.clear(&axes),
    };
    let released = client.release();
    tell_complaints(&mut client);
    changed?;
    released?;
    status::print(context, &client, &axes);
    Ok(())
}
