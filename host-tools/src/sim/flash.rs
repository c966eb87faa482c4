//! A node's flash: NOR cells in memory, and a power that can fail in the middle of a write.
//!
//! As in the STM32G4: pages of 2 KiB, written in double words of 8 bytes, and an error for one
//! that is written twice without being erased, unless it is to hold nothing but zeros.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read,
    check_write,
};

use super::random::SplitMix64;

/// Bytes of a page.
pub const PAGE: usize = 2048;

/// Bytes that are written at once.
const WORD: usize = 8;

/// What an erased byte reads as.
const ERASED: u8 = 0xFF;

/// Why the flash did not do what it was told to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum FlashError {
    /// The power failed meanwhile, or has failed before.
    #[error("the power has failed: the operation is not done, or half done")]
    PowerCut,
    /// A place outside, or not at the beginning of a word or page.
    #[error("the flash has no such place: {0}")]
    Place(NorFlashErrorKind),
    /// The word has been written since its page was erased.
    #[error("the word at offset {offset} is not erased: erase its page before writing it again")]
    NotErased {
        /// Of the word, from the beginning of the flash.
        offset: usize,
    },
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Place(kind) => *kind,
            Self::PowerCut | Self::NotErased { .. } => NorFlashErrorKind::Other,
        }
    }
}

/// Flash of whole pages, erased at first. What it holds outlives its node.
#[derive(Debug, Clone)]
pub struct SimulatedFlash {
    bytes: Vec<u8>,
    /// Words written and pages erased, half done ones included.
    operations: u64,
    /// Operations that are still whole before the power fails.
    left: Option<u32>,
    cut: bool,
    /// What is left of a half done operation.
    random: SplitMix64,
}

impl SimulatedFlash {
    /// `pages` erased pages; the seed says how half done operations turn out.
    pub fn new(pages: usize, seed: u64) -> Self {
        Self {
            bytes: vec![ERASED; pages * PAGE],
            operations: 0,
            left: None,
            cut: false,
            random: SplitMix64::new(seed),
        }
    }

    /// Has the power fail in the middle of the next operation after `after` whole ones: one word
    /// written, or one page erased. From then on nothing works until [`Self::restore`].
    pub fn cut_after(&mut self, after: u32) {
        self.left = Some(after);
    }

    /// Whether the power has failed.
    pub fn is_cut(&self) -> bool {
        self.cut
    }

    /// The power is back, and fails no more.
    pub fn restore(&mut self) {
        self.cut = false;
        self.left = None;
    }

    /// How many words were written and pages erased so far, half done ones included.
    pub fn operations(&self) -> u64 {
        self.operations
    }

    /// Begins an operation; says whether it will be whole.
    fn begin(&mut self) -> Result<bool, FlashError> {
        if self.cut {
            return Err(FlashError::PowerCut);
        }
        self.operations += 1;
        match &mut self.left {
            Some(0) => {
                self.cut = true;
                Ok(false)
            }
            Some(left) => {
                *left -= 1;
                Ok(true)
            }
            None => Ok(true),
        }
    }

    fn program(&mut self, offset: usize, word: &[u8]) -> Result<(), FlashError> {
        let cells = offset..offset + WORD;
        let erased = self.bytes[cells.clone()].iter().all(|byte| *byte == ERASED);
        if !erased && word.iter().any(|byte| *byte != 0) {
            return Err(FlashError::NotErased { offset });
        }
        let whole = self.begin()?;
        for (cell, byte) in self.bytes[cells].iter_mut().zip(word) {
            // Bits go from 1 to 0, and not all of them got so far.
            let not_yet = if whole { 0 } else { self.random.next() as u8 };
            *cell &= byte | not_yet;
        }
        if whole {
            Ok(())
        } else {
            Err(FlashError::PowerCut)
        }
    }

    fn wipe(&mut self, page: usize) -> Result<(), FlashError> {
        let whole = self.begin()?;
        for cell in &mut self.bytes[page..page + PAGE] {
            // Bits go from 0 to 1, and not all of them got so far.
            let already = if whole {
                ERASED
            } else {
                self.random.next() as u8
            };
            *cell |= already;
        }
        if whole {
            Ok(())
        } else {
            Err(FlashError::PowerCut)
        }
    }
}

impl ErrorType for SimulatedFlash {
    type Error = FlashError;
}

impl ReadNorFlash for SimulatedFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        if self.cut {
            return Err(FlashError::PowerCut);
        }
        check_read(self, offset, bytes.len()).map_err(FlashError::Place)?;
        let offset = offset as usize;
        bytes.copy_from_slice(&self.bytes[offset..offset + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for SimulatedFlash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        check_erase(self, from, to).map_err(FlashError::Place)?;
        (from as usize..to as usize)
            .step_by(PAGE)
            .try_for_each(|page| self.wipe(page))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        check_write(self, offset, bytes.len()).map_err(FlashError::Place)?;
        let words = bytes.chunks(WORD).enumerate();
        words
            .map(|(at, word)| (offset as usize + at * WORD, word))
            .try_for_each(|(offset, word)| self.program(offset, word))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(flash: &mut SimulatedFlash, offset: u32) -> [u8; WORD] {
        let mut word = [0; WORD];
        flash.read(offset, &mut word).expect("there is power");
        word
    }

    #[test]
    fn what_was_written_is_read_until_it_is_erased() {
        let mut flash = SimulatedFlash::new(2, 1);
        flash.write(PAGE as u32 + 8, &[7; 24]).expect("erased");
        assert_eq!(read(&mut flash, PAGE as u32 + 16), [7; 8]);
        flash.erase(0, PAGE as u32).expect("a page");
        assert_eq!(read(&mut flash, PAGE as u32 + 16), [7; 8]);
        flash.erase(PAGE as u32, 2 * PAGE as u32).expect("a page");
        assert_eq!(read(&mut flash, PAGE as u32 + 16), [0xFF; 8]);
        assert_eq!(flash.operations(), 5);
    }

    #[test]
    fn a_word_is_written_once_and_may_then_be_cleared() {
        let mut flash = SimulatedFlash::new(1, 1);
        flash.write(8, &[1; 8]).expect("erased");
        let refused = FlashError::NotErased { offset: 8 };
        assert_eq!(flash.write(0, &[2; 16]), Err(refused));
        // The first of the two words was in order.
        assert_eq!(read(&mut flash, 0), [2; 8]);
        assert_eq!(read(&mut flash, 8), [1; 8]);
        flash.write(8, &[0; 8]).expect("zeros");
        assert_eq!(read(&mut flash, 8), [0; 8]);
    }

    #[test]
    fn places_that_are_not_there_are_refused() {
        let mut flash = SimulatedFlash::new(1, 1);
        let unaligned = Err(FlashError::Place(NorFlashErrorKind::NotAligned));
        let outside = Err(FlashError::Place(NorFlashErrorKind::OutOfBounds));
        assert_eq!(flash.write(4, &[1; 8]), unaligned);
        assert_eq!(flash.write(0, &[1; 7]), unaligned);
        assert_eq!(flash.write(PAGE as u32, &[1; 8]), outside);
        assert_eq!(flash.erase(0, 100), unaligned);
        assert_eq!(flash.operations(), 0);
    }

    #[test]
    fn a_power_cut_leaves_one_operation_half_done_and_the_next_not_begun() {
        let (mut torn, mut half_erased) = (0, 0);
        for seed in 0..20 {
            let mut flash = SimulatedFlash::new(1, seed);
            flash.cut_after(1);
            let written = [0b0101_0101; 24];
            assert_eq!(flash.write(0, &written), Err(FlashError::PowerCut));
            assert!(flash.is_cut());
            assert_eq!(flash.write(0, &[0; 8]), Err(FlashError::PowerCut));
            assert_eq!(flash.erase(0, PAGE as u32), Err(FlashError::PowerCut));
            assert_eq!(flash.read(0, &mut [0]), Err(FlashError::PowerCut));
            flash.restore();
            assert_eq!(read(&mut flash, 0), written[..8]);
            let half = read(&mut flash, 8);
            assert!(half.iter().all(|byte| byte & written[0] == written[0]));
            torn += usize::from(half != written[..8] && half != [0xFF; 8]);
            assert_eq!(read(&mut flash, 16), [0xFF; 8]);

            flash.cut_after(0);
            assert_eq!(flash.erase(0, PAGE as u32), Err(FlashError::PowerCut));
            flash.restore();
            let page = read(&mut flash, 0);
            half_erased += usize::from(page != [0xFF; 8] && page != written[..8]);
        }
        assert!(torn > 15 && half_erased > 15, "{torn} {half_erased}");
    }
}
