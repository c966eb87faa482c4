//! When an axis must rest.

use canter_shared::axis::state::State;
use canter_shared::limits::Limits;
use canter_shared::motion::Setpoint;
use canter_shared::time::Ticks;
use canter_shared::wire::command::Command;

use super::{Believe, Finding, Glance, Statistics, Verdict};
use crate::sim::TrueTime;
use crate::soak::invariant::Invariant;

/// Seconds beside what the limits allow: a tick to take notice, one for the setpoint that is under
/// way, one to be at rest, and one by which all of this is rounded.
const ROUNDING: f64 = 0.004;

/// The longest time that a stop may take, in s.
///
/// With the acceleration a and the jerk j the acceleration is gone after |a| / j, and the velocity
/// is then |v| + a^2 / 2j at most, in either direction. From there at rest it takes v / d + d / j
/// with the deceleration d, or less where v is too small to reach d. Where the limits of speeding
/// up and slowing down differ, the lesser one is slower. A shaper delays it all.
pub(super) fn longest_stop(setpoint: &Setpoint, limits: &Limits, delay: Ticks) -> f64 {
    // What is inside of a shaper cannot be seen: at the worst it is at the limits.
    let (velocity, acceleration) = if delay > Ticks(0) {
        let strongest = limits.acceleration().max(limits.deceleration());
        (limits.velocity().radians(), strongest.radians())
    } else {
        let rate = setpoint.velocity.abs().radians();
        (rate, setpoint.acceleration.abs().radians())
    };
    let jerk = limits.jerk().radians();
    let deceleration = limits.slower_acceleration().radians();
    let left = velocity + acceleration * acceleration / (2.0 * jerk);
    let ramps = acceleration / jerk + left / deceleration + deceleration / jerk;
    ramps + delay.seconds() + ROUNDING
}

/// A stop that must come to its end.
#[derive(Debug, Clone, Copy)]
struct Due {
    since: TrueTime,
    until: TrueTime,
    why: &'static str,
    /// What the axis was at then.
    from: Setpoint,
    /// A new command to move takes its place.
    gives_way: bool,
}

/// The eye on the stops of an axis.
#[derive(Debug, Default)]
pub(super) struct Stopping {
    due: Option<Due>,
}

impl Stopping {
    /// A command was delivered; `moves` where a motion was commanded since the last tick.
    pub(super) fn command(
        &mut self,
        now: TrueTime,
        command: &Command,
        moves: bool,
        last: &Glance,
        believe: &Believe,
    ) {
        let why = match command {
            Command::Stop { .. } => "a stop",
            Command::EmergencyStop => "an emergency stop",
            _ => {
                if moves {
                    self.due = self.due.filter(|due| !due.gives_way);
                }
                return;
            }
        };
        if last.state.drives() && last.moving {
            let gives_way = why == "a stop";
            self.begin(now, last, believe, why, gives_way);
        }
    }

    fn begin(
        &mut self,
        since: TrueTime,
        last: &Glance,
        believe: &Believe,
        why: &'static str,
        gives_way: bool,
    ) {
        let longest = longest_stop(&last.setpoint, &believe.limits, believe.delay);
        let until = TrueTime(since.0.saturating_add((longest * 1e9) as u64));
        let due = Due {
            since,
            until,
            why,
            from: last.setpoint,
            gives_way,
        };
        // A second stop gives the first one no more time.
        match &mut self.due {
            Some(first) if first.until <= until => first.gives_way &= gives_way,
            _ => self.due = Some(due),
        }
    }

    pub(super) fn tick(
        &mut self,
        last: Option<&Glance>,
        now: &Glance,
        believe: &Believe,
        statistics: &mut Statistics,
    ) -> Verdict {
        if let Some(last) = last.filter(|last| last.state == State::OperationEnabled) {
            let why = match now.state {
                State::FaultReactionActive => Some("a fault"),
                State::QuickStopActive => Some("a disable"),
                _ => None,
            };
            if let Some(why) = why {
                // What a tick finds out, it brings to rest from the setpoint of that very tick.
                let (before, after) = (&last.setpoint, &now.setpoint);
                let faster = if after.velocity.abs() > before.velocity.abs() {
                    now
                } else {
                    last
                };
                self.begin(last.time, faster, believe, why, false);
            }
        }
        let Some(due) = self.due else {
            return Ok(());
        };
        let may = due.until.0.saturating_sub(due.since.0) as f64;
        if now.rests() {
            self.due = None;
            let took = now.time.0.saturating_sub(due.since.0) as f64;
            statistics.stop(took / may);
        } else if now.time > due.until {
            return Err(Finding(
                Invariant::Stop,
                format!(
                    "still at {:.9} rad/s in {} {:.1} ms after {} at {:.9} rad/s and {:.6} rad/s^2, which takes {:.1} ms at the most with {:.6} rad/s^2 and {:.3} rad/s^3",
                    now.setpoint.velocity.radians(),
                    now.state,
                    now.time.0.saturating_sub(due.since.0) as f64 / 1e6,
                    due.why,
                    due.from.velocity.radians(),
                    due.from.acceleration.radians(),
                    may / 1e6,
                    believe.limits.slower_acceleration().radians(),
                    believe.limits.jerk().radians(),
                ),
            ));
        }
        Ok(())
    }
}
