//! From a mode's frequency and damping to the impulses that do not excite it.
//!
//! A mode s = -zeta w +- i w sqrt(1 - zeta^2) that an impulse has excited is still again after one
//! more, half a damped period Td / 2 later and K = exp(-zeta pi / sqrt(1 - zeta^2)) as strong. With D
//! for that delay, the shapers are products or sums of powers of K D over their value at rest:
//!
//! | shaper | operator | source |
//! |---|---|---|
//! | ZV | 1 + K D | Singer and Seering, J. Dyn. Sys. Meas. Control 112 (1990), 76-82 |
//! | ZVD | (1 + K D)^2 | the same |
//! | EI | (1 + V) / 4 + (1 - V) / 2 K D + (1 + V) / 4 K^2 D^2, with V = 5 % | Singhose, Seering and Singer, J. Mech. Design 116 (1994), 654-659 |
//!
//! The EI shaper's amplitudes are exact without damping; with it they are the customary
//! approximation, whose tolerance is a little below V.
//!
//! A device has whole ticks only, and half a period hardly ever is. There K D is split onto the two
//! neighbouring ticks n and n + 1 so that at the mode itself it is still exactly -1: with theta for
//! the damped angle of one tick, alpha = pi - n theta and beta = theta - alpha, the weights are
//! e^(-zeta w n) sin(beta) / sin(theta) and e^(-zeta w (n + 1)) sin(alpha) / sin(theta), w per
//! tick. Both are positive, so the shaped setpoints are a mean of past ones.

use super::CAPACITY;
use crate::motion::elementary::{exponential, sine};
use crate::time::{TICKS_PER_SECOND, Ticks};
use crate::units::whole;
use core::f64::consts::{PI, TAU};
use core::fmt;
use heapless::Vec;

/// The most impulses of a shaper: three, each but the first split onto whole ticks.
pub const MOST_IMPULSES: usize = 6;

/// The residual vibration that an EI shaper allows at the mode, as a part of what there would be
/// without it.
pub const TOLERANCE: f64 = 0.05;

/// The highest frequency of a mode in Hz, a quarter of the rate of setpoints: half a period is two
/// ticks then, the least at which the ticks of all impulses are different ones.
pub const HIGHEST_FREQUENCY: f64 = TICKS_PER_SECOND as f64 / 4.0;

/// The largest damping ratio; what is damped more does not ring.
pub const LARGEST_DAMPING: f64 = 0.5;

/// The kinds of shapers: each is later, and minds a wrong frequency less, than the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShaperKind {
    /// Zero vibration: half a period late; below 5 % while the frequency is right to 3 %.
    Zv,
    /// Zero vibration and derivative: a period late; below 5 % over +-14 % of frequency.
    Zvd,
    /// Extra insensitive: a period late; at most 5 % over +-20 % of frequency, and at the right one.
    Ei,
}

impl ShaperKind {
    /// How many half periods the last impulse comes after the first.
    const fn half_periods(self) -> u32 {
        match self {
            Self::Zv => 1,
            Self::Zvd | Self::Ei => 2,
        }
    }

    /// The strengths of 1, K D and (K D)^2.
    const fn strengths(self) -> [f64; 3] {
        match self {
            Self::Zv => [1.0, 1.0, 0.0],
            Self::Zvd => [1.0, 2.0, 1.0],
            Self::Ei => [
                (1.0 + TOLERANCE) / 4.0,
                (1.0 - TOLERANCE) / 2.0,
                (1.0 + TOLERANCE) / 4.0,
            ],
        }
    }

    /// The lowest frequency in Hz that a shaper of this kind may have: its last impulse comes
    /// within [`CAPACITY`] ticks. 2.6 Hz for ZV, 5.2 Hz for the others, slightly more with damping.
    pub fn lowest_frequency(self, damping: f64) -> f64 {
        let half_period = CAPACITY as f64 / f64::from(self.half_periods());
        TICKS_PER_SECOND as f64 / (2.0 * half_period) / undamped(damping)
    }
}

impl fmt::Display for ShaperKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Zv => "ZV",
            Self::Zvd => "ZVD",
            Self::Ei => "EI",
        })
    }
}

/// sqrt(1 - zeta^2): the damped frequency as a part of the undamped one.
fn undamped(damping: f64) -> f64 {
    libm::sqrt(1.0 - damping * damping)
}

/// An angle from zero to `whole`, where what rounding leaves near either of them means that one: half
/// a period of whole ticks is then one impulse and not two, and the last one at the lowest frequency
/// not a tick too late.
fn snap(angle: f64, whole: f64) -> f64 {
    const ROUNDING: f64 = 1e-12;
    if angle < whole * ROUNDING {
        0.0
    } else if angle > whole * (1.0 - ROUNDING) {
        whole
    } else {
        angle
    }
}

/// Why a shaper cannot be, or not now. Nothing has changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ShapingError {
    /// The damping ratio is not a number, or outside its range.
    Damping {
        /// What was asked for.
        value: f64,
    },
    /// The frequency is not a number, or outside its range.
    Frequency {
        /// The shaper's kind, which the range depends on.
        kind: ShaperKind,
        /// What was asked for, in Hz.
        value: f64,
        /// The lowest frequency that is accepted, in Hz.
        minimum: f64,
    },
    /// The setpoints still move, or have moved a moment ago.
    Moving,
}

impl fmt::Display for ShapingError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Damping { value } => write!(
                formatter,
                "shaper damping ratio must be a number from 0 to {LARGEST_DAMPING}, \
                 but it is {value}: what is damped more needs no shaper"
            ),
            Self::Frequency {
                kind,
                value,
                minimum,
            } => {
                write!(
                    formatter,
                    "{kind} shaper frequency must be a number from {minimum} to \
                     {HIGHEST_FREQUENCY} Hz, but it is {value}"
                )?;
                match kind {
                    ShaperKind::Zv => Ok(()),
                    _ => formatter.write_str(": a ZV shaper goes down to half of the minimum"),
                }
            }
            Self::Moving => formatter
                .write_str("shaper can only be changed at rest: wait until the axis stands"),
        }
    }
}

impl core::error::Error for ShapingError {}

/// One impulse of a shaper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impulse {
    /// Seconds after the first.
    pub time: f64,
    /// Its part of the whole, positive; the parts add up to one but for rounding.
    pub amplitude: f64,
}

/// The impulses of a shaper in their order.
pub type Impulses = Vec<Impulse, MOST_IMPULSES>;

/// A shaper for one mode.
#[derive(Debug, Clone, Copy)]
pub struct Shaping {
    kind: ShaperKind,
    frequency: f64,
    damping: f64,
}

// By their bits: neither is a NaN, and a zero of another sign would only be shaped for again.
impl PartialEq for Shaping {
    fn eq(&self, other: &Self) -> bool {
        let bits = |shaping: &Self| (shaping.frequency.to_bits(), shaping.damping.to_bits());
        self.kind == other.kind && bits(self) == bits(other)
    }
}

/// A whole number of ticks, and a part of the whole.
pub(super) type Tap = (u32, f64);

impl Shaping {
    /// A shaper for a mode of this natural (undamped) frequency in Hz and this damping ratio.
    ///
    /// # Errors
    /// A damping outside 0 to [`LARGEST_DAMPING`], or a frequency outside
    /// [`ShaperKind::lowest_frequency`] to [`HIGHEST_FREQUENCY`].
    pub fn new(kind: ShaperKind, frequency: f64, damping: f64) -> Result<Self, ShapingError> {
        if !(0.0..=LARGEST_DAMPING).contains(&damping) {
            return Err(ShapingError::Damping { value: damping });
        }
        let minimum = kind.lowest_frequency(damping);
        if !(minimum..=HIGHEST_FREQUENCY).contains(&frequency) {
            return Err(ShapingError::Frequency {
                kind,
                value: frequency,
                minimum,
            });
        }
        Ok(Self {
            kind,
            frequency,
            damping,
        })
    }

    /// The shaper's kind.
    pub const fn kind(&self) -> ShaperKind {
        self.kind
    }

    /// The mode's natural frequency in Hz.
    pub const fn frequency(&self) -> f64 {
        self.frequency
    }

    /// The mode's damping ratio.
    pub const fn damping(&self) -> f64 {
        self.damping
    }

    /// The impulses as they are published, at half periods.
    pub fn impulses(&self) -> Impulses {
        let undamped = undamped(self.damping);
        let decay = libm::exp(-self.damping * PI / undamped);
        let half_period = 0.5 / (self.frequency * undamped);
        let [first, second, third] = self.kind.strengths();
        let parts = [first, second * decay, third * decay * decay];
        let whole: f64 = parts.iter().sum();
        let times = [0.0, half_period, 2.0 * half_period];
        let all = times.into_iter().zip(parts).map(|(time, part)| Impulse {
            time,
            amplitude: part / whole,
        });
        all.filter(|impulse| impulse.amplitude > 0.0).collect()
    }

    /// The impulses that the device applies, at whole ticks.
    pub fn impulses_in_ticks(&self) -> Impulses {
        let taps = self.taps().into_iter();
        taps.map(|(ticks, amplitude)| Impulse {
            time: Ticks(ticks).seconds(),
            amplitude,
        })
        .collect()
    }

    /// How much later the shaped motion arrives on a device.
    pub fn delay(&self) -> Ticks {
        Ticks(self.taps().last().map_or(0, |(ticks, _)| *ticks))
    }

    /// Ticks and parts of the impulses, in their order, the first at zero.
    pub(super) fn taps(&self) -> Vec<Tap, MOST_IMPULSES> {
        let turn = TAU * self.frequency / TICKS_PER_SECOND as f64;
        let (angle, decay) = (turn * undamped(self.damping), turn * self.damping);
        let early = whole(PI / angle) as u32;
        let late = early + 1;
        let alpha = snap(PI - f64::from(early) * angle, angle);
        let beta = angle - alpha;
        // Half a period decays by e^1.9 at most.
        let strength = exponential(-decay * f64::from(early)) / sine(angle);
        let (one, other) = (
            strength * sine(beta),
            strength * exponential(-decay) * sine(alpha),
        );
        let [first, second, third] = self.kind.strengths();
        let parts = [
            (0, first),
            (early, second * one),
            (late, second * other),
            (2 * early, third * one * one),
            (early + late, 2.0 * third * one * other),
            (2 * late, third * other * other),
        ];
        let whole: f64 = parts.iter().map(|(_, part)| part).sum();
        let scale = 1.0 / whole;
        let shares = parts.into_iter().map(|(ticks, part)| (ticks, part * scale));
        shares.filter(|(_, part)| *part > 0.0).collect()
    }
}
