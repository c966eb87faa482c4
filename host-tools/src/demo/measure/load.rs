//! How much of the time the bus was taken, and by what.

use crate::sim::Transmission;
use canter_shared::time::BusTime;
use canter_shared::wire::id::{Function, split};

/// What a frame is for, roughly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Knots of a stream.
    Knots,
    /// Where the axes are.
    Feedback,
    /// Everything else: SYNC, heartbeats, commands and their answers.
    Other,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Knots, Self::Feedback, Self::Other];

    /// Its name in a legend.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Knots => "knots",
            Self::Feedback => "feedback",
            Self::Other => "SYNC, heartbeats, commands",
        }
    }

    fn of(sent: &Transmission) -> Self {
        match split(sent.frame.id()) {
            Some((Function::Knot, _)) => Self::Knots,
            Some((Function::Feedback, _)) => Self::Feedback,
            _ => Self::Other,
        }
    }
}

/// How much of some time the bus was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Its middle, in s of bus time.
    pub middle: f64,
    /// By kind, each from 0 to 1.
    pub shares: [f64; 3],
}

impl Window {
    /// By all kinds together, from 0 to 1.
    pub fn share(&self) -> f64 {
        self.shares.iter().sum()
    }
}

/// The load in so many equal parts of the time from one instant to another; a frame counts where it
/// ends.
pub fn windows(frames: &[Transmission], from: BusTime, to: BusTime, parts: usize) -> Vec<Window> {
    let span = to.0.saturating_sub(from.0).max(1) as f64 / parts.max(1) as f64;
    let window = |index| Window {
        middle: (from.0 as f64 + span * (index as f64 + 0.5)) / 1e6,
        shares: [0.0; 3],
    };
    let mut windows: Vec<Window> = (0..parts.max(1)).map(window).collect();
    for sent in frames {
        let time = sent.end.bus_time();
        if !(from..to).contains(&time) {
            continue;
        }
        let index = ((time.0 - from.0) as f64 / span) as usize;
        if let Some(window) = windows.get_mut(index) {
            // ns in us.
            window.shares[Kind::of(sent) as usize] += sent.busy() as f64 / 1e3 / span;
        }
    }
    windows
}
