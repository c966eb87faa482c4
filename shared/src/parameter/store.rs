//! Parameters over a loss of power: two slots of a flash, of which one is always whole.
//!
//! ```text
//! slot    header, 32 bytes               body
//! header  magic, layout, generation, length of the body, CRC-32 over all of it but itself
//! body    for each axis: its id, how many pairs, pairs of a parameter's number and raw value
//! ```
//!
//! A save goes to the slot that does not hold the newest: erase, body, and the header last. Until the
//! last bit of the header is there the slot is not valid and the other one counts, so a loss of
//! power at any instant leaves all of the old values or all of the new ones. Pairs carry their
//! numbers, so that an older or a newer firmware reads what it knows: a number that it does not know
//! is passed over; a value that is out of its range, or contradicts those before, leaves the default.

mod slot;

use super::table::Parameter;
use super::values::{RAW_BYTES, Values, from_bytes, to_bytes};
use core::fmt;
use embedded_storage::nor_flash::NorFlash;
use heapless::Vec;
use slot::{HEADER, Header, Reader, Slot};

/// One axis as it is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StoredAxis {
    /// Its id.
    pub axis: u8,
    /// Its parameters.
    pub values: Values,
}

/// All that a node keeps: its axes, in the node's own order.
pub type Image<const AXES: usize> = Vec<StoredAxis, AXES>;

/// What a store held.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Loaded<const AXES: usize> {
    /// Nothing was ever saved.
    Empty,
    /// Something was saved, and none of it can be read.
    Lost,
    /// What was saved last.
    Image(Image<AXES>),
}

/// Why parameters were not saved. Those that were saved before are still there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StoreError<E> {
    /// The flash failed.
    Flash(E),
    /// The parameters do not fit a slot.
    TooLarge {
        /// Bytes that they need.
        needed: usize,
        /// Bytes of a slot.
        slot: usize,
    },
    /// What is in the flash now is not what was written.
    NotKept,
}

impl<E: fmt::Debug> fmt::Display for StoreError<E> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flash(error) => write!(formatter, "the flash failed: {error:?}"),
            Self::TooLarge { needed, slot } => write!(
                formatter,
                "the parameters need {needed} bytes and a slot has {slot}: save fewer axes"
            ),
            Self::NotKept => formatter.write_str("the flash did not keep what was written"),
        }
    }
}

impl<E: fmt::Debug> core::error::Error for StoreError<E> {}

impl<E> From<E> for StoreError<E> {
    fn from(error: E) -> Self {
        Self::Flash(error)
    }
}

/// Bytes that are written at once, a multiple of every flash's least.
const CHUNK: usize = 256;

/// Bytes of one pair.
const PAIR: usize = 1 + RAW_BYTES;

/// Bytes that an axis takes.
const AXIS_BYTES: usize = 2 + Parameter::COUNT * PAIR;

/// Two slots of a flash.
#[derive(Debug)]
pub struct Store<F> {
    flash: F,
    start: u32,
    slot: u32,
}

impl<F: NorFlash> Store<F> {
    /// The slots of `slot` bytes each that follow each other from `start` on; `slot` is a whole number
    /// of the flash's pages.
    pub fn new(flash: F, start: u32, slot: u32) -> Self {
        const {
            assert!(CHUNK.is_multiple_of(F::WRITE_SIZE) && HEADER.is_multiple_of(F::WRITE_SIZE));
            assert!(slot::BLOCK.is_multiple_of(F::READ_SIZE));
        }
        Self { flash, start, slot }
    }

    /// Bytes that a slot must have for `axes` axes.
    pub const fn needed(axes: usize) -> usize {
        HEADER + axes * AXIS_BYTES
    }

    /// The flash.
    pub fn flash(&self) -> &F {
        &self.flash
    }

    /// The flash, to change it by other ways.
    pub fn flash_mut(&mut self) -> &mut F {
        &mut self.flash
    }

    fn slots(&self) -> [u32; 2] {
        [self.start, self.start.saturating_add(self.slot)]
    }

    /// The newest whole slot.
    fn newest(&mut self) -> (Option<(u32, Header)>, bool) {
        let mut newest: Option<(u32, Header)> = None;
        let mut lost = false;
        for start in self.slots() {
            match slot::look(&mut self.flash, start, self.slot) {
                Slot::Erased => {}
                Slot::Broken => lost = true,
                Slot::Whole(header) => {
                    if newest.is_none_or(|(_, other)| header.is_newer_than(&other)) {
                        newest = Some((start, header));
                    }
                }
            }
        }
        (newest, lost)
    }

    /// Reads what was saved last. Axes beyond `AXES` are passed over.
    ///
    /// With one slot whole and the other broken a save was cut short, or the newer one has gone bad
    /// since: the two look alike, and what is whole is given.
    pub fn load<const AXES: usize>(&mut self) -> Loaded<AXES> {
        let (newest, lost) = self.newest();
        match newest {
            Some((start, header)) => {
                let body = Reader::new(&mut self.flash, start, header.length);
                read_axes(body).map_or(Loaded::Lost, Loaded::Image)
            }
            None if lost => Loaded::Lost,
            None => Loaded::Empty,
        }
    }

    /// Saves `image`. What is saved already is not written again: a flash wears out.
    ///
    /// # Errors
    /// The flash failed, or is too small. What was saved before is still there.
    pub fn save<const AXES: usize>(
        &mut self,
        image: &Image<AXES>,
    ) -> Result<(), StoreError<F::Error>> {
        let length = image.len() * AXIS_BYTES;
        let needed = HEADER + length;
        let slot = self.slot as usize;
        if needed > slot {
            return Err(StoreError::TooLarge { needed, slot });
        }
        let [first, second] = self.slots();
        let (newest, _) = self.newest();
        let (start, generation) = match newest {
            Some((start, header)) => {
                let kept = Reader::new(&mut self.flash, start, header.length);
                if header.length as usize == length && kept.eq(body(image)) {
                    return Ok(());
                }
                let other = if start == first { second } else { first };
                (other, header.generation.wrapping_add(1))
            }
            None => (first, 0),
        };
        self.flash.erase(start, start.saturating_add(self.slot))?;
        let mut bytes = body(image);
        let mut to = start.saturating_add(HEADER as u32);
        let mut left = length;
        while left > 0 {
            let mut chunk = [super::flash::ERASED; CHUNK];
            for (place, byte) in chunk.iter_mut().zip(&mut bytes) {
                *place = byte;
            }
            // The last chunk ends with the body, up to what a flash programs at once.
            let part = left.min(CHUNK).next_multiple_of(HEADER);
            self.flash.write(to, chunk.get(..part).unwrap_or(&chunk))?;
            to = to.saturating_add(part as u32);
            left = left.saturating_sub(part);
        }
        let header = Header {
            generation,
            length: length as u32,
        };
        self.flash.write(start, &header.encode(body(image)))?;
        // Nobody is told that it is saved before it has been read back.
        match slot::look(&mut self.flash, start, self.slot) {
            Slot::Whole(kept) if kept == header => Ok(()),
            _ => Err(StoreError::NotKept),
        }
    }
}

/// The bytes of a body.
fn body(image: &[StoredAxis]) -> impl Iterator<Item = u8> {
    image.iter().flat_map(|stored| {
        let pairs = Parameter::ALL.into_iter().flat_map(|parameter| {
            let [a, b, c, d, e, f] = to_bytes(stored.values.get(parameter));
            [u8::from(parameter), a, b, c, d, e, f]
        });
        [stored.axis, Parameter::COUNT as u8]
            .into_iter()
            .chain(pairs)
    })
}

/// The axes of a body; `None` where it makes no sense, which a whole one always does.
fn read_axes<const AXES: usize>(mut bytes: impl Iterator<Item = u8>) -> Option<Image<AXES>> {
    let mut image = Image::<AXES>::new();
    while let Some(axis) = bytes.next() {
        let pairs = bytes.next()?;
        if axis == 0 || image.iter().any(|other| other.axis == axis) {
            return None;
        }
        let mut values = Values::defaults(axis);
        for _ in 0..pairs {
            let number = bytes.next()?;
            let mut raw = [0; RAW_BYTES];
            for byte in &mut raw {
                *byte = bytes.next()?;
            }
            if let Ok(parameter) = Parameter::try_from(number)
                && let Ok((changed, _)) = values.with(parameter, from_bytes(raw))
            {
                values = changed;
            }
        }
        // There may be more than this node has room for.
        let _ = image.push(StoredAxis { axis, values });
    }
    Some(image)
}
