//! `canter enable`, `disable` and `clear`.

use super::status;
use crate::commander::while_held;
use crate::context::{Context, resolve};
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
    while_held(&mut client, &axes, |client| {
        match change {
            Change::Enable => client.enable(&axes)?,
            Change::Disable => client.disable(&axes)?,
            Change::Clear => client.clear(&axes)?,
        }
        Ok(())
    })?;
    status::print(context, &client, &axes);
    Ok(())
}
