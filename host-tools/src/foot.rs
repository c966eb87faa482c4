//! Foot trajectories: one cycle of one leg, stance first, in closed form.
//!
//! | file | what it holds |
//! |---|---|
//! | `step` | one step through the air in three dimensions |
//! | `law` | the acceleration laws that it is made of |
//! | `error` | why a trajectory cannot be had |

pub mod error;
mod law;
pub mod step;

pub use error::FootError;
pub use step::Step;
