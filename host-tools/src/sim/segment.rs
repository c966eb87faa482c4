//! A bus on which the caller plays every station, such as the drives' bus of a node.
//!
//! Frames have their exact lengths and wait for the bus by their identifiers; nothing goes wrong here.

use canter_shared::wire::frame::Frame;

use super::bits;
use super::clock::TrueTime;
use super::controller::{Controller, NOTHING};
use super::medium::{Fate, Load, Medium};
use crate::bus::Bitrate;

/// A frame that was on the bus of a [`Segment`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Passed {
    /// When its first bit began.
    pub start: TrueTime,
    /// When its last bit ended, and every other station has it.
    pub end: TrueTime,
    /// Who sent it: the station of this number, counted from 0.
    pub sender: usize,
    /// What was sent.
    pub frame: Frame,
}

/// A bus of its own in virtual time.
///
/// The caller keeps the time: it asks [`Self::due`], and calls [`Self::step`] then and after each
/// [`Self::send`].
///
/// ```
/// use canter::bus::Bitrate;
/// use canter::sim::{Segment, TrueTime};
/// use canter_shared::wire::frame::Frame;
///
/// let mut bus = Segment::new(Bitrate::default(), &[3, 3]);
/// bus.send(0, Frame::new(0x123, &[1, 2]).expect("a valid frame"));
/// assert_eq!(bus.step(TrueTime(5_000)), None);
/// let end = bus.due().expect("a frame is under way");
/// let passed = bus.step(end).expect("it has ended");
/// assert_eq!((passed.start, passed.sender), (TrueTime(5_000), 0));
/// ```
#[derive(Debug)]
pub struct Segment {
    medium: Medium,
    controllers: Vec<Controller>,
    clashes: u64,
}

impl Segment {
    /// A bus that is free; each station's controller has room for so many frames to send, which it sends
    /// in their order.
    pub fn new(bitrate: Bitrate, room: &[usize]) -> Self {
        Self {
            medium: Medium::new(bitrate),
            controllers: room.iter().map(|room| Controller::new(*room)).collect(),
            clashes: 0,
        }
    }

    /// Whether the controller of `station` takes another frame; none of a station that is not there.
    pub fn has_room(&self, station: usize) -> bool {
        self.controllers
            .get(station)
            .is_some_and(Controller::has_room)
    }

    /// Hands a frame to the controller of `station`; says whether there was room.
    pub fn send(&mut self, station: usize, frame: Frame) -> bool {
        let room = self.has_room(station);
        if room && let Some(controller) = self.controllers.get_mut(station) {
            controller.push(frame);
        }
        room
    }

    /// When the next frame ends, or may begin, which is in the past where the bus has been free; none
    /// where nobody has anything to send.
    pub fn due(&self) -> Option<TrueTime> {
        let waits = self.lowest() != NOTHING;
        self.medium
            .due()
            .or_else(|| self.medium.free().filter(|_| waits))
    }

    /// Ends what is over by `now`, which it gives, and lets begin what waits for a free bus.
    pub fn step(&mut self, now: TrueTime) -> Option<Passed> {
        let passed = self.medium.finish(now).map(|ended| {
            if let Some(controller) = self.controllers.get_mut(ended.sender) {
                controller.sent();
            }
            Passed {
                start: ended.start,
                end: ended.end,
                sender: ended.sender,
                frame: ended.frame,
            }
        });
        if self.medium.free().is_some_and(|free| free <= now) {
            self.begin(now);
        }
        passed
    }

    /// How much of the time up to `now` the bus was taken, the frame under way aside.
    pub fn load(&self, now: TrueTime) -> Load {
        self.medium.load(now)
    }

    /// How often two stations began with the same identifier. On a real bus they destroy each other's
    /// frame, unless it is the same; here the first of them is sent, so a caller that relies on what it
    /// measures finds none.
    pub fn clashes(&self) -> u64 {
        self.clashes
    }

    fn lowest(&self) -> u16 {
        let wanted = self.controllers.iter().map(Controller::wanted);
        wanted.min().unwrap_or(NOTHING)
    }

    fn begin(&mut self, now: TrueTime) {
        let lowest = self.lowest();
        let mut senders = self.controllers.iter().enumerate().filter_map(|(at, one)| {
            let frame = one.first().filter(|frame| frame.id() == lowest)?;
            Some((at, *frame))
        });
        let Some((sender, frame)) = senders.next() else {
            return;
        };
        self.clashes += senders.count() as u64;
        self.medium.line_up([sender].into_iter());
        let bits = bits::length(&frame);
        self.medium.begin(now, sender, frame, bits, Fate::Whole);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(id: u16) -> Frame {
        Frame::new(id, &[]).expect("a valid frame")
    }

    /// Everything that is sent from `now` on, one after the other.
    fn rest(bus: &mut Segment, now: u64) -> Vec<(usize, u16, u64)> {
        let mut now = TrueTime(now);
        let mut sent = Vec::new();
        while let Some(due) = bus.due() {
            now = now.max(due);
            sent.extend(
                bus.step(now)
                    .map(|passed| (passed.sender, passed.frame.id(), passed.start.0)),
            );
        }
        sent
    }

    #[test]
    fn the_lowest_identifier_goes_first_once_the_bus_is_free() {
        let mut bus = Segment::new(Bitrate::default(), &[2, 2, 2]);
        bus.send(0, frame(0x555));
        assert_eq!(bus.step(TrueTime(1_000)), None);
        // The first of a station's frames keeps the ones behind it back, whatever they are.
        bus.send(1, frame(0x2AA));
        bus.send(1, frame(0x155));
        bus.send(2, frame(0x1AA));
        let sent = rest(&mut bus, 1_000);
        let order: Vec<_> = sent.iter().map(|(sender, id, _)| (*sender, *id)).collect();
        assert_eq!(order, [(0, 0x555), (2, 0x1AA), (1, 0x2AA), (1, 0x155)]);
        let length = |id| u64::from(bits::length(&frame(id)) + bits::INTERFRAME) * 1_000;
        let second = 1_000 + length(0x555);
        assert_eq!(sent[1].2, second);
        assert_eq!(sent[2].2, second + length(0x1AA));
        let busy = [0x555, 0x1AA, 0x2AA, 0x155].map(length).iter().sum::<u64>();
        assert_eq!(bus.load(TrueTime(1_000_000)).busy, busy);
        assert_eq!(bus.clashes(), 0);
    }

    #[test]
    fn a_full_controller_takes_no_more_and_a_clash_is_counted() {
        let mut bus = Segment::new(Bitrate::default(), &[1, 1]);
        assert!(bus.send(0, frame(7)) && bus.send(1, frame(7)));
        assert!(!bus.send(0, frame(8)) && !bus.send(2, frame(8)));
        let senders: Vec<_> = rest(&mut bus, 0).iter().map(|sent| sent.0).collect();
        assert_eq!((senders, bus.clashes()), (vec![0, 1], 1));
    }
}
