//! What an episode was made of: a soak in which nothing happens proves nothing.

use super::Glance;

/// Counts of what happened; those of several episodes can be added.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Statistics {
    /// Setpoints seen.
    pub ticks: u64,
    /// Of these, setpoints of axes in motion.
    pub moving: u64,
    /// Frames on the bus, whole ones.
    pub frames: u64,
    /// Moves that began.
    pub starts: u64,
    /// Faults that were latched.
    pub faults: u64,
    /// Stops from motion that came to rest.
    pub stops: u64,
    /// Times that parameters changed.
    pub changes: u64,
    /// Times that a node began anew after a loss of power.
    pub resets: u64,
    /// Things that went wrong by choice or by chance, single frames aside.
    pub disturbances: u64,
    /// The most that a stop took of the time that it may take, 0 to 1.
    pub slowest_stop: f64,
}

impl Statistics {
    pub(super) fn tick(&mut self, last: Option<&Glance>, now: &Glance) {
        self.ticks += 1;
        self.moving += u64::from(now.setpoint.velocity.counts() != 0);
        let had = last.and_then(|last| last.fault);
        self.faults += u64::from(now.fault.is_some() && had.is_none());
    }

    /// A stop took `part` of its time.
    pub(super) fn stop(&mut self, part: f64) {
        self.stops += 1;
        self.slowest_stop = self.slowest_stop.max(part);
    }

    /// Takes in what another episode was made of.
    pub fn add(&mut self, other: &Self) {
        self.ticks += other.ticks;
        self.moving += other.moving;
        self.frames += other.frames;
        self.starts += other.starts;
        self.faults += other.faults;
        self.stops += other.stops;
        self.changes += other.changes;
        self.resets += other.resets;
        self.disturbances += other.disturbances;
        self.slowest_stop = self.slowest_stop.max(other.slowest_stop);
    }
}
