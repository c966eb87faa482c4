//! Motions whose acceleration stays below zero: a slowing down that gets less hard in between.
//!
//! They begin the family of `upward` where the start slows down and the direct change of velocity
//! slows down harder. Along them the peak rises from a0 to zero. With P the velocity where the
//! release of a0 alone would lead to, what is reached may grow, fall and grow again: its slope
//! has the sign of G = a (2 a + x) + 2 P, where a is the peak and -x the trough. G is convex in a, so
//! there is one hill at most, and the first way over the place that is asked for is the quickest.

use super::lobes::Lobes;
use super::upward::Upward;

/// The member of the family where the first hill is.
enum Hill {
    /// The lower limit is held, with this peak.
    Held(f64),
    /// No limit is reached, with this s.
    Free(f64),
}

impl Upward {
    /// The quickest motion, where its acceleration stays below zero; `at_zero` is R where the
    /// peak is zero.
    pub(super) fn quickest_below_zero(&self, at_zero: f64) -> Option<Lobes> {
        let fall = self.range.fall;
        let (a0, gain) = (self.a0, self.gain());
        // Peaks below -edge hold the lower limit, those above do not, up to zero.
        let edge_squared = fall * fall + gain;
        let edge = libm::sqrt(edge_squared.max(0.0));
        let held_from = a0;
        let held_to = if edge_squared > 0.0 { -edge } else { 0.0 };
        let starts_held = held_from < held_to;
        let length = |peak: f64| -gain / (libm::sqrt(peak * peak - gain) - peak);
        let free_from = length(if starts_held { held_to } else { a0 });
        let free_to = libm::sqrt(-gain);

        let trough = if starts_held {
            fall
        } else {
            libm::sqrt(a0 * a0 - gain)
        };
        if a0 * (2.0 * a0 + trough) + 2.0 * self.begin > 0.0 {
            match self.hill(starts_held.then_some((held_from, held_to)), free_from) {
                Some(Hill::Held(peak)) if self.reach <= self.reach_held(peak) => {
                    return Some(self.fall_held(held_from, peak));
                }
                Some(Hill::Free(s)) if self.reach <= self.reach_free(s) => {
                    // Before the hill, in whichever part.
                    if starts_held && self.reach <= self.reach_held(held_to) {
                        return Some(self.fall_held(held_from, held_to));
                    }
                    return Some(self.free(free_from, s));
                }
                _ => {}
            }
        }
        if self.reach >= at_zero {
            return None;
        }
        let in_held = edge_squared <= 0.0 || starts_held && self.reach <= self.reach_held(held_to);
        Some(if in_held {
            self.fall_held(held_from, held_to)
        } else {
            self.free(free_from, free_to)
        })
    }

    /// Where G passes zero downwards.
    fn hill(&self, held: Option<(f64, f64)>, free_from: f64) -> Option<Hill> {
        let (fall, gain, sum) = (self.range.fall, self.gain(), self.sum());
        if let Some((from, to)) = held {
            let under = fall * fall - 16.0 * self.begin;
            let peak = -(fall + libm::sqrt(under.max(0.0))) / 4.0;
            if under >= 0.0 && peak >= from && peak <= to {
                return Some(Hill::Held(peak));
            }
        }
        // 3 s^4 + 4 S s^2 + K^2 = 0, its smaller root.
        let under = 4.0 * sum * sum - 3.0 * gain * gain;
        if sum < 0.0 && under >= 0.0 {
            let squared = gain * gain / (libm::sqrt(under) - 2.0 * sum);
            let s = libm::sqrt(squared);
            if s >= free_from && squared <= -gain {
                return Some(Hill::Free(s));
            }
        }
        None
    }

    /// R where no limit is reached.
    fn reach_free(&self, s: f64) -> f64 {
        let ratio = self.gain() / s;
        s * (s * s / 4.0 + self.sum() - ratio * ratio / 4.0)
    }

    /// R where the lower limit is held.
    fn reach_held(&self, peak: f64) -> f64 {
        let fall = self.range.fall;
        let with = peak + fall;
        let square = peak * with;
        (square * square + 2.0 * self.begin * peak * (with + fall)) / (2.0 * fall)
            + self.sum() * (fall - self.gain() / fall) / 2.0
    }
}
