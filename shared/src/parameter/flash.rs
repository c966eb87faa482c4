//! A flash in memory, for targets that have no other: what it holds is lost with the power.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

/// Bytes that are programmed at once: those of an STM32G4, so that the same rules hold.
const WORD: usize = 8;

/// What an erased byte holds.
pub const ERASED: u8 = 0xFF;

/// `SIZE` bytes in pages of `PAGE`, which can be erased, and programmed once after that.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MemoryFlash<const SIZE: usize, const PAGE: usize> {
    bytes: [u8; SIZE],
}

impl<const SIZE: usize, const PAGE: usize> MemoryFlash<SIZE, PAGE> {
    /// As it comes from the factory: erased.
    pub const fn new() -> Self {
        Self {
            bytes: [ERASED; SIZE],
        }
    }

    /// What it holds.
    pub fn bytes(&self) -> &[u8; SIZE] {
        &self.bytes
    }

    /// What it holds, to change it by other ways than a flash's.
    pub fn bytes_mut(&mut self) -> &mut [u8; SIZE] {
        &mut self.bytes
    }

    fn part(&mut self, from: u32, length: usize) -> Result<&mut [u8], NorFlashErrorKind> {
        let from = from as usize;
        let part = self.bytes.get_mut(from..from.saturating_add(length));
        part.ok_or(NorFlashErrorKind::OutOfBounds)
    }
}

impl<const SIZE: usize, const PAGE: usize> Default for MemoryFlash<SIZE, PAGE> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const SIZE: usize, const PAGE: usize> ErrorType for MemoryFlash<SIZE, PAGE> {
    type Error = NorFlashErrorKind;
}

impl<const SIZE: usize, const PAGE: usize> ReadNorFlash for MemoryFlash<SIZE, PAGE> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len())?;
        let part = self.part(offset, bytes.len())?;
        for (to, from) in bytes.iter_mut().zip(part) {
            *to = *from;
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        SIZE
    }
}

impl<const SIZE: usize, const PAGE: usize> NorFlash for MemoryFlash<SIZE, PAGE> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        check_erase(self, from, to)?;
        self.part(from, to.saturating_sub(from) as usize)?
            .fill(ERASED);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        check_write(self, offset, bytes.len())?;
        let part = self.part(offset, bytes.len())?;
        // What is programmed already must be erased first, as on the chip.
        if part.iter().any(|byte| *byte != ERASED) {
            return Err(NorFlashErrorKind::Other);
        }
        for (to, from) in part.iter_mut().zip(bytes) {
            *to = *from;
        }
        Ok(())
    }
}
