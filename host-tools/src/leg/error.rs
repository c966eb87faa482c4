//! What a leg cannot do, and by how much.

use thiserror::Error;

/// Why a leg has no such joints, foot, rates or lengths.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum LegError {
    /// A number is none, or out of its range.
    #[error("{field} = {value}: it must be a number from {least} to {most} {unit}")]
    OutOfRange {
        /// Which number.
        field: &'static str,
        /// What it is.
        value: f64,
        /// The least that it may be.
        least: f64,
        /// The most that it may be.
        most: f64,
        /// What it is in.
        unit: &'static str,
    },
    /// The foot is beyond the reach of a thigh and its shank.
    #[error(
        "the foot is {} too far from the {from}: it is {} away, and the leg reaches {}: bring it nearer",
        millimetres(.distance - .reach), millimetres(*.distance), millimetres(*.reach)
    )]
    TooFar {
        /// The joint that it is too far from.
        from: &'static str,
        /// How far it is from there in the leg's plane, in m.
        distance: f64,
        /// How far it may be, in m.
        reach: f64,
    },
    /// The foot is nearer than a thigh and its shank fold.
    #[error(
        "the foot is {} too near to the {to}: it is {} away, and the leg folds to {}: move it away",
        millimetres(.least - .distance), millimetres(*.distance), millimetres(*.least)
    )]
    TooNear {
        /// The joint that it is too near to.
        to: &'static str,
        /// How far it is from there in the leg's plane, in m.
        distance: f64,
        /// How far it has to be, in m.
        least: f64,
    },
    /// The foot is nearer to the axis of abduction than the leg's plane.
    #[error(
        "the foot is {} too near to the axis of abduction: it is {} away, and the leg's plane is {} from it: move it away",
        millimetres(.least - .distance), millimetres(*.distance), millimetres(*.least)
    )]
    NearHipAxis {
        /// How far it is from the axis, in m.
        distance: f64,
        /// How far the leg's plane is from the axis, in m.
        least: f64,
    },
    /// The knees of a five-bar are further apart than its lower links span.
    #[error(
        "the lower links do not meet: the knees are {} apart, {} more than both links are long: turn the motors towards each other",
        millimetres(*.distance), millimetres(.distance - .reach)
    )]
    KneesApart {
        /// How far the knees are apart, in m.
        distance: f64,
        /// How far they may be, in m.
        reach: f64,
    },
    /// A foot of a five-bar that its lower links would have to pass through each other for.
    #[error(
        "the lower links would have to pass through each other, by {angle} rad: move the foot towards the middle, below the motors"
    )]
    KneesCrossed {
        /// How far they would be past each other, in rad.
        angle: f64,
    },
    /// A motion is asked for where the joints would have to be infinitely fast.
    #[error(
        "{what}, to within {angle:e} rad, so the leg is singular and the joints would have to be infinitely fast: \
         at least {least} rad are needed: {cure}"
    )]
    Singular {
        /// What is degenerate.
        what: &'static str,
        /// How far from degenerate it is, in rad.
        angle: f64,
        /// How far it has to be, in rad.
        least: f64,
        /// What to do.
        cure: &'static str,
    },
}

impl LegError {
    /// By how much a chain misses its foot, in m; 0 for other errors.
    pub(super) fn missed_by(&self) -> f64 {
        match self {
            Self::TooFar {
                distance, reach, ..
            } => distance - reach,
            Self::TooNear {
                distance, least, ..
            } => least - distance,
            _ => 0.0,
        }
    }
}

/// A length in mm, in digits that show it even where it is tiny.
fn millimetres(metres: f64) -> String {
    let value = metres * 1e3;
    if value == 0.0 || value.abs() >= 1e-3 {
        format!("{value:.3} mm")
    } else {
        format!("{value:.3e} mm")
    }
}

/// The number if it is one and in its range.
pub(crate) fn in_range(
    field: &'static str,
    value: f64,
    [least, most]: [f64; 2],
    unit: &'static str,
) -> Result<f64, LegError> {
    // A NaN is in no range.
    if (least..=most).contains(&value) {
        Ok(value)
    } else {
        Err(LegError::OutOfRange {
            field,
            value,
            least,
            most,
            unit,
        })
    }
}
