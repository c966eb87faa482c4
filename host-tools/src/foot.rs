//! Foot trajectories: one cycle of one leg, stance first, in closed form.
//!
//! | file | what it holds |
//! |---|---|
//! | `cycle` | one cycle of one foot: position, velocity, acceleration at a time |
//! | `preset` | the shapes that there are: the published ones and ours |
//! | `compare` | them side by side, as numbers and as SVG |
//! | `step` | one step through the air in three dimensions |
//! | `law` | the acceleration laws that it is made of |
//! | `error` | why a trajectory cannot be had |

pub mod compare;
pub mod cycle;
pub mod error;
pub(crate) mod law;
pub mod preset;
pub mod step;

pub use cycle::{Cycle, CycleRequest, Phase};
pub use error::FootError;
pub use preset::Preset;
pub use step::Step;
