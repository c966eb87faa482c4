//! A leg of a hip, a thigh and a shank, with a motor in each joint.

use super::chain::{Chain, Point, along};
use super::error::{LegError, in_range};
use super::varying::Varying;
use super::{HIP_RANGE, LINK_RANGE};
use std::f64::consts::PI;

/// The lengths of a serial leg, in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SerialLengths {
    /// From the axis of abduction to the leg's plane, to the left: negative on a right leg.
    pub hip: f64,
    /// The thigh.
    pub upper: f64,
    /// The shank.
    pub lower: f64,
}

/// A leg whose knee bends backward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Serial {
    pub(super) lengths: SerialLengths,
}

impl Serial {
    /// The leg of the published foot planner: hip 60 mm, thigh 120 mm, shank 150 mm.
    pub const PUBLISHED: Self = Self {
        lengths: SerialLengths {
            hip: 0.06,
            upper: 0.12,
            lower: 0.15,
        },
    };

    /// A leg of these lengths.
    ///
    /// # Errors
    /// A link shorter than 1 mm or longer than 10 m, a hip beyond 10 m.
    pub fn new(lengths: SerialLengths) -> Result<Self, LegError> {
        in_range("hip", lengths.hip, HIP_RANGE, "m")?;
        in_range("upper", lengths.upper, LINK_RANGE, "m")?;
        in_range("lower", lengths.lower, LINK_RANGE, "m")?;
        Ok(Self { lengths })
    }

    /// Its lengths.
    pub fn lengths(&self) -> SerialLengths {
        self.lengths
    }

    fn chain(&self) -> Chain {
        Chain {
            joint: "hip",
            upper: self.lengths.upper,
            lower: self.lengths.lower,
        }
    }

    /// The thigh's direction and the knee's angle, and how far from straight or folded it is.
    pub(super) fn angles(&self, [x, w]: Point) -> Result<([Varying; 2], f64), LegError> {
        let triangle = self.chain().triangle(x, w)?;
        let knee = triangle.knee;
        Ok((
            [triangle.direction + triangle.inner, knee],
            knee.value.min(PI - knee.value),
        ))
    }

    /// The hip, the knee and the foot.
    pub(super) fn points(&self, [thigh, knee]: [Varying; 2]) -> [Point; 3] {
        let hip = [Varying::constant(0.0); 2];
        let knee_point = along(hip, self.lengths.upper, thigh);
        let shank = thigh + knee - PI;
        [
            hip,
            knee_point,
            along(knee_point, self.lengths.lower, shank),
        ]
    }
}
