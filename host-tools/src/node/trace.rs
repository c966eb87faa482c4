//! The trace of a node: every setpoint of every tick as CSV.

use crate::log::{Rates, Seconds};
use canter_shared::node::AxisSetpoint;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Ticks after which the file is brought up to date, so that it can be read while it grows and
/// loses little when the process is killed.
const FLUSH_TICKS: u32 = 50;

/// A trace that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write the trace {path}: {source}")]
pub struct TraceError {
    path: PathBuf,
    source: std::io::Error,
}

/// `t,axis,state,position,velocity,acceleration`: bus time in s, rad and its rates; the numbers
/// read back exactly.
#[derive(Debug)]
pub struct Trace {
    path: PathBuf,
    file: BufWriter<File>,
    unflushed: u32,
}

impl Trace {
    /// Creates the file, or empties it.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn create(path: &Path) -> Result<Self, TraceError> {
        let file = File::create(path).map_err(|source| TraceError {
            path: path.to_owned(),
            source,
        })?;
        let mut trace = Self {
            path: path.to_owned(),
            file: BufWriter::with_capacity(1 << 16, file),
            unflushed: 0,
        };
        let header = "t,axis,state,position,velocity,acceleration";
        trace.attempt(|file| writeln!(file, "{header}"))?;
        trace.flush()?;
        Ok(trace)
    }

    /// Adds the setpoints of one tick.
    pub(super) fn write(&mut self, setpoints: &[AxisSetpoint]) -> Result<(), TraceError> {
        for row in setpoints {
            let (time, rates) = (Seconds(row.tick), Rates(row.setpoint));
            let (axis, state) = (row.axis, row.state);
            self.attempt(|file| writeln!(file, "{time},{axis},{state},{rates}"))?;
        }
        self.unflushed += 1;
        if self.unflushed >= FLUSH_TICKS {
            self.flush()?;
        }
        Ok(())
    }

    /// Brings the file up to date.
    pub(super) fn flush(&mut self) -> Result<(), TraceError> {
        self.unflushed = 0;
        self.attempt(|file| file.flush())
    }

    fn attempt(
        &mut self,
        write: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
    ) -> Result<(), TraceError> {
        write(&mut self.file).map_err(|source| TraceError {
            path: self.path.clone(),
            source,
        })
    }
}
