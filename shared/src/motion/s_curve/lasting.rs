//! To rest within a given time: for axes that arrive together.
//!
//! The acceleration and the jerk stay those of the quickest motion, and the cruise is slower: at a
//! velocity u there is a change to u, a cruise, and a stop, and what is reached grows with u. In
//! unit-jerk time, where h(w) = w t(w) / 2 with the time t of a change of velocity by w (see
//! `lobes`), the reach within a time T is
//!
//!   T u + u a0 - h(u - P) - h(u)                where the change to u rises,
//!   T u - u a0 + h(Q - u) - h(u) + 2 v0 a0      where it falls; Q = v0 + a0^2 / 2.
//!
//! A start that moves may leave no room for two changes of velocity within the time. Then the
//! motion is blended from two that last just as long: the one that stops at once and waits, and
//! the one that gets farthest. Limits are convex and motion is linear, so that a blend of two
//! motions that keep the limits keeps them too.

use super::brake::brake;
use super::lobes::{Lobes, Triangle, change_peak, change_time};
use super::root::{CORNERED, Curve, root};
use super::unit::{Piece, Pieces, Range, State};
use super::upward::Upward;
use super::{Side, SignedBounds, checked_start, side};
use crate::motion::bounds::LARGEST;
use crate::motion::error::{ProfileError, checked};
use crate::motion::segments::Segments;
use crate::motion::trajectory::Sample;

/// How far, in relation, a duration may be below the shortest for the rounding of both.
const ROUNDING: f64 = 1e-12;

/// To rest at `target` in `duration` seconds, with the acceleration and jerk of the quickest motion
/// and a slower cruise.
///
/// From rest this is a symmetrical s-curve with the velocity limit lowered; a start that moves may
/// ask for less acceleration and jerk than the limits allow.
///
/// # Errors
/// A value that is not a number or too large; a duration that is too short, with the shortest.
pub fn lasting(
    from: Sample,
    target: f64,
    duration: f64,
    bounds: &SignedBounds,
) -> Result<Segments, ProfileError> {
    let outside = checked_start(from, target, bounds)?;
    checked("duration", duration, 0.0, LARGEST)?;
    let jerk = bounds.jerk();
    let range = Range::new(bounds, from.position, target);
    let mut pieces = Pieces::default();
    let state = brake(outside, &range, &mut pieces);
    let braked = pieces.duration();
    let left = jerk * duration - braked;
    let (up, sign) = match side(state, 0.0, &range) {
        Side::Above(up, sign) => (up, sign),
        Side::There(up) => (up, 0.0),
    };
    let quickest = if sign == 0.0 {
        up.direct()
    } else {
        up.quickest()
    };
    let least = quickest.duration(up.a0);
    if left < least - ROUNDING * (least + braked) {
        return Err(ProfileError::TooShort {
            duration,
            shortest: (braked + least) / jerk,
        });
    }
    if left <= least + ROUNDING * (least + braked) {
        quickest.lay(up.a0, if sign == 0.0 { 1.0 } else { sign }, &mut pieces);
    } else if sign == 0.0 {
        quickest.lay(up.a0, 1.0, &mut pieces);
        pieces.push(Piece::cruise(left - least, 0.0));
    } else {
        let slower = Slower { up, time: left };
        match slower.cruise_velocity(&quickest) {
            Some(velocity) => slower.lay(velocity, sign, &mut pieces),
            None => slower.blend(sign, &mut pieces),
        }
    }
    Ok(pieces.join(from, Sample::at_rest(target), jerk))
}

/// A motion upwards that is to last for a time, longer than the quickest.
struct Slower {
    up: Upward,
    time: f64,
}

impl Slower {
    /// What is left of the time for a cruise at `velocity`.
    fn cruise(&self, velocity: f64) -> f64 {
        let change = self.up.towards(velocity).direct().duration(self.up.a0);
        self.time - change - change_time(velocity, self.up.range.fall)
    }

    /// The velocity of the cruise, where there is time for one.
    fn cruise_velocity(&self, quickest: &Lobes) -> Option<f64> {
        let Upward {
            a0,
            begin,
            reach,
            range,
            ..
        } = self.up;
        let curve = |velocity: f64| {
            let stop = Triangle::new(velocity, range.fall);
            let (change, turn, sign) = if self.up.towards(velocity).rises() {
                (Triangle::new(velocity - begin, range.rise), a0, -1.0)
            } else {
                let top = begin + a0 * a0;
                (Triangle::new(top - velocity, range.fall), -a0, 1.0)
            };
            let constant = if sign > 0.0 {
                a0 * (2.0 * begin + a0 * a0)
            } else {
                0.0
            };
            Curve {
                value: (self.time + turn) * velocity + sign * change.area - stop.area + constant
                    - reach,
                slope: self.time + turn - change.slope - stop.slope,
                curvature: sign * change.curvature - stop.curvature,
            }
        };
        // The quickest motion's own peak: at that velocity the time is enough to get too far.
        let highest = if quickest.cruise > 0.0 {
            range.highest
        } else if quickest.peak > 0.0 {
            begin + quickest.peak * (quickest.peak + quickest.peak_hold)
        } else {
            begin
        };
        if highest <= 0.0 || curve(highest).value < 0.0 {
            return None;
        }
        let velocity = root(0.0, highest, reach / self.time, CORNERED, curve);
        (self.cruise(velocity) >= 0.0).then_some(velocity)
    }

    /// Lays the motion that cruises at `velocity`.
    fn lay(&self, velocity: f64, sign: f64, pieces: &mut Pieces) {
        self.up
            .towards(velocity)
            .direct()
            .lay(self.up.a0, sign, pieces);
        pieces.push(Piece::cruise(self.cruise(velocity), sign * velocity));
        let (trough, trough_hold) = change_peak(velocity, self.up.range.fall);
        let stop = Lobes {
            trough,
            trough_hold,
            ..Lobes::default()
        };
        stop.lay(0.0, sign, pieces);
    }

    /// Lays the blend of the nearest and the farthest.
    fn blend(&self, sign: f64, pieces: &mut Pieces) {
        let Upward { a0, begin, .. } = self.up;
        let state = State {
            position: 0.0,
            velocity: begin + a0 * a0 / 2.0,
            acceleration: a0,
        };
        let distance = self.up.distance();
        let (mut near, mut far) = (Pieces::default(), Pieces::default());
        self.up.direct().lay(a0, 1.0, &mut near);
        self.up.farthest(self.time).lay(a0, 1.0, &mut far);
        let (nearest, farthest) = (near.carry(state).position, far.carry(state).position);
        let share = ((distance - nearest) / (farthest - nearest)).clamp(0.0, 1.0);
        let mut acceleration = a0;
        let (mut near, mut far) = (Stretch::new(&near), Stretch::new(&far));
        let mut left = self.time;
        while left > 0.0 {
            let duration = near.left().min(far.left()).min(left);
            let jerk = (1.0 - share) * near.jerk() + share * far.jerk();
            pieces.push(Piece::new(duration, sign * jerk, sign * acceleration));
            acceleration += duration * jerk;
            near.pass(duration);
            far.pass(duration);
            left -= duration;
            if near.ended() && far.ended() {
                break;
            }
        }
    }
}

/// Goes through pieces by time; after them all is at rest.
struct Stretch<'a> {
    pieces: &'a [Piece],
    passed: f64,
}

impl<'a> Stretch<'a> {
    fn new(pieces: &'a Pieces) -> Self {
        Self {
            pieces: pieces.as_slice(),
            passed: 0.0,
        }
    }

    fn ended(&self) -> bool {
        self.pieces.is_empty()
    }

    /// What is left of the piece.
    fn left(&self) -> f64 {
        self.pieces
            .first()
            .map_or(f64::INFINITY, |piece| piece.duration - self.passed)
    }

    fn jerk(&self) -> f64 {
        self.pieces.first().map_or(0.0, |piece| piece.jerk)
    }

    fn pass(&mut self, duration: f64) {
        if duration >= self.left() {
            self.pieces = self.pieces.get(1..).unwrap_or(&[]);
            self.passed = 0.0;
        } else {
            self.passed += duration;
        }
    }
}
