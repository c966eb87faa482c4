//! `canter node`: axis nodes in this process.

use crate::arguments::{DriveKind, Node};
use crate::context::{Context, on_signal};
use anyhow::{Result, bail};
use canter::node::{Origin, StoreFile, Trace, axes_of, run as run_node};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

pub fn run(context: &Context, arguments: &Node) -> Result<()> {
    if context.is_simulated() {
        bail!("a node needs a bus that others can reach: name one with --can, such as vcan0");
    }
    let DriveKind::Simulated = arguments.drive;
    let stop = Arc::new(AtomicBool::new(false));
    on_signal(Arc::clone(&stop))?;
    let mut bus = context.open(context.bitrate())?;
    let trace = match &arguments.trace {
        Some(path) => Some(Trace::create(path)?),
        None => None,
    };
    let store = match &arguments.store {
        Some(path) => Some(StoreFile::open(path)?),
        None => None,
    };
    let named = &arguments.axes.0;
    let axes = axes_of(named, store.as_ref())?;
    if axes != *named {
        let ids: Vec<_> = axes.iter().map(ToString::to_string).collect();
        eprintln!("axes {}, as the store keeps them", ids.join(","));
    }
    eprintln!(
        "running {} axes on {}; end with Ctrl-C",
        axes.len(),
        bus.description()
    );
    let origin = Origin {
        robot: &context.robot,
        store: store.as_ref(),
    };
    let summary = run_node(&mut bus, named, origin, trace, &stop)?;
    eprintln!(
        "ran {} ticks, {} of them more than 1 ms late, the latest by {} us; {} frames not sent",
        summary.ticks, summary.late, summary.latest, summary.unsent
    );
    Ok(())
}
