//! A walk, measured.

use super::super::Walk;
use super::super::{Performance, Sample};
use super::load::windows;
use super::{largest, shares, skews};
use crate::gait::State;
use crate::robot::Robot;
use crate::walk::Phase;
use canter_shared::time::Tick;
use canter_shared::wire::id::AxisId;

/// Loads are looked for in stretches of so many us.
const STRETCH: u64 = 100_000;

/// A walk, measured.
#[derive(Debug, Clone, PartialEq)]
pub struct WalkMeasurement {
    /// From the start to rest, in s.
    pub duration: f64,
    /// How long it was led by a gait, in s.
    pub walking: f64,
    /// How far the body went over the ground, in m.
    pub distance: f64,
    /// How far it turned to the left, in rad.
    pub turned: f64,
    /// How much of the time the bus was taken while it was led by a gait, from 0 to 1.
    pub load: f64,
    /// The same in the busiest tenth of a second.
    pub peak_load: f64,
    /// The largest distance of any setpoint from the ideal curve of its joint at any tick, in rad.
    pub deviation: f64,
    /// The largest distance of any shaft from its setpoint, in rad.
    pub following: f64,
    /// The largest velocity and acceleration as parts of the axis's limits.
    pub shares: [f64; 2],
    /// By how much the axes handed over their first setpoint later than the first of them, in us.
    pub skews: Vec<(AxisId, f64)>,
    /// Knots that were lost on their way.
    pub missing: u32,
}

impl WalkMeasurement {
    /// The largest skew of any axis, in us.
    pub fn skew(&self) -> f64 {
        largest(&self.skews)
    }
}

impl Walk {
    /// Its axes, leg by leg.
    pub(crate) fn axes(&self) -> impl Iterator<Item = AxisId> {
        self.quadruped
            .mounts
            .iter()
            .flat_map(|mount| mount.leg.axes)
    }

    /// The last tick of its motion.
    pub(crate) fn end(&self) -> Tick {
        Tick(self.start.0 + self.ideal.len().saturating_sub(1) as u64)
    }

    /// The first tick and the last one in which a gait led it.
    pub(crate) fn led(&self) -> (Tick, Tick) {
        let is_led = |(phase, _): &(Phase, State)| *phase == Phase::Walking;
        let first = self.ideal.iter().position(is_led).unwrap_or(0);
        let last = self.ideal.iter().rposition(is_led).unwrap_or(0);
        let at = |index| Tick(self.start.0 + index as u64);
        (at(first), at(last))
    }

    /// For each tick of a joint of a leg, what it did and where it should have been, in rad.
    pub(crate) fn against_ideal<'a>(
        &'a self,
        performance: &'a Performance,
        leg: usize,
        joint: usize,
    ) -> impl Iterator<Item = (&'a Sample, f64)> {
        let axis = self.quadruped.mounts[leg].leg.axes[joint];
        let samples = performance.samples.between(axis, self.start, self.end());
        let ideal = self.ideal.iter();
        samples
            .iter()
            .zip(ideal.map(move |(_, state)| state.joints[leg].position[joint]))
    }
}

impl Performance {
    pub(super) fn measure_walk(&self, walk: &Walk, robot: &Robot) -> WalkMeasurement {
        let (first, last) = walk.led();
        let walking = last.since(first).seconds();
        let (from, to) = (first.time(), last.time());
        let mut load = [0.0; 2];
        let stretches = (to.0 - from.0) / STRETCH;
        for (load, parts) in load.iter_mut().zip([1, stretches as usize]) {
            let windows = windows(&self.frames, from, to, parts);
            *load = windows.iter().map(|w| w.share()).fold(0.0, f64::max);
        }
        let mut measurement = WalkMeasurement {
            duration: walk.end().since(walk.start).seconds(),
            walking,
            distance: walk.distance(),
            turned: walk.ideal.last().map_or(0.0, |(_, state)| state.pose.yaw),
            load: load[0],
            peak_load: load[1],
            deviation: 0.0,
            following: 0.0,
            shares: [0.0; 2],
            skews: skews(self, &walk.axes().collect::<Vec<_>>(), walk.start),
            missing: walk.ends.iter().map(|end| end.missing).sum(),
        };
        let mut seen = 0;
        for (leg, joint) in (0..4).flat_map(|leg| (0..3).map(move |joint| (leg, joint))) {
            for (sample, ideal) in walk.against_ideal(self, leg, joint) {
                let setpoint = sample.setpoint.setpoint.position.radians();
                let [velocity, acceleration] = shares(sample, robot);
                measurement.deviation = measurement.deviation.max((setpoint - ideal).abs());
                measurement.following = measurement.following.max(sample.error().abs());
                measurement.shares[0] = measurement.shares[0].max(velocity);
                measurement.shares[1] = measurement.shares[1].max(acceleration);
                seen += 1;
            }
        }
        // A tick that nobody has seen has kept no promise.
        if seen != 12 * walk.ideal.len() {
            measurement.deviation = f64::INFINITY;
        }
        measurement
    }
}

impl Walk {
    /// How far the body went over the ground, in m.
    fn distance(&self) -> f64 {
        let way = |pair: &[(Phase, State)]| {
            let (a, b) = (&pair[0].1.pose, &pair[1].1.pose);
            (b.x - a.x).hypot(b.y - a.y)
        };
        self.ideal.windows(2).map(way).sum()
    }
}
