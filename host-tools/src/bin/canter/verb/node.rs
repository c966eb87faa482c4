//! `canter node`: axis nodes in this process.

use crate::arguments::{BusAddress, Node};
use crate::context::{Context, on_signal};
use anyhow::{Result, bail};
use canter::bus::{Address, Bus};
use canter::node::{Origin, StoreFile, Trace, advice, run as run_node, values_of};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

pub fn run(context: &Context, arguments: &Node) -> Result<()> {
    if context.is_simulated() {
        bail!("a node needs a bus that others can reach: name one with --can, such as vcan0");
    }
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
    let origin = Origin {
        robot: &context.robot,
        store: store.as_ref(),
        drive: arguments.drive.map(Into::into),
    };
    let values = values_of(named, origin)?;
    let axes: Vec<_> = values.iter().map(|(axis, _)| *axis).collect();
    if axes != *named {
        let ids: Vec<_> = axes.iter().map(ToString::to_string).collect();
        eprintln!("axes {}, as the store keeps them", ids.join(","));
    }
    for words in advice(&values) {
        eprintln!("{words}");
    }
    let mut drives = match &arguments.drive_can {
        Some(BusAddress(address)) => Some(open_drives(context, address)?),
        None => None,
    };
    let drives = drives.as_mut().map(|bus| bus.as_mut() as &mut dyn Bus);
    eprintln!(
        "running {} axes on {}; end with Ctrl-C",
        axes.len(),
        bus.description()
    );
    let summary = run_node(&mut bus, drives, named, origin, trace, &stop)?;
    eprintln!(
        "ran {} ticks, {} of them more than 1 ms late, the latest by {} us; {} frames not sent",
        summary.ticks, summary.late, summary.latest, summary.unsent
    );
    if summary.lost_of_drives > 0 {
        eprintln!(
            "{} frames to or from the drives were lost",
            summary.lost_of_drives
        );
    }
    Ok(())
}

/// The bus of the drives, which must be another one than the hosts'.
fn open_drives(context: &Context, address: &Address) -> Result<Box<dyn Bus>> {
    if *address == context.address {
        bail!(
            "--drive-can and --can name the same bus, where ids would collide: give the drives their own"
        );
    }
    if *address == Address::Simulated {
        bail!("--drive-can: the simulated robot has its drives inside; name a bus, such as vcan1");
    }
    Ok(address.open()?)
}
