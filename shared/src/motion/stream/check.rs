//! Whether a piece keeps the limits.
//!
//! A polynomial in Bernstein form stays between the least and the greatest of its control values
//! (the convex hull property; Farin, Curves and Surfaces for CAGD). So the limits are held against
//! control values. Where those say too much, de Casteljau's halving brings them closer to the curve
//! by four each time.

use super::Breach;
use super::shape::{ACCELERATION_BITS, Cubic, Divisor, Shape, TICK, VELOCITY_BITS, round};
use super::stretch::Place;
use crate::limits::Limits;
use crate::motion::fixed::scale;
use crate::time::TICKS_PER_SECOND;
use crate::units::{Position, difference, product, sum};

/// Counts that a position may be off by rounding.
const ROUNDING: i64 = 8;

/// A second in ticks; what is shorter is a fraction.
const SECOND: u16 = TICKS_PER_SECOND as u16;

/// How often a curve is halved before a limit counts as broken: its control values are then off by
/// less than 1/256 of what they first were.
const HALVINGS: u32 = 4;

/// Whether the piece from one knot to the next, `ticks` later, at most [`super::LONGEST_PIECE`], keeps the
/// limits from end to end. Gives the acceleration that it ends with, in counts/s^2.
///
/// # Errors
/// The first limit that is found broken.
pub(super) fn check<const QUINTIC: bool>(
    from: &Place,
    to: &Place,
    ticks: u16,
    known: &Divisor,
    limits: &Limits,
) -> Result<i64, Breach> {
    let fastest = limits.velocity().counts();
    let way = difference(to.position, from.position);
    let thousandfold = product(way, TICKS_PER_SECOND as u32);
    for velocity in [from.velocity, to.velocity] {
        if velocity.saturating_abs() > fastest {
            return Err(Breach::Velocity(velocity));
        }
    }
    let length = known.or_new(ticks);
    if thousandfold.saturating_abs() > fastest * i64::from(ticks) {
        return Err(Breach::Velocity(length.divide(thousandfold)));
    }
    let speeding_up = limits.acceleration().counts();
    let rates = Rates {
        velocity: fastest << VELOCITY_BITS,
        acceleration: speeding_up << ACCELERATION_BITS,
        deceleration: limits.deceleration().counts() << ACCELERATION_BITS,
    };
    // Where an end leaves its acceleration to the curve, no other than the curve's is followed.
    if QUINTIC && let (Some(first), Some(last)) = (from.acceleration, to.acceleration) {
        let strongest = speeding_up.max(limits.deceleration().counts());
        for (velocity, acceleration) in [(from.velocity, first), (to.velocity, last)] {
            // Whoever stands cannot slow down.
            let limit = if velocity == 0 {
                speeding_up
            } else {
                strongest
            };
            if acceleration.saturating_abs() > limit {
                return Err(Breach::Acceleration(acceleration));
            }
        }
        let shape = Shape::quintic(from, first, to, last, &length)?;
        rates.keep(shape.velocity, shape.acceleration, HALVINGS)?;
        stays(|| shape.velocity, from.position, ticks, limits)?;
        return Ok(last);
    }
    let cubic = Cubic::between(from, to, &length)?;
    rates.keep(cubic.velocity, cubic.acceleration, HALVINGS)?;
    stays(|| cubic.raised().velocity, from.position, ticks, limits)?;
    let [_, last] = cubic.acceleration;
    Ok(round(last, ACCELERATION_BITS))
}

/// Whether the piece from `position` with this velocity stays inside the travel.
fn stays(
    velocity: impl FnOnce() -> [i64; 5],
    position: i64,
    ticks: u16,
    limits: &Limits,
) -> Result<(), Breach> {
    // Mostly the ends of the travel are too far away to be reached in this time.
    let whole = u64::from(ticks).wrapping_mul(TICK);
    let reach = scale(limits.velocity().counts(), whole) + ROUNDING;
    let least = Position::from_counts(difference(position, reach));
    let greatest = Position::from_counts(sum(position, reach));
    if ticks < SECOND && limits.allow(least) && limits.allow(greatest) {
        return Ok(());
    }
    // T / 5 = ticks / 5000 of a second.
    let fifth = u64::from(ticks) * (TICK / 5);
    let mut control = [position; 6];
    let mut sum = 0i64;
    for (value, velocity) in control.iter_mut().skip(1).zip(velocity()) {
        sum = sum.saturating_add(scale(velocity, fifth));
        *value = position.saturating_add(round(sum, VELOCITY_BITS));
    }
    inside(control, limits, HALVINGS)
}

/// Whether the positions of a curve are inside the travel, looked at in up to 2^`halvings` parts.
fn inside(control: [i64; 6], limits: &Limits, halvings: u32) -> Result<(), Breach> {
    let (least, greatest) = least_and_greatest(&control);
    let allowed = |counts: i64| limits.allow(Position::from_counts(counts));
    if allowed(least) && allowed(greatest) {
        return Ok(());
    }
    if let Some(outside) = ends(&control).into_iter().find(|end| !allowed(*end)) {
        return Err(Breach::Travel(outside));
    }
    if halvings == 0 {
        return Err(Breach::Travel(if allowed(least) {
            greatest
        } else {
            least
        }));
    }
    let (control, next) = halve(control);
    inside(control, limits, halvings - 1)?;
    inside(next, limits, halvings - 1)
}

/// Raised limits of velocity and acceleration.
struct Rates {
    velocity: i64,
    acceleration: i64,
    deceleration: i64,
}

impl Rates {
    /// Whether both curves keep the limits, looked at in up to 2^`halvings` parts.
    fn keep<const V: usize, const A: usize>(
        &self,
        velocity: [i64; V],
        acceleration: [i64; A],
        halvings: u32,
    ) -> Result<(), Breach> {
        // What is rounded to a standstill has no direction.
        const STILL: i64 = 1 << (VELOCITY_BITS - 1);
        let (slowest, fastest) = least_and_greatest(&velocity);
        let (least, greatest) = least_and_greatest(&acceleration);
        let (down, up) = if slowest >= -STILL {
            (self.deceleration, self.acceleration)
        } else if fastest <= STILL {
            (self.acceleration, self.deceleration)
        } else {
            let lesser = self.acceleration.min(self.deceleration);
            (lesser, lesser)
        };
        let slow_enough = -self.velocity <= slowest && fastest <= self.velocity;
        if slow_enough && -down <= least && greatest <= up {
            return Ok(());
        }
        // The ends are on the curve: no halving brings them back.
        for end in ends(&velocity) {
            if end.abs() > self.velocity {
                return Err(Breach::Velocity(round(end, VELOCITY_BITS)));
            }
        }
        let strongest = self.acceleration.max(self.deceleration);
        for end in ends(&acceleration) {
            if end.abs() > strongest {
                return Err(Breach::Acceleration(round(end, ACCELERATION_BITS)));
            }
        }
        if halvings == 0 {
            return Err(if slow_enough {
                let value = if greatest > up { greatest } else { least };
                Breach::Acceleration(round(value, ACCELERATION_BITS))
            } else {
                let value = if fastest > self.velocity {
                    fastest
                } else {
                    slowest
                };
                Breach::Velocity(round(value, VELOCITY_BITS))
            });
        }
        let (velocity, next_velocity) = halve(velocity);
        let (acceleration, next_acceleration) = halve(acceleration);
        self.keep(velocity, acceleration, halvings - 1)?;
        self.keep(next_velocity, next_acceleration, halvings - 1)
    }
}

/// The two halves of a curve in Bernstein form, by de Casteljau's corner cutting.
fn halve<const N: usize>(mut control: [i64; N]) -> ([i64; N], [i64; N]) {
    let mut first = control;
    for (left, value) in (1..N).rev().zip(first.iter_mut()) {
        let mut corners = control.iter_mut().take(left + 1);
        let Some(mut corner) = corners.next() else {
            continue;
        };
        *value = *corner;
        for next in corners {
            *corner = (*corner + *next) >> 1;
            corner = next;
        }
    }
    // The last corner that was cut belongs to both.
    if let (Some(end), Some(middle)) = (first.last_mut(), control.first()) {
        *end = *middle;
    }
    (first, control)
}

fn least_and_greatest<const N: usize>(control: &[i64; N]) -> (i64, i64) {
    control
        .iter()
        .fold((i64::MAX, i64::MIN), |(least, greatest), value| {
            (least.min(*value), greatest.max(*value))
        })
}

fn ends<const N: usize>(control: &[i64; N]) -> [i64; 2] {
    let end = |value: Option<&i64>| value.copied().unwrap_or_default();
    [end(control.first()), end(control.last())]
}
