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

use super::ROUNDING;
use super::lobes::{Lobes, change_peak, change_time};
use super::unit::{Range, State};

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
    /// K.
    gain: f64,
    /// How much of K may be rounding. A start that only has to release its acceleration would
    /// otherwise get a lobe as high as the square root of that.
    noise: f64,
}

/// How far the quickest change of velocity gets.
pub(super) struct Direct {
    /// R.
    pub reach: f64,
    /// By how much it grows with the velocity at the end.
    pub slope: f64,
    /// How much of it may be rounding.
    pub noise: f64,
}

impl Upward {
    pub fn new(state: State, v1: f64, distance: f64, range: &Range) -> Self {
        let State {
            velocity: v0,
            acceleration: a0,
            ..
        } = state;
        let begin = v0 - a0 * a0 / 2.0;
        Self {
            reach: distance + a0 * (v0 - a0 * a0 / 3.0),
            ..Self::change(a0, begin, v1, range)
        }
    }

    /// A change of velocity, to no particular place.
    fn change(a0: f64, begin: f64, v1: f64, range: &Range) -> Self {
        let noise = ROUNDING * (begin.abs() + v1.abs() + a0 * a0);
        let gain = v1 - begin;
        Self {
            a0,
            begin,
            v1,
            reach: 0.0,
            range: *range,
            gain: if gain.abs() <= noise { 0.0 } else { gain },
            noise,
        }
    }

    /// From the same start to another velocity.
    pub fn towards(&self, v1: f64) -> Self {
        Self::change(self.a0, self.begin, v1, &self.range)
    }

    /// d: the displacement from the start.
    pub fn distance(&self) -> f64 {
        let a0 = self.a0;
        self.reach - a0 * (self.begin + a0 * a0 / 6.0)
    }

    /// K: what the squares of peak and trough differ by.
    pub fn gain(&self) -> f64 {
        self.gain
    }

    /// S: twice the mean of the velocities at both ends.
    pub fn sum(&self) -> f64 {
        self.begin + self.v1
    }

    /// Whether the quickest change of velocity begins by raising the acceleration.
    pub fn rises(&self) -> bool {
        let raised = self.a0.max(0.0);
        self.gain >= raised * raised - self.noise
    }

    /// How far the quickest change of velocity gets.
    pub fn direct_reach(&self) -> Direct {
        let Self { a0, begin, v1, .. } = *self;
        let v0 = begin + a0 * a0 / 2.0;
        let rises = self.rises();
        // Where it falls it is the same upside down, from the other release of the acceleration.
        let (from, change, limit) = if rises {
            (begin, self.gain, self.range.rise)
        } else {
            let square = a0 * a0;
            (begin + square, square - self.gain, self.range.fall)
        };
        let time = change_time(change, limit);
        // By how much the time grows with the change: 1 / limit where that is held, otherwise
        // 1 / peak.
        let rate = if change >= limit * limit {
            1.0 / limit
        } else if time > 0.0 {
            2.0 / time
        } else {
            0.0
        };
        let (released, sign) = if rises {
            (0.0, 1.0)
        } else {
            (2.0 * v0 * a0, -1.0)
        };
        let mean = (from + v1) / 2.0;
        let reach = released + mean * time;
        let terms = (v0 * a0).abs() + reach.abs() + self.reach.abs();
        Direct {
            reach,
            slope: time / 2.0 + sign * mean * rate,
            // K is known to its noise: the smaller a lobe, the more of that it shows.
            noise: ROUNDING * terms + self.noise * rate * (v0.abs() + v1.abs()),
        }
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
        if !rises
            && self.a0 < 0.0
            && let Some(found) = self.quickest_below_zero(self.reach_at(begin))
        {
            return found;
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
}
