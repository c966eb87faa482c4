//! Gaits: which foot is when on the ground, and where.
//!
//! | file | what it holds |
//! |---|---|
//! | `pattern` | the gaits by name: who lifts when, and for how long |
//! | `body` | what the body is asked to do |
//! | `quadruped` | where the legs are, and which axes move them |
//! | `blend` | from one command to the next without a jump |
//! | `rhythm` | the clock of the legs, and from one gait to the next |
//! | `ground` | where the body is on the ground |
//! | `walker` | one foot on the ground or above it |
//! | `planner` | the motion of every foot and joint, as time goes on |
//! | `course` | a whole walk offline: start, cycles, stop; its peaks |
//! | `picture` | a walk as charts |
//! | `error` | what a gait cannot be, and the cure |
//!
//! A foot on the ground stays where it is on the ground, and a foot in the air goes from rest to
//! rest, seen from the ground. The body's velocity changes without a jump of its acceleration. So
//! each foot, seen from the body, has a continuous acceleration, whatever is asked and whenever.

mod blend;
mod body;
mod course;
mod error;
mod ground;
mod pattern;
mod picture;
mod planner;
mod quadruped;
mod rhythm;
#[cfg(test)]
mod tests;
mod walker;

pub use body::Body;
pub use course::{AxisPeaks, Course, Peaks, Request};
pub use error::GaitError;
pub use ground::Pose;
pub use pattern::{Gait, Kind, LEG_NAMES, LEGS};
pub use picture::svg;
pub use planner::{Planner, State};
pub use quadruped::{Mount, Quadruped};
