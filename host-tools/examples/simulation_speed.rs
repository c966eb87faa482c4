//! How fast the simulated robot is: twelve axes that move without a pause, with SYNC, heartbeats
//! and feedback, on one core. Prints simulated seconds per second of the wall clock.
//!
//! `cargo run --release -p canter --example simulation_speed [SECONDS]`

use std::time::Instant;

use canter::bus::Bus;
use canter::sim::{Configuration, SimulatedBus};
use canter_shared::time::{BusTime, Ticks};
use canter_shared::units::Position;
use canter_shared::wire::command::{Action, Command, ProfileKind, wire_position};
use canter_shared::wire::id::{Address, AxisId};

const SESSION: u16 = 0xCA27;

/// Between two SYNCs, in us; each third comes with a heartbeat.
const SYNC_PERIOD: u64 = 20_000;

/// SYNCs from one move to the next: 0.8 s, of which the axis moves 0.75 s.
const MOVE_PERIOD: u64 = 40;

fn main() {
    let seconds = std::env::args()
        .nth(1)
        .map_or(Ok(100), |text| text.parse::<u64>());
    let Ok(seconds) = seconds else {
        eprintln!("usage: simulation_speed [SECONDS], a whole number of simulated seconds");
        std::process::exit(2);
    };
    let mut bus = SimulatedBus::new(&Configuration::default());
    let start = Instant::now();
    let mut frames: u64 = 0;
    for beat in 0..seconds * 1_000_000 / SYNC_PERIOD {
        for (address, command) in commands(beat, bus.now()) {
            let frame = command.encode(address).expect("values in range");
            bus.send(&frame).expect("the bus has room");
        }
        let until = BusTime((beat + 1) * SYNC_PERIOD);
        while bus.receive(until).expect("nothing goes wrong").is_some() {
            frames += 1;
        }
    }
    let elapsed = start.elapsed().as_secs_f64();
    let moving = (0..12).filter(|node| bus.axis(*node).is_some_and(|axis| axis.state().drives()));
    println!(
        "{seconds} s of {} enabled axes in {elapsed:.2} s: {:.0} simulated seconds per second, \
         {frames} frames from the nodes, bus load {:.0} %",
        moving.count(),
        seconds as f64 / elapsed,
        100.0 * bus.load().share(),
    );
}

/// What the host has to say at a SYNC.
fn commands(beat: u64, time: BusTime) -> Vec<(Address, Command)> {
    let counter = beat as u8;
    let mut commands = vec![(Address::All, Command::Sync { counter, time })];
    if beat.is_multiple_of(3) {
        commands.push((Address::All, Command::HostHeartbeat { session: SESSION }));
    }
    // After a second in which the clocks settle.
    let Some(begun) = beat.checked_sub(50) else {
        return commands;
    };
    let sequence = (begun + 1) as u8;
    let control = |action| Command::Control {
        action,
        sequence,
        session: SESSION,
    };
    let command = match begun {
        0 => control(Action::Hold),
        1 => control(Action::Enable),
        _ if begun.is_multiple_of(MOVE_PERIOD) => {
            let there = (begun / MOVE_PERIOD).is_multiple_of(2);
            let target = Position::from_radians(if there { 3.0 } else { -3.0 });
            Command::Move {
                profile: ProfileKind::Beta,
                staged: false,
                target: wire_position(target.expect("in range")),
                duration: Ticks(750),
                sequence,
            }
        }
        _ => return commands,
    };
    commands.extend(
        (1..=12)
            .filter_map(AxisId::new)
            .map(|axis| (axis.into(), command)),
    );
    commands
}
