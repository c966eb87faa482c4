//! One Hermite piece between two knots, in integers: its Bernstein form, its limits, its values.
//!
//! A polynomial in Bernstein form stays between the least and the greatest of its control values
//! (the convex hull property; Farin, Curves and Surfaces for CAGD). So the limits are held against
//! control values. Where those say too much, de Casteljau's halving brings them closer to the curve
//! by four each time.

use super::{Breach, LONGEST_PIECE, Place};
use crate::limits::Limits;
use crate::motion::fixed::{ALMOST_ONE, scale};
use crate::time::TICKS_PER_SECOND;
use crate::units::Position;

/// Bits behind the point of a velocity. Over a curve of degree four that stays below 2^43 counts/s,
/// as every velocity limit does, control values stay below 12 * 2^43 and the polynomial's
/// coefficients below 256 * 2^43 = 2^51: 8 bits more are 2^59.
const VELOCITY_BITS: u32 = 8;

/// Bits behind the point of an acceleration: of degree three and below 2^50 counts/s^2, the
/// coefficients stay below 48 * 2^50, and 6 bits more are below 2^62.
const ACCELERATION_BITS: u32 = 6;

// The way of a whole piece, raised, fits: 2^43 counts/s over 2.04 s.
const _: () = assert!((LONGEST_PIECE as i64) < i64::MAX >> (43 + VELOCITY_BITS));

/// What one tick is of a second, as a Q64 fraction.
const TICK: u64 = ALMOST_ONE / TICKS_PER_SECOND;

/// Counts that a position may be off by rounding.
const ROUNDING: i64 = 8;

/// A second in ticks; what is shorter is a fraction.
const SECOND: u16 = TICKS_PER_SECOND as u16;

/// How often a curve is halved before a limit counts as broken: its control values are then off by
/// less than 1/256 of what they first were.
const HALVINGS: u32 = 4;

/// A quintic, or a cubic written as one, over a whole number of ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Piece {
    from: i64,
    /// Coefficients of u to u^5 of the position over the duration: counts/s, raised by
    /// [`VELOCITY_BITS`].
    rate: [i64; 5],
    /// Coefficients of 1 to u^3: counts/s^2, raised by [`ACCELERATION_BITS`].
    acceleration: [i64; 4],
    /// One tick as a fraction of the duration.
    step: u64,
    ticks: u16,
}

/// A piece's derivatives in Bernstein form, raised.
struct Shape {
    velocity: [i64; 5],
    acceleration: [i64; 4],
}

impl Piece {
    /// The piece from one knot to the next, `ticks` later: quintic where both know their
    /// acceleration, cubic otherwise. At most [`LONGEST_PIECE`] ticks.
    pub(super) fn between(
        from: &Place,
        to: &Place,
        ticks: u16,
        limits: &Limits,
    ) -> Result<Self, Breach> {
        let shape = Shape::between(from, to, ticks.max(1), limits)?;
        let [v0, v1, v2, v3, v4] = shape.velocity;
        // Forward differences times binomial coefficients, integrated: 4 / 2, 6 / 3, 4 / 4, 1 / 5.
        let fourth = v4 - 4 * v3 + 6 * v2 - 4 * v1 + v0;
        let rate = [
            v0,
            2 * (v1 - v0),
            2 * (v2 - 2 * v1 + v0),
            v3 - 3 * v2 + 3 * v1 - v0,
            fourth / 5,
        ];
        let [a0, a1, a2, a3] = shape.acceleration;
        let acceleration = [
            a0,
            3 * (a1 - a0),
            3 * (a2 - 2 * a1 + a0),
            a3 - 3 * a2 + 3 * a1 - a0,
        ];
        Ok(Self {
            from: from.position,
            rate,
            acceleration,
            step: divide_unsigned(ALMOST_ONE, ticks.max(1)),
            ticks,
        })
    }

    /// How long the piece lasts.
    pub(super) fn ticks(&self) -> u16 {
        self.ticks
    }

    /// Position, velocity and acceleration `elapsed` ticks after the piece's start; the next piece
    /// begins before `elapsed` reaches its duration.
    #[inline]
    pub(super) fn at(&self, elapsed: u32) -> (i64, i64, i64) {
        let u = u64::from(elapsed) * self.step;
        let [r1, r2, r3, r4, r5] = self.rate;
        let mean = scale(
            r1 + scale(r2 + scale(r3 + scale(r4 + scale(r5, u), u), u), u),
            u,
        );
        let offset = scale(mean * i64::from(self.ticks), TICK);
        let third = 3 * r3 + scale(4 * r4 + scale(5 * r5, u), u);
        let velocity = r1 + scale(2 * r2 + scale(third, u), u);
        let [a0, a1, a2, a3] = self.acceleration;
        let acceleration = a0 + scale(a1 + scale(a2 + scale(a3, u), u), u);
        (
            self.from.saturating_add(round(offset, VELOCITY_BITS)),
            round(velocity, VELOCITY_BITS),
            round(acceleration, ACCELERATION_BITS),
        )
    }

    /// The acceleration that the piece ends with.
    pub(super) fn exit_acceleration(&self) -> i64 {
        round(self.acceleration.iter().sum(), ACCELERATION_BITS)
    }
}

impl Shape {
    fn between(from: &Place, to: &Place, ticks: u16, limits: &Limits) -> Result<Self, Breach> {
        let rate = TICKS_PER_SECOND as i64;
        let fastest = limits.velocity().counts();
        let difference = to.position.saturating_sub(from.position);
        let thousandfold = difference.saturating_mul(rate);
        for velocity in [from.velocity, to.velocity] {
            if velocity.saturating_abs() > fastest {
                return Err(Breach::Velocity(velocity));
            }
        }
        if thousandfold.saturating_abs() > fastest * i64::from(ticks) {
            return Err(Breach::Velocity(divide(thousandfold, ticks)));
        }
        let speeding_up = limits.acceleration().counts();
        let strongest = speeding_up.max(limits.deceleration().counts());
        for end in [from, to] {
            let acceleration = end.acceleration.unwrap_or_default();
            // Whoever stands cannot slow down.
            let limit = if end.velocity == 0 {
                speeding_up
            } else {
                strongest
            };
            if acceleration.saturating_abs() > limit {
                return Err(Breach::Acceleration(acceleration));
            }
        }
        // The mean is below 2^43 counts/s, and so the thousandfold below 2^43 * 2040 < 2^54.
        let mean = divide(thousandfold << VELOCITY_BITS, ticks);
        let v0 = from.velocity << VELOCITY_BITS;
        let v4 = to.velocity << VELOCITY_BITS;
        let rates = Rates {
            velocity: fastest << VELOCITY_BITS,
            acceleration: limits.acceleration().counts() << ACCELERATION_BITS,
            deceleration: limits.deceleration().counts() << ACCELERATION_BITS,
        };
        let shape = match (from.acceleration, to.acceleration) {
            (Some(first), Some(last)) => {
                // a T / 4 with T = ticks / 1000: a * ticks is below 2^61.
                let quarter = |acceleration: i64| {
                    let raised = TICK << (VELOCITY_BITS - 2);
                    scale(acceleration * i64::from(ticks), raised)
                };
                let v1 = v0 + quarter(first);
                let v3 = v4 - quarter(last);
                // The mean of the control values is that of the velocity.
                let velocity = [v0, v1, 5 * mean - v0 - v1 - v3 - v4, v3, v4];
                let [_, v1, v2, v3, _] = velocity;
                let acceleration = [
                    first << ACCELERATION_BITS,
                    per_second(v2 - v1, 4, ticks)?,
                    per_second(v3 - v2, 4, ticks)?,
                    last << ACCELERATION_BITS,
                ];
                rates.keep(velocity, acceleration, HALVINGS)?;
                Self {
                    velocity,
                    acceleration,
                }
            }
            _ => {
                // The quadratic v0, middle, v4, raised to degree four.
                let middle = 3 * mean - v0 - v4;
                let first = per_second(middle - v0, 2, ticks)?;
                let last = per_second(v4 - middle, 2, ticks)?;
                rates.keep([v0, middle, v4], [first, last], HALVINGS)?;
                Self {
                    velocity: [
                        v0,
                        (v0 + middle) / 2,
                        (v0 + 4 * middle + v4) / 6,
                        (middle + v4) / 2,
                        v4,
                    ],
                    acceleration: [
                        first,
                        first - (first - last) / 3,
                        last + (first - last) / 3,
                        last,
                    ],
                }
            }
        };
        shape.stays(from.position, ticks, limits)?;
        Ok(shape)
    }

    /// Whether the piece from `position` stays inside the travel.
    fn stays(&self, position: i64, ticks: u16, limits: &Limits) -> Result<(), Breach> {
        // Mostly the ends of the travel are too far away to be reached in this time.
        let whole = u64::from(ticks).wrapping_mul(TICK);
        let reach = scale(limits.velocity().counts(), whole) + ROUNDING;
        let least = Position::from_counts(position.saturating_sub(reach));
        let greatest = Position::from_counts(position.saturating_add(reach));
        if ticks < SECOND && limits.allow(least) && limits.allow(greatest) {
            return Ok(());
        }
        // T / 5 = ticks / 5000 of a second.
        let fifth = u64::from(ticks) * (TICK / 5);
        let mut control = [position; 6];
        let mut sum = 0i64;
        for (value, velocity) in control.iter_mut().skip(1).zip(self.velocity) {
            sum = sum.saturating_add(scale(velocity, fifth));
            *value = position.saturating_add(round(sum, VELOCITY_BITS));
        }
        inside(control, limits, HALVINGS)
    }
}

/// `factor` times a raised difference of velocities over `ticks`, as a raised acceleration.
#[inline(always)]
fn per_second(difference: i64, factor: i64, ticks: u16) -> Result<i64, Breach> {
    const RATE: i64 = TICKS_PER_SECOND as i64 >> (VELOCITY_BITS - ACCELERATION_BITS);
    let product = difference.checked_mul(factor * RATE);
    let beyond = Breach::Acceleration(if difference < 0 { i64::MIN } else { i64::MAX });
    let value = divide(product.ok_or(beyond)?, ticks);
    // No limit is above 2^50, and a curve of degree three below that has no control value above
    // 5 * 2^50; beyond this the sums of the halving might not fit.
    let fits = value.saturating_abs() < 1 << (53 + ACCELERATION_BITS);
    fits.then_some(value).ok_or(beyond)
}

/// `value / ticks`, towards zero.
#[inline(always)]
fn divide(value: i64, ticks: u16) -> i64 {
    let quotient = divide_unsigned(value.unsigned_abs(), ticks) as i64;
    if value < 0 {
        quotient.wrapping_neg()
    } else {
        quotient
    }
}

/// `value / ticks`, for a number of ticks that is not 0: in four digits of 16 bits, since the device
/// has an instruction for those, and none for 64 bits.
fn divide_unsigned(value: u64, ticks: u16) -> u64 {
    let ticks = u32::from(ticks.max(1));
    let (mut quotient, mut rest) = (0, 0);
    for digit in [48, 32, 16, 0] {
        // The rest is below 2^16.
        let part = rest << 16 | (value >> digit) as u32 & 0xFFFF;
        quotient = quotient << 16 | u64::from(part / ticks);
        rest = part % ticks;
    }
    quotient
}

/// The nearest integer to a raised value; a half goes up.
const fn round(raised: i64, bits: u32) -> i64 {
    (raised + (1 << (bits - 1))) >> bits
}

/// The two halves of a curve in Bernstein form, by de Casteljau's corner cutting.
fn halve<const N: usize>(mut control: [i64; N]) -> ([i64; N], [i64; N]) {
    let mut first = control;
    for (left, value) in (1..N).rev().zip(first.iter_mut()) {
        *value = control.first().copied().unwrap_or_default();
        let next = control;
        for (cut, after) in control.iter_mut().take(left).zip(next.iter().skip(1)) {
            *cut = (*cut + *after) >> 1;
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn digits_divide_as_whole_numbers_do(value: i64, shift in 0u32..64, ticks in 1u16..) {
            let value = value >> shift;
            prop_assert_eq!(divide(value, ticks), value / i64::from(ticks));
            let whole = value as u64;
            prop_assert_eq!(divide_unsigned(whole, ticks), whole / u64::from(ticks));
        }
    }
}
