//! The controlled stop: from any state to rest, quickly and inside the limits; no target counts.
//!
//! It is the quickest change of velocity to zero with limited jerk, see `change`.

use super::Motion;
use super::chain::Chain;
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
    /// would leave the travel, it is made with more jerk than the limit; where even that does not
    /// help, the motion under way, which was checked to stay inside, runs on to its end. From
    /// outside the travel every stop counts that does not lead farther out.
    pub fn stop(&mut self, now: Tick, limits: &Limits) -> Tick {
        self.drop_pending(now);
        self.fold(now);
        let Some(end) = self.end().filter(|end| now < *end) else {
            return now;
        };
        let commanded = self.commanded(now);
        for times in [1.0].into_iter().chain(HARDER) {
            let mut chain = Chain::new(now, commanded.state.position.counts());
            let laid = commanded.stop(&mut chain, limits, times).is_some();
            if !laid || !chain.stays(limits) {
                continue;
            }
            if chain.end < end {
                self.take_over(now, &chain);
                return chain.end;
            }
            if times == 1.0 {
                break;
            }
        }
        end
    }
}
