//! Any profile as one type.

use canter_shared::motion::beta::{exact, general};
use canter_shared::motion::polynomial::{Cubic, Quintic, Septic};
use canter_shared::motion::segments::Segments;
use canter_shared::motion::trajectory::{Peaks, Sample, Trajectory};

/// A profile that was made.
#[derive(Debug, Clone)]
pub enum Curve {
    /// The beta S-curve.
    Beta(exact::Profile),
    /// The beta S-curve with another exponent.
    General(general::Profile),
    /// Pieces of constant jerk: a trapezoid or an s-curve.
    Pieces(Box<Segments>),
    /// A polynomial of degree three.
    Cubic(Cubic),
    /// A polynomial of degree five.
    Quintic(Quintic),
    /// A polynomial of degree seven.
    Septic(Septic),
}

impl Curve {
    fn inner(&self) -> &dyn Trajectory {
        match self {
            Self::Beta(profile) => profile,
            Self::General(profile) => profile,
            Self::Pieces(segments) => segments.as_ref(),
            Self::Cubic(polynomial) => polynomial,
            Self::Quintic(polynomial) => polynomial,
            Self::Septic(polynomial) => polynomial,
        }
    }
}

impl Trajectory for Curve {
    fn duration(&self) -> f64 {
        self.inner().duration()
    }

    fn at(&self, time: f64) -> Sample {
        self.inner().at(time)
    }

    fn peaks(&self) -> Peaks {
        self.inner().peaks()
    }
}
