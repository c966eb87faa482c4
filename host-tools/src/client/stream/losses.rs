//! How many knots an axis may lose until that is too many.

use std::collections::VecDeque;

/// Knots that are looked back at.
pub const LOOKED_AT: u64 = 100;

/// How many of those may be lost. On a bus that loses 1 % of its frames so many would be lost once
/// in 10^8 looks; one that loses 10 % has a fault that streaming must not hide.
pub const MOST: u64 = 10;

/// The knots that one axis has lost lately.
#[derive(Debug, Clone, Default)]
pub struct Losses {
    /// How many before which knot.
    lately: VecDeque<(u64, u64)>,
}

impl Losses {
    /// Notes so many that were missing before a knot, or that were asked for again because of it.
    pub fn note(&mut self, knot: u64, missing: u64) {
        self.lately.push_back((knot, missing));
        while let Some((first, _)) = self.lately.front()
            && first + LOOKED_AT <= knot
        {
            self.lately.pop_front();
        }
    }

    /// How many of the last [`LOOKED_AT`] were lost, where that is more than [`MOST`].
    pub fn too_many(&self) -> Option<u64> {
        let lost = self.lately.iter().map(|(_, missing)| missing).sum();
        (lost > MOST).then_some(lost)
    }
}
