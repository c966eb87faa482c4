//! The profiles side by side for one move from rest to rest.

use super::curve::Curve;
use super::error::PlanError;
use super::make::plan;
use super::request::{AskedLimits, Kind, Request};
use super::vibration::Resonance;
use canter_shared::motion::bounds::{LARGEST, SMALLEST};
use canter_shared::motion::shaping::{Shaped, ShaperKind, Shaping};
use canter_shared::motion::trajectory::{Peaks, Trajectory};

/// What may be left swinging, as a share of the way, for a move to count as calm.
pub const CALM: f64 = 0.01;

/// Which of the profiles are shown behind an input shaper too: those that a node plays.
const SHAPED: [Kind; 3] = [Kind::Trapezoid, Kind::SCurve, Kind::Beta];

/// A comparison that is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// Where the move starts.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// How fast it may be; velocity and acceleration must be named.
    pub limits: AskedLimits,
    /// The mass on a spring that it carries.
    pub resonance: Option<Resonance>,
    /// Input shapers for that mass.
    pub shapers: Vec<ShaperKind>,
}

/// One profile, and a shaper behind it perhaps.
#[derive(Debug, Clone)]
pub struct Row {
    /// Which profile.
    pub kind: Kind,
    /// The shaper behind it.
    pub shaping: Option<Shaping>,
    /// The curve before the shaper.
    pub curve: Curve,
    /// From start to rest, in seconds.
    pub duration: f64,
    /// The duration as a multiple of the shortest.
    pub ratio: f64,
    /// The largest magnitudes.
    pub peaks: Peaks,
    /// What is left swinging, in the unit of the position; `None` without a resonance.
    pub residual: Option<f64>,
}

impl Row {
    /// Its name in a table.
    pub fn name(&self) -> String {
        match self.shaping {
            Some(shaping) => format!("{} + {}", self.kind, shaping.kind()),
            None => self.kind.to_string(),
        }
    }

    /// What another mass on a spring would be left swinging with, in the unit of the position.
    ///
    /// # Errors
    /// Those of [`Resonance::residual`].
    pub fn residual_of(&self, resonance: &Resonance) -> Result<f64, PlanError> {
        let bare = resonance.residual(&self.curve)?;
        let left = self.shaping.map_or(1.0, |shaping| {
            let impulses = shaping.impulses_in_ticks();
            let impulses: Vec<(f64, f64)> = impulses
                .iter()
                .map(|impulse| (impulse.time, impulse.amplitude))
                .collect();
            resonance.left_by(&impulses)
        });
        Ok(bare * left)
    }

    /// Whether its acceleration steps, which no jerk limit allows.
    pub fn steps(&self) -> bool {
        self.peaks.jerk == f64::INFINITY
    }
}

/// All rows, and which of them to choose.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// The profiles, then those behind shapers.
    pub rows: Vec<Row>,
    /// What should be known about them.
    pub notes: Vec<String>,
    /// The place of the chosen one in `rows`.
    pub choice: usize,
    /// Which one to choose, and why, in one sentence.
    pub advice: String,
}

/// Makes every profile for one move, and chooses.
///
/// Without a jerk limit the s-curve gets the peak jerk of the beta curve within the other limits,
/// so that both are as gentle.
///
/// # Errors
/// Limits that are missing or make a profile impossible.
pub fn compare(question: &Question) -> Result<Comparison, PlanError> {
    let limits = &question.limits;
    if limits.velocity.is_none() || limits.acceleration.is_none() {
        return Err(PlanError::Missing {
            subject: "a comparison".to_owned(),
            flags: "--vmax and --amax",
        });
    }
    let mut notes = Vec::new();
    let mut rows = Vec::new();
    for kind in Kind::ALL {
        let mut request = Request::rest_to_rest(kind, question.from, question.to);
        request.limits = *limits;
        if kind == Kind::SCurve && limits.jerk.is_none() {
            let beta = Request {
                kind: Kind::Beta,
                ..request
            };
            let jerk = plan(&beta)?.curve.peaks().jerk.clamp(SMALLEST, LARGEST);
            request.limits.jerk = Some(jerk);
            notes.push(format!(
                "without --jmax the s-curve has the peak jerk of the beta curve, {jerk:.6}"
            ));
        }
        let curve = plan(&request)?.curve;
        rows.push(row(kind, curve, None, question)?);
    }
    if let Some(resonance) = &question.resonance {
        for kind in &question.shapers {
            match Shaping::new(*kind, resonance.frequency, resonance.damping) {
                Ok(shaping) => {
                    for kind in SHAPED {
                        let bare = rows.iter().find(|row| row.kind == kind);
                        if let Some(curve) = bare.map(|row| row.curve.clone()) {
                            rows.push(row(kind, curve, Some(shaping), question)?);
                        }
                    }
                }
                Err(error) => notes.push(format!("left out: {error}")),
            }
        }
    }
    let fastest = rows
        .iter()
        .map(|row| row.duration)
        .fold(f64::INFINITY, f64::min);
    for row in &mut rows {
        row.ratio = if fastest > 0.0 {
            row.duration / fastest
        } else {
            1.0
        };
    }
    let (choice, advice) = choose(&rows, question);
    Ok(Comparison {
        rows,
        notes,
        choice,
        advice,
    })
}

fn row(
    kind: Kind,
    curve: Curve,
    shaping: Option<Shaping>,
    question: &Question,
) -> Result<Row, PlanError> {
    let (duration, peaks) = match &shaping {
        Some(shaping) => {
            let shaped = Shaped::in_ticks(curve.clone(), shaping);
            (shaped.duration(), shaped.peaks())
        }
        None => (curve.duration(), curve.peaks()),
    };
    let mut row = Row {
        kind,
        shaping,
        curve,
        duration,
        ratio: 1.0,
        peaks,
        residual: None,
    };
    row.residual = question
        .resonance
        .map(|resonance| row.residual_of(&resonance))
        .transpose()?;
    Ok(row)
}

/// The place of the first row with the least of a value.
fn least<'a>(
    rows: impl Iterator<Item = (usize, &'a Row)>,
    value: impl Fn(&Row) -> f64,
) -> Option<(usize, &'a Row)> {
    rows.min_by(|(_, one), (_, other)| value(one).total_cmp(&value(other)))
}

fn choose(rows: &[Row], question: &Question) -> (usize, String) {
    let way = (question.to - question.from).abs();
    let share = |row: &Row| {
        let residual = row.residual.unwrap_or_default();
        if way > 0.0 { residual / way } else { 0.0 }
    };
    let percent = |row: &Row| format!("{:.2} %", share(row) * 100.0);
    let limits_jerk = question.limits.jerk.is_some();
    let smooth = || rows.iter().enumerate().filter(|(_, row)| !row.steps());
    if question.resonance.is_none() {
        let found = least(smooth(), |row| row.duration);
        return found.map_or((0, String::new()), |(at, row)| {
            let why = if limits_jerk {
                "the fastest that keeps every limit"
            } else {
                "the fastest whose acceleration does not step"
            };
            (at, format!("Choose the {}: {why}.", row.name()))
        });
    }
    let eligible = || {
        rows.iter()
            .enumerate()
            .filter(|(_, row)| !(limits_jerk && row.steps()))
    };
    let calm = eligible().filter(|(_, row)| share(row) <= CALM);
    if let Some((at, row)) = least(calm, |row| row.duration) {
        let advice = format!(
            "Choose the {}: the fastest that leaves at most {} % of the way swinging ({}).",
            row.name(),
            CALM * 100.0,
            percent(row)
        );
        return (at, advice);
    }
    least(eligible(), share).map_or((0, String::new()), |(at, row)| {
        let advice = format!(
            "Choose the {}: nothing leaves at most {} % of the way swinging, and it leaves the least ({}).",
            row.name(),
            CALM * 100.0,
            percent(row)
        );
        (at, advice)
    })
}
