//! From one command to the next without a jump.

use crate::leg::varying::Varying;

/// How many changes may be under way at once; the latest of what comes more often waits.
const MOST_CHANGES: usize = 8;

/// From 0 to 1 with neither rate nor acceleration at the ends, for `share` of the time gone: its
/// value and first two derivatives. A polynomial of degree 5: 10 u^3 - 15 u^4 + 6 u^5.
pub fn rise(share: f64) -> [f64; 3] {
    let u = share.clamp(0.0, 1.0);
    let (left, square) = (1.0 - u, u * u);
    [
        square * u * (10.0 + u * (6.0 * u - 15.0)),
        30.0 * square * left * left,
        60.0 * u * left * (1.0 - 2.0 * u),
    ]
}

/// The integral of [`rise`] from 0, which is a half at the end and a straight line after it.
pub fn risen(share: f64) -> f64 {
    let u = share.clamp(0.0, 1.0);
    let cube = u * u * u;
    cube * u * (2.5 + u * (u - 3.0)) + (share - 1.0).max(0.0)
}

#[derive(Debug, Clone, Copy)]
struct Change {
    start: f64,
    duration: f64,
    by: [f64; 6],
}

/// The body's commands, blended.
///
/// Each change comes in by [`rise`], and those under way add up, so the accelerations of the values
/// are continuous. A later change never overtakes an earlier one, so each value is a mean of
/// what was commanded and never goes beyond it.
#[derive(Debug, Clone)]
pub struct Commands {
    settled: [f64; 6],
    changes: [Option<Change>; MOST_CHANGES],
    target: [f64; 6],
    waiting: Option<([f64; 6], f64)>,
}

impl Commands {
    pub fn new(values: [f64; 6]) -> Self {
        Self {
            settled: values,
            changes: [None; MOST_CHANGES],
            target: values,
            waiting: None,
        }
    }

    /// A command that comes in over `duration`; where too many are under way it waits.
    pub fn set(&mut self, time: f64, values: [f64; 6], duration: f64) {
        self.waiting = Some((values, duration));
        self.pass(time);
    }

    /// Does what is due at a time: forgets changes that have ended, lets in what waits.
    pub fn pass(&mut self, time: f64) {
        for slot in &mut self.changes {
            if let Some(change) = slot
                && change.start + change.duration <= time
            {
                for (value, by) in self.settled.iter_mut().zip(change.by) {
                    *value += by;
                }
                *slot = None;
            }
        }
        // What is left of sums of differences is rounding.
        if self.changes.iter().all(Option::is_none) {
            self.settled = self.target;
        }
        let last = self
            .changes
            .iter()
            .flatten()
            .map(|change| change.start + change.duration);
        let last = last.fold(time, f64::max);
        if let Some((values, duration)) = self.waiting
            && let Some(slot) = self.changes.iter_mut().find(|slot| slot.is_none())
        {
            self.waiting = None;
            let duration = duration.max(last - time);
            let mut by = [0.0; 6];
            for ((by, value), target) in by.iter_mut().zip(values).zip(self.target) {
                *by = value - target;
            }
            self.target = values;
            if by != [0.0; 6] {
                *slot = Some(Change {
                    start: time,
                    duration,
                    by,
                });
            }
        }
    }

    /// When something is due next.
    pub fn due(&self) -> f64 {
        let ends = self
            .changes
            .iter()
            .flatten()
            .map(|change| change.start + change.duration);
        ends.fold(f64::INFINITY, f64::min)
    }

    /// Whether all changes have come to their end.
    pub fn is_settled(&self) -> bool {
        self.waiting.is_none() && self.changes.iter().all(Option::is_none)
    }

    /// The values, with their first two derivatives, at a time that is not before the last change.
    pub fn at(&self, time: f64) -> [Varying; 6] {
        let mut values = self.settled.map(Varying::constant);
        for change in self.changes.iter().flatten() {
            let [share, rate, acceleration] = rise((time - change.start) / change.duration);
            let rate = rate / change.duration;
            let acceleration = acceleration / (change.duration * change.duration);
            for (value, by) in values.iter_mut().zip(change.by) {
                *value = *value + Varying::new(share, rate, acceleration) * by;
            }
        }
        values
    }
}
