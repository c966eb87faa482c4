//! What hosts said, once more, at the times they said it.
//!
//! A log's SYNCs carry its bus time, and its triggers and streams name it, so a replay makes the same motion
//! wherever the nodes follow its SYNCs: on a robot that no other host is leading.

use std::sync::atomic::{AtomicBool, Ordering};

use canter_shared::time::BusTime;
use canter_shared::wire::command::Command;
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId};
use canter_shared::wire::layout::Sender;
use canter_shared::wire::report::Report;
use std::collections::BTreeMap;
use thiserror::Error;

use super::decode::decode;
use crate::bus::{Bus, BusError, Event};

/// The longest time that an interrupt goes unseen, in microseconds.
const LOOK: u64 = 10_000;

/// Number of the stop that an interrupt sends: any will do.
const STOP: u8 = 1;

/// How a replay went.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Replayed {
    /// Frames that were sent.
    pub frames: u64,
    /// How late the latest of them was handed to the bus, in microseconds.
    pub latest: u64,
    /// Where each axis that was heard was last, in rad.
    pub positions: BTreeMap<AxisId, f64>,
}

/// Why a replay ended early.
#[derive(Debug, Error)]
pub enum ReplayError {
    /// The bus would not go on.
    #[error("after {frames} frames of the log: {source}")]
    Bus {
        /// Frames that were sent before.
        frames: u64,
        /// What it says.
        source: BusError,
    },
    /// Somebody asked for the end; the axes were told to stop.
    #[error("interrupted after {frames} frames of the log; all axes were told to stop")]
    Interrupted {
        /// Frames that were sent before.
        frames: u64,
    },
}

/// Whether a frame is one that a host sends: nodes answer those themselves, so what they said is not said
/// again.
pub fn is_of_a_host(frame: &Frame) -> bool {
    decode(frame).is_some_and(|decoded| decoded.sender == Sender::Host)
}

/// Sends the hosts' frames of a log on `bus`, each as long after the first as it was. Frames must be in the
/// order of their times; one that is earlier than the one before is sent right after it.
///
/// # Errors
/// The bus does not go on, or `interrupt` was set: then every axis is told to stop.
pub fn replay(
    bus: &mut dyn Bus,
    frames: &[(BusTime, Frame)],
    interrupt: &AtomicBool,
) -> Result<Replayed, ReplayError> {
    let mut replayed = Replayed::default();
    let begin = bus.now();
    let first = frames.first().map_or(begin, |(time, _)| *time);
    for (time, frame) in frames.iter().filter(|(_, frame)| is_of_a_host(frame)) {
        let due = BusTime(begin.0 + time.0.saturating_sub(first.0));
        let failed = |frames| move |source| ReplayError::Bus { frames, source };
        listen(bus, due, interrupt, &mut replayed)?;
        bus.send(frame).map_err(failed(replayed.frames))?;
        replayed.latest = replayed.latest.max(bus.now().0.saturating_sub(due.0));
        replayed.frames += 1;
    }
    // Whatever followed the last command of a host belongs to it.
    let last = frames.last().map_or(first, |(time, _)| *time);
    let end = BusTime(begin.0 + last.0.saturating_sub(first.0));
    listen(bus, end, interrupt, &mut replayed)?;
    Ok(replayed)
}

/// Hears what nodes say until `until`.
fn listen(
    bus: &mut dyn Bus,
    until: BusTime,
    interrupt: &AtomicBool,
    replayed: &mut Replayed,
) -> Result<(), ReplayError> {
    let frames = replayed.frames;
    let failed = |source| ReplayError::Bus { frames, source };
    loop {
        if interrupt.load(Ordering::Relaxed) {
            let stop = Command::Stop { sequence: STOP }.encode(Address::All);
            if let Ok(stop) = stop {
                bus.send(&stop).map_err(failed)?;
            }
            return Err(ReplayError::Interrupted { frames });
        }
        let look = BusTime(until.0.min(bus.now().0 + LOOK));
        let received = bus.receive(look).map_err(failed)?;
        match received.map(|received| received.event) {
            Some(Event::Frame(frame)) => {
                if let Ok(Some((axis, Report::Feedback { position, .. }))) = Report::decode(&frame)
                {
                    replayed.positions.insert(axis, position.radians());
                }
            }
            Some(Event::Error(_)) => {}
            None if bus.now() >= until => return Ok(()),
            None => {}
        }
    }
}
