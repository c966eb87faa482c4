//! Where the legs are, and which axes move them.

use super::error::GaitError;
use super::pattern::{LEG_NAMES, LEGS};
use crate::leg::varying::Varying;
use crate::leg::{FootMotion, JointMotion, LegError};
use crate::robot::{Robot, RobotLeg};
use canter_shared::limits::Limits;

/// One leg on the body.
#[derive(Debug, Clone, PartialEq)]
pub struct Mount {
    /// The leg, its place and its axes.
    pub leg: RobotLeg,
    /// What its axes may do, in the order of its joints.
    pub limits: [Limits; 3],
}

impl Mount {
    /// Where the foot is when nobody goes anywhere: below its leg's plane upright, forward and to the
    /// left, in m.
    pub fn neutral(&self) -> [f64; 2] {
        let [forward, left, _] = self.leg.place;
        [forward, left]
    }

    /// How the axes move where the foot, seen from the hip, moves like this.
    ///
    /// # Errors
    /// What the leg does not reach.
    pub fn axis_motion(&self, foot: &FootMotion) -> Result<JointMotion, LegError> {
        let joints = self.leg.kinematics.joint_motion(foot)?;
        Ok(JointMotion {
            position: self.leg.axis_positions(joints.position),
            velocity: self.leg.axis_rates(joints.velocity),
            acceleration: self.leg.axis_rates(joints.acceleration),
        })
    }

    /// The places of the leg's joints on the body, in m, for a stick figure.
    ///
    /// # Errors
    /// What the leg cannot do.
    pub fn limb(&self, axes: [f64; 3]) -> Result<Vec<[f64; 3]>, LegError> {
        let mut places = self.leg.kinematics.limb(self.leg.joints(axes))?;
        for place in &mut places {
            for (value, hip) in place.iter_mut().zip(self.leg.place) {
                *value += hip;
            }
        }
        Ok(places)
    }

    /// A foot on the body, seen from the hip.
    pub(super) fn seen(&self, foot: [Varying; 3]) -> FootMotion {
        let mut motion = FootMotion::default();
        for (index, (value, hip)) in foot.iter().zip(self.leg.place).enumerate() {
            motion.position[index] = value.value - hip;
            motion.velocity[index] = value.rate;
            motion.acceleration[index] = value.acceleration;
        }
        motion
    }
}

/// A body on four legs: front left, front right, rear left, rear right.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadruped {
    /// The legs.
    pub mounts: [Mount; LEGS],
}

impl Quadruped {
    /// The hips above the ground where nobody says otherwise, in m: the assumed robot's knees are
    /// well bent there.
    pub const HEIGHT: f64 = 0.3;

    /// The legs of a robot, each known by where its hip is.
    ///
    /// # Errors
    /// A robot that has not one leg in each of the four corners.
    pub fn of(robot: &Robot) -> Result<Self, GaitError> {
        let mount = |corner: usize| {
            let (is_front, is_left) = (corner < 2, corner.is_multiple_of(2));
            let is_there = |leg: &&RobotLeg| {
                let [forward, left, _] = leg.place;
                let is_ahead = if is_front {
                    forward > 0.0
                } else {
                    forward < 0.0
                };
                let is_beside = if is_left { left > 0.0 } else { left < 0.0 };
                is_ahead && is_beside
            };
            let mut there = robot.legs().iter().filter(is_there);
            let (Some(leg), None) = (there.next(), there.next()) else {
                return Err(GaitError::Legs {
                    corner: LEG_NAMES[corner],
                    legs: robot.legs().iter().filter(is_there).count(),
                });
            };
            let limits = |id| {
                let axis = robot.axes().iter().find(|axis| axis.id == id);
                axis.map(|axis| axis.limits())
                    .ok_or(GaitError::Axis { axis: id.get() })
            };
            let [first, second, third] = leg.axes.map(limits);
            Ok(Mount {
                leg: leg.clone(),
                limits: [first?, second?, third?],
            })
        };
        Ok(Self {
            mounts: [mount(0)?, mount(1)?, mount(2)?, mount(3)?],
        })
    }
}
