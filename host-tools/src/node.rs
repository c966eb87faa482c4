//! Axis nodes in a host process, in real time, from the firmware's own core.
//!
//! | file | what it holds |
//! |---|---|
//! | `store`, `file_flash` | parameters in a file |
//! | `trace` | every setpoint as CSV |
//! | `advice` | what is worth to be known about the drives |

mod advice;
mod file_flash;
mod store;
mod trace;

pub use advice::advice;
pub use store::{StoreFile, StoreFileError};
pub use trace::{Trace, TraceError};

use crate::bus::{Bus, BusError, ErrorEvent, Event};
use crate::robot::Robot;
use canter_shared::drive::link::DriveLink;
use canter_shared::drive::settings::DriveKind;
use canter_shared::node::{Board, BusEvent, Identity, Node, NodeError};
use canter_shared::parameter::{Parameter, ParameterError, Values};
use canter_shared::time::{BusTime, LocalTime};
use canter_shared::wire::id::AxisId;
use std::collections::hash_map::RandomState;
use std::hash::{BuildHasher, Hasher};
use std::sync::atomic::{AtomicBool, Ordering};
use store::Kept;

/// Frames taken in a row before the tick is looked at again.
const FRAMES_IN_A_ROW: usize = 64;

/// Why a node ended.
#[derive(Debug, thiserror::Error)]
pub enum HostNodeError {
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// The axes cannot be what was asked for.
    #[error(transparent)]
    Node(#[from] NodeError),
    /// The store keeps something else.
    #[error(transparent)]
    Store(#[from] StoreFileError),
    /// An axis cannot have this drive.
    #[error("axis {axis} cannot have this drive: {source}")]
    Drive {
        /// The axis.
        axis: AxisId,
        /// Why not.
        source: ParameterError,
    },
    /// A drive has no bus.
    #[error(
        "axis {axis} has a drive of its own: name the drives' bus with --drive-can, such as vcan1"
    )]
    NoDriveBus {
        /// The axis.
        axis: AxisId,
    },
    /// The trace cannot be written.
    #[error(transparent)]
    Trace(#[from] TraceError),
}

/// What a node did while it ran.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Summary {
    /// Ticks run.
    pub ticks: u64,
    /// Ticks that ran more than 1 ms late: the machine was busy elsewhere.
    pub late: u64,
    /// The latest tick, in microseconds.
    pub latest: u64,
    /// Frames that the bus did not take.
    pub unsent: u64,
    /// Frames that the drives' bus did not take, or lost on the way in.
    pub lost_of_drives: u64,
}

type HostNode = Node<DriveLink, { store::AXES }>;

/// A chip id that no other process has: two nodes with one axis id must be told apart.
fn chip() -> [u8; 12] {
    let random = || RandomState::new().build_hasher().finish().to_le_bytes();
    let mut chip = [0; 12];
    for (byte, from) in chip.iter_mut().zip(random().into_iter().chain(random())) {
        *byte = from;
    }
    chip
}

/// Where the parameters of a node come from, and where they are kept.
#[derive(Debug, Clone, Copy)]
pub struct Origin<'run> {
    /// What the axes are, where nothing is kept.
    pub robot: &'run Robot,
    /// Where it is kept; without it, a save is kept as long as the process lives.
    pub store: Option<&'run StoreFile>,
    /// What drives the axes have, whatever is kept.
    pub drive: Option<DriveKind>,
}

/// The axes that a node is going to have, with their parameters: those that the store keeps, with the ids
/// that it keeps, or else `axes`.
///
/// # Errors
/// The store keeps another number of them than `axes` names, or one cannot have the drive.
pub fn values_of(
    axes: &[AxisId],
    origin: Origin<'_>,
) -> Result<Vec<(AxisId, Values)>, HostNodeError> {
    let mut values: Vec<_> = match origin.store.map(|store| (store, store.kept())) {
        Some((store, Kept::Axes(kept))) if kept.len() != axes.len() => {
            return Err(store.wrong_count(kept.len(), axes.len()).into());
        }
        Some((_, Kept::Axes(kept))) => kept.clone(),
        _ => {
            let of_robot = axes.iter().map(|axis| (*axis, origin.robot.values(*axis)));
            of_robot.collect()
        }
    };
    if let Some(kind) = origin.drive {
        let raw = u8::from(kind).into();
        for (axis, values) in &mut values {
            let changed = values.with(Parameter::DriveKind, raw);
            let (changed, _) = changed.map_err(|source| HostNodeError::Drive {
                axis: *axis,
                source,
            })?;
            *values = changed;
        }
    }
    Ok(values)
}

/// A node with its axes.
fn assemble(axes: &[AxisId], origin: Origin<'_>) -> Result<Box<HostNode>, HostNodeError> {
    // On the heap: room for all axes is too much for a stack.
    let mut node: Box<HostNode> = Box::new(Node::new(Identity {
        chip: chip(),
        firmware: crate::version(),
        board: Board::Host,
    }));
    for (axis, values) in values_of(axes, origin)? {
        let link = DriveLink::new(&values.drive());
        node.add_axis_with_values(axis, &values, link)?;
    }
    if origin
        .store
        .is_some_and(|store| *store.kept() == Kept::Lost)
    {
        node.lose_parameters();
    }
    Ok(node)
}

/// Runs nodes for `axes` on `bus`, with their drives on `drives`, until `stop` is set.
///
/// # Errors
/// A bus or the trace failed, or the axes are not possible.
pub fn run(
    bus: &mut impl Bus,
    mut drives: Option<&mut dyn Bus>,
    axes: &[AxisId],
    origin: Origin<'_>,
    mut trace: Option<Trace>,
    stop: &AtomicBool,
) -> Result<Summary, HostNodeError> {
    let mut node = assemble(axes, origin)?;
    let mut with_drives = node
        .axes()
        .filter(|axis| drives.is_none() && axis.values().drive().kind != DriveKind::Simulated);
    if let Some(axis) = with_drives.next() {
        return Err(HostNodeError::NoDriveBus { axis: axis.id() });
    }
    drop(with_drives);
    let mut summary = Summary::default();
    while !stop.load(Ordering::Relaxed) {
        if let Some(drives) = drives.as_deref_mut() {
            hear_drives(&mut node, drives, &mut summary)?;
        }
        let now = LocalTime(bus.now().0);
        run_due_ticks(&mut node, bus, now, &mut trace, &mut summary)?;
        // First: a setpoint is for its tick.
        if let Some(drives) = drives.as_deref_mut() {
            lead_drives(&mut node, drives, &mut summary)?;
        }
        save(&mut node, origin.store);
        transmit(&mut node, bus, now, &mut summary)?;
        // The node's clock is the bus's own: its local time is what the bus shows.
        let mut until = BusTime(node.next_tick().0);
        for _ in 0..FRAMES_IN_A_ROW {
            let Some(received) = bus.receive(until)? else {
                break;
            };
            let at = LocalTime(received.time.0);
            // A process that was held up makes good for it in the order of time: a knot that finds ticks
            // undone would find no room, and the next one a gap.
            run_due_ticks(&mut node, bus, at, &mut trace, &mut summary)?;
            match received.event {
                Event::Frame(frame) => {
                    node.handle_frame(at, &frame);
                    node.plan();
                }
                Event::Error(error) => count(&mut node, &error),
            }
            // What else is there is taken at once, then answered.
            until = BusTime(0);
        }
    }
    if let Some(trace) = &mut trace {
        trace.flush()?;
    }
    Ok(summary)
}

/// Does the ticks that are due by `until`. Each is told when it really ran: hosts see by that how late it was.
fn run_due_ticks(
    node: &mut HostNode,
    bus: &mut impl Bus,
    until: LocalTime,
    trace: &mut Option<Trace>,
    summary: &mut Summary,
) -> Result<(), HostNodeError> {
    loop {
        let due = node.next_tick();
        if until < due {
            return Ok(());
        }
        let now = LocalTime(bus.now().0);
        if due.0 > 0 {
            let late = now.since(due);
            summary.latest = summary.latest.max(late);
            summary.late += u64::from(late > 1_000);
        }
        summary.ticks += 1;
        let setpoints = node.tick(now);
        if let Some(trace) = trace {
            trace.write(setpoints)?;
        }
        node.plan();
    }
}

/// Takes what the drives have said. A tick is as often as it is looked at, so nobody waits for it.
fn hear_drives(
    node: &mut HostNode,
    drives: &mut dyn Bus,
    summary: &mut Summary,
) -> Result<(), HostNodeError> {
    while let Some(received) = drives.receive(BusTime(0))? {
        match received.event {
            Event::Frame(frame) => node.handle_drive_frame(&frame),
            Event::Error(ErrorEvent::LostReception(count)) => {
                summary.lost_of_drives += u64::from(count.unwrap_or(1));
            }
            // A drive that is not heard because of it is lost, which its axis finds.
            Event::Error(_) => {}
        }
    }
    Ok(())
}

fn lead_drives(
    node: &mut HostNode,
    drives: &mut dyn Bus,
    summary: &mut Summary,
) -> Result<(), HostNodeError> {
    while let Some(frame) = node.poll_drive_transmit() {
        match drives.send(&frame) {
            Ok(()) => {}
            Err(BusError::SendQueueFull { .. }) => summary.lost_of_drives += 1,
            Err(error) => return Err(error.into()),
        }
    }
    Ok(())
}

/// Hands over what is to be saved, and takes back what has been.
fn save(node: &mut HostNode, store: Option<&StoreFile>) {
    if let Some(image) = node.take_save() {
        let begun = store.map(|store| store.save(image.clone()));
        match begun {
            Some(true) => {}
            Some(false) => node.saved(&image, false),
            // It outlives nothing, and neither does the process.
            None => node.saved(&image, true),
        }
    }
    while let Some((image, kept)) = store.and_then(StoreFile::finished) {
        node.saved(&image, kept);
    }
}

fn transmit(
    node: &mut HostNode,
    bus: &mut impl Bus,
    now: LocalTime,
    summary: &mut Summary,
) -> Result<(), HostNodeError> {
    while let Some(frame) = node.poll_transmit(now) {
        match bus.send(&frame) {
            Ok(()) => {}
            // The axes go on without: their host will miss them and stop beating.
            Err(BusError::SendQueueFull { .. }) => summary.unsent += 1,
            Err(error) => return Err(error.into()),
        }
    }
    Ok(())
}

fn count(node: &mut HostNode, error: &ErrorEvent) {
    match error {
        ErrorEvent::BusOff => node.count(BusEvent::BusOff),
        ErrorEvent::LostReception(_) => node.count(BusEvent::LostReception),
        ErrorEvent::ErrorPassive | ErrorEvent::Other(_) => node.count(BusEvent::ErrorFrame),
        ErrorEvent::Restarted => {}
    }
}
