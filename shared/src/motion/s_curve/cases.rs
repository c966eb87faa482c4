//! The members of the family of `upward`, case by case: which limits of acceleration are held.

use super::lobes::{Lobes, change_peak, change_time};
use super::root::{Curve, SMOOTH, root, rough_cube_root};
use super::unit::Range;
use super::upward::Upward;

impl Upward {
    /// Both limits are held; `more` is what R is above that of the peak velocity `later`, where the
    /// second limit is just reached.
    pub fn both_held(&self, later: f64, more: f64) -> Lobes {
        let Range { rise, fall, .. } = self.range;
        let quadratic = 1.0 / rise + 1.0 / fall;
        let linear = quadratic * later + (rise + fall) / 2.0;
        let turn = libm::sqrt(linear * linear + 2.0 * quadratic * more);
        let above = if linear > 0.0 {
            2.0 * more / (linear + turn)
        } else {
            (turn - linear) / quadratic
        };
        self.with_top(later + above)
    }

    /// Both limits are held and the velocity peaks at `top`.
    pub fn with_top(&self, top: f64) -> Lobes {
        let Range { rise, fall, .. } = self.range;
        Lobes {
            peak: rise,
            peak_hold: ((top - self.begin) / rise - rise).max(0.0),
            trough: fall,
            trough_hold: ((top - self.v1) / fall - fall).max(0.0),
            ..Lobes::default()
        }
    }

    /// At the velocity limit for `time`.
    pub fn cruising(&self, time: f64) -> Lobes {
        let Range {
            highest,
            rise,
            fall,
            ..
        } = self.range;
        let (peak, peak_hold) = change_peak(highest - self.begin, rise);
        let (trough, trough_hold) = change_peak(highest - self.v1, fall);
        Lobes {
            peak: peak.max(self.a0),
            peak_hold,
            cruise: time,
            cruise_velocity: highest,
            trough,
            trough_hold,
        }
    }

    /// The upper limit of acceleration is held, the trough lies from `low` to `high`.
    pub fn rise_held(&self, low: f64, high: f64) -> Lobes {
        let rise = self.range.rise;
        let gain = self.gain();
        let rest = self.reach - self.sum() * (rise + gain / rise) / 2.0;
        self.with_trough(held_root(rise, self.v1, rest, low, high))
    }

    /// The upper limit of acceleration is held, the trough is this deep.
    fn with_trough(&self, trough: f64) -> Lobes {
        let (rise, gain) = (self.range.rise, self.gain());
        let peak_hold = (gain - rise * rise + trough * trough) / rise;
        Lobes {
            peak: rise,
            peak_hold: peak_hold.max(0.0),
            trough,
            ..Lobes::default()
        }
    }

    /// The lower limit of acceleration is held, the peak lies from `low` to `high`.
    pub fn fall_held(&self, low: f64, high: f64) -> Lobes {
        let fall = self.range.fall;
        let gain = self.gain();
        let rest = self.reach - self.sum() * (fall - gain / fall) / 2.0;
        self.with_peak(held_root(fall, self.begin, rest, low, high))
    }

    /// The lower limit of acceleration is held, the peak is this high.
    fn with_peak(&self, peak: f64) -> Lobes {
        let (fall, gain) = (self.range.fall, self.gain());
        let trough_hold = (peak * peak - fall * fall - gain) / fall;
        Lobes {
            peak,
            trough: fall,
            trough_hold: trough_hold.max(0.0),
            ..Lobes::default()
        }
    }

    /// No limit is reached; s lies from `low` to `high`.
    pub fn free(&self, low: f64, high: f64) -> Lobes {
        let (sum, gain, reach) = (self.sum(), self.gain(), self.reach);
        let curve = |s: f64| {
            let inverse = 1.0 / s;
            let ratio = gain * inverse;
            let (s2, ratio2) = (s * s, ratio * ratio);
            Curve {
                value: s * (s2 / 4.0 + sum - ratio2 / 4.0) - reach,
                slope: 0.75 * s2 + sum + ratio2 / 4.0,
                curvature: (1.5 * s2 - ratio2 / 2.0) * inverse,
            }
        };
        let guess = self.guess(low, &curve);
        self.with_length(root(low, high, guess, SMOOTH, curve))
    }

    /// Where no limit is reached and peak and trough differ by `s`.
    pub fn with_length(&self, s: f64) -> Lobes {
        let ratio = if s > 0.0 { self.gain() / s } else { 0.0 };
        Lobes {
            peak: ((s + ratio) / 2.0).max(self.a0),
            trough: ((s - ratio) / 2.0).max(0.0),
            ..Lobes::default()
        }
    }

    /// A place above the root but not far from it: the third derivative is at least 3 / 2, so the
    /// cubic that touches the curve at `low` stays below it.
    fn guess(&self, low: f64, curve: &impl Fn(f64) -> Curve) -> f64 {
        if low <= 0.0 {
            let mut guess = rough_cube_root(4.0 * self.reach);
            if self.sum() > 0.0 {
                guess = guess.min(self.reach / self.sum());
            } else {
                guess += 2.0 * libm::sqrt(-self.sum());
            }
            return guess;
        }
        let Curve {
            value,
            slope,
            curvature,
        } = curve(low);
        let missing = -value;
        let mut guess = rough_cube_root(4.0 * missing.max(0.0));
        if curvature > 0.0 {
            let turn = libm::sqrt(slope * slope + 2.0 * curvature * missing.max(0.0));
            let parabola = if slope > 0.0 {
                2.0 * missing / (slope + turn)
            } else {
                (turn - slope) / curvature
            };
            guess = if slope > 0.0 {
                guess.min(parabola)
            } else {
                parabola
            };
        }
        low + guess
    }

    /// The motion that gets farthest within `time`, which must be enough for the direct change.
    pub fn farthest(&self, time: f64) -> Lobes {
        let Range {
            highest,
            rise,
            fall,
            ..
        } = self.range;
        let (begin, v1, gain) = (self.begin, self.v1, self.gain());
        let time = time + self.a0;
        let cruise = time - change_time(highest - begin, rise) - change_time(highest - v1, fall);
        if cruise >= 0.0 {
            return self.cruising(cruise);
        }
        let free = self.with_length(time / 2.0);
        if free.peak <= rise && free.trough <= fall {
            return free;
        }
        let trough = libm::sqrt((rise * time - gain).max(0.0)) - rise;
        if free.peak > rise && trough <= fall {
            return self.with_trough(trough.max(0.0));
        }
        let peak = libm::sqrt((fall * time + gain).max(0.0)) - fall;
        if peak <= rise {
            return self.with_peak(peak.max(self.a0));
        }
        // Both: the time as a function of the peak velocity is a straight line.
        let top = (time - rise - fall + begin / rise + v1 / fall) / (1.0 / rise + 1.0 / fall);
        self.with_top(top)
    }
}

/// Where (x^2 (x + limit)^2 + 2 velocity x (x + 2 limit)) / (2 limit) is `rest`, between `low` and
/// `high`.
fn held_root(limit: f64, velocity: f64, rest: f64, low: f64, high: f64) -> f64 {
    // Without the velocity it is a quadratic in x (x + limit), and that one more in x.
    let mut guess = high;
    if low >= 0.0 {
        let product = libm::sqrt((2.0 * limit * rest).max(0.0));
        let x = 2.0 * product / (limit + libm::sqrt(limit * limit + 4.0 * product));
        if velocity == 0.0 {
            return x.max(low).min(high);
        }
        guess = if velocity > 0.0 {
            x.min(rest / (2.0 * velocity))
        } else {
            x
        };
    }
    let curve = |x: f64| {
        let with = x + limit;
        let square = x * with;
        Curve {
            value: (square * square + 2.0 * velocity * x * (with + limit)) / 2.0 - limit * rest,
            slope: with * (x * (with + x) + 2.0 * velocity),
            curvature: (6.0 * square + limit * limit) + 2.0 * velocity,
        }
    };
    root(low, high, guess, SMOOTH, curve)
}
