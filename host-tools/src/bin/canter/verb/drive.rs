//! `canter drive`: models of servo drives in this process.

use crate::arguments::Drive;
use crate::context::{Context, on_signal};
use anyhow::{Result, bail};
use canter::drive_model::{Make, Station, model, run as run_drives};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

pub fn run(context: &Context, arguments: &Drive) -> Result<()> {
    if context.is_simulated() {
        bail!("drives need a bus that a node can reach: name one with --can, such as vcan1");
    }
    let make = Make {
        kind: arguments.kind.into(),
        firmware: arguments.firmware.into(),
        watchdog: arguments.watchdog(),
        starts_enabled: arguments.start_enabled,
    };
    let nodes: Vec<u8> = arguments.nodes.0.iter().map(|node| node.get()).collect();
    let troubled = arguments.trouble_node.or(nodes.first().copied());
    if let Some(node) = troubled.filter(|node| !nodes.contains(node)) {
        bail!("--trouble-node {node} is none of the drives of --nodes: name one of them");
    }
    let station = |node: u8| {
        let trials = if troubled == Some(node) {
            arguments.trials()
        } else {
            Vec::new()
        };
        let model = model(&make, node, arguments.position)?;
        Some(Station::new(node, model, trials))
    };
    let stations: Option<Vec<_>> = nodes.iter().map(|node| station(*node)).collect();
    let Some(mut stations) = stations else {
        bail!("a simulated drive is in the node itself: choose --kind odrive, mit or cia402");
    };
    let stop = Arc::new(AtomicBool::new(false));
    on_signal(Arc::clone(&stop))?;
    let mut bus = context.open(context.bitrate())?;
    eprintln!(
        "running {} drives on {}; end with Ctrl-C",
        stations.len(),
        bus.description()
    );
    run_drives(&mut bus, &mut stations, &stop, |words| eprintln!("{words}"))?;
    Ok(())
}
