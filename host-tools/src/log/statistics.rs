//! How full a bus was, and of what.

use std::collections::BTreeMap;

use canter_shared::time::BusTime;
use canter_shared::wire::frame::Frame;

use super::decode::decode;
use crate::bus::Bitrate;
use crate::sim::bits::{INTERFRAME, length};

/// The time that the fullest moment is looked for in, in microseconds.
const WINDOW: u64 = 100_000;

const SECOND: f64 = 1e6;

/// What all frames are called that are none of canter's.
const OTHERS: &str = "others";

/// The frames of one kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct MessageCount {
    /// How many.
    pub frames: u64,
    /// How long they were together, in bits, stuffed and with the space behind each.
    pub bits: u64,
}

/// What was seen of one bus.
#[derive(Debug, Clone, Default)]
pub struct Traffic {
    first: Option<BusTime>,
    last: BusTime,
    longest_silence: u64,
    total: MessageCount,
    messages: BTreeMap<String, MessageCount>,
    /// Bits of each window that had any.
    windows: BTreeMap<u64, u64>,
}

impl Traffic {
    fn add(&mut self, time: BusTime, frame: &Frame) {
        let bits = u64::from(length(frame) + INTERFRAME);
        let before = self.last;
        let first = *self.first.get_or_insert(time);
        if time >= before && first != time {
            self.longest_silence = self.longest_silence.max(time.0 - before.0.max(first.0));
        }
        // Frames of several queues may be written a little out of turn.
        self.last = self.last.max(time);
        self.first = Some(first.min(time));
        let name = decode(frame).map_or_else(
            || OTHERS.to_owned(),
            |decoded| format!("{:?}", decoded.function),
        );
        for count in [&mut self.total, self.messages.entry(name).or_default()] {
            count.frames += 1;
            count.bits += bits;
        }
        *self.windows.entry(time.0 / WINDOW).or_default() += bits;
    }

    /// All frames.
    pub const fn total(&self) -> MessageCount {
        self.total
    }

    /// The frames by what they are for, as the functions are called; `others` are none of canter's.
    pub fn messages(&self) -> impl Iterator<Item = (&str, MessageCount)> {
        self.messages
            .iter()
            .map(|(name, count)| (name.as_str(), *count))
    }

    /// From the first frame to the last, in s.
    pub fn duration(&self) -> f64 {
        let first = self.first.unwrap_or(self.last);
        self.last.0.saturating_sub(first.0) as f64 / SECOND
    }

    /// The longest time from one frame to the next, in s.
    pub fn longest_silence(&self) -> f64 {
        self.longest_silence as f64 / SECOND
    }

    /// The part of the time that these frames took of a bus of that rate; 0 where no time has passed.
    pub fn load_of(&self, count: MessageCount, bitrate: Bitrate) -> f64 {
        let room = self.duration() * f64::from(bitrate.bits_per_second());
        if room > 0.0 {
            count.bits as f64 / room
        } else {
            0.0
        }
    }

    /// The part of the fullest tenth of a second that was taken, of those that begin at whole tenths: one that
    /// begins between may be fuller.
    pub fn peak_load(&self, bitrate: Bitrate) -> f64 {
        let most = self.windows.values().max().copied().unwrap_or(0);
        most as f64 * SECOND / (WINDOW as f64 * f64::from(bitrate.bits_per_second()))
    }
}

/// What was seen in a log.
#[derive(Debug, Clone, Default)]
pub struct Statistics {
    buses: BTreeMap<String, Traffic>,
}

impl Statistics {
    /// Counts one frame.
    pub fn add(&mut self, interface: &str, time: BusTime, frame: &Frame) {
        if !self.buses.contains_key(interface) {
            self.buses.insert(interface.to_owned(), Traffic::default());
        }
        if let Some(traffic) = self.buses.get_mut(interface) {
            traffic.add(time, frame);
        }
    }

    /// Each interface and what was seen there.
    pub fn buses(&self) -> impl Iterator<Item = (&str, &Traffic)> {
        self.buses
            .iter()
            .map(|(name, traffic)| (name.as_str(), traffic))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn load_is_bits_over_time() {
        let frame = Frame::new(0x40, &[0; 8]).expect("a SYNC");
        let other = Frame::new(0x7FF, &[]).expect("a frame");
        let mut statistics = Statistics::default();
        for at in 0..1_000 {
            statistics.add("can0", BusTime(5_000_000 + at * 1_000), &frame);
        }
        // A tenth of a second twice as full, and one frame after a second of silence.
        for at in 0..100 {
            statistics.add("can0", BusTime(5_200_500 + at * 1_000), &frame);
        }
        statistics.add("can0", BusTime(6_999_000), &other);
        statistics.add("can1", BusTime(1), &other);
        let buses: Vec<_> = statistics.buses().collect();
        assert_eq!(buses.len(), 2);
        let (name, traffic) = buses[0];
        assert_eq!(name, "can0");
        let bits = u64::from(length(&frame) + INTERFRAME);
        let last = u64::from(length(&other) + INTERFRAME);
        assert_eq!(
            traffic.total(),
            MessageCount {
                frames: 1_101,
                bits: 1_100 * bits + last
            }
        );
        assert!((traffic.duration() - 1.999).abs() < 1e-9);
        assert!((traffic.longest_silence() - 1.0).abs() < 1e-9);
        let rate = Bitrate::default();
        let load = (1_100 * bits + last) as f64 / 1_999_000.0;
        assert!((traffic.load_of(traffic.total(), rate) - load).abs() < 1e-12);
        assert!((traffic.peak_load(rate) - 200.0 * bits as f64 / 1e5).abs() < 1e-12);
        let names: Vec<_> = traffic
            .messages()
            .map(|(name, count)| (name, count.frames))
            .collect();
        assert_eq!(names, [("Sync", 1_100), ("others", 1)]);
        // One frame lasts no time, and fills no bus.
        assert_eq!(buses[1].1.load_of(buses[1].1.total(), rate), 0.0);
    }
}
