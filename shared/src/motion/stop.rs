//! From any state to rest, quickly and inside the limits; no target counts.
//!
//! The controlled stop is the quickest change of velocity to zero with limited jerk, see `change`.
//! The quick stop has the deceleration limit from its first tick to its last, whatever the jerk: a
//! velocity v is gone after v / d, and v^2 / (2 d) farther on.

use super::Motion;
use super::chain::Chain;
use super::passing::passes;
use super::smooth::ROUNDING_MARGIN;
use crate::limits::Limits;
use crate::time::Tick;

/// Multiples of the jerk limit that a stop is tried with where it would leave the travel: the
/// travel goes before the jerk.
pub(super) const HARDER: [f64; 4] = [4.0, 16.0, 256.0, 65_536.0];

impl Motion {
    /// Comes to rest as quickly as the limits allow, wherever that is; what was still to start is
    /// dropped. Gives the first tick at rest.
    ///
    /// A motion that rests as soon anyway is left alone, a stop under way above all. Where a stop
    /// would leave the travel or pass another limit, it is made with more jerk than the limit,
    /// at the last as a quick stop; where even that does not help, the motion under way, which was
    /// checked to stay inside, runs on to its end. From outside the travel every stop counts that
    /// does not lead farther out; above a velocity limit that was lowered it is smooth.
    pub fn stop(&mut self, now: Tick, limits: &Limits) -> Tick {
        self.rest_soon(now, limits, false)
    }

    /// Comes to rest as quickly as the deceleration limit allows, whatever the jerk; the rest as
    /// [`Self::stop`].
    ///
    /// Whatever is under way needs at least as much room to come to rest, so a quick stop does not
    /// leave the travel.
    pub fn quick_stop(&mut self, now: Tick, limits: &Limits) -> Tick {
        self.rest_soon(now, limits, true)
    }

    #[inline(never)]
    fn rest_soon(&mut self, now: Tick, limits: &Limits, quick: bool) -> Tick {
        self.drop_pending(now);
        self.fold(now);
        let Some(end) = self.end().filter(|end| now < *end) else {
            return now;
        };
        let commanded = self.commanded(now);
        // The wanted stop first; what is tried after it comes to rest later or has more jerk.
        let mut times = [
            1.0,
            HARDER[0],
            HARDER[1],
            HARDER[2],
            HARDER[3],
            f64::INFINITY,
        ];
        if quick {
            times.reverse();
        }
        // A motion that brakes for the end of the travel already, and then turns back, leaves no room
        // but for what rounding takes: the margin to the limit, which only the quick stop uses up,
        // and where the limits are of a few counts, some counts beside the end.
        let last = (f64::INFINITY, ROUNDING_MARGIN as i64);
        let tries = times.map(|times| (times, 0)).into_iter().chain([last]);
        for (place, (times, beside)) in tries.enumerate() {
            // What was a trapezoid's steps to what can be taken back in time.
            if !commanded.steps && passes(&commanded.state, limits, times, 0.0) {
                continue;
            }
            let mut chain = Chain::new(now, commanded.state.position.counts());
            let laid = commanded.stop(&mut chain, limits, times).is_some();
            if !laid || !chain.stays_beside(limits, beside) {
                continue;
            }
            // Of two that end with the same tick the quick stop is shorter.
            if chain.end < end || quick && chain.end == end {
                self.take_over(now, &chain);
                return chain.end;
            }
            if place == 0 {
                break;
            }
        }
        end
    }
}
