//! The least duration in which a polynomial keeps its limits.

use super::{Cubic, Hermite, Polynomial, Quintic, Rates, Septic, checked_ends, horner, peaks};
use crate::motion::bounds::{Bounds, LARGEST, SMALLEST};
use crate::motion::error::{ProfileError, checked};
use crate::motion::trajectory::{Peaks, Sample};

/// Peaks of the cubic 3 u^2 - 2 u^3: 6 u (1 - u) at u = 1/2, 6 - 12 u at u = 0, and no jerk that
/// could be limited, since the acceleration steps at both ends.
const CUBIC: Peaks = Peaks {
    velocity: 6.0 / 4.0,
    acceleration: 6.0,
    jerk: 0.0,
};
/// Peaks of the quintic 10 u^3 - 15 u^4 + 6 u^5, with w = u (1 - u): 30 w^2 at w = 1/4;
/// 60 w (1 - 2 u) where (1 - 2 u)^2 = 1/3 and w = 1/6; 60 (1 - 6 w) at the ends.
const QUINTIC: Peaks = Peaks {
    velocity: 30.0 / 16.0,
    acceleration: 10.0 / 1.732_050_807_568_877_2,
    jerk: 60.0,
};
/// Peaks of the septic 35 u^4 - 84 u^5 + 70 u^6 - 20 u^7: 140 w^3 at w = 1/4; 420 w^2 (1 - 2 u)
/// where (1 - 2 u)^2 = w = 1/5; 840 w (1 - 5 w) at w = 1/4.
const SEPTIC: Peaks = Peaks {
    velocity: 140.0 / 64.0,
    acceleration: 420.0 / 25.0 / 2.236_067_977_499_79,
    jerk: 840.0 / 16.0,
};

/// Rounding by which a peak may be over its limit.
const ROUNDING: f64 = 1e-12;
/// Each duration that is tried is that much longer than the one before.
const STEP: f64 = 1.01;
/// Where the limits are broken by less than this at the best of three durations, a narrow window of durations
/// that keep them may lie between: a step changes a jerk by 3 %.
const SHALLOW: f64 = 1.05;
/// Golden sections of two steps: they leave 10^-9 of them.
const SECTIONS: u32 = 43;
/// How far the search goes beyond the longest time that limits and boundary values name; and below
/// the shortest of them where mean rates say nothing.
const FARTHEST: f64 = 100.0;
/// Places at which a duration is looked at before its peaks are computed.
const GLANCES: u32 = 16;

impl Cubic {
    /// The quickest cubic within the limits of velocity and acceleration.
    ///
    /// The lesser of acceleration and deceleration counts. The jerk is not looked at: a cubic's
    /// acceleration steps at the ends. From rest to rest the duration has a closed form; else it
    /// is searched for, upwards in steps of 1 % and between them where they come near, from the least that
    /// the mean velocity, mean acceleration and mean jerk allow.
    ///
    /// # Errors
    /// As [`Cubic::new`]; and [`ProfileError::Value`] that names the limit that would have to be
    /// higher, where a boundary value is over it or no duration keeps it.
    pub fn within(from: Sample, to: Sample, bounds: &Bounds) -> Result<Self, ProfileError> {
        let known = |sample: Sample| Sample::coasting(sample.position, sample.velocity);
        let bounds = bounds.without_jerk();
        Self::quickest(known(from), known(to), &bounds, super::cubic, &CUBIC)
    }
}

impl Quintic {
    /// The quickest quintic within the limits; as [`Cubic::within`], and the jerk counts.
    ///
    /// # Errors
    /// As [`Cubic::within`].
    pub fn within(from: Sample, to: Sample, bounds: &Bounds) -> Result<Self, ProfileError> {
        let known = |sample: Sample| Sample {
            jerk: 0.0,
            ..sample
        };
        Self::quickest(known(from), known(to), bounds, super::quintic, &QUINTIC)
    }
}

impl Septic {
    /// The quickest septic within the limits; as [`Cubic::within`], and the jerk counts.
    ///
    /// # Errors
    /// As [`Cubic::within`].
    pub fn within(from: Sample, to: Sample, bounds: &Bounds) -> Result<Self, ProfileError> {
        Self::quickest(from, to, bounds, super::septic, &SEPTIC)
    }
}

/// The limit that is broken most: its name, its value, and how many times over.
#[derive(Debug, Clone, Copy)]
struct Worst {
    field: &'static str,
    limit: f64,
    ratio: f64,
}

impl Worst {
    fn of(peaks: &Peaks, bounds: &Bounds) -> Self {
        let limits = [
            ("velocity limit", peaks.velocity, bounds.velocity()),
            (
                "acceleration limit",
                peaks.acceleration,
                bounds.slower_acceleration(),
            ),
            ("jerk limit", peaks.jerk, bounds.jerk()),
        ];
        let mut worst = Self {
            field: "velocity limit",
            limit: bounds.velocity(),
            ratio: 0.0,
        };
        for (field, peak, limit) in limits {
            let ratio = peak / limit;
            if ratio > worst.ratio {
                worst = Self {
                    field,
                    limit,
                    ratio,
                };
            }
        }
        worst
    }

    fn kept(&self) -> bool {
        self.ratio <= 1.0 + ROUNDING
    }

    fn error(&self) -> ProfileError {
        ProfileError::Value {
            field: self.field,
            value: self.limit,
            minimum: self.limit * self.ratio,
            maximum: LARGEST,
        }
    }
}

impl<const N: usize> Polynomial<N> {
    fn quickest(
        from: Sample,
        to: Sample,
        bounds: &Bounds,
        unit: Hermite<N>,
        rest: &Peaks,
    ) -> Result<Self, ProfileError> {
        checked_ends(&from, &to)?;
        let distance = to.position - from.position;
        let (velocity, acceleration, jerk) = (
            bounds.velocity(),
            bounds.slower_acceleration(),
            bounds.jerk(),
        );
        let at_rest = |sample: &Sample| *sample == Sample::at_rest(sample.position);
        if at_rest(&from) && at_rest(&to) {
            let way = distance.abs();
            let duration = (rest.velocity * way / velocity)
                .max(libm::sqrt(rest.acceleration * way / acceleration))
                .max(libm::cbrt(rest.jerk * way / jerk));
            let duration = if way > 0.0 {
                checked("duration", duration.max(SMALLEST), SMALLEST, LARGEST)?
            } else {
                0.0
            };
            return Self::hermite(from, to, duration, unit);
        }
        for end in [&from, &to] {
            let ends = Worst::of(
                &Peaks {
                    velocity: end.velocity.abs(),
                    acceleration: end.acceleration.abs(),
                    jerk: end.jerk.abs(),
                },
                bounds,
            );
            if !ends.kept() {
                return Err(ends.error());
            }
        }
        let worst = |duration: f64| {
            let (start, stop) = (Rates::scaled(&from, duration), Rates::scaled(&to, duration));
            let unit = unit(distance, start, stop);
            let square = duration * duration;
            let against = |peaks: Peaks| {
                Worst::of(
                    &Peaks {
                        velocity: peaks.velocity / duration,
                        acceleration: peaks.acceleration / square,
                        jerk: peaks.jerk / (square * duration),
                    },
                    bounds,
                )
            };
            // Most durations are ruled out by a glance, which is much quicker.
            let glance = against(glance(&unit));
            if glance.kept() {
                against(peaks::unit(&unit))
            } else {
                glance
            }
        };
        let duration = search(&from, &to, bounds, worst)?;
        Self::hermite(from, to, duration, unit)
    }
}

/// The largest rates at a few places, which are not over the peaks.
fn glance(coefficients: &[f64]) -> Peaks {
    let mut seen = Peaks::default();
    for place in 0..=GLANCES {
        let at = horner(coefficients, f64::from(place) / f64::from(GLANCES));
        seen.velocity = seen.velocity.max(at.velocity.abs());
        seen.acceleration = seen.acceleration.max(at.acceleration.abs());
        seen.jerk = seen.jerk.max(at.jerk.abs());
    }
    seen
}

/// The duration between two whose worst is least, by golden sections, or one that keeps the limits.
fn bottom(low: f64, high: f64, worst: &impl Fn(f64) -> Worst) -> f64 {
    // (sqrt(5) - 1) / 2
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (mut low, mut high) = (low, high);
    let at = |time: f64| (time, worst(time).ratio);
    let mut left = at(high - GOLDEN * (high - low));
    let mut right = at(low + GOLDEN * (high - low));
    for _ in 0..SECTIONS {
        if left.1.min(right.1) <= 1.0 {
            break;
        }
        if left.1 < right.1 {
            high = right.0;
            right = left;
            left = at(high - GOLDEN * (high - low));
        } else {
            low = left.0;
            left = right;
            right = at(low + GOLDEN * (high - low));
        }
    }
    if left.1 < right.1 { left.0 } else { right.0 }
}

/// The least duration of which `worst` says that the limits are kept.
fn search(
    from: &Sample,
    to: &Sample,
    bounds: &Bounds,
    worst: impl Fn(f64) -> Worst,
) -> Result<f64, ProfileError> {
    let (velocity, acceleration, jerk) = (
        bounds.velocity(),
        bounds.slower_acceleration(),
        bounds.jerk(),
    );
    let distance = to.position - from.position;
    // Mean velocity, acceleration and jerk must be inside the limits.
    let least = (distance.abs() / velocity)
        .max((to.velocity - from.velocity).abs() / acceleration)
        .max((to.acceleration - from.acceleration).abs() / jerk);
    // Times that limits and boundary values name; the answer is of their order.
    let fastest = from.velocity.abs().max(to.velocity.abs());
    let strongest = from.acceleration.abs().max(to.acceleration.abs());
    let times = [
        least,
        libm::sqrt(distance.abs() / acceleration),
        libm::cbrt(distance.abs() / jerk),
        fastest / acceleration,
        libm::sqrt(fastest / jerk),
        strongest / jerk,
        velocity / acceleration,
    ];
    let named = times.into_iter().filter(|time| *time > 0.0);
    let longest = named.clone().fold(0.0, f64::max);
    let shortest = named.fold(LARGEST, f64::min);
    let first = if least > 0.0 {
        least
    } else {
        shortest / FARTHEST
    };
    let first = first.clamp(SMALLEST, LARGEST);
    let mut nearest = worst(first);
    if nearest.kept() {
        return Ok(first);
    }
    let farthest = (longest * FARTHEST).min(LARGEST / STEP);
    let mut low = first;
    let mut high = first;
    let mut ratios = [f64::INFINITY, nearest.ratio];
    // The end is a bounded number of decades away, so this comes to it.
    loop {
        if high >= farthest {
            return Err(nearest.error());
        }
        let before = low;
        low = high;
        high *= STEP;
        let found = worst(high);
        if found.kept() {
            break;
        }
        // Between two steps there may be a few durations that do.
        let [falling, least] = ratios;
        if least <= falling && least <= found.ratio && least < SHALLOW {
            let bottom = bottom(before, high, &worst);
            if worst(bottom).kept() {
                (low, high) = (before, bottom);
                break;
            }
        }
        ratios = [least, found.ratio];
        if found.ratio < nearest.ratio {
            nearest = found;
        }
    }
    for _ in 0..52 {
        let middle = 0.5 * (low + high);
        if worst(middle).kept() {
            high = middle;
        } else {
            low = middle;
        }
    }
    Ok(high)
}
