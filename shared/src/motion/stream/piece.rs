//! One Hermite piece between two knots, in integers: its polynomials, and their values.

use super::setpoint;
use super::shape::{ACCELERATION_BITS, Divisor, FIFTH, Shape, TICK, VELOCITY_BITS, round};
use super::stretch::Place;
use crate::motion::Setpoint;
use crate::motion::fixed::scale;

/// A quintic, or a cubic written as one, over a whole number of ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Piece {
    from: i64,
    /// Coefficients of u to u^5 of the position over the duration: counts/s, raised by
    /// [`VELOCITY_BITS`].
    rate: [i64; 5],
    /// Coefficients of 1 to u^3: counts/s^2, raised by [`ACCELERATION_BITS`].
    acceleration: [i64; 4],
    /// The duration in ticks; its part is one tick of it.
    ticks: Divisor,
}

impl Piece {
    /// Makes the piece from one knot to the next, `ticks` later: quintic where both know their
    /// acceleration, cubic otherwise. There is none where [`super::check`] refuses it. A divisor that is
    /// known may be the one for `ticks`.
    pub(super) fn make<const QUINTIC: bool>(
        made: &mut Option<Self>,
        from: &Place,
        to: &Place,
        ticks: u16,
        known: &Divisor,
    ) {
        let ticks = known.or_new(ticks);
        let Ok(shape) = Shape::between::<QUINTIC>(from, to, &ticks) else {
            *made = None;
            return;
        };
        let [v0, v1, v2, v3, v4] = shape.velocity;
        let [a0, a1, a2, a3] = shape.acceleration;
        // Forward differences times binomial coefficients, integrated: 4 / 2, 6 / 3, 4 / 4, 1 / 5.
        let fourth = v4 - 4 * v3 + 6 * v2 - 4 * v1 + v0;
        *made = Some(Self {
            from: from.position,
            rate: [
                v0,
                2 * (v1 - v0),
                2 * (v2 - 2 * v1 + v0),
                v3 - 3 * v2 + 3 * v1 - v0,
                FIFTH.divide(fourth),
            ],
            acceleration: [
                a0,
                3 * (a1 - a0),
                3 * (a2 - 2 * a1 + a0),
                a3 - 3 * a2 + 3 * a1 - a0,
            ],
            ticks,
        });
    }

    /// How long the piece lasts.
    pub(super) fn ticks(&self) -> u32 {
        self.ticks.get()
    }

    /// The setpoint `elapsed` ticks after the piece's start; the next piece begins before `elapsed`
    /// reaches its duration.
    #[inline(never)] // A copy for each way to come by a piece would be a kilobyte of flash.
    pub(super) fn at(&self, elapsed: u32) -> Setpoint {
        let u = u64::from(elapsed) * self.ticks.part();
        let [r1, r2, r3, r4, r5] = self.rate;
        let mean = scale(
            r1 + scale(r2 + scale(r3 + scale(r4 + scale(r5, u), u), u), u),
            u,
        );
        let offset = scale(mean * i64::from(self.ticks.get()), TICK);
        let third = 3 * r3 + scale(4 * r4 + scale(5 * r5, u), u);
        let velocity = r1 + scale(2 * r2 + scale(third, u), u);
        let [a0, a1, a2, a3] = self.acceleration;
        let acceleration = a0 + scale(a1 + scale(a2 + scale(a3, u), u), u);
        setpoint(
            self.from.saturating_add(round(offset, VELOCITY_BITS)),
            round(velocity, VELOCITY_BITS),
            round(acceleration, ACCELERATION_BITS),
        )
    }
}
