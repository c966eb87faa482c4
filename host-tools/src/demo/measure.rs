//! What the recording of a performance says: true skew, distance from the curve, peaks, bus load.

mod load;
mod moves;
mod walk;

use super::{Performance, Sample};
use crate::robot::Robot;
use crate::sim::Transmission;
use canter_shared::axis::state::State;
use canter_shared::time::Tick;
use canter_shared::wire::command::Command;
use canter_shared::wire::id::AxisId;
pub(super) use load::{Kind, Window, windows};
pub use moves::MoveMeasurement;
pub use walk::WalkMeasurement;

/// A performance, measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurements {
    /// Each move.
    pub moves: Vec<MoveMeasurement>,
    /// The walk, if there was one.
    pub walk: Option<WalkMeasurement>,
    /// The largest velocity of any setpoint as a part of its axis's limit.
    pub velocity: f64,
    /// The largest acceleration or deceleration as a part of its axis's limit.
    pub acceleration: f64,
    /// Setpoints outside their axes' travel.
    pub outside: usize,
    /// The largest distance of an enabled shaft from its setpoint, in rad.
    pub following: f64,
    /// From the stop to rest, in s.
    pub stopping: f64,
    /// How much of the time the bus was taken, from 0 to 1.
    pub load: f64,
    /// Frames on the bus.
    pub frames: usize,
    /// Setpoints handed to drives.
    pub setpoints: usize,
}

/// The tick at which the last Stop was on the bus.
pub(super) fn stop_tick(frames: &[Transmission]) -> Option<Tick> {
    frames.iter().rev().find_map(|sent| {
        let decoded = Command::decode(&sent.frame).ok()??;
        let is_stop = matches!(decoded.1, Command::Stop { .. });
        is_stop.then(|| sent.end.bus_time().next_tick())
    })
}

/// The velocity and the acceleration of a setpoint as parts of its axis's limits, without signs.
pub(super) fn shares(sample: &Sample, robot: &Robot) -> [f64; 2] {
    let limits = robot.limits(sample.setpoint.axis);
    let part = |value: i64, limit: i64| value.abs() as f64 / limit as f64;
    let now = &sample.setpoint.setpoint;
    [
        part(now.velocity.counts(), limits.velocity().counts()),
        part(
            now.acceleration.counts(),
            limits.slower_acceleration().counts(),
        ),
    ]
}

/// By how much each axis handed over its setpoint of a tick later than the first of them, in us: for ever
/// where it had none.
fn skews(performance: &Performance, axes: &[AxisId], tick: Tick) -> Vec<(AxisId, f64)> {
    let time = |axis: &AxisId| {
        performance
            .samples
            .at(*axis, tick)
            .map(|sample| sample.time.0)
    };
    let earliest = axes.iter().filter_map(time).min().unwrap_or(0);
    let late = |axis| time(axis).map_or(f64::INFINITY, |time| (time - earliest) as f64 / 1e3);
    axes.iter().map(|axis| (*axis, late(axis))).collect()
}

/// The largest of some skews, in us.
fn largest(skews: &[(AxisId, f64)]) -> f64 {
    skews.iter().map(|(_, late)| *late).fold(0.0, f64::max)
}

impl Performance {
    /// Measures the performance against the robot's limits.
    pub fn measure(&self, robot: &Robot) -> Measurements {
        let mut measurements = Measurements {
            moves: Vec::new(),
            walk: self
                .walk
                .as_ref()
                .map(|walk| self.measure_walk(walk, robot)),
            velocity: 0.0,
            acceleration: 0.0,
            outside: 0,
            following: 0.0,
            stopping: 0.0,
            load: self.load.share(),
            frames: self.frames.len(),
            setpoints: 0,
        };
        let at_stop = self.stopped.0;
        let mut last_moving = at_stop;
        for sample in self.samples.all() {
            let (tick, setpoint) = (sample.setpoint.tick, &sample.setpoint.setpoint);
            let [velocity, acceleration] = shares(sample, robot);
            let limits = robot.limits(sample.setpoint.axis);
            let travel = limits.position_minimum()..=limits.position_maximum();
            measurements.setpoints += 1;
            measurements.velocity = measurements.velocity.max(velocity);
            measurements.acceleration = measurements.acceleration.max(acceleration);
            measurements.outside += usize::from(!travel.contains(&setpoint.position));
            if sample.setpoint.state == State::OperationEnabled {
                measurements.following = measurements.following.max(sample.error().abs());
                if tick > at_stop && setpoint.velocity.counts() != 0 {
                    last_moving = last_moving.max(tick);
                }
            }
        }
        measurements.stopping = last_moving.since(at_stop).seconds();
        let moves = self.moves.iter();
        let measured = moves.filter_map(|performed| self.measure_move(performed));
        measurements.moves = measured.collect();
        measurements
    }
}
