//! How far apart the axes of a simulated robot leave, in true time.

use std::cell::RefCell;
use std::rc::Rc;

use canter::client::{Client, Goal, MoveRequest, Overrides, Target};
use canter::robot::Robot;
use canter::sim::{Configuration, Observer, SimulatedBus, TrueTime};
use canter_shared::node::AxisSetpoint;
use canter_shared::wire::command::ProfileKind;

#[derive(Default)]
struct Ticks {
    ticks: std::collections::BTreeMap<u64, (u64, u64, u32)>,
}

impl Observer for Ticks {
    fn setpoint(&mut self, time: TrueTime, setpoint: &AxisSetpoint) {
        let entry = self.ticks.entry(setpoint.tick.0).or_insert((u64::MAX, 0, 0));
        entry.0 = entry.0.min(time.0);
        entry.1 = entry.1.max(time.0);
        entry.2 += 1;
    }
}

#[test]
fn proto() {
    let robot = Robot::default();
    let count: u64 = std::env::var("SEEDS").map_or(20, |s| s.parse().unwrap());
    let mut skews = Vec::new();
    let mut later = Vec::new();
    let begin = std::time::Instant::now();
    let mut virtual_time = 0.0;
    for seed in 0..count {
        let configuration = Configuration { seed, ..Configuration::default() };
        let mut bus = SimulatedBus::new(&configuration);
        let ticks = Rc::new(RefCell::new(Ticks::default()));
        bus.observe(ticks.clone());
        let mut client = Client::new(bus, 7);
        let axes: Vec<_> = configuration.axes.iter().map(|a| a.id).collect();
        client.hold(&axes).unwrap();
        client.enable(&axes).unwrap();
        let rounds: usize = std::env::var("ROUNDS").map_or(1, |s| s.parse().unwrap());
        for round in 0..rounds {
            let goals = axes.iter().map(|axis| Goal { axis: *axis, target: Target::Absolute(if round % 2 == 0 { 0.05 } else { 0.0 }) }).collect();
            let request = MoveRequest { goals, profile: ProfileKind::Beta, duration: Some(0.06), limits: Overrides::default(), independent: false };
            let arrivals = client.move_together(&robot, &request, |_| {}).unwrap();
            let start = (arrivals[0].start.0 + 500) / 1000;
            let (least, most, n) = ticks.borrow().ticks[&start];
            assert_eq!(n, 12);
            if round == 0 { skews.push(most - least); } else { later.push(most - least); if most - least > 19000 { println!("seed {seed} round {round} tick {start} {}", most - least); } }
            if round == 0 && seed < 5 {
            println!("seed {seed} start {start} skew {} offset {} reported {:?}", most - least, least as i64 - start as i64 * 1_000_000, arrivals.iter().map(|a| a.skew_microseconds).max()); }
        }
        virtual_time += client.now().0 as f64 / 1e6;
    }
    for (name, list) in [("first", &mut skews), ("later", &mut later)] {
        if list.is_empty() { continue; }
        list.sort();
        let p = |q: f64| list[((list.len() - 1) as f64 * q) as usize];
        println!("{name}: n {} median {} 90 {} 99 {} max {}", list.len(), p(0.5), p(0.9), p(0.99), p(1.0));
    }
    println!("{virtual_time} s in {:?}", begin.elapsed());
}

#[test]
fn series() {
    let seed: u64 = std::env::var("SEED").map_or(1, |s| s.parse().unwrap());
    let length: u64 = std::env::var("LENGTH").map_or(5_000, |s| s.parse().unwrap());
    let configuration = Configuration { seed, ..Configuration::default() };
    let robot = Robot::default();
    let mut bus = SimulatedBus::new(&configuration);
    let ticks = Rc::new(RefCell::new(Ticks::default()));
    bus.observe(ticks.clone());
    let mut client = Client::new(bus, 7);
    let axes: Vec<_> = configuration.axes.iter().map(|a| a.id).collect();
    client.hold(&axes).unwrap();
    client.enable(&axes).unwrap();
    let mut round = 0;
    while client.now().0 < length * 1000 {
        let goals = axes.iter().map(|axis| Goal { axis: *axis, target: Target::Absolute(if round % 2 == 0 { 0.05 } else { 0.0 }) }).collect();
        let request = MoveRequest { goals, profile: ProfileKind::Beta, duration: Some(0.06), limits: Overrides::default(), independent: false };
        client.move_together(&robot, &request, |_| {}).unwrap();
        round += 1;
    }
    for (tick, (least, most, n)) in &ticks.borrow().ticks {
        if tick % 20 == 0 { println!("tick {tick} least {} most {} spread {} n {n}", *least as i64 - *tick as i64 * 1_000_000, *most as i64 - *tick as i64 * 1_000_000, most - least); }
    }
}
