//! A robot that walks on a bus: checked, stood up, led by orders, settled and sat down.
//!
//! | file | what it holds |
//! |---|---|
//! | `order` | what may be asked of a robot under way, and how it is written |
//! | `sequence` | the whole motion as time goes on: up, walk, settle, down |
//! | `climb` | a body that stands, slowly up or down |
//! | `joints` | all joints of a quadruped in a row |
//! | `foresight` | an order tried out ahead, refused before it breaks a limit |
//! | `knots` | the motion as knots for streams, close to it between them too |
//! | `budget` | what a stream, feedback, SYNC and heartbeats take of the bus |
//! | `preflight` | what is checked before anything moves |
//! | `run` | all of it, on a client |
//! | `replay` | the motion once more, from the orders that were taken |
//! | `error` | what goes wrong, and the cure |

mod budget;
mod climb;
mod error;
mod foresight;
pub mod joints;
mod knots;
mod order;
mod preflight;
mod replay;
mod run;
mod sequence;
#[cfg(test)]
mod tests;

pub use budget::{Budget, Share};
pub use error::WalkError;
pub use order::{Line, Order, OrderError};
pub use preflight::{Item, Preflight, preflight};
pub use replay::Replay;
pub use run::{Orders, Walked, walk};
pub use sequence::{Phase, Sequence, Settings};
