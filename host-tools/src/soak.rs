//! Random robots under random traffic and faults, against the invariants that canter promises.
//!
//! One seed is one episode: a robot, its commander, whoever else is on the bus, and what goes
//! wrong, for [`EPISODE`] of virtual time. `docs/soak.md` says the invariants in words.
//!
//! | file | what it holds |
//! |---|---|
//! | `fault` | what can go wrong, by name |
//! | `dice` | chance, from the seed |
//! | `scenario` | a seed's robot, and what is to happen to it |
//! | `actor` | who speaks on the bus: the commander, a rival, a hostile device |
//! | `invariant` | what must always hold, by name |
//! | `check` | sees what happens, and holds it to the invariants |
//! | `episode` | one seed, from its beginning to its end or to a violation |
//! | `recording` | bus.log, and its replay |
//! | `campaign` | many seeds, on some threads |
//! | `sabotage` | what tests break on purpose |

mod actor;
mod campaign;
mod check;
mod dice;
mod episode;
mod fault;
mod invariant;
mod recording;
mod sabotage;
mod scenario;

pub use campaign::{Campaign, Progress, Report};
pub use check::Statistics;
pub use episode::{EPISODE, Ending, Options, run};
pub use fault::{FaultKind, Faults, UnknownFault};
pub use invariant::{Invariant, Violation};
pub use recording::{Recording, ReplayError, replay};
pub use sabotage::Sabotage;
