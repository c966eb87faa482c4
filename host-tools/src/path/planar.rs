//! One segment in the plane, from place, heading, speed and acceleration to another such end.
//!
//! The published planner (PythonRobotics, quintic polynomials planner, after Takahashi and others
//! 1989) tries one duration after the other until accelerations and jerks keep their limits. This
//! does the same, but looks finely at each duration, whatever step the caller samples with later, and
//! refuses where no duration does, where that one returns its last try.

use super::error::PathError;
use canter_shared::motion::bounds::{LARGEST, SMALLEST};
use canter_shared::motion::polynomial::Quintic;
use canter_shared::motion::trajectory::{Sample, Trajectory};

/// Places in time at which limits are looked at.
const PLACES: u32 = 4000;
/// The longest duration that is looked for to tell what it would take, in s.
const LONGEST: f64 = 1e6;

/// One end of a segment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct End {
    /// Place along x, in the caller's unit.
    pub x: f64,
    /// Place along y.
    pub y: f64,
    /// The direction of travel from the x axis towards the y axis, in rad.
    pub heading: f64,
    /// Along the heading, per second.
    pub speed: f64,
    /// Along the heading, per second squared.
    pub acceleration: f64,
}

/// The limits of a search, and the durations that it tries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    /// The most acceleration: the length of its vector, per second squared.
    pub acceleration: f64,
    /// The most jerk: the length of its vector, per second cubed.
    pub jerk: f64,
    /// From one duration that is tried to the next, and the first of them, in s.
    pub step: f64,
    /// The longest duration that is tried, in s.
    pub longest: f64,
}

impl Search {
    /// The durations of the published planner: 5 s, 10 s and so on up to 95 s.
    pub const fn published(acceleration: f64, jerk: f64) -> Self {
        Self {
            acceleration,
            jerk,
            step: 5.0,
            longest: 95.0,
        }
    }
}

/// A segment in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Planar {
    /// Along x.
    pub x: Quintic,
    /// Along y.
    pub y: Quintic,
}

impl Planar {
    /// The segment between two ends that lasts so long.
    ///
    /// # Errors
    /// [`PathError::Profile`] with the value that is out of range.
    pub fn lasting(from: &End, to: &End, duration: f64) -> Result<Self, PathError> {
        let along = |end: &End, place: f64, part: f64| Sample {
            position: place,
            velocity: end.speed * part,
            acceleration: end.acceleration * part,
            jerk: 0.0,
        };
        let x = |end: &End| along(end, end.x, end.heading.cos());
        let y = |end: &End| along(end, end.y, end.heading.sin());
        Ok(Self {
            x: Quintic::new(x(from), x(to), duration)?,
            y: Quintic::new(y(from), y(to), duration)?,
        })
    }

    /// The first of the durations tried that keeps the limits.
    ///
    /// # Errors
    /// A value out of range; [`PathError::NoDuration`] with what it would take.
    pub fn search(from: &End, to: &End, search: &Search) -> Result<Self, PathError> {
        for (field, value) in [
            ("acceleration limit", search.acceleration),
            ("jerk limit", search.jerk),
            ("step of durations", search.step),
            ("longest duration", search.longest),
        ] {
            if !(SMALLEST..=LARGEST).contains(&value) {
                let field = field.to_owned();
                return Err(PathError::Limit { field, value });
            }
        }
        // A step so short that there would be no end of tries is made longer.
        let tries = (search.longest / search.step + 1e-9).floor().min(10_000.0) as u32;
        for index in 1..=tries {
            let segment = Self::lasting(from, to, search.step * f64::from(index))?;
            if segment.keeps(search) {
                return Ok(segment);
            }
        }
        Err(Self::needed(from, to, search)?)
    }

    /// The shortest duration that keeps the limits, to a millionth, and at most `longest`.
    ///
    /// # Errors
    /// As [`Self::search`].
    pub fn shortest(from: &End, to: &End, search: &Search) -> Result<Self, PathError> {
        let coarse = Self::search(from, to, search)?;
        let longest = coarse.x.duration();
        Self::refined(from, to, search, (longest - search.step).max(0.0), longest)
    }

    /// The end of an interval, moved down to where the limits are just kept.
    fn refined(
        from: &End,
        to: &End,
        search: &Search,
        mut short: f64,
        mut long: f64,
    ) -> Result<Self, PathError> {
        while long - short > 1e-6 * long {
            let middle = (short + long) / 2.0;
            if Self::lasting(from, to, middle)?.keeps(search) {
                long = middle;
            } else {
                short = middle;
            }
        }
        Self::lasting(from, to, long)
    }

    /// Says what a search that found nothing would have needed.
    fn needed(from: &End, to: &End, search: &Search) -> Result<PathError, PathError> {
        let mut long = search.longest;
        while !Self::lasting(from, to, long)?.keeps(search) {
            if long > LONGEST {
                return Ok(PathError::NoDurationAtAll { longest: long });
            }
            long *= 1.5;
        }
        let found = Self::refined(from, to, search, long / 1.5, long)?;
        Ok(PathError::NoDuration {
            step: search.step,
            longest: search.longest,
            needed: found.x.duration(),
        })
    }

    /// The greatest acceleration and jerk, each as the length of its vector.
    pub fn peaks(&self) -> (f64, f64) {
        let duration = self.x.duration();
        let mut peaks = (0.0_f64, 0.0_f64);
        for place in 0..=PLACES {
            let time = duration * f64::from(place) / f64::from(PLACES);
            let (x, y) = (self.x.at(time), self.y.at(time));
            peaks.0 = peaks.0.max(x.acceleration.hypot(y.acceleration));
            peaks.1 = peaks.1.max(x.jerk.hypot(y.jerk));
        }
        peaks
    }

    fn keeps(&self, search: &Search) -> bool {
        let (acceleration, jerk) = self.peaks();
        // Between two places a peak is higher by a millionth at most.
        acceleration <= search.acceleration * (1.0 - 1e-6) && jerk <= search.jerk * (1.0 - 1e-6)
    }
}
