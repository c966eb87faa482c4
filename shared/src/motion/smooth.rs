//! S-curves on the device: from rest, and from whatever an axis is doing to a new target.

use super::Setpoint;
use super::bounds::Bounds;
use super::chain::{Chain, turns};
use super::error::ProfileError;
use super::s_curve::{self, SignedBounds};
use super::segments::Segments;
use super::stop::Braking;
use super::trajectory::{Sample, Trajectory};
use crate::limits::Limits;
use crate::time::{Tick, Ticks};
use crate::units::Position;

/// Counts that a plan stays below each limit, for what the tick's rounding may add.
pub(crate) const ROUNDING_MARGIN: f64 = 8.0;

/// An axis as it is commanded at one tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Commanded {
    pub state: Setpoint,
    /// Whether its acceleration may step, because that is what is under way.
    pub steps: bool,
}

/// The limits in turns, with a margin for rounding; `None` where there is none, which a
/// [`Limits`] never is.
pub(crate) fn bounds(limits: &Limits) -> Option<Bounds> {
    let below = |counts: i64| turns(counts) - turns(ROUNDING_MARGIN as i64);
    Bounds::new(
        below(limits.velocity().counts()),
        below(limits.acceleration().counts()),
        below(limits.deceleration().counts()),
        below(limits.jerk().counts()),
    )
    .ok()
}

/// The least duration of an s-curve over `range`; `None` where that is longer than
/// [`crate::time::LONGEST_MOVE`].
pub fn shortest_s_curve(range: Position, limits: &Limits) -> Option<Ticks> {
    let to = Sample::at_rest(turns(range.counts()));
    let curve = s_curve::plan(Sample::at_rest(0.0), to, &bounds(limits)?).ok()?;
    whole_ticks(curve.duration())
}

/// The ticks that last at least `seconds`, where a tick may miss it by rounding.
fn whole_ticks(seconds: f64) -> Option<Ticks> {
    Ticks::from_seconds_ceil(seconds * (1.0 - 1e-12))
}

/// From rest over `range` in `duration`; otherwise the least duration, where there is one.
pub(crate) fn from_rest(
    range: Position,
    duration: Ticks,
    limits: &Limits,
) -> Result<Segments, Option<Ticks>> {
    let bounds = bounds(limits).ok_or(None)?;
    let range = turns(range.counts());
    let signed = if range < 0.0 {
        SignedBounds::backward(&bounds)
    } else {
        SignedBounds::forward(&bounds)
    };
    let from = Sample::at_rest(0.0);
    let signed = signed.map_err(|_| None)?;
    match s_curve::lasting(from, range, duration.seconds(), &signed) {
        Ok(curve) => Ok(curve),
        Err(ProfileError::TooShort { shortest, .. }) => match whole_ticks(shortest) {
            // As long as the ticks are but for rounding.
            Some(least) if least <= duration => {
                s_curve::to_rest(from, range, &signed).map_err(|_| None)
            }
            least => Err(least),
        },
        Err(_) => Err(None),
    }
}

/// The limit that counts while the speed rises, and while it falls.
#[derive(Clone, Copy)]
struct Speeding {
    up: f64,
    down: f64,
}

/// The limits by sign for a motion whose first lobe has this `sign` and whose last one brakes.
///
/// A first lobe that begins against its own direction slows down before it speeds up, so the
/// lesser of both limits counts.
fn signed(sign: f64, from: &Sample, bounds: &Bounds) -> Option<SignedBounds> {
    let (velocity, acceleration) = (sign * from.velocity, sign * from.acceleration);
    let dip = if acceleration < 0.0 {
        acceleration * acceleration / (2.0 * bounds.jerk())
    } else {
        0.0
    };
    let limit = Speeding {
        up: if velocity >= dip {
            bounds.acceleration()
        } else {
            bounds.slower_acceleration()
        },
        down: bounds.deceleration(),
    };
    let (greatest, least) = if sign < 0.0 {
        (limit.down, -limit.up)
    } else {
        (limit.up, -limit.down)
    };
    let velocity = bounds.velocity();
    SignedBounds::new(velocity, -velocity, greatest, least, bounds.jerk()).ok()
}

impl Commanded {
    /// What a curve of limited jerk begins with.
    ///
    /// At its corners a trapezoid has more acceleration than such a curve can take back in time:
    /// before the velocity limit, or before standstill where it slows down. Since it steps anyway,
    /// it then steps down to what can be taken back.
    pub(crate) fn entry(&self, bounds: &Bounds) -> Sample {
        let velocity = turns(self.state.velocity.counts());
        let acceleration = turns(self.state.acceleration.counts());
        let mut entry = Sample {
            velocity,
            acceleration,
            ..Sample::default()
        };
        if self.steps && acceleration != 0.0 {
            let speeds_up = velocity == 0.0 || (velocity > 0.0) == (acceleration > 0.0);
            let room = if speeds_up {
                (bounds.velocity() - velocity.abs()).max(0.0)
            } else {
                velocity.abs()
            };
            let square = 2.0 * bounds.jerk() * room;
            if acceleration * acceleration > square {
                entry.acceleration = libm::sqrt(square).copysign(acceleration);
            }
        }
        entry
    }

    /// To rest at `target` in `duration`, or as quickly as the limits allow where that is longer;
    /// it begins at `start`.
    pub(crate) fn to_rest(
        &self,
        start: Tick,
        target: Position,
        duration: Ticks,
        limits: &Limits,
    ) -> Option<Chain> {
        let bounds = bounds(limits)?;
        let from = self.entry(&bounds);
        let place = self.state.position;
        let distance = turns((target - place).counts());
        let stop = Braking::new(&from, &bounds);
        // Short of the place where it can stop it goes back, and beyond that it goes on.
        let beyond = distance - stop.distance();
        let seconds = stop.duration();
        let rounding = turns(ROUNDING_MARGIN as i64) * (1.0 + seconds + seconds * seconds);
        if beyond.abs() <= rounding && duration.seconds() <= seconds + Ticks(1).seconds() {
            // A state in whole counts stops beside the target by a few of them.
            return Chain::of(stop.pieces(), start, place.counts(), Some(target.counts()));
        }
        let sign = 1.0f64.copysign(beyond);
        let curve = quickest(&from, distance, duration.seconds(), sign, &bounds)?;
        Chain::new(&curve, start, place.counts(), target.counts())
    }

    /// To rest as quickly as the limits allow, with a multiple of the jerk limit.
    pub(crate) fn stop(&self, now: Tick, limits: &Limits, times: f64) -> Option<Chain> {
        let own = bounds(limits)?;
        let jerk = own.jerk() * times;
        let harder = Bounds::new(own.velocity(), own.acceleration(), own.deceleration(), jerk);
        let bounds = harder.ok()?;
        let mut from = self.entry(&bounds);
        if self.steps && from.velocity * from.acceleration >= 0.0 {
            // A trapezoid that speeds up steps to none: taking it back would cost speed and time.
            from.acceleration = 0.0;
        }
        let stop = Braking::new(&from, &bounds);
        Chain::of(stop.pieces(), now, self.state.position.counts(), None)
    }
}

/// From a state whose motion to `target` turns begins with a lobe of this `sign`, in `duration`
/// seconds or as quickly as the limits allow.
fn quickest(
    from: &Sample,
    target: f64,
    duration: f64,
    sign: f64,
    bounds: &Bounds,
) -> Option<Segments> {
    let limited = signed(sign, from, bounds)?;
    let rise = from.acceleration * from.acceleration.abs() / (2.0 * bounds.jerk());
    let fastest = from.velocity.abs().max((from.velocity + rise).abs());
    if fastest <= bounds.velocity() {
        return match s_curve::lasting(*from, target, duration, &limited) {
            Err(ProfileError::TooShort { .. }) => {
                s_curve::to_rest(*from, target, &limited).ok()
            }
            curve => curve.ok(),
        };
    }
    // Above the velocity limit, which has been lowered. A longer duration has a cruise below the
    // limit, and is solved without it: the way to that cruise is then one ramp too.
    let quickest = s_curve::to_rest(*from, target, &limited).ok()?;
    if duration <= quickest.duration() {
        return Some(quickest);
    }
    let wide = Bounds::new(
        fastest * (1.0 + 1e-12),
        bounds.acceleration(),
        bounds.deceleration(),
        bounds.jerk(),
    );
    let curve = s_curve::lasting(*from, target, duration, &signed(sign, from, &wide.ok()?)?);
    Some(curve.unwrap_or(quickest))
}
