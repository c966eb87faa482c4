//! `canter node`: axis nodes in this process.

use crate::arguments::{DriveKind, Node};
use crate::context::{Context, on_signal};
use anyhow::{Result, bail};
use canter::node::{Trace, run as run_node};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

pub fn run(context: &Context, arguments: &Node) -> Result<()> {
    if context.is_simulated() {
        bail!("a node needs a bus that others can reach: name one with --can, such as vcan0");
    }
    let DriveKind::Simulated = arguments.drive;
    let stop = Arc::new(AtomicBool::new(false));
    on_signal(Arc::clone(&stop))?;
    let mut bus = context.open()?;
    let trace = match &arguments.trace {
        Some(path) => Some(Trace::create(path)?),
        None => None,
    };
    eprintln!(
        "running {} axes on {}; end with Ctrl-C",
        arguments.axes.0.len(),
        bus.description()
    );
    let summary = run_node(&mut bus, &arguments.axes.0, &context.robot, trace, &stop)?;
    eprintln!(
        "ran {} ticks, {} of them more than 1 ms late, the latest by {} us; {} frames not sent",
        summary.ticks, summary.late, summary.latest, summary.unsent
    );
    Ok(())
}
