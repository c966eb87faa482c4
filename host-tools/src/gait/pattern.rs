//! The gaits by name: who lifts when, and for how long.

use super::error::GaitError;
use crate::notation::Range;

/// How many legs walk.
pub const LEGS: usize = 4;

/// The legs in their order everywhere.
pub const LEG_NAMES: [&str; LEGS] = ["front left", "front right", "rear left", "rear right"];

/// A gait by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// All feet on the ground.
    Stand,
    /// One foot after the other, three always on the ground.
    Walk,
    /// The diagonal pairs in turn.
    Trot,
    /// The pairs of a side in turn.
    Pace,
    /// The front pair and the rear pair in turn.
    Bound,
    /// All four together.
    Pronk,
    /// The rear feet shortly one after the other, then the front feet.
    Gallop,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Stand,
        Self::Walk,
        Self::Trot,
        Self::Pace,
        Self::Bound,
        Self::Pronk,
        Self::Gallop,
    ];

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stand => "stand",
            Self::Walk => "walk",
            Self::Trot => "trot",
            Self::Pace => "pace",
            Self::Bound => "bound",
            Self::Pronk => "pronk",
            Self::Gallop => "gallop",
        }
    }

    /// What it is, in a sentence.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Stand => "all feet on the ground",
            Self::Walk => "one foot after the other, three always on the ground",
            Self::Trot => "the diagonal pairs in turn",
            Self::Pace => "the pairs of a side in turn",
            Self::Bound => "the front pair and the rear pair in turn",
            Self::Pronk => "all four together",
            Self::Gallop => "the rear feet shortly one after the other, then the front feet",
        }
    }

    /// The gait as it usually is; none for standing.
    pub const fn gait(self) -> Option<Gait> {
        let (offsets, period, duty) = match self {
            Self::Stand => return None,
            Self::Walk => ([0.0, 0.5, 0.75, 0.25], 1.2, 0.75),
            Self::Trot => ([0.0, 0.5, 0.5, 0.0], 0.4, 0.5),
            Self::Pace => ([0.5, 0.0, 0.5, 0.0], 0.6, 0.5),
            Self::Bound => ([0.0, 0.0, 0.5, 0.5], 0.6, 0.5),
            Self::Pronk => ([0.0; LEGS], 0.6, 0.5),
            Self::Gallop => ([0.0, 0.2, 0.7, 0.9], 0.6, 0.5),
        };
        Some(Gait {
            offsets,
            period,
            duty,
            overlay: 0.0,
            swing: 0.03,
            stance: 0.0,
        })
    }
}

/// When each foot is on the ground, and how high it goes in between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gait {
    /// When each foot comes down, as a share of the cycle from 0 to 1: front left, front right,
    /// rear left, rear right.
    pub offsets: [f64; LEGS],
    /// How long a cycle lasts, in s.
    pub period: f64,
    /// Which share of the cycle a foot is on the ground.
    pub duty: f64,
    /// How much longer it stays there, as a share of the cycle; added to the duty.
    pub overlay: f64,
    /// How high a foot is lifted, in m.
    pub swing: f64,
    /// How deep a foot pushes below the ground in the middle of its stance, in m.
    pub stance: f64,
}

/// How long a foot may be in the air, in s.
const SWING_TIME: [f64; 2] = [0.02, 20.0];

impl Gait {
    /// The share of the cycle that a foot is on the ground, overlay included.
    pub fn ground_share(&self) -> f64 {
        self.duty + self.overlay
    }

    /// Whether it can be walked.
    ///
    /// # Errors
    /// The field that is out of its range: offsets from 0 to 1, a period from 0.05 to 20 s,
    /// a duty with its overlay from 0.1 to 0.95, heights from 0 to 1 m, and at least 20 ms in the
    /// air.
    pub fn check(&self) -> Result<(), GaitError> {
        let share = |field, least, most, cure| Range {
            field,
            unit: "of the cycle",
            least,
            most,
            cure,
        };
        let offset = share("a phase offset", 0.0, 1.0, "leave out whole cycles");
        for value in self.offsets {
            offset.check(value)?;
        }
        let in_metres = |field, most, cure| Range {
            field,
            unit: "m",
            least: 0.0,
            most,
            cure,
        };
        Range {
            field: "the period",
            unit: "s",
            least: 0.05,
            most: 20.0,
            cure: "give it in s, such as 0.4",
        }
        .check(self.period)?;
        share("the duty", 0.1, 0.95, "a half is a trot's").check(self.duty)?;
        share("the overlay", 0.0, 0.85, "choose a smaller one").check(self.overlay)?;
        share(
            "the duty with the overlay",
            0.1,
            0.95,
            "choose a smaller overlay",
        )
        .check(self.ground_share())?;
        in_metres("the swing height", 1.0, "give it in m, such as 0.03").check(self.swing)?;
        in_metres("the stance depth", 0.1, "give it in m, such as 0.003").check(self.stance)?;
        let swing = (1.0 - self.ground_share()) * self.period;
        let [least, most] = SWING_TIME;
        if (least..=most).contains(&swing) {
            Ok(())
        } else {
            Err(GaitError::Swing { swing, least, most })
        }
    }
}
