//! An upper and a lower link in the leg's plane: a thigh and its shank.
//!
//! In that plane x is forward and w down along the leg, and angles are counted from forward to
//! down. The law of cosines is solved by the triangle's area (Heron) and not by an arc cosine, which
//! loses half its digits where the chain is straight.

use super::error::LegError;
use super::varying::Varying;

/// What rounding may put a foot beyond the reach, in m.
const ROUNDING: f64 = 1e-12;

/// A joint of the body, an upper link, a knee, a lower link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Chain {
    /// What its first joint is called.
    pub joint: &'static str,
    /// In m.
    pub upper: f64,
    /// In m.
    pub lower: f64,
}

/// The triangle of the first joint, the knee and the foot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Triangle {
    /// The direction from the first joint to the foot.
    pub direction: Varying,
    /// The angle at the first joint between the foot and the knee, from 0.
    pub inner: Varying,
    /// The angle at the knee between both links: 0 is folded, a half turn is straight.
    pub knee: Varying,
}

impl Chain {
    /// The triangle with the foot at this place, as the first joint sees it.
    pub fn triangle(&self, x: Varying, w: Varying) -> Result<Triangle, LegError> {
        let Self {
            joint,
            upper,
            lower,
        } = *self;
        let distance = x.hypot(w);
        let reach = upper + lower;
        let least = (upper - lower).abs();
        if distance.value > reach + ROUNDING {
            return Err(LegError::TooFar {
                from: joint,
                distance: distance.value,
                reach,
            });
        }
        if distance.value < least - ROUNDING || distance.value == 0.0 {
            return Err(LegError::TooNear {
                to: joint,
                distance: distance.value,
                least,
            });
        }
        // Four times the area. Both angles are from the same area, so where rounding moves it, it
        // moves the foot along the leg and by as little.
        let outside = -((distance - reach) * (distance + reach));
        let inside = (distance - least) * (distance + least);
        let area = outside.at_least_zero() * inside.at_least_zero();
        let area = area.sqrt();
        let square = distance * distance;
        let difference = upper * upper - lower * lower;
        let sum = upper * upper + lower * lower;
        Ok(Triangle {
            direction: w.atan2(x),
            inner: area.atan2(square + difference),
            knee: area.atan2(-square + sum),
        })
    }
}

/// A point of the leg's plane: x and w.
pub(super) type Point = [Varying; 2];

/// The point that a link of this length and direction leads to.
pub(super) fn along(from: Point, length: f64, direction: Varying) -> Point {
    [
        from[0] + direction.cos() * length,
        from[1] + direction.sin() * length,
    ]
}
