//! A file as a flash: the store's rules hold on a disk as they do on a chip.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read,
    check_write,
};
use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt;

/// Bytes that are erased at once: a block of most file systems.
const PAGE: usize = 4096;

/// What an erased byte holds.
const ERASED: u8 = 0xFF;

/// A file of fixed size. Each change is on the disk before the next one begins: otherwise the order
/// that the store relies on would be the disk's to choose.
#[derive(Debug)]
pub(super) struct FileFlash {
    file: File,
    size: usize,
}

/// What the system said.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub(super) struct FileFlashError(#[from] io::Error);

impl FileFlash {
    /// Makes the file `size` bytes long; what is new in it is erased. A file of another length that
    /// holds anything is somebody else's, and stays as it is.
    pub(super) fn new(file: File, size: usize) -> io::Result<Self> {
        let length = file.metadata()?.len();
        if length != size as u64 {
            // What was left of making it may be shorter, but then it is still erased.
            let mut begun = vec![0; (length as usize).min(size)];
            file.read_exact_at(&mut begun, 0)?;
            if length > size as u64 || begun.iter().any(|byte| *byte != ERASED) {
                let words = "it is no store of this version of canter's: name another file";
                return Err(io::Error::new(io::ErrorKind::InvalidData, words));
            }
        }
        let missing = (size as u64).saturating_sub(length) as usize;
        file.write_all_at(&vec![ERASED; missing], length)?;
        file.sync_all()?;
        Ok(Self { file, size })
    }
}

impl From<NorFlashErrorKind> for FileFlashError {
    fn from(kind: NorFlashErrorKind) -> Self {
        Self(io::Error::new(
            io::ErrorKind::InvalidInput,
            kind.to_string(),
        ))
    }
}

impl NorFlashError for FileFlashError {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl ErrorType for FileFlash {
    type Error = FileFlashError;
}

impl ReadNorFlash for FileFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len())?;
        Ok(self.file.read_exact_at(bytes, offset.into())?)
    }

    fn capacity(&self) -> usize {
        self.size
    }
}

impl NorFlash for FileFlash {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        check_erase(self, from, to)?;
        self.file
            .write_all_at(&vec![ERASED; (to - from) as usize], from.into())?;
        Ok(self.file.sync_data()?)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        check_write(self, offset, bytes.len())?;
        self.file.write_all_at(bytes, offset.into())?;
        Ok(self.file.sync_data()?)
    }
}
