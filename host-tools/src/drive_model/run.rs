//! Drives on a bus, in real time.

use super::{Seen, Station, Trouble};
use crate::bus::{Bus, BusError, Event};
use canter_shared::time::{BusTime, MICROSECONDS_PER_TICK};
use std::sync::atomic::{AtomicBool, Ordering};

/// Ticks that are made up for at once; a machine that was busy for longer has stopped its drives.
const MOST_LATE: u64 = 50;

/// Runs drives on `bus` until `stop` is set, and says what happens to them.
///
/// # Errors
/// The bus failed.
pub fn run(
    bus: &mut impl Bus,
    stations: &mut [Station],
    stop: &AtomicBool,
    mut tell: impl FnMut(&str),
) -> Result<(), BusError> {
    let mut seen: Vec<Seen> = stations.iter().map(Station::seen).collect();
    let mut next = bus.now().0;
    while !stop.load(Ordering::Relaxed) {
        while let Some(received) = bus.receive(BusTime(next))? {
            if let Event::Frame(frame) = received.event {
                for station in &mut *stations {
                    station.receive(&frame);
                }
                send(bus, stations)?;
            }
            // It came after the tick was due.
            if received.time.0 >= next {
                break;
            }
        }
        let late = bus.now().0.saturating_sub(next) / MICROSECONDS_PER_TICK;
        if late > MOST_LATE {
            next += (late - MOST_LATE) * MICROSECONDS_PER_TICK;
        }
        next += MICROSECONDS_PER_TICK;
        for (station, before) in stations.iter_mut().zip(&mut seen) {
            let node = station.node();
            if let Some(trouble) = station.tick() {
                tell(&format!("drive {node}: {}", words(trouble)));
            }
            let now = station.seen();
            if now.enabled != before.enabled {
                let what = if now.enabled { "enabled" } else { "disabled" };
                tell(&format!("drive {node}: {what} at {:.4} turn", now.position));
            }
            if now.faulted && !before.faulted {
                tell(&format!("drive {node}: stopped by a fault"));
            }
            *before = now;
        }
        send(bus, stations)?;
    }
    Ok(())
}

fn words(trouble: Trouble) -> &'static str {
    match trouble {
        Trouble::Fault => "its supply is too low",
        Trouble::Reboot => "its power goes and comes",
        Trouble::Silence => "nobody hears it any more",
        Trouble::Deaf => "it hears nobody any more",
        Trouble::DropOut => "it stops by itself",
    }
}

fn send(bus: &mut impl Bus, stations: &mut [Station]) -> Result<(), BusError> {
    for station in stations {
        while let Some(frame) = station.poll_transmit() {
            match bus.send(&frame) {
                // As on a real bus that is too full: it is lost.
                Ok(()) | Err(BusError::SendQueueFull { .. }) => {}
                Err(error) => return Err(error),
            }
        }
    }
    Ok(())
}
