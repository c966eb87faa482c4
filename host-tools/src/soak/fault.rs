//! What can go wrong, by name: what `canter soak --faults` chooses from.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

macro_rules! kinds {
    ($($kind:ident = $name:literal, $meaning:literal;)*) => {
        /// A kind of fault. A seed draws for each kind that it may use whether it does, and how
        /// often.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum FaultKind {
            $(#[doc = $meaning] $kind,)*
        }

        impl FaultKind {
            /// Every kind.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$kind),*];

            /// Its name on the command line.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$kind => $name,)*
                }
            }

            /// What happens.
            pub const fn meaning(self) -> &'static str {
                match self {
                    $(Self::$kind => $meaning,)*
                }
            }
        }
    };
}

kinds! {
    Lost = "lost", "one receiver misses a frame, and nobody notices";
    Doubled = "doubled", "all receivers but one have a frame twice";
    Delayed = "delayed", "a node looks at no frame for some time";
    Corrupted = "corrupted", "the wire or a receiver is disturbed: error frames, repetitions, bus-off";
    Babbling = "babbling", "a strange device sends without a pause";
    Reset = "reset", "a node loses its power and comes back";
    HostKilled = "host-killed", "the commander's process ends, and another begins later";
    HostStalled = "host-stalled", "the commander stands still for some time, then goes on as if nothing were";
    SyncLost = "sync-lost", "the commander's SYNC does not come for some time";
    Drive = "drive", "a drive has a fault, lets go, falls silent or is blocked";
    PowerCutWhileSaving = "power-cut-while-saving", "the power fails while parameters are being saved";
    Rival = "rival", "a second host holds, moves and stops what it can get";
    Hostile = "hostile", "forged, wild, stale, doubled and malformed frames, also in floods";
}

impl fmt::Display for FaultKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// Some kinds of faults.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Faults(u32);

/// A name that no kind has.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "no fault is called '{name}': choose some of {}, or all, or none",
    names()
)]
pub struct UnknownFault {
    /// The name.
    pub name: String,
}

fn names() -> String {
    FaultKind::ALL.map(FaultKind::name).join(", ")
}

impl Faults {
    /// None of them.
    pub const NONE: Self = Self(0);
    /// All of them.
    pub const ALL: Self = Self((1 << FaultKind::ALL.len()) - 1);

    /// These and `kind`.
    #[must_use]
    pub const fn with(self, kind: FaultKind) -> Self {
        Self(self.0 | 1 << kind as u32)
    }

    /// Whether `kind` is one of them.
    pub const fn has(self, kind: FaultKind) -> bool {
        self.0 & 1 << kind as u32 != 0
    }
}

impl fmt::Display for Faults {
    /// As [`Faults::from_str`] reads it.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NONE => return formatter.write_str("none"),
            Self::ALL => return formatter.write_str("all"),
            _ => {}
        }
        let kinds = FaultKind::ALL.into_iter().filter(|kind| self.has(*kind));
        for (at, kind) in kinds.enumerate() {
            let comma = if at == 0 { "" } else { "," };
            write!(formatter, "{comma}{kind}")?;
        }
        Ok(())
    }
}

impl FromStr for Faults {
    type Err = UnknownFault;

    fn from_str(text: &str) -> Result<Self, UnknownFault> {
        let mut faults = Self::NONE;
        for name in text.split(',') {
            let name = name.trim();
            let kind = FaultKind::ALL.into_iter().find(|kind| kind.name() == name);
            faults = match (name, kind) {
                (_, Some(kind)) => faults.with(kind),
                ("all", None) => Self::ALL,
                ("none", None) => faults,
                (_, None) => return Err(UnknownFault { name: name.into() }),
            };
        }
        Ok(faults)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_read_and_written() {
        for text in ["all", "none", "lost", "reset,drive,hostile"] {
            assert_eq!(
                text.parse::<Faults>().map(|it| it.to_string()),
                Ok(text.into())
            );
        }
        let every = FaultKind::ALL.map(FaultKind::name).join(",");
        assert_eq!(every.parse(), Ok(Faults::ALL));
    }

    #[test]
    fn a_wrong_name_is_told_with_the_right_ones() {
        let error = "lost,goblins".parse::<Faults>().expect_err("no such fault");
        let words = error.to_string();
        assert!(words.contains("'goblins'"), "{words}");
        for kind in FaultKind::ALL {
            assert!(words.contains(kind.name()), "{words}");
        }
    }
}
