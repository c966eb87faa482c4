//! S-curves on the device: from rest, and from whatever an axis is doing to a new target.

use super::Setpoint;
use super::bounds::Bounds;
use super::chain::{Chain, turns};
use super::change::{Change, Strength};
use super::trajectory::Sample;
use super::way::Way;
use crate::limits::Limits;
use crate::time::Ticks;
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

/// The limits in turns, with a margin for rounding.
pub(crate) fn bounds(limits: &Limits) -> Bounds {
    let below = |counts: i64| turns(counts) - turns(ROUNDING_MARGIN as i64);
    Bounds::of_axis(
        below(limits.velocity().counts()),
        below(limits.acceleration().counts()),
        below(limits.deceleration().counts()),
        below(limits.jerk().counts()),
    )
}

/// The least duration of an s-curve over `range`; `None` where that is longer than
/// [`crate::time::LONGEST_MOVE`].
pub fn shortest_s_curve(range: Position, limits: &Limits) -> Option<Ticks> {
    whole_ticks(way_from_rest(range, limits).quickest()?.duration())
}

/// The way from rest over `range`.
fn way_from_rest(range: Position, limits: &Limits) -> Way {
    let bounds = bounds(limits);
    let target = turns(range.counts());
    let sign = 1.0f64.copysign(target);
    let rest = Sample::at_rest(0.0);
    Way::new(&rest, target, sign, bounds.acceleration(), &bounds)
}

/// The ticks that last at least `seconds`, where a tick may miss it by rounding.
fn whole_ticks(seconds: f64) -> Option<Ticks> {
    Ticks::from_seconds_ceil(seconds * (1.0 - 1e-12))
}

/// Lays a chain from rest over `range` to `to` in `duration`; otherwise gives the least duration,
/// where there is one.
pub(crate) fn from_rest(
    chain: &mut Chain,
    range: Position,
    to: i64,
    duration: Ticks,
    limits: &Limits,
) -> Result<(), Option<Ticks>> {
    let way = way_from_rest(range, limits);
    if let Some(pieces) = way.lasting(duration) {
        return chain.lay(&pieces, Some(to)).ok_or(None);
    }
    let quickest = way.quickest().ok_or(None)?;
    match whole_ticks(quickest.duration()) {
        Some(least) if least <= duration => chain.lay(&way.pieces(&quickest), Some(to)).ok_or(None),
        least => Err(least),
    }
}

/// What the speed may rise with in a first lobe of this `sign`.
///
/// A first lobe that begins against its own direction slows down before it speeds up, so the
/// lesser of both limits counts.
fn speeding(sign: f64, from: &Sample, bounds: &Bounds) -> f64 {
    let (velocity, acceleration) = (sign * from.velocity, sign * from.acceleration);
    let dip = if acceleration < 0.0 {
        0.5 * acceleration * acceleration
    } else {
        0.0
    };
    if velocity * bounds.jerk() >= dip {
        bounds.acceleration()
    } else {
        bounds.slower_acceleration()
    }
}

/// The same bounds with the velocity that a state comes to, where that is above the limit by no
/// more than the margin for rounding: such a state is inside the limits.
fn above_by_rounding(from: &Sample, bounds: Bounds) -> Bounds {
    let taken = 0.5 * from.acceleration * from.acceleration.abs() / bounds.jerk();
    let fastest = from.velocity.abs().max((from.velocity + taken).abs());
    let excess = fastest - bounds.velocity();
    if excess <= 0.0 || excess > turns(ROUNDING_MARGIN as i64) {
        return bounds;
    }
    let (acceleration, deceleration) = (bounds.acceleration(), bounds.deceleration());
    Bounds::of_axis(fastest, acceleration, deceleration, bounds.jerk())
}

/// The stop from a state.
fn stopping(from: &Sample, bounds: &Bounds) -> Change<f64> {
    let strength = Strength {
        rise: bounds.deceleration(),
        fall: bounds.deceleration(),
        jerk: bounds.jerk(),
    };
    Change::new(from.velocity, from.acceleration, 0.0, &strength)
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
        let (v, a) = (
            self.state.velocity.counts(),
            self.state.acceleration.counts(),
        );
        if self.steps && a != 0 {
            let speeds_up = v == 0 || (v > 0) == (a > 0);
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

    /// Lays a chain from here to rest at `target` in `duration`, or as quickly as the limits allow
    /// where that is longer.
    pub(crate) fn rest_at(
        &self,
        chain: &mut Chain,
        target: Position,
        duration: Ticks,
        limits: &Limits,
    ) -> Option<()> {
        let bounds = bounds(limits);
        let from = self.entry(&bounds);
        let bounds = above_by_rounding(&from, bounds);
        let distance = turns((target - self.state.position).counts());
        let to = target.counts();
        let stop = stopping(&from, &bounds);
        // Short of the place where it can stop it goes back, and beyond that it goes on.
        let beyond = distance - stop.distance();
        let seconds = stop.duration();
        let rounding = turns(ROUNDING_MARGIN as i64) * (1.0 + seconds + seconds * seconds);
        if beyond.abs() <= rounding && duration.seconds() <= seconds + Ticks(1).seconds() {
            // A state in whole counts stops beside the target by a few of them.
            return chain.lay(&stop.pieces(0.0), Some(to));
        }
        let sign = 1.0f64.copysign(beyond);
        let strong = speeding(sign, &from, &bounds);
        let way = Way::new(&from, distance, sign, strong, &bounds);
        if let Some(pieces) = way.lasting(duration) {
            return chain.lay(&pieces, Some(to));
        }
        if let Some(pieces) = way.down() {
            return chain.lay(&pieces, Some(to));
        }
        let quickest = way.quickest()?;
        chain.lay(&way.pieces(&quickest), Some(to))
    }

    /// Lays a chain to rest as quickly as the limits allow, with a multiple of the jerk limit; with
    /// an infinite one the acceleration steps.
    pub(crate) fn stop(&self, chain: &mut Chain, limits: &Limits, times: f64) -> Option<()> {
        if times > f64::MAX {
            let velocity = turns(self.state.velocity.counts());
            let braking = Change::braking(velocity, turns(limits.deceleration().counts()));
            chain.lay(&braking.pieces(0.0), None)?;
            chain.step();
            return Some(());
        }
        let own = bounds(limits);
        let jerk = own.jerk() * times;
        let bounds = Bounds::of_axis(own.velocity(), own.acceleration(), own.deceleration(), jerk);
        let mut from = self.entry(&bounds);
        if self.steps && from.velocity * from.acceleration >= 0.0 {
            // A trapezoid that speeds up steps to none: taking it back would cost speed and time.
            from.acceleration = 0.0;
        }
        let stop = stopping(&from, &bounds);
        chain.lay(&stop.pieces(0.0), None)
    }
}
