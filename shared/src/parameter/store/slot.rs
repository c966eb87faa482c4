//! One slot: its header, and whether it is whole.

use crate::parameter::flash::ERASED;
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use embedded_storage::nor_flash::ReadNorFlash;

/// Bytes of a header: a multiple of what every flash programs at once, 32 bytes on an STM32H7.
pub(super) const HEADER: usize = 32;

/// Bytes that are read at once.
pub(super) const BLOCK: usize = 32;

/// The first bytes of a slot that was written by canter.
const MAGIC: [u8; 4] = *b"cntr";

/// The layout of what follows. Another one is for another firmware, and cannot be read.
const LAYOUT: u16 = 1;

/// Without a table: 32 bits a byte are quick enough for some hundred bytes, and flash is short.
static CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// What a slot says of itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Header {
    /// One more with each save, and round.
    pub generation: u32,
    /// Bytes of the body.
    pub length: u32,
}

/// What a slot holds.
pub(super) enum Slot {
    /// Nothing, and no save of it ever ended.
    Erased,
    /// Something that is not whole.
    Broken,
    Whole(Header),
}

impl Header {
    pub(super) fn is_newer_than(&self, other: &Self) -> bool {
        (self.generation.wrapping_sub(other.generation) as i32) > 0
    }

    /// All but the check.
    fn words(&self) -> [u8; 16] {
        let [m0, m1, m2, m3] = MAGIC;
        let [v0, v1] = LAYOUT.to_le_bytes();
        let [g0, g1, g2, g3] = self.generation.to_le_bytes();
        let [l0, l1, l2, l3] = self.length.to_le_bytes();
        [
            m0, m1, m2, m3, v0, v1, ERASED, ERASED, g0, g1, g2, g3, l0, l1, l2, l3,
        ]
    }

    fn check(&self, body: impl Iterator<Item = u8>) -> u32 {
        let mut digest = CRC.digest();
        digest.update(&self.words());
        for byte in body {
            digest.update(&[byte]);
        }
        digest.finalize()
    }

    pub(super) fn encode(&self, body: impl Iterator<Item = u8>) -> [u8; HEADER] {
        let mut bytes = [ERASED; HEADER];
        let check = self.check(body).to_le_bytes();
        let all = self.words().into_iter().chain(check);
        for (place, byte) in bytes.iter_mut().zip(all) {
            *place = byte;
        }
        bytes
    }
}

/// Looks at the slot from `start` on. A flash that cannot be read holds something broken.
pub(super) fn look<F: ReadNorFlash>(flash: &mut F, start: u32, slot: u32) -> Slot {
    let mut bytes = [0; HEADER];
    if flash.read(start, &mut bytes).is_err() {
        return Slot::Broken;
    }
    // Programmers that fill the gaps of an image, and emulators, leave 0 where nothing was written. No save,
    // whole or cut short, makes a header of nothing but 0: there are bytes in it that stay erased.
    if bytes == [ERASED; HEADER] || bytes == [0; HEADER] {
        return Slot::Erased;
    }
    let [_, _, _, _, _, _, _, _, g0, g1, g2, g3, l0, l1, l2, l3, ..] = bytes;
    let header = Header {
        generation: u32::from_le_bytes([g0, g1, g2, g3]),
        length: u32::from_le_bytes([l0, l1, l2, l3]),
    };
    if header.length > slot.saturating_sub(HEADER as u32) {
        return Slot::Broken;
    }
    // Compared whole: so the magic and the layout are looked at as well.
    let body = Reader::new(flash, start, header.length);
    if header.encode(body) == bytes {
        Slot::Whole(header)
    } else {
        Slot::Broken
    }
}

/// The bytes of a body, one by one. It ends early where the flash cannot be read.
pub(super) struct Reader<'flash, F> {
    flash: &'flash mut F,
    /// Where the next block is.
    next: u32,
    /// Bytes of the body that have not been given.
    left: u32,
    block: [u8; BLOCK],
    /// The place of the next byte in the block.
    place: usize,
}

impl<'flash, F: ReadNorFlash> Reader<'flash, F> {
    /// The body of the slot from `start` on.
    pub(super) fn new(flash: &'flash mut F, start: u32, length: u32) -> Self {
        Self {
            flash,
            next: start.saturating_add(HEADER as u32),
            left: length,
            block: [0; BLOCK],
            place: BLOCK,
        }
    }
}

impl<F: ReadNorFlash> Iterator for Reader<'_, F> {
    type Item = u8;

    fn next(&mut self) -> Option<u8> {
        self.left = self.left.checked_sub(1)?;
        if self.place >= BLOCK {
            if self.flash.read(self.next, &mut self.block).is_err() {
                self.left = 0;
                return None;
            }
            self.next = self.next.saturating_add(BLOCK as u32);
            self.place = 0;
        }
        let byte = self.block.get(self.place).copied();
        self.place += 1;
        byte
    }
}
