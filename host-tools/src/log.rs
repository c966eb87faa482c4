//! Files of what happened: the bus in the format of can-utils, and setpoints as CSV.
//!
//! | file | what it holds |
//! |---|---|
//! | `candump` | the lines of `candump -L`, written and read |
//! | `setpoints` | one row for each axis and tick |

pub mod candump;
mod setpoints;

pub use setpoints::SetpointsCsv;
pub(crate) use setpoints::{Rates, Seconds};
