//! Profiles offline: from what a person asks to a curve, its numbers and its picture.
//!
//! Units are the caller's own, except for `device`, which speaks rad as an axis does.
//!
//! | file | what it holds |
//! |---|---|
//! | `request` | what can be asked |
//! | `error` | why it cannot be had |
//! | `curve` | any profile as one type |
//! | `make` | from a request to a curve |
//! | `table` | at which times it is looked at, and what is seen |
//! | `array` | many points at once |
//! | `device` | the setpoints that a node would send |
//! | `vibration` | what a curve leaves a mass on a spring with |
//! | `compare` | the profiles side by side |
//! | `picture` | both as SVG |

pub mod array;
pub mod compare;
pub mod curve;
pub mod device;
pub mod error;
mod make;
pub mod picture;
pub mod request;
pub mod table;
pub mod vibration;

pub use curve::Curve;
pub use error::PlanError;
pub use make::{Planned, plan};
pub use request::{AskedLimits, Kind, Request};
