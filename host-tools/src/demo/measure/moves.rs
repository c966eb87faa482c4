//! One synchronised move, measured.

use super::super::{Performance, Performed};
use super::{largest, skews};
use canter_shared::motion::beta::exact;
use canter_shared::time::{MICROSECONDS_PER_TICK, Tick, Ticks};
use canter_shared::wire::command::ProfileKind;
use canter_shared::wire::id::AxisId;

/// One move, measured.
#[derive(Debug, Clone, PartialEq)]
pub struct MoveMeasurement {
    /// What it shows.
    pub title: &'static str,
    /// When it began.
    pub start: Tick,
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

impl MoveMeasurement {
    /// The largest skew of any axis, in us.
    pub fn skew(&self) -> f64 {
        largest(&self.skews)
    }
}

impl Performance {
    pub(super) fn measure_move(&self, performed: &Performed) -> Option<MoveMeasurement> {
        let first = performed.arrivals.first()?;
        let half = MICROSECONDS_PER_TICK / 2;
        let start = Tick((first.start.0 + half) / MICROSECONDS_PER_TICK);
        let end = start.after(first.duration);
        let mut together = true;
        let mut distance: f64 = 0.0;
        for arrival in &performed.arrivals {
            let at = |tick: Tick| {
                let sample = self.samples.at(arrival.axis, tick);
                sample.map_or(f64::NAN, |sample| {
                    sample.setpoint.setpoint.position.radians()
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
        let axes: Vec<AxisId> = performed.arrivals.iter().map(|a| a.axis).collect();
        Some(MoveMeasurement {
            title: performed.title,
            start,
            duration: first.duration.seconds(),
            skews: skews(self, &axes, start),
            distance: (performed.profile == ProfileKind::Beta).then_some(distance),
            together,
        })
    }
}
