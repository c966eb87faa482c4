//! A node's parameters in a file, by the same two slots as on a chip.

use super::file_flash::FileFlash;
use canter_shared::parameter::Values;
use canter_shared::parameter::store::{Image, Loaded, Store};
use canter_shared::wire::id::{AxisId, LAST_AXIS};
use std::fs::OpenOptions;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

/// Room for every axis that there can be.
pub(super) const AXES: usize = LAST_AXIS as usize;

/// Bytes of a slot: 63 axes need 16 475, in whole pages of 4096, and with room for more parameters.
const SLOT: u32 = 8 * 4096;

const _: () = assert!(Store::<FileFlash>::needed(AXES) <= SLOT as usize);

/// Why a store cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StoreFileError {
    /// It cannot be opened or made.
    #[error("cannot open the store {path}: {source}")]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Another node uses it.
    #[error("the store {path} is used by another node: give each node a file of its own")]
    Used {
        /// The file.
        path: PathBuf,
    },
    /// It keeps another number of axes.
    #[error(
        "the store {path} keeps {kept} axes, but --axes names {named}: name as many, or another file"
    )]
    Count {
        /// The file.
        path: PathBuf,
        /// Axes in it.
        kept: usize,
        /// Axes on the command line.
        named: usize,
    },
}

/// What a store held.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Kept {
    /// Nothing: a new one.
    Nothing,
    /// Something that cannot be read.
    Lost,
    /// The axes, in the node's order.
    Axes(Vec<(AxisId, Values)>),
}

/// A store in a file, which a thread of its own writes: a disk takes longer than a tick.
#[derive(Debug)]
pub struct StoreFile {
    path: PathBuf,
    kept: Kept,
    work: Sender<Image<AXES>>,
    done: Receiver<(Image<AXES>, bool)>,
}

impl StoreFile {
    /// Opens the file, or makes it, and reads what it keeps.
    ///
    /// # Errors
    /// It cannot be opened, or another node has it.
    pub fn open(path: &Path) -> Result<Self, StoreFileError> {
        let open = |source| StoreFileError::Open {
            path: path.to_owned(),
            source,
        };
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .map_err(open)?;
        // Two that write would mix what neither alone can. The lock ends with the process.
        file.try_lock().map_err(|error| match error {
            std::fs::TryLockError::WouldBlock => StoreFileError::Used {
                path: path.to_owned(),
            },
            std::fs::TryLockError::Error(source) => open(source),
        })?;
        let flash = FileFlash::new(file, 2 * SLOT as usize).map_err(open)?;
        let mut store = Store::new(flash, 0, SLOT);
        let kept = match store.load::<AXES>() {
            Loaded::Empty => Kept::Nothing,
            Loaded::Lost => Kept::Lost,
            Loaded::Image(image) => {
                let axes = image.iter().map(|stored| {
                    let axis = AxisId::new(stored.axis)?;
                    Some((axis, stored.values))
                });
                axes.collect::<Option<_>>().map_or(Kept::Lost, Kept::Axes)
            }
        };
        let (work, images) = channel::<Image<AXES>>();
        let (results, done) = channel();
        let name = path.to_owned();
        thread::spawn(move || {
            // Ends when the node does.
            for image in images {
                let saved = store.save(&image);
                if let Err(error) = &saved {
                    eprintln!("cannot save to {}: {error}", name.display());
                }
                let _ = results.send((image, saved.is_ok()));
            }
        });
        Ok(Self {
            path: path.to_owned(),
            kept,
            work,
            done,
        })
    }

    pub(super) fn kept(&self) -> &Kept {
        &self.kept
    }

    pub(super) fn wrong_count(&self, kept: usize, named: usize) -> StoreFileError {
        let path = self.path.clone();
        StoreFileError::Count { path, kept, named }
    }

    /// Begins to write; false where that cannot be.
    pub(super) fn save(&self, image: Image<AXES>) -> bool {
        self.work.send(image).is_ok()
    }

    /// An image that has been written, or could not be.
    pub(super) fn finished(&self) -> Option<(Image<AXES>, bool)> {
        self.done.try_recv().ok()
    }
}
