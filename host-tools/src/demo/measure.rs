//! What the record of a performance says: true skew, distance from the curve, peaks.

use super::Performance;
use crate::robot::Robot;
use crate::sim::{Record, TrueTime};
use canter_shared::axis::state::State;
use canter_shared::motion::beta::exact;
use canter_shared::node::AxisSetpoint;
use canter_shared::time::{MICROSECONDS_PER_TICK, Tick, Ticks};
use canter_shared::wire::command::{Command, ProfileKind};
use canter_shared::wire::id::AxisId;
use std::collections::BTreeMap;

/// One move, measured.
#[derive(Debug, Clone, PartialEq)]
pub struct MoveMeasurement {
    /// What it shows.
    pub title: &'static str,
    /// From leaving to rest, in s.
    pub duration: f64,
    /// By how much the axes handed over their first setpoint later than the first of them, in
    /// the simulation's true time, in us.
    pub skews: Vec<(AxisId, f64)>,
    /// The largest distance of any setpoint from the beta curve, in rad; none for other profiles.
    pub distance: Option<f64>,
    /// Whether all axes were at their targets in the same tick, and in none before.
    pub together: bool,
}

/// A performance, measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurements {
    /// Each move.
    pub moves: Vec<MoveMeasurement>,
    /// The largest velocity of any setpoint as a part of its axis's limit.
    pub velocity: f64,
    /// The largest acceleration or deceleration as a part of its axis's limit.
    pub acceleration: f64,
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
pub(super) fn stop_tick(record: &Record) -> Option<Tick> {
    record.frames.iter().rev().find_map(|sent| {
        let decoded = Command::decode(&sent.frame).ok()??;
        let is_stop = matches!(decoded.1, Command::Stop { .. });
        is_stop.then(|| sent.end.bus_time().next_tick())
    })
}

/// The setpoints by tick and axis, from the first tick that all axes have to the last one.
pub(super) fn grid(record: &Record) -> BTreeMap<(Tick, AxisId), (TrueTime, AxisSetpoint)> {
    let mut spans: BTreeMap<AxisId, (Tick, Tick)> = BTreeMap::new();
    for (_, setpoint) in &record.setpoints {
        let span = spans
            .entry(setpoint.axis)
            .or_insert((setpoint.tick, setpoint.tick));
        span.0 = span.0.min(setpoint.tick);
        span.1 = span.1.max(setpoint.tick);
    }
    let first = spans.values().map(|span| span.0).max();
    let last = spans.values().map(|span| span.1).min();
    record
        .setpoints
        .iter()
        .filter(|(_, setpoint)| first <= Some(setpoint.tick) && Some(setpoint.tick) <= last)
        .map(|(time, setpoint)| ((setpoint.tick, setpoint.axis), (*time, *setpoint)))
        .collect()
}

impl Performance {
    /// Every setpoint of every axis, one for each tick, in that order.
    pub fn setpoints(&self) -> impl Iterator<Item = AxisSetpoint> {
        grid(&self.record)
            .into_values()
            .map(|(_, setpoint)| setpoint)
    }

    /// Measures the performance against the robot's limits.
    pub fn measure(&self, robot: &Robot) -> Measurements {
        let grid = grid(&self.record);
        let mut measurements = Measurements {
            moves: Vec::new(),
            velocity: 0.0,
            acceleration: 0.0,
            stopping: self.stopped.1.since(self.stopped.0).seconds(),
            load: self.load.share(),
            frames: self.record.frames.len(),
            setpoints: self.record.setpoints.len(),
        };
        let at_stop = self.stopped.0;
        let mut last_moving = at_stop;
        for (tick, setpoint) in grid.values().map(|(_, setpoint)| (setpoint.tick, setpoint)) {
            let limits = robot.limits(setpoint.axis);
            let part = |value: i64, limit: i64| value.abs() as f64 / limit as f64;
            let now = &setpoint.setpoint;
            let velocity = part(now.velocity.counts(), limits.velocity().counts());
            let slower = limits.slower_acceleration().counts();
            let acceleration = part(now.acceleration.counts(), slower);
            measurements.velocity = measurements.velocity.max(velocity);
            measurements.acceleration = measurements.acceleration.max(acceleration);
            if tick > at_stop
                && now.velocity.counts() != 0
                && setpoint.state == State::OperationEnabled
            {
                last_moving = last_moving.max(tick);
            }
        }
        measurements.stopping = last_moving.since(at_stop).seconds();
        for performed in &self.moves {
            let Some(first) = performed.arrivals.first() else {
                continue;
            };
            let half = MICROSECONDS_PER_TICK / 2;
            let start = Tick((first.start.0 + half) / MICROSECONDS_PER_TICK);
            let end = start.after(first.duration);
            let true_start = |axis| grid.get(&(start, axis)).map_or(0, |(time, _)| time.0);
            let earliest = performed
                .arrivals
                .iter()
                .map(|arrival| true_start(arrival.axis))
                .min()
                .unwrap_or(0);
            let mut together = true;
            let mut distance: f64 = 0.0;
            for arrival in &performed.arrivals {
                let at = |tick: Tick| {
                    let setpoint = grid.get(&(tick, arrival.axis));
                    setpoint.map_or(f64::NAN, |(_, setpoint)| {
                        setpoint.setpoint.position.radians()
                    })
                };
                let (from, to) = (at(start), at(end));
                // Half way an axis that moves at all is not there yet.
                let half_way = at(start.after(Ticks(first.duration.0 / 2)));
                together &= to == arrival.target && (from == to || half_way != to);
                for tick in start.0..=end.0 {
                    let x = 2.0 * (tick - start.0) as f64 / f64::from(first.duration.0) - 1.0;
                    let want = from + (to - from) * exact::shape(x).value;
                    distance = distance.max((at(Tick(tick)) - want).abs());
                }
            }
            measurements.moves.push(MoveMeasurement {
                title: performed.title,
                duration: first.duration.seconds(),
                skews: performed
                    .arrivals
                    .iter()
                    .map(|arrival| {
                        let late = true_start(arrival.axis) - earliest;
                        (arrival.axis, late as f64 / 1e3)
                    })
                    .collect(),
                distance: (performed.profile == ProfileKind::Beta).then_some(distance),
                together,
            });
        }
        measurements
    }
}

impl MoveMeasurement {
    /// The largest skew of any axis, in us.
    pub fn skew(&self) -> f64 {
        self.skews.iter().map(|(_, late)| *late).fold(0.0, f64::max)
    }
}
