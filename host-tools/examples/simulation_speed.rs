//! How fast the simulated robot is: twelve axes that move nearly all the time, with SYNC,
//! heartbeats and feedback. Prints simulated seconds per second of the processor, of which it
//! uses one core.
//!
//! `cargo run --release -p canter --example simulation_speed [SECONDS]`

use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

use canter::bus::Bus;
use canter::sim::{
    AxisTick, Configuration, Delivery, Destroyed, Observer, Rates, SimulatedBus, TrueTime,
};
use canter_shared::time::{BusTime, Ticks};
use canter_shared::units::Position;
use canter_shared::wire::command::{Action, Command, ProfileKind, wire_position};
use canter_shared::wire::id::{Address, AxisId};
use nix::time::{ClockId, clock_gettime};

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
    run("nobody looks on", &mut bus, seconds);
    let tally = Rc::new(RefCell::new(Tally::default()));
    let mut bus = SimulatedBus::new(&Configuration {
        disturbances: Rates {
            corrupted: 1_000,
            misread: 1_000,
            doubled: 1_000,
            lost: 1_000,
            ..Rates::default()
        },
        ..Configuration::default()
    });
    bus.observe(Rc::clone(&tally));
    run("observed and disturbed", &mut bus, seconds);
    let tally = tally.borrow();
    println!(
        "observed: {} ticks, {} deliveries, {} frames destroyed, drives off by {:.0} urad at most",
        tally.ticks,
        tally.deliveries,
        tally.destroyed,
        tally.off * 1e6
    );
}

fn run(what: &str, bus: &mut SimulatedBus, seconds: u64) {
    let start = processor_time();
    for beat in 0..seconds * 1_000_000 / SYNC_PERIOD {
        for (address, command) in commands(beat, bus.now()) {
            let frame = command.encode(address).expect("values in range");
            bus.send(&frame).expect("the bus has room");
        }
        let until = BusTime((beat + 1) * SYNC_PERIOD);
        while bus.receive(until).expect("the bus is up").is_some() {}
    }
    let elapsed = (processor_time() - start).as_secs_f64();
    let enabled = |node: &usize| bus.axis(*node).is_some_and(|axis| axis.state().drives());
    println!(
        "{what}: {seconds} s of {} enabled axes in {elapsed:.2} s, {:.0} simulated seconds per \
         second, bus load {:.0} %",
        (0..12).filter(enabled).count(),
        seconds as f64 / elapsed,
        100.0 * bus.load().share(),
    );
}

/// Of this process; the wall clock would count what else the machine does.
fn processor_time() -> Duration {
    let time = clock_gettime(ClockId::CLOCK_PROCESS_CPUTIME_ID);
    time.expect("every Linux has this clock").into()
}

/// Looks at everything, as a checker would.
#[derive(Default)]
struct Tally {
    ticks: u64,
    deliveries: u64,
    destroyed: u64,
    off: f64,
}

impl Observer for Tally {
    fn destroyed(&mut self, _: &Destroyed) {
        self.destroyed += 1;
    }

    fn delivery(&mut self, _: TrueTime, _: &Delivery) {
        self.deliveries += 1;
    }

    fn tick(&mut self, _: TrueTime, tick: &AxisTick<'_>) {
        self.ticks += 1;
        let off = tick.drive.position - tick.setpoint.setpoint.position;
        self.off = self.off.max(off.abs().radians());
    }
}

/// What the host has to say at a SYNC.
fn commands(beat: u64, time: BusTime) -> Vec<(Address, Command)> {
    let counter = beat as u8;
    let mut commands = vec![(Address::All, Command::Sync { counter, time })];
    if beat.is_multiple_of(3) {
        let heartbeat = Command::HostHeartbeat { session: SESSION };
        commands.push((Address::All, heartbeat));
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
    let axes = (1..=12).filter_map(AxisId::new);
    commands.extend(axes.map(|axis| (axis.into(), command)));
    commands
}
