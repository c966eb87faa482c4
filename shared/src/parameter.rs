//! Parameters: what can be set about an axis, and what it means for the axis.
//!
//! | file | what it holds |
//! |---|---|
//! | `table` | every parameter: name, unit, range, default, when it may change |
//! | `values` | one axis's raw values |
//! | `settings` | what they mean, checked against each other |
//! | `drive` | what they mean for the link to the drive |
//! | `store` | how they outlive a loss of power |
//! | `flash` | a flash in memory |
//!
//! A raw value is a whole number; the value that is meant is `raw / per_unit` in the parameter's
//! unit. So what a person writes with a few decimals is kept exactly, and comes back as written.

mod drive;
pub mod flash;
mod settings;
pub mod store;
mod table;
mod values;

pub use settings::{Reaction, Reactions, Settings};
pub use table::{Change, Default, Entry, Kind, Parameter};
pub use values::{ParameterError, Values};
