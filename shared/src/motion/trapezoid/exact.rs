//! The trapezoid in f64, from any velocity: constant acceleration, cruise, constant deceleration.
//!
//! With a = acceleration, d = deceleration and k = 1/(2 a) + 1/(2 d), all seen in the direction of
//! travel: going straight from velocity v0 to v1 takes the distance (v1^2 - v0^2) / (2 a), or
//! (v0^2 - v1^2) / (2 d) to slow down. Rising from there to a peak w and back takes k (w^2 - m^2)
//! more, where m is the greater of v0 and v1. So what is `beyond` the straight ramp gives
//! w = sqrt(m^2 + beyond / k), and what a limit of velocity cuts off becomes the cruise.
//!
//! | function | the first ramp | the last ramp | from, to |
//! |---|---|---|---|
//! | [`plan`] | acceleration | deceleration | velocities inside the limit, no detour |
//! | [`lasting`] | as plan, or deceleration to a slower cruise | as plan, or acceleration | as plan |
//! | [`to_rest`], [`to_rest_lasting`] | by speed: slowing is deceleration | deceleration | any velocity, to rest |
//! | [`time_optimal`] | by sign, as Ruckig's second order | by sign | any velocity, any in the limits |

mod lasting;

pub use lasting::{lasting, to_rest_lasting};

use crate::motion::bounds::{Bounds, checked_position, checked_rate};
use crate::motion::error::{ProfileError, checked};
use crate::motion::segments::{Builder, Segments};
use crate::motion::trajectory::Sample;

/// Rounding that a boundary case may carry: what an error said could be reached is accepted.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A move seen in its direction of travel, which is `sign`.
#[derive(Debug, Clone, Copy)]
struct Forward {
    sign: f64,
    distance: f64,
    /// The size of the positions, which carry rounding of theirs.
    size: f64,
    start: f64,
    stop: f64,
}

/// Seconds of the phases.
#[derive(Debug, Clone, Copy)]
struct Phases {
    rise: f64,
    cruise: f64,
    fall: f64,
}

impl Forward {
    /// How much farther the move goes than the straight ramp from start to stop velocity, and what of
    /// that may be rounding.
    fn beyond(&self, bounds: &Bounds) -> (f64, f64) {
        let rate = if self.stop > self.start {
            bounds.acceleration()
        } else {
            -bounds.deceleration()
        };
        let (start, stop) = (self.start * self.start, self.stop * self.stop);
        let straight = (stop - start) / (2.0 * rate);
        // Equal velocities leave nothing to round.
        let ramps = if straight == 0.0 {
            0.0
        } else {
            (stop + start) / (2.0 * rate.abs())
        };
        let rounding = f64::EPSILON * self.size + ROUNDING * ramps;
        (self.distance - straight, rounding)
    }

    /// The quickest phases that go `beyond` the straight ramp, which is not negative.
    fn quickest(&self, beyond: f64, bounds: &Bounds) -> Phases {
        let (up, down) = (bounds.acceleration(), bounds.deceleration());
        let greater = self.start.max(self.stop);
        let limit = bounds.velocity();
        // beyond / k
        let gain = beyond * (2.0 * up * down / (up + down));
        let peak = libm::sqrt(greater * greater + gain);
        let (over, cruise) = if peak > limit {
            let spare = gain - (limit - greater) * (limit + greater);
            let k = 0.5 / up + 0.5 / down;
            (limit - greater, spare * k / limit)
        } else if greater > 0.0 {
            // peak - greater without the cancellation.
            (gain / (peak + greater), 0.0)
        } else if beyond > 0.0 {
            (peak - greater, 0.0)
        } else {
            (0.0, 0.0)
        };
        Phases {
            rise: (greater - self.start + over) / up,
            cruise,
            fall: (greater - self.stop + over) / down,
        }
    }

    fn lay(&self, builder: Builder, phases: Phases, bounds: &Bounds) -> Builder {
        builder
            .acceleration(phases.rise, self.sign * bounds.acceleration())
            .acceleration(phases.cruise, 0.0)
            .acceleration(phases.fall, -self.sign * bounds.deceleration())
    }
}

/// What `plan` and `lasting` accept, seen in the direction of travel.
fn checked_ends(from: &Sample, to: &Sample, bounds: &Bounds) -> Result<Forward, ProfileError> {
    let start = checked_position("start position", from.position)?;
    let stop = checked_position("stop position", to.position)?;
    let limit = bounds.velocity();
    let start_velocity = checked("start velocity", from.velocity, -limit, limit)?;
    let stop_velocity = checked("stop velocity", to.velocity, -limit, limit)?;
    let distance = stop - start;
    // Without a distance the velocities tell the direction.
    let direction = [distance, start_velocity, stop_velocity]
        .into_iter()
        .find(|value| *value != 0.0)
        .unwrap_or(1.0);
    let sign = 1.0f64.copysign(direction);
    Ok(Forward {
        sign,
        distance: sign * distance,
        size: start.abs() + stop.abs(),
        start: sign * start_velocity,
        stop: sign * stop_velocity,
    })
}

/// `beyond`, or why start or stop velocity rule the move out.
fn reachable(forward: &Forward, bounds: &Bounds) -> Result<f64, ProfileError> {
    let (beyond, rounding) = forward.beyond(bounds);
    if beyond >= -rounding {
        return Ok(beyond.max(0.0));
    }
    let Forward {
        sign,
        distance,
        start,
        stop,
        ..
    } = *forward;
    // v^2 = v0^2 + 2 a R
    let after =
        |velocity: f64, rate: f64| sign * libm::sqrt(velocity * velocity + 2.0 * rate * distance);
    Err(if stop > start {
        ProfileError::StopOutOfReach {
            velocity: sign * stop,
            reachable: after(start, bounds.acceleration()),
        }
    } else {
        ProfileError::StartTooFast {
            velocity: sign * start,
            fastest: after(stop, bounds.deceleration()),
        }
    })
}

/// The quickest trapezoid from position and velocity to position and velocity.
///
/// Seen in the direction of travel the first ramp has the acceleration limit and the last one the
/// deceleration limit, also where a velocity against that direction makes them pass standstill.
/// Accelerations of `from` and `to` are not looked at, since a trapezoid steps its own. A zero
/// range counts as one in the direction of the start velocity, else of the stop velocity; with
/// equal velocities there is nothing to do.
///
/// # Errors
/// [`ProfileError::Value`] for a position that is not a number or a velocity above the limit;
/// [`ProfileError::StartTooFast`] and [`ProfileError::StopOutOfReach`] where the range is too short
/// for the velocities, with the one that it is just enough for.
pub fn plan(from: Sample, to: Sample, bounds: &Bounds) -> Result<Segments, ProfileError> {
    let forward = checked_ends(&from, &to, bounds)?;
    let builder = Builder::new(Sample::coasting(from.position, from.velocity));
    if forward.distance == 0.0 && forward.start == forward.stop {
        return Ok(builder.end(to.position, to.velocity));
    }
    let beyond = reachable(&forward, bounds)?;
    let phases = forward.quickest(beyond, bounds);
    let laid = forward.lay(builder, phases, bounds);
    Ok(laid.end(to.position, to.velocity))
}

/// The quickest way from any position and velocity to rest at `target`.
///
/// Whoever comes too fast overshoots and comes back; whoever is faster than the velocity limit
/// slows down to it. Slowing down takes the deceleration limit and speeding up the acceleration
/// limit, whatever the direction. It takes one square root, so a device can afford it.
///
/// # Errors
/// [`ProfileError::Value`] for a position or velocity that is not a number or beyond 1e15.
pub fn to_rest(from: Sample, target: f64, bounds: &Bounds) -> Result<Segments, ProfileError> {
    let Approach {
        builder,
        mut forward,
        beyond,
    } = approach(from, target, bounds)?;
    let builder = forward.slow_to_limit(builder, bounds);
    let phases = forward.quickest(beyond, bounds);
    let laid = forward.lay(builder, phases, bounds);
    Ok(laid.end(target, 0.0))
}

/// A way to rest from where it leads straight to the target.
struct Approach {
    /// The turning back before that.
    builder: Builder,
    forward: Forward,
    /// How much farther the target is than the braking distance.
    beyond: f64,
}

/// Turns back first where the target is behind.
fn approach(from: Sample, target: f64, bounds: &Bounds) -> Result<Approach, ProfileError> {
    let start = checked_position("start position", from.position)?;
    let stop = checked_position("target", target)?;
    let velocity = checked_rate("start velocity", from.velocity)?;
    let distance = stop - start;
    let braking = velocity * velocity.abs() / (2.0 * bounds.deceleration());
    let beyond = distance - braking;
    let sign = 1.0f64.copysign(if beyond == 0.0 { velocity } else { beyond });
    let mut forward = Forward {
        sign,
        distance: sign * distance,
        size: start.abs() + stop.abs(),
        start: sign * velocity,
        stop: 0.0,
    };
    let beyond = beyond.abs();
    let mut builder = Builder::new(Sample::coasting(start, velocity));
    if forward.start < 0.0 {
        let deceleration = bounds.deceleration();
        builder = builder.acceleration(-forward.start / deceleration, sign * deceleration);
        forward.start = 0.0;
        forward.distance = beyond;
    }
    Ok(Approach {
        builder,
        forward,
        beyond,
    })
}

impl Forward {
    /// Comes down to the velocity limit first.
    fn slow_to_limit(&mut self, builder: Builder, bounds: &Bounds) -> Builder {
        let excess = self.start - bounds.velocity();
        if excess > 0.0 {
            self.start = bounds.velocity();
        }
        builder.acceleration(
            excess / bounds.deceleration(),
            -self.sign * bounds.deceleration(),
        )
    }
}

/// The quickest way from any position and velocity to any position and velocity, where limits go
/// by sign: what Ruckig plans without a jerk limit.
///
/// `up` holds where the velocity first rises: to at most its velocity, rising with its
/// acceleration and falling with its deceleration. `down` holds where it first falls, seen from
/// there: its acceleration is how fast the velocity falls, its deceleration how fast it rises
/// again. With limits that are the same both ways, both are the same. A start outside the velocity
/// limits first comes back inside.
///
/// # Errors
/// [`ProfileError::Value`] for a position or start velocity that is not a number or beyond 1e15,
/// and for a stop velocity outside the limits.
pub fn time_optimal(
    from: Sample,
    to: Sample,
    up: &Bounds,
    down: &Bounds,
) -> Result<Segments, ProfileError> {
    let start = checked_position("start position", from.position)?;
    let stop = checked_position("stop position", to.position)?;
    let start_velocity = checked_rate("start velocity", from.velocity)?;
    let stop_velocity = checked(
        "stop velocity",
        to.velocity,
        -down.velocity(),
        up.velocity(),
    )?;
    let builder = Builder::new(Sample::coasting(start, start_velocity));
    let seen = |sign: f64| Forward {
        sign,
        distance: sign * (stop - start),
        size: start.abs() + stop.abs(),
        start: sign * start_velocity,
        stop: sign * stop_velocity,
    };
    let mut forward = seen(1.0);
    let (mut beyond, mut rounding) = forward.beyond(up);
    let mut bounds = up;
    if beyond < 0.0 {
        forward = seen(-1.0);
        (beyond, rounding) = forward.beyond(down);
        bounds = down;
    }
    // With both velocities against the direction the least bit beyond is a long way round.
    if forward.start < 0.0 && forward.stop < 0.0 && beyond <= rounding {
        beyond = 0.0;
    }
    let builder = forward.slow_to_limit(builder, bounds);
    let phases = forward.quickest(beyond.max(0.0), bounds);
    let laid = forward.lay(builder, phases, bounds);
    Ok(laid.end(stop, stop_velocity))
}
