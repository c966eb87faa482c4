//! The wire: one frame at a time, and what becomes of it.

use canter_shared::wire::frame::Frame;

use super::bits;
use super::clock::TrueTime;
use super::observer::Destruction;
use super::station::Station;
use crate::bus::Bitrate;

/// Bits of an error flag.
const FLAG: u32 = 6;

/// Recessive bits after the flags of an error frame.
const DELIMITER: u32 = 8;

/// Bits that an error passive sender waits after a frame of its own, besides the usual space.
const SUSPENSION: u32 = 8;

/// Recessive bits from the last dominant one until the next frame may begin: after a good frame
/// the acknowledge delimiter, the end of frame and the space, after an error frame its delimiter
/// and the space.
const RECESSIVE: u32 = 8 + bits::INTERFRAME;

/// A frame that was on the bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transmission {
    /// When its first bit began.
    pub start: TrueTime,
    /// When its last bit ended, and everybody has it but for the receivers' own delay.
    pub end: TrueTime,
    /// Its length in bits: stuff bits included, the space to the next frame not.
    pub bits: u32,
    /// Who sent it; of several that sent the very same at once, the first.
    pub sender: Station,
    /// What was sent.
    pub frame: Frame,
}

impl Transmission {
    /// Nanoseconds in which it kept the bus: itself, and the space that it must leave behind.
    pub fn busy(&self) -> u64 {
        let bit = (self.end.0 - self.start.0) / u64::from(self.bits.max(1));
        u64::from(self.bits + bits::INTERFRAME) * bit
    }
}

/// How much of the time the bus was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Load {
    /// Nanoseconds in which the bus was not free: frames, error frames and the space that each
    /// must keep.
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

/// What becomes of a frame; stations by their places.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fate {
    /// It comes to its end.
    Whole,
    /// An error frame ends it after this many bits.
    Destroyed { bits: u32, cause: Destruction },
    /// All but this one have taken it when an error frame spoils its last bit for the sender.
    Doubled { but: usize },
}

/// A station without a part in the frame under way any more.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lapse {
    pub(super) place: usize,
    /// Whether it was one of those that sent.
    pub(super) sent: bool,
}

/// A frame on the wire.
#[derive(Debug, Clone, Copy)]
pub(super) struct OnWire {
    pub(super) start: TrueTime,
    /// When it and the error frame that it may get are over.
    pub(super) end: TrueTime,
    pub(super) bits: u32,
    pub(super) frame: Frame,
    /// The first of those that sent it when it began.
    pub(super) sender: usize,
    pub(super) fate: Fate,
}

/// The state of the wire.
#[derive(Debug)]
pub(super) struct Medium {
    /// Nanoseconds of one bit.
    bit: u64,
    current: Option<OnWire>,
    /// Those that send the frame under way, to its end.
    senders: Vec<usize>,
    /// Those that saw an error in it and made nobody see it.
    lapses: Vec<Lapse>,
    /// When the space after the last frame is over.
    free: TrueTime,
    busy: u64,
}

impl Medium {
    pub(super) fn new(bitrate: Bitrate) -> Self {
        Self {
            bit: 1_000_000_000 / u64::from(bitrate.bits_per_second()),
            current: None,
            senders: Vec::new(),
            lapses: Vec::new(),
            free: TrueTime::default(),
            busy: 0,
        }
    }

    /// Nanoseconds of one bit.
    pub(super) fn bit(&self) -> u64 {
        self.bit
    }

    /// When the frame under way is over.
    pub(super) fn due(&self) -> Option<TrueTime> {
        self.current.as_ref().map(|current| current.end)
    }

    /// When the next frame may begin; none while one is under way.
    pub(super) fn free(&self) -> Option<TrueTime> {
        self.current.is_none().then_some(self.free)
    }

    /// Since when the bus has been recessive, if no frame is under way.
    pub(super) fn recessive_since(&self) -> TrueTime {
        TrueTime(self.free.0.saturating_sub(u64::from(RECESSIVE) * self.bit))
    }

    /// Until when an error passive sender of the last frame waits.
    pub(super) fn suspension(&self) -> TrueTime {
        self.free.after(u64::from(SUSPENSION) * self.bit)
    }

    pub(super) fn senders(&self) -> &[usize] {
        &self.senders
    }

    pub(super) fn lapses(&self) -> &[Lapse] {
        &self.lapses
    }

    /// Whether `place` takes the frame under way if it is on the bus at all.
    pub(super) fn receives(&self, place: usize) -> bool {
        !self.senders.contains(&place) && self.lapses.iter().all(|lapse| lapse.place != place)
    }

    /// Whether `place` sent the frame under way, to its end or not.
    pub(super) fn sends(&self, place: usize) -> bool {
        let mut lapses = self.lapses.iter();
        self.senders.contains(&place) || lapses.any(|lapse| lapse.sent && lapse.place == place)
    }

    /// Takes note of who is to send the next frame, in the order of their places.
    pub(super) fn line_up(&mut self, senders: impl Iterator<Item = usize>) {
        self.lapses.clear();
        self.senders.clear();
        self.senders.extend(senders);
    }

    /// One of the senders leaves it to the others.
    pub(super) fn give_up(&mut self, place: usize) {
        self.senders.retain(|sender| *sender != place);
        self.lapses.push(Lapse { place, sent: true });
    }

    /// A receiver misses it.
    pub(super) fn miss(&mut self, place: usize) {
        self.lapses.push(Lapse { place, sent: false });
    }

    /// The frame begins, and its fate is decided.
    pub(super) fn begin(
        &mut self,
        now: TrueTime,
        sender: usize,
        frame: Frame,
        bits: u32,
        fate: Fate,
    ) {
        let end = match fate {
            Fate::Whole => self.after(now, bits),
            Fate::Destroyed { bits, cause } => self.after(now, bits + error_frame(cause)),
            Fate::Doubled { .. } => self.after(now, bits - 1 + 2 * FLAG + DELIMITER),
        };
        self.set(OnWire {
            start: now,
            end,
            bits,
            frame,
            sender,
            fate,
        });
    }

    fn set(&mut self, current: OnWire) {
        self.free = self.after(current.end, bits::INTERFRAME);
        self.current = Some(current);
    }

    /// `place` has lost its power. A frame that nobody else sends is cut off there, unless all
    /// that is still to come of it is recessive anyhow.
    pub(super) fn lose(&mut self, now: TrueTime, place: usize) {
        let sent = self.senders.contains(&place);
        self.senders.retain(|sender| *sender != place);
        self.lapses.retain(|lapse| lapse.place != place);
        let Some(mut current) = self.current.filter(|_| sent && self.senders.is_empty()) else {
            return;
        };
        let passed = now.0.saturating_sub(current.start.0).div_ceil(self.bit);
        let passed = u32::try_from(passed).unwrap_or(u32::MAX).max(1);
        let ends = match current.fate {
            Fate::Destroyed { bits, .. } => bits,
            _ => current.bits.saturating_sub(8),
        };
        if passed < ends {
            let cause = Destruction::CutOff;
            current.fate = Fate::Destroyed {
                bits: passed,
                cause,
            };
            current.end = self.after(current.start, passed + error_frame(cause));
            self.set(current);
        }
    }

    /// The frame that is over by `now`.
    pub(super) fn finish(&mut self, now: TrueTime) -> Option<OnWire> {
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

    fn after(&self, time: TrueTime, bits: u32) -> TrueTime {
        time.after(u64::from(bits) * self.bit)
    }
}

/// Bits of an error frame. Whoever sees the error sends a flag; the others see six equal bits,
/// which no frame has, and send theirs right after it. A sender that nobody hears is alone with it.
const fn error_frame(cause: Destruction) -> u32 {
    let flags = match cause {
        Destruction::NotAcknowledged => FLAG,
        _ => 2 * FLAG,
    };
    flags + DELIMITER
}
