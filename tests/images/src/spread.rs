//! What many counts of the same thing come to.

use core::fmt::Display;

use crate::report;

/// The least, the mean and the most of some counts.
pub struct Spread {
    least: u32,
    most: u32,
    sum: u32,
    counts: u32,
}

impl Default for Spread {
    fn default() -> Self {
        Self::new()
    }
}

impl Spread {
    /// Of nothing yet.
    pub fn new() -> Self {
        Self {
            least: u32::MAX,
            most: 0,
            sum: 0,
            counts: 0,
        }
    }

    /// Adds one count.
    pub fn add(&mut self, count: u32) {
        self.least = self.least.min(count);
        self.most = self.most.max(count);
        self.sum += count;
        self.counts += 1;
    }

    /// Adds those of another.
    pub fn merge(&mut self, other: &Self) {
        self.least = self.least.min(other.least);
        self.most = self.most.max(other.most);
        self.sum += other.sum;
        self.counts += other.counts;
    }

    /// What all of them come to.
    pub fn sum(&self) -> u32 {
        self.sum
    }

    /// How many there are.
    pub fn counts(&self) -> u32 {
        self.counts
    }

    /// Prints them as `NAME.least`, `NAME.mean` and `NAME.most`.
    pub fn report(&self, name: impl Display) {
        let mean = self.sum / self.counts.max(1);
        report(format_args!("{name}.least"), self.least);
        report(format_args!("{name}.mean"), mean);
        report(format_args!("{name}.most"), self.most);
    }
}
