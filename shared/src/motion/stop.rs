//! The controlled stop: from any state to rest, quickly and inside the limits; no target counts.
//!
//! Three phases of constant jerk: the acceleration goes to a deceleration A, stays there, and
//! comes back to zero just as the velocity does. With jerk j and start (v, a) in the direction of
//! motion, the middle phase vanishes for A = sqrt(j v + a^2 / 2), the triangle; where that is
//! over the deceleration limit d, A = d and the middle phase takes (v + a^2 / (2 j) - d^2 / j) / d.
//! The durations are then rounded up to whole ticks, and A is solved again from them, so that the
//! velocity ends at exactly zero.

use super::phase::{Entry, Phase};
use crate::limits::Limits;
use crate::time::{LONGEST_MOVE, TICKS_PER_SECOND, Ticks};
use heapless::Vec;

/// The phases of a stop.
pub(crate) const STOP_PHASES: usize = 3;

/// Counts that the plan stays below each limit, for what the tick's rounding may add.
pub(crate) const ROUNDING_MARGIN: f64 = 8.0;

/// A planned stop: its phases, and the tick and place of rest.
pub(crate) struct Stop {
    pub phases: Vec<Phase, STOP_PHASES>,
    pub rest: Entry,
}

/// Durations of the three phases in ticks.
#[derive(Clone, Copy)]
struct Durations {
    ramp: f64,
    hold: f64,
    release: f64,
}

/// The deceleration that brings the velocity to zero over these durations, in counts/s per tick
/// from a velocity in counts/s.
fn solve(velocity: f64, acceleration: f64, durations: Durations) -> f64 {
    (velocity + acceleration * durations.ramp / 2.0)
        / (durations.ramp / 2.0 + durations.hold + durations.release / 2.0)
}

fn ticks(duration: f64) -> f64 {
    libm::ceil(duration).max(1.0)
}

/// Plans the stop from `entry` with a multiple of the jerk limit; `None` where it is longer than a
/// move may be.
pub(crate) fn plan(entry: Entry, limits: &Limits, times: f64) -> Option<Stop> {
    let rate = TICKS_PER_SECOND as f64;
    // Everything in counts/s and ticks, mirrored so that the velocity is not negative.
    let mirror = if entry.velocity < 0.0 { -1.0 } else { 1.0 };
    let velocity = entry.velocity * mirror;
    let acceleration = entry.acceleration * mirror / rate;
    let limit = (limits.deceleration().counts() as f64 - ROUNDING_MARGIN) / rate;
    let fastest = limits.velocity().counts() as f64 - ROUNDING_MARGIN;
    let mut jerk = times * limits.jerk().counts() as f64 / (rate * rate);
    if acceleration < 0.0 && velocity > 0.0 {
        // Braking harder than this jerk can release before standstill: release faster instead.
        jerk = jerk.max(acceleration * acceleration / (2.0 * velocity));
    }
    let peak = libm::sqrt(jerk * velocity + acceleration * acceleration / 2.0).min(limit);
    let hold = (velocity + acceleration * acceleration / (2.0 * jerk) - peak * peak / jerk) / peak;
    let mut durations = Durations {
        ramp: ticks((peak + acceleration) / jerk),
        hold: if hold > 1e-6 { libm::ceil(hold) } else { 0.0 },
        release: ticks(peak / jerk),
    };
    let whole = durations.ramp + durations.hold + durations.release;
    if whole.is_nan() || whole >= f64::from(LONGEST_MOVE.0) {
        return None;
    }
    // While it still accelerates, the velocity rises by a^2 / (2 j): the velocity limit goes
    // before the jerk limit, so a shorter ramp where the rise would pass it.
    let held = durations.hold;
    loop {
        // Rounding up may have asked for more than the limit: hold for longer.
        while solve(velocity, acceleration, durations) > limit {
            durations.hold += 1.0;
        }
        let slope = (acceleration + solve(velocity, acceleration, durations)) / durations.ramp;
        let keeps = velocity + acceleration * acceleration / (2.0 * slope) <= fastest;
        if durations.ramp <= 1.0 || acceleration <= 0.0 || keeps {
            break;
        }
        durations.ramp -= 1.0;
        durations.hold = held;
    }
    let deceleration = -solve(velocity, acceleration, durations) * rate * mirror;
    let mut phases = Vec::new();
    let mut at = entry;
    for (duration, until) in [
        (durations.ramp, deceleration),
        (durations.hold, deceleration),
        (durations.release, 0.0),
    ] {
        if duration >= 1.0 {
            let (phase, exit) = Phase::constant_jerk(at, Ticks(duration as u32), until)?;
            phases.push(phase).ok()?;
            at = exit;
        }
    }
    Some(Stop { phases, rest: at })
}
