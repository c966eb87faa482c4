//! A trot of twelve simulated axes on a bus that loses frames.

use canter::bus::{Bus, BusError, Received};
use canter::client::{Client, ClientError};
use canter::gait::{Body, Kind, Quadruped};
use canter::robot::Robot;
use canter::sim::{Configuration, Rates, Record, SimulatedBus};
use canter::walk::joints::{axes, positions};
use canter::walk::{Order, Orders, Phase, Settings, WalkError, Walked, walk};
use canter_shared::axis::fault::Fault;
use canter_shared::time::BusTime;
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{AxisId, Function, split};
use canter_tests::measurement;
use std::cell::RefCell;
use std::rc::Rc;

/// How long it trots, in s.
const TROT: f64 = 30.0;

/// The simulated robot, which loses frames from the first knot on.
struct Lossy {
    bus: SimulatedBus,
    rates: Option<Rates>,
}

impl Bus for Lossy {
    fn now(&self) -> BusTime {
        self.bus.now()
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        let is_knot = split(frame.id()).is_some_and(|(function, _)| function == Function::Knot);
        if is_knot && let Some(rates) = self.rates.take() {
            self.bus.set_rates(rates);
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

/// Trots for [`TROT`] seconds after it stood up, then stops.
#[derive(Default)]
struct ForAWhile {
    since: Option<f64>,
}

impl Orders for ForAWhile {
    fn next(&mut self, time: f64, phase: Phase) -> Option<Order> {
        let since = *self.since.get_or_insert(time);
        if phase != Phase::Walking {
            self.since = None;
        }
        (phase == Phase::Walking && time - since >= TROT).then_some(Order::Stop)
    }

    fn refused(&mut self, order: &Order, why: &WalkError) {
        panic!("{order:?} was refused: {why}");
    }
}

struct Trot {
    result: Result<Walked, WalkError>,
    axes: Vec<AxisId>,
    client: Client<Lossy>,
    record: Record,
}

/// A default trot at 0.5 m/s where so many of a million receptions are lost.
fn trot(lost: u32, seed: u64) -> Trot {
    let robot = Robot::default();
    let mut bus = SimulatedBus::new(&Configuration {
        seed,
        ..Configuration::of(&robot)
    });
    let record = Rc::new(RefCell::new(Record::default()));
    bus.observe(record.clone());
    let rates = Some(Rates {
        lost,
        ..Rates::default()
    });
    let mut client = Client::new(Lossy { bus, rates }, 0xCA27);
    let quadruped = Quadruped::of(&robot).expect("four legs");
    let axes = axes(&quadruped).to_vec();
    client.check(&axes).expect("all are there");
    client.hold(&axes).expect("nobody else is there");
    client.enable(&axes).expect("well");
    let body = Body {
        vx: 0.5,
        ..Body::standing(Quadruped::HEIGHT)
    };
    let settings = Settings::new(Kind::Trot.gait(), body);
    let result = walk(&mut client, &robot, &settings, &mut ForAWhile::default());
    Trot {
        result,
        axes,
        client,
        record: record.take(),
    }
}

/// Holds all setpoints of all axes to the limits, and to one way without a jump.
#[track_caller]
fn keeps(record: &Record, axes: &[AxisId]) {
    let robot = Robot::default();
    for (id, axis) in axes.iter().zip(robot.axes()) {
        let limits = axis.limits();
        let fastest = limits.velocity().radians() * (1.0 + 1e-9);
        let hardest = limits.slower_acceleration().radians() * (1.0 + 1e-9);
        let own = record.setpoints.iter().filter(|(_, of)| of.axis == *id);
        let mut before: Option<(u64, f64)> = None;
        for (_, setpoint) in own {
            let state = &setpoint.setpoint;
            assert!(state.velocity.radians().abs() <= fastest, "{setpoint:?}");
            assert!(
                state.acceleration.radians().abs() <= hardest,
                "{setpoint:?}"
            );
            let here = (setpoint.tick.0, state.position.radians());
            if let Some((tick, position)) = before {
                let time = (here.0 - tick) as f64 * 1e-3;
                assert!((here.1 - position).abs() <= fastest * time, "{setpoint:?}");
            }
            before = Some(here);
        }
    }
}

/// How far the setpoints were from what the joints were to do, at the worst tick, in rad.
fn deviation(walked: &Walked, record: &Record, axes: &[AxisId]) -> f64 {
    let states = walked.replay.states(1e-3).expect("as it was walked");
    let ideal: Vec<_> = states
        .map(|state| positions(&state.expect("in reach").1))
        .collect();
    let mut worst = 0.0f64;
    let mut seen = 0;
    for (_, setpoint) in &record.setpoints {
        let joint = axes.iter().position(|axis| *axis == setpoint.axis);
        let passed = setpoint.tick.0.checked_sub(walked.start.0);
        if let (Some(joint), Some(tick)) = (joint, passed)
            && let Some(ideal) = ideal.get(tick as usize)
        {
            let off = setpoint.setpoint.position.radians() - ideal[joint];
            worst = worst.max(off.abs());
            seen += 1;
        }
    }
    // Every tick of every axis was looked at.
    assert_eq!(seen, ideal.len() * axes.len());
    worst
}

#[test]
fn a_trot_that_loses_one_frame_in_a_hundred_goes_on() {
    let whole = trot(0, 1);
    let walked = whole.result.expect("it walks");
    let plain = deviation(&walked, &whole.record, &whole.axes);
    keeps(&whole.record, &whole.axes);
    assert!(walked.ends.iter().all(|end| end.missing == 0));
    assert!(plain <= 50e-6, "{plain}");

    let lossy = trot(10_000, 1);
    let walked = lossy.result.expect("it goes on");
    keeps(&lossy.record, &lossy.axes);
    assert!(walked.replay.duration > TROT);
    let missing: u32 = walked.ends.iter().map(|end| end.missing).sum();
    // One in a hundred of 12 x 100 knots in a second.
    let expected = 0.01 * 1200.0 * walked.replay.duration;
    assert!(
        (0.5..1.5).contains(&(f64::from(missing) / expected)),
        "{missing}"
    );
    let worst = deviation(&walked, &lossy.record, &lossy.axes);
    let micro = |radians: f64| format!("{:.1} urad", 1e6 * radians);
    measurement(
        "fast",
        "trot, setpoints from the ideal",
        &micro(plain),
        "<= 50 urad",
    );
    measurement("fast", "the same, 1 % of frames lost", &micro(worst), "-");
    measurement("fast", "the same, knots bridged", &missing.to_string(), "-");
    let faults = lossy
        .client
        .axes()
        .values()
        .filter(|axis| axis.fault.is_some());
    assert_eq!(faults.count(), 0);
}

#[test]
fn a_trot_that_loses_one_frame_in_five_is_stopped_together() {
    for seed in 1..=5 {
        let trot = trot(200_000, seed);
        let error = trot.result.expect_err("too many are lost");
        keeps(&trot.record, &trot.axes);
        let WalkError::Client(error) = error else {
            panic!("{error}");
        };
        let is_stop = match &error {
            ClientError::Lossy { .. } => true,
            // An axis may notice first.
            ClientError::Faulted { fault, .. } => {
                matches!(fault, Fault::StreamUnderrun | Fault::HostTimeout)
            }
            _ => false,
        };
        assert!(is_stop, "{error}");
        // All rest, and each came to rest soon after the others. Abduction does not move in a trot.
        let moving = trot
            .axes
            .iter()
            .enumerate()
            .filter(|(joint, _)| joint % 3 < 2);
        let rests: Vec<u64> = moving
            .filter_map(|(_, axis)| {
                let setpoints = trot.record.setpoints.iter().rev();
                let mut own = setpoints.filter(|(_, of)| of.axis == *axis);
                own.find(|(_, of)| of.setpoint.velocity.counts() != 0)
            })
            .map(|(_, of)| of.tick.0)
            .collect();
        assert_eq!(rests.len(), 8);
        let end = trot.record.setpoints.last().map_or(0, |(_, of)| of.tick.0);
        let first = rests.iter().min().copied().unwrap_or(0);
        let last = rests.iter().max().copied().unwrap_or(0);
        assert!(last < end, "an axis still moves");
        assert!(last - first <= 200, "{rests:?}");
        measurement(
            "fast",
            &format!("20 % of frames lost, seed {seed}: all at rest within"),
            &format!("{} ms", last - first),
            "<= 200 ms",
        );
    }
}
