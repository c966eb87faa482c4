//! Where a field lies in a payload, and how it is taken out and put in.

use super::layout::Field;

/// The bits of a payload that belong to one field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// The least significant bit's place in the payload.
    pub start: u8,
    /// Its width in bits, 1 to 63.
    pub bits: u8,
    /// Whether it is a two's complement number.
    pub signed: bool,
}

impl Place {
    const fn mask(self) -> u64 {
        (1 << self.bits) - 1
    }

    /// The least and greatest raw value.
    pub const fn range(self) -> (i64, i64) {
        if self.signed {
            (-(1 << (self.bits - 1)), (1 << (self.bits - 1)) - 1)
        } else {
            (0, self.mask() as i64)
        }
    }

    /// The raw value in a payload.
    pub const fn get(self, word: u64) -> i64 {
        let raw = (word >> self.start) & self.mask();
        if self.signed {
            let unused = 64 - self.bits;
            ((raw << unused) as i64) >> unused
        } else {
            raw as i64
        }
    }

    /// The payload with this field set; a raw value out of range is cut to its nearer end.
    pub fn put(self, word: u64, raw: i64) -> u64 {
        let (least, greatest) = self.range();
        let raw = raw.clamp(least, greatest) as u64 & self.mask();
        (word & !(self.mask() << self.start)) | (raw << self.start)
    }
}

/// A payload, read and written by fields.
///
/// What takes a field is inlined, so that of a field nothing but its place is left in a device's code.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::wire) struct Word(pub u64);

impl Word {
    #[inline(always)]
    pub fn get(self, field: &Field) -> i64 {
        field.place().get(self.0)
    }

    #[inline(always)]
    pub fn byte(self, field: &Field) -> u8 {
        field.place().get(self.0) as u8
    }

    #[inline(always)]
    pub fn put(self, field: &Field, raw: i64) -> Self {
        Self(field.place().put(self.0, raw))
    }
}
