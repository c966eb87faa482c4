//! Where the legs are, and which axes move them.

use super::error::GaitError;
use super::pattern::LEGS;
use crate::leg::varying::Varying;
use crate::leg::{FootMotion, JointMotion, Leg, LegError};
use crate::robot::Robot;
use canter_shared::limits::Limits;

/// Half the way from a front hip to a rear hip, and from a left hip to a right hip, in m.
const HIP: [f64; 2] = [0.19, 0.05];

/// One leg on the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mount {
    /// The leg, as a left one.
    pub leg: Leg,
    /// Where its hip is in the body, in m: forward, to the left, up.
    pub hip: [f64; 3],
    /// Whether it is a left leg mirrored; its joints turn as those of the left one do.
    pub mirrored: bool,
    /// Which axes move it, in the order of its joints.
    pub axes: [u8; 3],
    /// What they may do.
    pub limits: [Limits; 3],
}

impl Mount {
    /// Where the foot is below the body when nobody goes anywhere: forward and to the left, in m.
    pub fn neutral(&self) -> [f64; 2] {
        [self.hip[0], self.hip[1] + self.side() * self.leg.hip()]
    }

    /// How the joints move where the foot, seen from the hip, moves like this.
    ///
    /// # Errors
    /// What the leg does not reach.
    pub fn joint_motion(&self, foot: &FootMotion) -> Result<JointMotion, LegError> {
        let mut foot = *foot;
        for vector in [
            &mut foot.position,
            &mut foot.velocity,
            &mut foot.acceleration,
        ] {
            vector[1] *= self.side();
        }
        self.leg.joint_motion(&foot)
    }

    /// The joints' places on the body, in m, for a stick figure.
    ///
    /// # Errors
    /// What the leg cannot do.
    pub fn limb(&self, joints: [f64; 3]) -> Result<Vec<[f64; 3]>, LegError> {
        let mut places = self.leg.limb(joints)?;
        for place in &mut places {
            place[1] *= self.side();
            for (value, hip) in place.iter_mut().zip(self.hip) {
                *value += hip;
            }
        }
        Ok(places)
    }

    fn side(&self) -> f64 {
        if self.mirrored { -1.0 } else { 1.0 }
    }

    /// A foot on the body, seen from the hip.
    pub(super) fn seen(&self, foot: [Varying; 3]) -> FootMotion {
        let mut motion = FootMotion::default();
        for (index, (value, hip)) in foot.iter().zip(self.hip).enumerate() {
            motion.position[index] = value.value - hip;
            motion.velocity[index] = value.rate;
            motion.acceleration[index] = value.acceleration;
        }
        motion
    }
}

/// A body on four legs: front left, front right, rear left, rear right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quadruped {
    /// The legs.
    pub mounts: [Mount; LEGS],
}

impl Quadruped {
    /// The hips above the ground where nobody says otherwise, in m.
    pub const HEIGHT: f64 = 0.2;

    /// The robot's first twelve axes as four published serial legs, three after three; the hips are
    /// 380 mm apart along the body and 100 mm across it.
    ///
    /// # Errors
    /// A robot of other than twelve axes.
    pub fn of(robot: &Robot) -> Result<Self, GaitError> {
        let axes = robot.axes();
        let wrong = || GaitError::Axes { axes: axes.len() };
        let [a, b, c, d, e, f, g, h, i, j, k, l] = axes else {
            return Err(wrong());
        };
        let mount = |index: usize, axes: [&crate::robot::RobotAxis; 3]| {
            let ahead = if index < 2 { HIP[0] } else { -HIP[0] };
            let mirrored = index % 2 == 1;
            Mount {
                leg: Leg::published_serial(),
                hip: [ahead, if mirrored { -HIP[1] } else { HIP[1] }, 0.0],
                mirrored,
                axes: axes.map(|axis| axis.id.get()),
                limits: axes.map(|axis| axis.limits()),
            }
        };
        Ok(Self {
            mounts: [
                mount(0, [a, b, c]),
                mount(1, [d, e, f]),
                mount(2, [g, h, i]),
                mount(3, [j, k, l]),
            ],
        })
    }
}
