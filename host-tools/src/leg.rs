//! Legs: from a foot to its joints and back, with rates and accelerations in closed form.
//!
//! A foot is seen from its hip: x forward, y to the left, z up, so a standing foot has a negative z.
//! Lengths are in m, angles in rad.
//!
//! | file | what it holds |
//! |---|---|
//! | `five_bar`, `serial` | the two kinds of leg, each in its own plane |
//! | `hip` | the abduction, which swings that plane |
//! | `chain` | an upper and a lower link |
//! | `varying` | a quantity with its derivatives |
//! | `error` | what a leg cannot do, and by how much |

mod chain;
mod error;
mod five_bar;
mod hip;
mod serial;
#[cfg(test)]
mod tests;
pub(crate) mod varying;

pub use error::LegError;
pub use five_bar::{FiveBar, FiveBarLengths};
pub use serial::{Serial, SerialLengths};

pub(crate) use error::in_range;
use std::f64::consts::FRAC_PI_2;
use varying::Varying;

/// Where a foot is, how it moves, and how that changes: m, m/s, m/s^2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FootMotion {
    /// In m.
    pub position: [f64; 3],
    /// In m/s.
    pub velocity: [f64; 3],
    /// In m/s^2.
    pub acceleration: [f64; 3],
}

/// Where the three joints of a leg are, and how they move: rad, rad/s, rad/s^2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointMotion {
    /// In rad.
    pub position: [f64; 3],
    /// In rad/s.
    pub velocity: [f64; 3],
    /// In rad/s^2.
    pub acceleration: [f64; 3],
}

/// From here a singular leg is refused: an angle from straight, or from folded, in rad.
///
/// The joints of a leg that is straight but for this turn a thousand times as fast as those of
/// one that is well bent.
pub const SINGULAR_ANGLE: f64 = 1e-3;

/// What a link may be long, in m.
const LINK_RANGE: [f64; 2] = [1e-3, 10.0];

/// How far a hip may be from the axis of abduction, in m.
const HIP_RANGE: [f64; 2] = [-10.0, 10.0];

/// How far from the hip a foot may be asked for along x, y or z, in m.
pub const FARTHEST_FOOT: f64 = 1e3;

/// How far a joint may be asked to turn, in rad.
pub const LARGEST_JOINT: f64 = 1e4;

/// Where a foot may be asked for, in m, and how fast, in m/s and m/s^2.
const FOOT_RANGES: [f64; 3] = [FARTHEST_FOOT, 1e6, 1e9];

/// Where a joint may be asked for, in rad, and how fast, in rad/s and rad/s^2.
const JOINT_RANGES: [f64; 3] = [LARGEST_JOINT, 1e6, 1e9];

/// A leg of three joints. Its joint angles are q1, q2 and q3.
///
/// | | q1 | q2 | q3 |
/// |---|---|---|---|
/// | five-bar | the front motor's upper link | the rear motor's upper link | abduction |
/// | serial | the thigh | between thigh and shank, a half turn where it is straight | abduction |
///
/// Links are at 0 where they point forward and at a quarter turn where they point down; the
/// abduction is 0 where the leg's plane is upright and positive where the foot is to the left of
/// that. The inverse solves for a foot below the hip, seen in the leg's plane. It follows the
/// published foot planner (FootTrajectoryPlanner) where a foot is in the plane, and is right beside it too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Leg {
    /// Two motors at the hip whose links meet at the foot, with the knees outward.
    FiveBar(FiveBar),
    /// A thigh and a shank, with the knee backward.
    Serial(Serial),
}

impl Leg {
    /// The five-bar leg of the published foot planner.
    pub fn published_five_bar() -> Self {
        Self::FiveBar(FiveBar::PUBLISHED)
    }

    /// The serial leg of the published foot planner.
    pub fn published_serial() -> Self {
        Self::Serial(Serial::PUBLISHED)
    }

    /// The joint angles, in rad, of a foot that is here, in m.
    ///
    /// # Errors
    /// A foot that the leg does not reach, or a number out of its range.
    pub fn joints(&self, foot: [f64; 3]) -> Result<[f64; 3], LegError> {
        let (joints, _) = self.inverse(&FootMotion {
            position: foot,
            ..FootMotion::default()
        })?;
        Ok(joints.map(|joint| joint.value))
    }

    /// Where the foot is, in m, with the joints at these angles, in rad.
    ///
    /// # Errors
    /// A five-bar whose lower links do not meet, or lie on each other; a number out of its range.
    pub fn foot(&self, joints: [f64; 3]) -> Result<[f64; 3], LegError> {
        let (foot, _) = self.forward(&JointMotion {
            position: joints,
            ..JointMotion::default()
        })?;
        Ok(foot.map(|place| place.value))
    }

    /// How the joints move where the foot moves like this.
    ///
    /// # Errors
    /// As [`Self::joints`], and a leg nearer than [`SINGULAR_ANGLE`] to singular.
    pub fn joint_motion(&self, foot: &FootMotion) -> Result<JointMotion, LegError> {
        let (joints, freedom) = self.inverse(foot)?;
        freedom.check()?;
        Ok(JointMotion {
            position: joints.map(|joint| joint.value),
            velocity: joints.map(|joint| joint.rate),
            acceleration: joints.map(|joint| joint.acceleration),
        })
    }

    /// How the foot moves where the joints move like this.
    ///
    /// # Errors
    /// As [`Self::foot`], and a five-bar whose lower links are nearer than [`SINGULAR_ANGLE`] to
    /// one line.
    pub fn foot_motion(&self, joints: &JointMotion) -> Result<FootMotion, LegError> {
        let (foot, freedom) = self.forward(joints)?;
        freedom.check()?;
        Ok(FootMotion {
            position: foot.map(|place| place.value),
            velocity: foot.map(|place| place.rate),
            acceleration: foot.map(|place| place.acceleration),
        })
    }

    /// The foot's velocity for each joint's rate: row x, y, z and column q1, q2, q3, in m/rad.
    ///
    /// # Errors
    /// As [`Self::foot_motion`].
    pub fn jacobian(&self, joints: [f64; 3]) -> Result<[[f64; 3]; 3], LegError> {
        let mut jacobian = [[0.0; 3]; 3];
        for column in 0..3 {
            let mut motion = JointMotion {
                position: joints,
                ..JointMotion::default()
            };
            motion.velocity[column] = 1.0;
            let foot = self.foot_motion(&motion)?;
            for (row, velocity) in jacobian.iter_mut().zip(foot.velocity) {
                row[column] = velocity;
            }
        }
        Ok(jacobian)
    }

    /// The places of the joints in their order along the leg, in m, for a stick figure.
    ///
    /// A serial leg: hip, knee, foot. A five-bar: front motor, front knee, foot, rear knee, rear
    /// motor.
    ///
    /// # Errors
    /// As [`Self::foot`].
    pub fn limb(&self, joints: [f64; 3]) -> Result<Vec<[f64; 3]>, LegError> {
        let [first, second, abduction] = checked_joints(&JointMotion {
            position: joints,
            ..JointMotion::default()
        })?;
        let points = match self {
            Self::FiveBar(leg) => leg.points([first, second])?.0.to_vec(),
            Self::Serial(leg) => leg.points([first, second]).to_vec(),
        };
        let places = points
            .into_iter()
            .map(|point| hip::unswing(self.hip(), point, abduction).map(|place| place.value));
        Ok(places.collect())
    }

    /// How far the leg's plane is to the left of the axis of abduction, in m.
    pub fn hip(&self) -> f64 {
        match self {
            Self::FiveBar(leg) => leg.lengths.hip,
            Self::Serial(leg) => leg.lengths.hip,
        }
    }

    fn inverse(&self, foot: &FootMotion) -> Result<([Varying; 3], Freedom), LegError> {
        let place = checked_foot(foot)?;
        let swung = hip::swing(self.hip(), place)?;
        let point = [swung.x, swung.w];
        let ([first, second], knee) = match self {
            Self::FiveBar(leg) => leg.angles(point)?,
            Self::Serial(leg) => leg.angles(point)?,
        };
        let freedom = Freedom {
            abduction: swung.freedom,
            knee,
            ..Freedom::FULL
        };
        Ok(([first, second, swung.abduction], freedom))
    }

    fn forward(&self, joints: &JointMotion) -> Result<([Varying; 3], Freedom), LegError> {
        let [first, second, abduction] = checked_joints(joints)?;
        let (foot, between) = match self {
            Self::FiveBar(leg) => {
                let (points, between) = leg.points([first, second])?;
                (points[2], between)
            }
            Self::Serial(leg) => (leg.points([first, second])[2], Freedom::FULL.between),
        };
        let freedom = Freedom {
            between,
            ..Freedom::FULL
        };
        Ok((hip::unswing(self.hip(), foot, abduction), freedom))
    }
}

/// How far from each singularity a leg is, in rad.
struct Freedom {
    abduction: f64,
    knee: f64,
    between: f64,
}

impl Freedom {
    const FULL: Self = Self {
        abduction: FRAC_PI_2,
        knee: FRAC_PI_2,
        between: FRAC_PI_2,
    };

    fn check(&self) -> Result<(), LegError> {
        let singular = |what, angle, cure| LegError::Singular {
            what,
            angle,
            least: SINGULAR_ANGLE,
            cure,
        };
        if self.knee < SINGULAR_ANGLE {
            let cure = "keep the foot away from the border of its reach";
            return Err(singular("a knee is straight or folded", self.knee, cure));
        }
        if self.abduction < SINGULAR_ANGLE {
            let what = "the foot is level with the hip in the leg's plane";
            return Err(singular(what, self.abduction, "move it down"));
        }
        if self.between < SINGULAR_ANGLE {
            return Err(five_bar::folded(self.between));
        }
        Ok(())
    }
}

/// Positions, velocities and accelerations whose every number is within its range.
fn checked(
    motion: [[f64; 3]; 3],
    names: [[&'static str; 3]; 3],
    ranges: [f64; 3],
    units: [&'static str; 3],
) -> Result<[Varying; 3], LegError> {
    for (order, values) in motion.iter().enumerate() {
        let range = [-ranges[order], ranges[order]];
        for (name, value) in names[order].into_iter().zip(values) {
            in_range(name, *value, range, units[order])?;
        }
    }
    let [position, velocity, acceleration] = motion;
    Ok([0, 1, 2]
        .map(|axis: usize| Varying::new(position[axis], velocity[axis], acceleration[axis])))
}

fn checked_foot(foot: &FootMotion) -> Result<[Varying; 3], LegError> {
    checked(
        [foot.position, foot.velocity, foot.acceleration],
        [
            ["x", "y", "z"],
            [
                "the velocity along x",
                "the velocity along y",
                "the velocity along z",
            ],
            [
                "the acceleration along x",
                "the acceleration along y",
                "the acceleration along z",
            ],
        ],
        FOOT_RANGES,
        ["m", "m/s", "m/s^2"],
    )
}

fn checked_joints(joints: &JointMotion) -> Result<[Varying; 3], LegError> {
    checked(
        [joints.position, joints.velocity, joints.acceleration],
        [
            ["q1", "q2", "q3"],
            ["the rate of q1", "the rate of q2", "the rate of q3"],
            [
                "the acceleration of q1",
                "the acceleration of q2",
                "the acceleration of q3",
            ],
        ],
        JOINT_RANGES,
        ["rad", "rad/s", "rad/s^2"],
    )
}
