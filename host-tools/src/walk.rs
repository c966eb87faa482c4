//! A robot that walks on a bus: checked, stood up, led by orders, settled and sat down.
//!
//! | file | what it holds |
//! |---|---|
//! | `order` | what may be asked of a robot under way, and how it is written |
//! | `sequence` | the whole motion as time goes on: up, walk, settle, down |
//! | `foresight` | an order tried out ahead, refused before it breaks a limit |
//! | `knots` | the motion as knots for streams, close to it between them too |
//! | `budget` | what a stream, feedback, SYNC and heartbeats take of the bus |
//! | `preflight` | what is checked before anything moves |
//! | `run` | all of it, on a client |
//! | `replay` | the motion once more, from the orders that were taken |
//! | `error` | what goes wrong, and the cure |

mod budget;
mod error;
mod foresight;
mod knots;
mod order;
mod preflight;
mod replay;
mod run;
mod sequence;

pub use budget::Budget;
pub use error::WalkError;
pub use order::{Order, OrderError};
pub use preflight::Preflight;
pub use replay::Replay;
pub use run::{Orders, Walked, preflight, walk};
pub use sequence::{Phase, Sequence, Settings};
