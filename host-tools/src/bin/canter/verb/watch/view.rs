//! What the screen shows, as plain data.

use super::status;
use crate::context::AnyClient;
use canter::bus::Bus;
use canter::client::KnownAxis;
use canter_shared::axis::fault::Fault;
use canter_shared::time::BusTime;
use canter_shared::units::{Position, Velocity};
use canter_shared::wire::id::AxisId;

/// All that one picture of the screen depends on.
#[derive(Debug, Default)]
pub struct View {
    /// What bus it is.
    pub bus: String,
    /// The axes, in the order of their ids.
    pub axes: Vec<AxisRow>,
    /// Frames heard per second, once that can be told.
    pub rate: Option<f64>,
    /// What the bus complained of last.
    pub complaint: Option<String>,
    /// The first axis that is shown, counted from 0; less than that where there is room for all.
    pub first: usize,
    /// Whether there may be colours.
    pub has_colours: bool,
}

/// One axis.
#[derive(Debug, Clone, Default)]
pub struct AxisRow {
    pub axis: u8,
    pub state: &'static str,
    /// For how long it has been silent, in s, where it counts as gone.
    pub silence: Option<f64>,
    /// In rad.
    pub position: Option<f64>,
    /// In rad/s.
    pub velocity: Option<f64>,
    pub moving: Option<bool>,
    pub holder: String,
    pub fault: Option<Fault>,
    pub bus_off: u8,
    pub error_frames: u8,
    pub lost: u8,
    pub rejected: u8,
}

impl View {
    /// What `client` knows, seen from the start of the list.
    pub fn of(client: &AnyClient) -> Self {
        let now = client.now();
        let rows = client.axes().iter();
        Self {
            bus: client.bus().description(),
            axes: rows
                .map(|(axis, known)| AxisRow::of(*axis, known, now))
                .collect(),
            ..Self::default()
        }
    }
}

impl AxisRow {
    fn of(axis: AxisId, known: &KnownAxis, now: BusTime) -> Self {
        let silence = now.0.saturating_sub(known.heard.0) as f64 / 1e6;
        Self {
            axis: axis.get(),
            state: status::state(known),
            silence: known.is_silent(now).then_some(silence),
            position: known.position.map(Position::radians),
            velocity: known.velocity.map(Velocity::radians),
            moving: known.moving,
            holder: status::holder(known),
            fault: known.fault,
            bus_off: known.counters.bus_off,
            error_frames: known.counters.error_frames,
            lost: known.counters.lost,
            rejected: known.counters.rejected,
        }
    }
}

/// Frames per second, anew each second.
#[derive(Debug)]
pub struct Rate {
    since: BusTime,
    frames: u64,
    shown: Option<f64>,
}

/// Over how long frames are counted, in microseconds.
const COUNTED: u64 = 1_000_000;

impl Rate {
    /// Begins to count at `now`, after so many frames.
    pub fn new(now: BusTime, frames: u64) -> Self {
        Self {
            since: now,
            frames,
            shown: None,
        }
    }

    /// The rate at `now`, when `frames` were heard since the beginning.
    pub fn at(&mut self, now: BusTime, frames: u64) -> Option<f64> {
        let passed = now.0.saturating_sub(self.since.0);
        if passed >= COUNTED {
            let rate = frames.saturating_sub(self.frames) as f64 * 1e6 / passed as f64;
            *self = Self {
                shown: Some(rate),
                ..Self::new(now, frames)
            };
        }
        self.shown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_counted_over_a_second_or_more() {
        let mut rate = Rate::new(BusTime(500), 7);
        for (now, frames, shown) in [
            (500_000, 300, None),
            (1_000_500, 607, Some(600.0)),
            (1_100_500, 900, Some(600.0)),
            (3_000_500, 1_607, Some(500.0)),
        ] {
            assert_eq!(rate.at(BusTime(now), frames), shown, "{now}");
        }
    }

    #[test]
    fn an_axis_is_silent_after_half_a_second_without_a_frame() {
        let axis = AxisId::new(3).expect("an id");
        let mut known = KnownAxis::default();
        known.heard = BusTime(1_000_000);
        let silence = |now| AxisRow::of(axis, &known, BusTime(now)).silence;
        assert_eq!(silence(1_500_000), None);
        assert_eq!(silence(3_000_000), Some(2.0));
    }
}
