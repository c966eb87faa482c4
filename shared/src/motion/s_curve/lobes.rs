//! The quickest motion to a place that lies above where the quickest change of velocity ends.
//!
//! In unit-jerk time (see `unit`) such a motion raises the acceleration from a0 to a peak a, holds
//! it there only at the limit A, lowers it to a trough -x, holds it there only at the limit -D,
//! and raises it to zero. Between, where the velocity reaches its limit, it cruises. (The jerk of
//! a time-optimal motion is bang-bang: Pontryagin's maximum principle.) The velocities give
//!
//!   a^2 - x^2 + A t_hold,a - D t_hold,x = K,   K = v1 - P,   P = v0 - a0^2 / 2,
//!
//! where P is the velocity that a motion from zero acceleration would have had to start with.
//! With S = P + v1 and R = d + v0 a0 - a0^3 / 3, the displacement from there, integrating the
//! pieces and collecting terms leaves
//!
//! - neither limit reached, s = a + x:  s^3 / 4 + S s - K^2 / (4 s) = R, and a - x = K / s;
//! - A held:  (x^2 (x + A)^2 + 2 v1 x (x + 2 A)) / (2 A) + S (A + K / A) / 2 = R;
//! - D held:  (a^2 (a + D)^2 + 2 P a (a + 2 D)) / (2 D) + S (D - K / D) / 2 = R;
//! - both held, or whenever the velocity peaks at U:
//!   R = (P + U) / 2 t(U - P, A) + (U + v1) / 2 t(U - v1, D), where t is the time of a change of
//!   velocity between two states without acceleration: 2 sqrt(change) or limit + change / limit.
//!
//! The farthest place that can be reached grows along this family from the moment on when it
//! passes the place that it starts with; before, it may first fall (while the motion still goes
//! downwards). So the first of its members that gets to d is the quickest, and which limits it
//! holds is told by R at the peak velocities where a limit is just reached.

use super::root::{Curve, root, rough_cube_root};
use super::unit::{Piece, Pieces, Range, State};

/// What a motion upwards is asked for, in unit-jerk time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Upward {
    /// The acceleration at the start.
    pub a0: f64,
    /// P: the velocity from which a motion without acceleration would have come to the start.
    pub begin: f64,
    /// The velocity at the end.
    pub v1: f64,
    /// R: the displacement from there.
    pub reach: f64,
    pub range: Range,
}

/// A motion upwards: the acceleration's peak and trough, and what is held for how long.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Lobes {
    pub peak: f64,
    pub peak_hold: f64,
    /// Between peak and trough, at this velocity.
    pub cruise: f64,
    pub cruise_velocity: f64,
    /// The magnitude of the trough.
    pub trough: f64,
    pub trough_hold: f64,
}

impl Lobes {
    /// Lays it from an acceleration of `a0`; `sign` is -1 where everything is upside down.
    pub fn lay(&self, a0: f64, sign: f64, pieces: &mut Pieces) {
        let Self { peak, trough, .. } = *self;
        let mut push = |duration, jerk: f64, from: f64| {
            pieces.push(Piece::new(duration, sign * jerk, sign * from));
        };
        push(peak - a0, 1.0, a0);
        push(self.peak_hold, 0.0, peak);
        if self.cruise > 0.0 {
            push(peak, -1.0, peak);
            pieces.push(Piece::cruise(self.cruise, sign * self.cruise_velocity));
            pieces.push(Piece::new(trough, -sign, 0.0));
        } else {
            push(peak + trough, -1.0, peak);
        }
        let mut push = |duration, jerk: f64| {
            pieces.push(Piece::new(duration, sign * jerk, -sign * trough));
        };
        push(self.trough_hold, 0.0);
        push(trough, 1.0);
    }

    /// How long it lasts from an acceleration of `a0`.
    pub fn duration(&self, a0: f64) -> f64 {
        (self.peak - a0)
            + self.peak_hold
            + self.peak
            + self.cruise
            + self.trough
            + self.trough_hold
            + self.trough
    }
}

/// How long it takes to change the velocity by `change`, zero or more, between two states without
/// acceleration.
pub(super) fn change_time(change: f64, limit: f64) -> f64 {
    if change >= limit * limit {
        limit + change / limit
    } else {
        2.0 * libm::sqrt(change.max(0.0))
    }
}

/// The peak of acceleration of such a change, and how long it is held.
pub(super) fn change_peak(change: f64, limit: f64) -> (f64, f64) {
    let over = change - limit * limit;
    if over >= 0.0 {
        (limit, over / limit)
    } else {
        (libm::sqrt(change.max(0.0)), 0.0)
    }
}

impl Upward {
    pub fn new(state: State, v1: f64, distance: f64, range: &Range) -> Self {
        let State {
            velocity: v0,
            acceleration: a0,
            ..
        } = state;
        Self {
            a0,
            begin: v0 - a0 * a0 / 2.0,
            v1,
            reach: distance + a0 * (v0 - a0 * a0 / 3.0),
            range: *range,
        }
    }

    /// d: the displacement from the start.
    pub fn distance(&self) -> f64 {
        let a0 = self.a0;
        self.reach - a0 * (self.begin + a0 * a0 / 6.0)
    }

    /// K: what the squares of peak and trough differ by.
    pub fn gain(&self) -> f64 {
        self.v1 - self.begin
    }

    /// S: twice the mean of the velocities at both ends.
    pub fn sum(&self) -> f64 {
        self.begin + self.v1
    }

    /// Whether the quickest change of velocity begins by raising the acceleration.
    pub fn rises(&self) -> bool {
        let squared = if self.a0 > 0.0 {
            self.a0 * self.a0
        } else {
            0.0
        };
        self.gain() >= squared
    }

    /// R of the quickest change of velocity.
    pub fn direct_reach(&self) -> f64 {
        let (a0, gain) = (self.a0, self.gain());
        if self.rises() {
            return self.sum() / 2.0 * change_time(gain, self.range.rise);
        }
        // The same upside down, where it rises.
        let top = self.begin + a0 * a0;
        let v0 = self.begin + a0 * a0 / 2.0;
        2.0 * v0 * a0 + (top + self.v1) / 2.0 * change_time(a0 * a0 - gain, self.range.fall)
    }

    /// The quickest change of velocity.
    pub fn direct(&self) -> Lobes {
        let gain = self.gain();
        if self.rises() {
            let (peak, peak_hold) = change_peak(gain, self.range.rise);
            return Lobes {
                peak,
                peak_hold,
                ..Lobes::default()
            };
        }
        let (trough, trough_hold) = change_peak(self.a0 * self.a0 - gain, self.range.fall);
        Lobes {
            peak: self.a0,
            trough,
            trough_hold,
            ..Lobes::default()
        }
    }

    /// R of the motion whose velocity peaks at `top`.
    fn reach_at(&self, top: f64) -> f64 {
        let (begin, v1) = (self.begin, self.v1);
        let Range { rise, fall, .. } = self.range;
        (begin + top) / 2.0 * change_time(top - begin, rise)
            + (top + v1) / 2.0 * change_time(top - v1, fall)
    }

    /// The quickest motion; `reach` must be above [`Self::direct_reach`].
    pub fn quickest(&self) -> Lobes {
        let Range {
            highest,
            rise,
            fall,
            ..
        } = self.range;
        let (begin, v1, gain) = (self.begin, self.v1, self.gain());
        let rises = self.rises();
        // The peak velocity of the direct change, where the family begins.
        let first = if rises {
            v1
        } else {
            begin + self.a0.max(0.0) * self.a0.max(0.0)
        };
        if !rises && self.a0 < 0.0 {
            if let Some(found) = self.quickest_below_zero(self.reach_at(begin)) {
                return found;
            }
        }
        let at_highest = self.reach_at(highest);
        if self.reach >= at_highest {
            return self.cruising((self.reach - at_highest) / highest);
        }
        // The peak velocities at which the acceleration just reaches a limit.
        let (at_rise, at_fall) = (begin + rise * rise, v1 + fall * fall);
        let (sooner, later) = (at_rise.min(at_fall), at_rise.max(at_fall));
        if later < highest {
            let at_later = self.reach_at(later);
            if self.reach >= at_later {
                return self.both_held(later, self.reach - at_later);
            }
        }
        let highest = highest.min(later);
        if sooner <= first || sooner < highest && self.reach >= self.reach_at(sooner) {
            let first = first.max(sooner);
            return if at_rise <= at_fall {
                let low = libm::sqrt((first - v1).max(0.0));
                let high = libm::sqrt((highest - v1).max(0.0));
                self.rise_held(low, high)
            } else {
                let low = libm::sqrt((first - begin).max(0.0));
                let high = libm::sqrt((highest - begin).max(0.0));
                self.fall_held(low, high)
            };
        }
        let highest = highest.min(sooner);
        let low = if rises {
            libm::sqrt(gain)
        } else {
            self.a0.max(0.0) + libm::sqrt(first - v1)
        };
        let high = libm::sqrt((highest - begin).max(0.0)) + libm::sqrt((highest - v1).max(0.0));
        self.free(low, high)
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

    /// Both limits are held; `more` is what R is above that of the peak velocity `later`, where the
    /// second limit is just reached.
    fn both_held(&self, later: f64, more: f64) -> Lobes {
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
    fn with_top(&self, top: f64) -> Lobes {
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
    fn cruising(&self, time: f64) -> Lobes {
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
    fn rise_held(&self, low: f64, high: f64) -> Lobes {
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
            let ratio = gain / s;
            let (s2, ratio2) = (s * s, ratio * ratio);
            Curve {
                value: s * (s2 / 4.0 + sum - ratio2 / 4.0) - reach,
                slope: 0.75 * s2 + sum + ratio2 / 4.0,
                curvature: (1.5 * s2 - ratio2 / 2.0) / s,
            }
        };
        let guess = self.guess(low, &curve);
        self.with_length(root(low, high, guess, curve))
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
}

/// Where (x^2 (x + limit)^2 + 2 velocity x (x + 2 limit)) / (2 limit) is `rest`, between `low` and
/// `high`.
fn held_root(limit: f64, velocity: f64, rest: f64, low: f64, high: f64) -> f64 {
    if velocity == 0.0 && low >= 0.0 {
        // A quadratic in x (x + limit), and one more in x.
        let product = libm::sqrt((2.0 * limit * rest).max(0.0));
        let x = 2.0 * product / (limit + libm::sqrt(limit * limit + 4.0 * product));
        return x.max(low).min(high);
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
    root(low, high, high, curve)
}
