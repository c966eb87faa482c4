//! Paths: through waypoints of several axes, timed within their limits.
//!
//! A path is planned in two steps. Its shape is one curve through the waypoints, over a parameter
//! that has nothing to do with time yet. Its timing then says how fast that parameter runs, so that
//! no axis breaks a limit of its own.
//!
//! | file | what it holds |
//! |---|---|
//! | `waypoints` | what a path goes through |
//! | `file` | waypoints from CSV and TOML |
//! | `shape` | the curve: quintics with continuous first and second derivatives |
//! | `bounds` | what the axes, and the path as a whole, may do |
//! | `two_pass` | the quickest timing that keeps velocities and accelerations |
//! | `jerk_limited` | a timing that keeps jerks too |
//! | `timed` | both together: where each axis is when |
//! | `knots` | the same for a stream to the axes |
//! | `picture` | the same as SVG |
//! | `peak` | the greatest of what is seen at places only |
//! | `planar` | one segment in the plane, from a heading and speed to another |
//! | `error` | why a path cannot be had |

pub mod bounds;
pub mod error;
pub mod file;
mod jerk_limited;
pub mod knots;
mod peak;
pub mod picture;
pub mod planar;
pub mod shape;
pub mod timed;
mod two_pass;
pub mod waypoints;

pub use bounds::{AxisBounds, PathBounds};
pub use error::PathError;
pub use timed::{Request, Share, TimedPath, Timing, plan};
pub use waypoints::{Waypoint, Waypoints};

#[cfg(test)]
mod tests;
