//! What is recorded of the simulated robot: every frame, and every tick of every axis.

use crate::sim::{AxisTick, Observer, Transmission, TrueTime};
use canter_shared::node::AxisSetpoint;
use canter_shared::time::Tick;
use canter_shared::units::Position;
use canter_shared::wire::id::AxisId;
use std::collections::BTreeMap;

/// What an axis did at one tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sample {
    /// When it handed the setpoint to its drive, in true time.
    pub time: TrueTime,
    /// The setpoint.
    pub setpoint: AxisSetpoint,
    /// Where the shaft really was by then, whatever the encoder said.
    pub measured: Position,
}

impl Sample {
    /// How far the shaft is ahead of the setpoint, in rad.
    pub fn error(&self) -> f64 {
        (self.measured - self.setpoint.setpoint.position).radians()
    }
}

/// Hears everything as it happens.
#[derive(Debug, Clone, Default)]
pub(super) struct Recorder {
    pub frames: Vec<Transmission>,
    samples: BTreeMap<AxisId, Vec<Sample>>,
}

impl Observer for Recorder {
    fn frame(&mut self, transmission: &Transmission) {
        self.frames.push(*transmission);
    }

    fn tick(&mut self, time: TrueTime, tick: &AxisTick<'_>) {
        // Before its first SYNC a node's ticks are not those of the bus.
        if tick.synchronised {
            let sample = Sample {
                time,
                setpoint: tick.setpoint,
                measured: tick.plant.position,
            };
            let samples = self.samples.entry(tick.setpoint.axis).or_default();
            samples.push(sample);
        }
    }
}

impl Recorder {
    /// What each axis did, from the first tick that all of them have to the last one.
    pub fn into_samples(self) -> Samples {
        let ends = |end: fn(&[Sample]) -> Option<&Sample>| {
            let ends = self.samples.values().filter_map(move |axis| end(axis));
            ends.map(|sample| sample.setpoint.tick)
        };
        let first = ends(|axis| axis.first()).max().unwrap_or_default();
        let last = ends(|axis| axis.last()).min().unwrap_or_default();
        let cut = |samples: Vec<Sample>| {
            let mut samples = samples;
            samples.retain(|sample| (first..=last).contains(&sample.setpoint.tick));
            samples
        };
        let axes = self.samples.into_iter();
        Samples {
            first,
            axes: axes.map(|(axis, samples)| (axis, cut(samples))).collect(),
        }
    }
}

/// What all axes did, tick by tick.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Samples {
    first: Tick,
    /// One for each tick from the first one on.
    axes: BTreeMap<AxisId, Vec<Sample>>,
}

impl Samples {
    /// What an axis did at a tick; none outside of the recording.
    pub fn at(&self, axis: AxisId, tick: Tick) -> Option<&Sample> {
        let index = usize::try_from(tick.0.checked_sub(self.first.0)?).ok()?;
        self.axes.get(&axis)?.get(index)
    }

    /// What an axis did from one tick to another, both included.
    pub fn between(&self, axis: AxisId, from: Tick, to: Tick) -> &[Sample] {
        let place = |tick: Tick| tick.0.saturating_sub(self.first.0) as usize;
        let samples = self.axes.get(&axis).map_or(&[][..], Vec::as_slice);
        let end = (place(to) + 1).min(samples.len());
        samples.get(place(from)..end).unwrap_or_default()
    }

    /// All of them, in the order of ticks and axes.
    pub fn all(&self) -> impl Iterator<Item = &Sample> {
        let ticks = self.axes.values().map(Vec::len).max().unwrap_or(0);
        (0..ticks).flat_map(|index| self.axes.values().filter_map(move |axis| axis.get(index)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::Bus;
    use crate::sim::{Configuration, SimulatedBus};
    use canter_shared::time::BusTime;
    use canter_shared::wire::command::Command;
    use canter_shared::wire::id::Address;
    use std::cell::RefCell;
    use std::rc::Rc;

    #[test]
    fn every_axis_has_one_sample_for_each_tick() {
        let mut bus = SimulatedBus::new(&Configuration::default());
        let recorder = Rc::new(RefCell::new(Recorder::default()));
        bus.observe(Rc::clone(&recorder));
        for counter in 0..3 {
            let time = BusTime(50_000 + u64::from(counter) * 100_000);
            bus.run(time);
            let sync = Command::Sync { counter, time };
            let frame = sync.encode(Address::All).expect("in range");
            bus.send(&frame).expect("there is room");
        }
        bus.run(BusTime(400_000));
        let samples = recorder.take().into_samples();
        let first = samples.first;
        let axis = |id| AxisId::new(id).expect("in range");
        assert_eq!(samples.axes.len(), 12);
        for id in 1..=12 {
            let of_axis = samples.between(axis(id), first, Tick(u64::MAX - 1));
            assert!(of_axis.len() > 300, "{}", of_axis.len());
            for (index, sample) in of_axis.iter().enumerate() {
                let tick = Tick(first.0 + index as u64);
                assert_eq!(sample.setpoint.tick, tick);
                assert_eq!(samples.at(axis(id), tick), Some(sample));
            }
        }
        assert_eq!(samples.at(axis(1), Tick(first.0 - 1)), None);
        assert_eq!(samples.at(axis(13), first), None);
        let all: Vec<_> = samples.all().take(13).collect();
        assert_eq!(all[11].setpoint.axis, axis(12));
        assert_eq!(all[12].setpoint.tick, Tick(first.0 + 1));
    }
}
