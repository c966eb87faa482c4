//! `canter demo`.
use crate::arguments::Demo;
use crate::context::Context;
use anyhow::Result;
pub fn run(_context: &Context, _arguments: &Demo) -> Result<()> {
    anyhow::bail!("not yet")
}
