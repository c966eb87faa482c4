//! A leg of two motors at the hip, whose links meet at the foot.

use super::chain::{Chain, Point, along};
use super::error::{LegError, in_range};
use super::varying::Varying;
use super::{HIP_RANGE, LINK_RANGE, SINGULAR_ANGLE};
use std::f64::consts::PI;

/// The lengths of a five-bar leg, in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FiveBarLengths {
    /// From the middle of the hip to each motor, forward and backward.
    pub motor_offset: f64,
    /// From the axis of abduction to the leg's plane, to the left: negative on a right leg.
    pub hip: f64,
    /// Both upper links.
    pub upper: f64,
    /// Both lower links.
    pub lower: f64,
}

/// A leg whose front knee bends forward and whose rear knee bends backward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FiveBar {
    pub(super) lengths: FiveBarLengths,
}

impl FiveBar {
    /// The leg of the published foot planner: motors 31 mm from the middle, hip 60 mm, upper links
    /// 100 mm, lower links 160 mm.
    pub const PUBLISHED: Self = Self {
        lengths: FiveBarLengths {
            motor_offset: 0.031,
            hip: 0.06,
            upper: 0.1,
            lower: 0.16,
        },
    };

    /// A leg of these lengths.
    ///
    /// # Errors
    /// A link shorter than 1 mm or longer than 10 m, a hip beyond 10 m, a motor's offset below
    /// zero or beyond 10 m.
    pub fn new(lengths: FiveBarLengths) -> Result<Self, LegError> {
        let offsets = [0.0, HIP_RANGE[1]];
        in_range("motor_offset", lengths.motor_offset, offsets, "m")?;
        in_range("hip", lengths.hip, HIP_RANGE, "m")?;
        in_range("upper", lengths.upper, LINK_RANGE, "m")?;
        in_range("lower", lengths.lower, LINK_RANGE, "m")?;
        Ok(Self { lengths })
    }

    /// Its lengths.
    pub fn lengths(&self) -> FiveBarLengths {
        self.lengths
    }

    fn chain(&self, joint: &'static str) -> Chain {
        Chain {
            joint,
            upper: self.lengths.upper,
            lower: self.lengths.lower,
        }
    }

    /// Both motors' angles, and how far from straight or folded the nearer knee is.
    pub(super) fn angles(&self, [x, w]: Point) -> Result<([Varying; 2], f64), LegError> {
        let offset = self.lengths.motor_offset;
        let front = self.chain("front motor").triangle(x - offset, w);
        let rear = self.chain("rear motor").triangle(x + offset, w);
        // Of two that are out of reach the worse one: its cure is enough.
        let (front, rear) = match (front, rear) {
            (Err(front), Err(rear)) if rear.missed_by() > front.missed_by() => return Err(rear),
            (front, rear) => (front?, rear?),
        };
        let angles = [front.direction - front.inner, rear.direction + rear.inner];
        // Otherwise the motors would hold the foot on the other side of its knees.
        let between = self.between(self.knees(angles), [x, w]);
        if between <= 0.0 {
            return Err(LegError::KneesCrossed { angle: -between });
        }
        let knees = [front.knee.value, rear.knee.value];
        let bend = knees.map(|knee| knee.min(PI - knee));
        Ok((angles, bend[0].min(bend[1])))
    }

    /// The motors, front and rear.
    fn motors(&self) -> [Point; 2] {
        let offset = self.lengths.motor_offset;
        [offset, -offset].map(|x| [Varying::constant(x), Varying::constant(0.0)])
    }

    fn knees(&self, [front, rear]: [Varying; 2]) -> [Point; 2] {
        let motors = self.motors();
        [
            along(motors[0], self.lengths.upper, front),
            along(motors[1], self.lengths.upper, rear),
        ]
    }

    /// The angle at the foot between the lower links: positive where the front knee is in front.
    fn between(&self, [front, rear]: [Point; 2], foot: Point) -> f64 {
        let seen = |knee: Point| [0, 1].map(|index: usize| knee[index].value - foot[index].value);
        let ([front_x, front_w], [rear_x, rear_w]) = (seen(front), seen(rear));
        let sine = rear_x * front_w - rear_w * front_x;
        let cosine = rear_x * front_x + rear_w * front_w;
        sine.atan2(cosine)
    }

    /// The front motor, the front knee, the foot, the rear knee, the rear motor; and the angle
    /// between the lower links, from folded or straight.
    pub(super) fn points(&self, angles: [Varying; 2]) -> Result<([Point; 5], f64), LegError> {
        let motors = self.motors();
        let [front, rear] = self.knees(angles);
        let lower = self.lengths.lower;
        let [x, w] = [front[0] - rear[0], front[1] - rear[1]];
        let distance = x.hypot(w);
        let reach = 2.0 * lower;
        if distance.value > reach {
            return Err(LegError::KneesApart {
                distance: distance.value,
                reach,
            });
        }
        if distance.value == 0.0 {
            return Err(folded(0.0));
        }
        // Half the distance of the knees, and from the middle down to the foot.
        let half = distance * 0.5;
        let height = ((-half + lower) * (half + lower)).sqrt();
        let scale = height * distance.reciprocal();
        let foot = [
            (front[0] + rear[0]) * 0.5 - w * scale,
            (front[1] + rear[1]) * 0.5 + x * scale,
        ];
        let between = self.between([front, rear], foot);
        let points = [motors[0], front, foot, rear, motors[1]];
        Ok((points, between.min(PI - between)))
    }
}

/// The lower links lie on each other, or in one line: the motors do not hold the foot.
pub(super) fn folded(angle: f64) -> LegError {
    LegError::Singular {
        what: "the lower links are in one line",
        angle,
        least: SINGULAR_ANGLE,
        cure: "turn the motors so that the knees are apart, but by less than both links",
    }
}
