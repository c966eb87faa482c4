//! What must always hold: one table, from which `docs/soak.md` is checked.

use std::fmt;

use canter_shared::time::Tick;
use canter_shared::wire::id::AxisId;

use crate::sim::TrueTime;

macro_rules! invariants {
    ($($invariant:ident = $name:literal, $meaning:literal;)*) => {
        /// Something that must hold whatever happens.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Invariant {
            $(#[doc = $meaning] $invariant,)*
        }

        impl Invariant {
            /// Every invariant.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$invariant),*];

            /// Its name.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$invariant => $name,)*
                }
            }

            /// What must hold.
            pub const fn meaning(self) -> &'static str {
                match self {
                    $(Self::$invariant => $meaning,)*
                }
            }
        }
    };
}

invariants! {
    Limits = "limits", "every setpoint is inside the limits of velocity, acceleration and travel that are in force, and outside the travel only on the way from where the axis was enabled";
    Continuity = "continuity", "a setpoint follows from the one before: position from the velocity between, velocity from the acceleration limit; torque comes on where the drive is; each millisecond has its setpoint";
    Commander = "commander", "an axis moves only while it is enabled and held by a session that beat within the time-out and commanded that motion, or while it comes to rest";
    Stop = "stop", "after a stop, an emergency stop, a fault or the loss of its session an axis rests within the time that its limits allow";
    Latch = "latch", "a fault stays latched until its holder clears it or the node loses its power; no torque with a latched fault at rest; nothing is enabled unless its holder asks";
    Parameters = "parameters", "parameters change only as their holder writes them, and after a loss of power are what was saved last or was being saved, never a mixture";
    Answers = "answers", "each command is answered at most once, accepted only from who may, and a repetition starts nothing again";
    Panic = "panic", "nothing panics";
}

impl fmt::Display for Invariant {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// That an invariant did not hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Violation {
    /// The seed.
    pub seed: u64,
    /// Which invariant.
    pub invariant: Invariant,
    /// Of which axis; none where it is not about one.
    pub axis: Option<AxisId>,
    /// The last tick of that axis by its node's clock.
    pub tick: Tick,
    /// When, in true time.
    pub time: TrueTime,
    /// What was seen, and what should have been.
    pub detail: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}", self.invariant)?;
        if let Some(axis) = self.axis {
            write!(formatter, ", axis {axis}")?;
        }
        write!(
            formatter,
            ", seed {}, tick {}, at {:.6} s: {}",
            self.seed,
            self.tick.0,
            self.time.0 as f64 / 1e9,
            self.detail
        )
    }
}
