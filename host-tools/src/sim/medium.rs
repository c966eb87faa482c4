//! The wire: one frame at a time, and who may send the next.

use canter_shared::wire::frame::Frame;

use super::Station;
use super::bits;
use super::clock::TrueTime;
use super::random::SplitMix64;
use crate::bus::Bitrate;

/// A frame that was on the bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transmission {
    /// When its first bit began.
    pub start: TrueTime,
    /// When its last bit ended, and everybody has it but for the receivers' own delay.
    pub end: TrueTime,
    /// Its length in bits: stuff bits included, the space to the next frame not.
    pub bits: u32,
    /// Who sent it.
    pub sender: Station,
    /// What was sent.
    pub frame: Frame,
}

/// How much of the time the bus was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Load {
    /// Nanoseconds in which the bus was not free: frames and the space that each must keep.
    pub busy: u64,
    /// Nanoseconds since the start.
    pub elapsed: u64,
}

impl Load {
    /// The share of the time, 0 to 1; 0 where no time has passed.
    pub fn share(self) -> f64 {
        if self.elapsed == 0 {
            0.0
        } else {
            self.busy as f64 / self.elapsed as f64
        }
    }

    /// The load since `earlier`, an older one of the same bus.
    pub const fn since(self, earlier: Self) -> Self {
        Self {
            busy: self.busy.saturating_sub(earlier.busy),
            elapsed: self.elapsed.saturating_sub(earlier.elapsed),
        }
    }
}

/// The state of the wire.
#[derive(Debug)]
pub(super) struct Medium {
    /// Nanoseconds of one bit.
    bit: u64,
    current: Option<Transmission>,
    /// When the space after the last frame is over.
    free: TrueTime,
    busy: u64,
}

impl Medium {
    pub(super) fn new(bitrate: Bitrate) -> Self {
        Self {
            bit: 1_000_000_000 / u64::from(bitrate.bits_per_second()),
            current: None,
            free: TrueTime::default(),
            busy: 0,
        }
    }

    /// When something happens here next: a frame ends, or one of those that wait may begin.
    pub(super) fn due(&self, somebody_waits: bool) -> Option<TrueTime> {
        match &self.current {
            Some(current) => Some(current.end),
            None => somebody_waits.then_some(self.free),
        }
    }

    pub(super) fn is_free(&self, now: TrueTime) -> bool {
        self.current.is_none() && self.free <= now
    }

    pub(super) fn begin(&mut self, now: TrueTime, sender: Station, frame: Frame) {
        let bits = bits::length(&frame);
        let end = now.after(u64::from(bits) * self.bit);
        self.free = end.after(u64::from(bits::INTERFRAME) * self.bit);
        self.current = Some(Transmission {
            start: now,
            end,
            bits,
            sender,
            frame,
        });
    }

    /// The frame that has ended by `now`.
    pub(super) fn finish(&mut self, now: TrueTime) -> Option<Transmission> {
        let ended = self.current.take_if(|current| current.end <= now)?;
        self.busy += self.free.0.saturating_sub(ended.start.0);
        Some(ended)
    }

    pub(super) fn load(&self, now: TrueTime) -> Load {
        Load {
            busy: self.busy,
            elapsed: now.0,
        }
    }
}

/// Who gets the bus: the lowest identifier. Where several send the same one, which no healthy bus
/// has, real controllers would destroy each other's frames unless they were equal to the last bit;
/// here the seed says who is first.
pub(super) fn arbitrate<'a>(
    waiting: impl Iterator<Item = (Station, &'a Frame)>,
    random: &mut SplitMix64,
) -> Option<(Station, Frame)> {
    let mut first: Option<(Station, &Frame)> = None;
    let mut equal = 0;
    for (sender, frame) in waiting {
        let wins = match first {
            Some((_, best)) if frame.id() > best.id() => continue,
            Some((_, best)) if frame.id() == best.id() => {
                equal += 1;
                // Each of n is chosen with the same chance: the n-th takes over in one of n cases.
                random.up_to(equal) == 0
            }
            _ => {
                equal = 0;
                true
            }
        };
        if wins {
            first = Some((sender, frame));
        }
    }
    first.map(|(sender, frame)| (sender, *frame))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(id: u16) -> Frame {
        Frame::new(id, &[]).expect("a valid frame")
    }

    #[test]
    fn the_lowest_identifier_wins() {
        let frames = [0x321, 0x7FF, 0x045, 0x046].map(frame);
        let waiting = frames
            .iter()
            .enumerate()
            .map(|(at, frame)| (Station::Node(at), frame));
        let winner = arbitrate(waiting, &mut SplitMix64::new(0));
        assert_eq!(winner, Some((Station::Node(2), frames[2])));
        assert_eq!(arbitrate([].into_iter(), &mut SplitMix64::new(0)), None);
    }

    #[test]
    fn equal_identifiers_share_by_chance() {
        let frame = frame(1);
        let mut random = SplitMix64::new(3);
        let mut won = [0; 3];
        for _ in 0..3_000 {
            let waiting = (0..3).map(|at| (Station::Node(at), &frame));
            if let Some((Station::Node(at), _)) = arbitrate(waiting, &mut random) {
                won[at] += 1;
            }
        }
        assert!(
            won.iter().all(|count| (900..1_100).contains(count)),
            "{won:?}"
        );
    }
}
