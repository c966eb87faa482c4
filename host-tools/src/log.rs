//! Files of what happened: the bus in the format of can-utils, and setpoints as CSV.
//!
//! | file | what it holds |
//! |---|---|
//! | `candump` | the lines of `candump -L`, written and read |
//! | `decode` | what a frame says |
//! | `reader` | a whole log, line by line |
//! | `replay` | what hosts said, once more |
//! | `statistics` | how full a bus was, and of what |
//! | `setpoints` | one row for each axis and tick |

pub mod candump;
mod decode;
mod reader;
mod replay;
mod setpoints;
mod statistics;

pub use decode::{Decoded, Value, decode};
pub use reader::{Entry, ReadError, Reader};
pub use replay::{ReplayError, Replayed, replay};
pub use setpoints::SetpointsCsv;
pub(crate) use setpoints::{Rates, Seconds};
pub use statistics::{MessageCount, Statistics, Traffic};
