//! A flash whose power goes in the middle of what it does.

use canter_shared::parameter::flash::{ERASED, MemoryFlash};
use canter_shared::parameter::store::{Image, Store, StoredAxis};
use canter_shared::parameter::{Parameter, Values};
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};

/// Bytes of a slot, two pages of them.
pub const SLOT: u32 = 2 * PAGE as u32;
pub const PAGE: usize = 512;
/// The slots do not begin where the flash does.
pub const START: u32 = PAGE as u32;
pub const SIZE: usize = PAGE + 2 * SLOT as usize;

pub type Memory = MemoryFlash<SIZE, PAGE>;

/// Bytes that are programmed at once.
pub const WORD: usize = Memory::WRITE_SIZE;

/// What the operation that the power goes in leaves behind.
#[derive(Debug, Clone, Copy)]
pub enum Torn {
    /// It had not begun.
    Nothing,
    /// All of it was done, and nobody was told.
    All,
    /// Each bit by itself has changed, or not: as this number's bits say, over and over.
    Bits(u64),
}

/// A flash that lives for so many operations: words programmed and pages erased.
#[derive(Debug, Clone)]
pub struct Cut {
    pub memory: Memory,
    pub left: Option<usize>,
    pub torn: Torn,
    /// Operations so far.
    pub done: usize,
}

impl Cut {
    pub fn new(memory: Memory) -> Self {
        Self {
            memory,
            left: None,
            torn: Torn::Nothing,
            done: 0,
        }
    }

    /// Whether the power is still there; the operation in which it goes is torn.
    fn change(
        &mut self,
        from: usize,
        length: usize,
        target: impl Fn(usize) -> u8,
    ) -> Result<(), NorFlashErrorKind> {
        let dies = match &mut self.left {
            Some(0) => return Err(NorFlashErrorKind::Other),
            Some(left) => {
                *left -= 1;
                *left == 0
            }
            None => false,
        };
        self.done += 1;
        for index in 0..length {
            let byte = &mut self.memory.bytes_mut()[from + index];
            let wanted = target(index);
            *byte = match self.torn {
                _ if !dies => wanted,
                Torn::Nothing => *byte,
                Torn::All => wanted,
                Torn::Bits(bits) => {
                    let taken = bits.rotate_left(index as u32 * 7) as u8;
                    (wanted & taken) | (*byte & !taken)
                }
            };
        }
        if dies {
            return Err(NorFlashErrorKind::Other);
        }
        Ok(())
    }
}

impl ErrorType for Cut {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Cut {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.memory.read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        SIZE
    }
}

impl NorFlash for Cut {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        assert!(from.is_multiple_of(PAGE as u32) && to.is_multiple_of(PAGE as u32) && from <= to);
        for page in (from..to).step_by(PAGE) {
            self.change(page as usize, PAGE, |_| ERASED)?;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        assert!(offset.is_multiple_of(WORD as u32) && bytes.len().is_multiple_of(WORD));
        for (place, word) in bytes.chunks(WORD).enumerate() {
            let from = offset as usize + place * WORD;
            let old = &self.memory.bytes()[from..from + WORD];
            assert_eq!(old, [ERASED; WORD], "programmed without being erased");
            self.change(from, WORD, |index| word[index])?;
        }
        Ok(())
    }
}

pub fn store(memory: Memory) -> Store<Cut> {
    Store::new(Cut::new(memory), START, SLOT)
}

/// Three axes whose parameters all tell the same number, so that a mix shows.
pub fn image(number: u32) -> Image<3> {
    let axes = 1..=3;
    axes.map(|axis| {
        let mut values = Values::defaults(axis);
        let rate = i64::from(number) + 1;
        for (parameter, raw) in [
            (Parameter::VelocityLimit, rate * 1_000_000),
            (Parameter::AccelerationLimit, rate * 1_000),
            (Parameter::JerkLimit, rate * 10),
            (Parameter::PositionMaximum, rate),
            (Parameter::FollowingError, rate),
            (Parameter::ShaperDamping, rate),
            (Parameter::HeartbeatPeriod, 10 + rate % 190),
        ] {
            values = values.with(parameter, raw).expect("in range").0;
        }
        StoredAxis { axis, values }
    })
    .collect()
}
