//! How far apart the axes of a simulated robot are in true time: 12 nodes with crystals of
//! +-100 ppm that receive up to 20 us late, under the bus traffic of a real one.

use std::cell::RefCell;
use std::rc::Rc;

use canter::bus::{Bus, BusError, Received};
use canter::client::{Arrival, Client, Goal, MoveRequest, Overrides, Target};
use canter::robot::Robot;
use canter::sim::{Configuration, Observer, SimulatedBus, TrueTime};
use canter_shared::node::{AxisSetpoint, TICK_LEAD};
use canter_shared::time::BusTime;
use canter_shared::wire::command::{Command, ProfileKind};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::AxisId;
use canter_tests::measurement;

/// Moves of robots that were just switched on, and bounds in nanoseconds.
const MOVES: u64 = 1_000;
const SKEW: u64 = 20_000;
const LOCK: u64 = 20_000;
const AFTER_SILENCE: u64 = 100_000;

/// No move of a fresh robot begins before this tick.
const FIRST_MOVE: u64 = 350;

/// Nanoseconds of a tick.
const TICK: u64 = 1_000_000;

/// When the axes ran each tick, in nanoseconds.
#[derive(Debug, Clone, Copy)]
struct Ran {
    tick: u64,
    first: u64,
    last: u64,
    axes: usize,
}

impl Ran {
    fn spread(self) -> u64 {
        self.last - self.first
    }
}

#[derive(Default)]
struct Ticks(Vec<Ran>);

impl Observer for Ticks {
    fn setpoint(&mut self, time: TrueTime, setpoint: &AxisSetpoint) {
        let (tick, time) = (setpoint.tick.0, time.0);
        // An axis's tick comes soon after the others' or is a new one.
        match self.0.iter_mut().rev().take(4).find(|ran| ran.tick == tick) {
            Some(ran) => {
                ran.first = ran.first.min(time);
                ran.last = ran.last.max(time);
                ran.axes += 1;
            }
            None => self.0.push(Ran {
                tick,
                first: time,
                last: time,
                axes: 1,
            }),
        }
    }
}

/// The simulated bus, on which the host's SYNCs can be lost.
struct Filtered {
    bus: SimulatedBus,
    mute: Rc<RefCell<bool>>,
}

impl Bus for Filtered {
    fn now(&self) -> BusTime {
        self.bus.now()
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        let is_sync = matches!(Command::decode(frame), Ok(Some((_, Command::Sync { .. }))));
        if is_sync && *self.mute.borrow() {
            return Ok(());
        }
        self.bus.send(frame)
    }

    fn receive(&mut self, until: BusTime) -> Result<Option<Received>, BusError> {
        self.bus.receive(until)
    }

    fn description(&self) -> String {
        self.bus.description()
    }
}

/// A robot that was just switched on, held and enabled.
struct Fresh {
    client: Client<Filtered>,
    robot: Robot,
    axes: Vec<AxisId>,
    ticks: Rc<RefCell<Ticks>>,
    mute: Rc<RefCell<bool>>,
    moves: usize,
}

impl Fresh {
    fn new(seed: u64) -> Self {
        let configuration = Configuration {
            seed,
            ..Configuration::default()
        };
        let mut bus = SimulatedBus::new(&configuration);
        let ticks = Rc::new(RefCell::new(Ticks::default()));
        bus.observe(Rc::clone(&ticks));
        let mute = Rc::new(RefCell::new(false));
        let bus = Filtered {
            bus,
            mute: Rc::clone(&mute),
        };
        let mut client = Client::new(bus, 0x5CE3);
        let axes: Vec<_> = configuration.axes.iter().map(|axis| axis.id).collect();
        assert_eq!(axes.len(), 12);
        client.hold(&axes).expect("all axes are free");
        client.enable(&axes).expect("the drives are well");
        Self {
            client,
            robot: Robot::default(),
            axes,
            ticks,
            mute,
            moves: 0,
        }
    }

    /// Moves all axes there or back.
    fn go(&mut self, radians: f64, duration: f64) -> Vec<Arrival> {
        self.moves += 1;
        let target = if self.moves % 2 == 1 { radians } else { 0.0 };
        let goals = self.axes.iter().map(|axis| Goal {
            axis: *axis,
            target: Target::Absolute(target),
        });
        let request = MoveRequest {
            goals: goals.collect(),
            profile: ProfileKind::Beta,
            duration: Some(duration),
            limits: Overrides::default(),
            independent: false,
        };
        let moved = self.client.move_together(&self.robot, &request, |_| {});
        moved.expect("the move arrives")
    }

    /// When the axes ran the tick at which a move began.
    fn start(&self, arrivals: &[Arrival]) -> Ran {
        let start = (arrivals[0].start.0 + 500) / 1_000;
        let ticks = self.ticks.borrow();
        let ran = ticks.0.iter().find(|ran| ran.tick == start).copied();
        let ran = ran.expect("the tick is there");
        assert_eq!(ran.axes, self.axes.len(), "{ran:?}");
        // What the nodes report is what happened, but for what they cannot know.
        for arrival in arrivals {
            let reported = arrival.start.0.abs_diff(start * 1_000);
            assert!(reported <= 2, "{arrival:?}");
        }
        ran
    }
}

fn percentile(values: &mut [u64], hundredths: usize) -> u64 {
    values.sort_unstable();
    values[(values.len() * hundredths).div_ceil(100) - 1]
}

fn microseconds(nanoseconds: u64) -> String {
    format!("{:.1} us", nanoseconds as f64 * 1e-3)
}

fn bound(nanoseconds: u64) -> String {
    format!("<= {} us", nanoseconds / 1_000)
}

#[test]
fn the_first_move_of_a_robot_leaves_together_in_true_time() {
    let mut skews: Vec<u64> = (0..MOVES)
        .map(|seed| {
            let mut robot = Fresh::new(seed);
            let arrivals = robot.go(0.05, 0.06);
            robot.start(&arrivals).spread()
        })
        .collect();
    let (usual, most) = (percentile(&mut skews, 50), percentile(&mut skews, 99));
    let what = format!("start skew, median of {MOVES} first moves");
    measurement("soak", &what, &microseconds(usual), "-");
    let what = format!("start skew, 99th percentile of {MOVES} first moves");
    measurement("soak", &what, &microseconds(most), &bound(SKEW));
    assert!(most <= SKEW, "{most} ns");
}

/// For a minute, with one move after the other: then the clock may only give way slowly.
#[test]
fn ticks_stay_locked_to_sync() {
    let (mut farthest, mut skews) = (0, Vec::new());
    for seed in 0..20 {
        let mut robot = Fresh::new(seed);
        while robot.client.now().0 < 60_000_000 {
            let arrivals = robot.go(0.3, 0.8);
            skews.push(robot.start(&arrivals).spread());
        }
        let ticks = robot.ticks.borrow();
        // From the first move on; and the last tick may not be complete.
        let moving = || ticks.0.iter().skip_while(|ran| ran.tick < FIRST_MOVE);
        let ran = || moving().filter(|ran| ran.axes == 12);
        let lead = 1_000 * TICK_LEAD;
        let late = |time: u64, ran: &Ran| (time + lead - ran.tick * TICK) as f64;
        let sum: f64 = ran()
            .map(|ran| late(ran.first, ran) + late(ran.last, ran))
            .sum();
        // All clocks are late by a SYNC's way to the nodes.
        let common = sum / (2 * ran().count()) as f64;
        for ran in ran() {
            for time in [ran.first, ran.last] {
                let off = (late(time, ran) - common).abs() as u64;
                farthest = farthest.max(off);
            }
        }
        for (before, ran) in moving().zip(moving().skip(1)) {
            assert_eq!(ran.tick, before.tick + 1, "seed {seed}");
        }
    }
    let most = percentile(&mut skews, 99);
    let what = format!("start skew, 99th percentile of {} later moves", skews.len());
    measurement("soak", &what, &microseconds(most), &bound(SKEW));
    let what = "ticks off SYNC, the most in 20 minutes of 12 axes";
    measurement("soak", what, &microseconds(farthest), &bound(LOCK));
    assert!(most <= SKEW, "{most} ns");
    assert!(farthest <= LOCK, "{farthest} ns");
}

#[test]
fn without_sync_the_axes_part_slowly() {
    let mut farthest = 0;
    for seed in 0..20 {
        let mut robot = Fresh::new(seed);
        while robot.client.now().0 < 6_000_000 {
            robot.go(0.3, 0.8);
        }
        *robot.mute.borrow_mut() = true;
        let silent = robot.client.now().0;
        while robot.client.now().0 < silent + 10_000_000 {
            robot.go(0.3, 0.8);
        }
        let ticks = robot.ticks.borrow();
        let ran = ticks.0.iter().rev().find(|ran| ran.axes == 12);
        farthest = farthest.max(ran.expect("ticks").spread());
    }
    let what = "12 axes apart after 10 s without SYNC, the most of 20 robots";
    measurement("soak", what, &microseconds(farthest), &bound(AFTER_SILENCE));
    assert!(farthest <= AFTER_SILENCE, "{farthest} ns");
}
