//! The legs of a robot file: their geometry, where they hang, and which axes move them.
//!
//! ```toml
//! [[leg]]
//! name = "front-left"
//! kind = "serial"            # or five-bar, which has a motor_offset too
//! hip = 0.06                 # m; to the left of the axis of abduction, so negative on a right leg
//! upper = 0.12               # m
//! lower = 0.15               # m
//! axes = [1, 2, 3]           # of q1, q2, q3
//! signs = [1, 1, 1]          # 1 or -1; 1 where it is left out
//! offsets = [-1.57, -3.14, 0.0]   # rad; 0 where it is left out
//! place = [0.19, 0.11, 0.0]  # m; the hip in the body: forward, left, up
//! ```

use super::Robot;
use crate::leg::{FiveBar, FiveBarLengths, Leg, LegError, Serial, SerialLengths, in_range};
use canter_shared::wire::id::AxisId;
use serde::Deserialize;
use std::f64::consts::{FRAC_PI_2, PI};

/// What an offset may be, in rad.
const OFFSET_RANGE: [f64; 2] = [-1e3, 1e3];

/// Where a hip may be in the body, in m.
const PLACE_RANGE: [f64; 2] = [-10.0, 10.0];

/// The legs of the robot that is assumed, in m.
const ASSUMED: SerialLengths = SerialLengths {
    hip: 0.06,
    upper: 0.2,
    lower: 0.2,
};

/// A leg of a robot: what it is, where it is, and what moves it.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotLeg {
    /// What it is called, such as front-left.
    pub name: String,
    /// Its geometry.
    pub kinematics: Leg,
    /// The axes of q1, q2 and q3.
    pub axes: [AxisId; 3],
    /// 1, or -1 where the axis turns against the joint.
    pub signs: [f64; 3],
    /// The axis's position where the joint is at 0, in rad.
    pub offsets: [f64; 3],
    /// The hip in the body, from where the foot is counted: forward, left, up, in m.
    pub place: [f64; 3],
}

impl RobotLeg {
    /// Where the axes are, in rad, with the joints at these angles: sign * joint + offset.
    pub fn axis_positions(&self, joints: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|joint: usize| self.signs[joint] * joints[joint] + self.offsets[joint])
    }

    /// How the axes turn where the joints turn like this: rates, or accelerations.
    pub fn axis_rates(&self, joints: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|joint: usize| self.signs[joint] * joints[joint])
    }

    /// The joint angles with the axes at these positions, in rad.
    pub fn joints(&self, positions: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|joint: usize| self.signs[joint] * (positions[joint] - self.offsets[joint]))
    }
}

impl Robot {
    /// The same legs, moved by the axes of another robot, such as one that was read from its nodes.
    #[must_use]
    pub fn with_axes_of(&self, other: &Self) -> Self {
        Self {
            axes: other.axes.clone(),
            legs: self.legs.clone(),
        }
    }
}

/// What is wrong with a leg of a robot file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RobotLegError {
    /// A length, an offset or a place is no number or out of its range.
    #[error(transparent)]
    Value(#[from] LegError),
    /// It has no name, or one that stands for something else.
    #[error(
        "name = \"{0}\": it must be a word of letters, digits, - and _ that no other leg has, and not five-bar or serial"
    )]
    Name(String),
    /// A five-bar needs to know where its motors are.
    #[error("motor_offset is missing: a five-bar leg needs it, from 0 to 10 m")]
    NoMotorOffset,
    /// A serial leg has no such thing.
    #[error("motor_offset = {0}: a serial leg has none: remove it, or write kind = \"five-bar\"")]
    MotorOffset(f64),
    /// An axis that the robot does not have, or that moves another joint already.
    #[error("axes names {0}: it must be the id of an [[axis]] that moves no other joint")]
    Axis(u8),
    /// A sign is none.
    #[error(
        "signs names {0}: each of them must be 1, or -1 where the axis turns against the joint"
    )]
    Sign(f64),
}

/// A leg that was asked for and is not there.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("--leg {wanted}: the robot has no such leg: choose one of {there}")]
pub struct UnknownLeg {
    /// What was asked for.
    pub wanted: String,
    /// What there is.
    pub there: String,
}

/// One `[[leg]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileLeg {
    pub name: String,
    kind: FileLegKind,
    motor_offset: Option<f64>,
    hip: f64,
    upper: f64,
    lower: f64,
    axes: [u8; 3],
    #[serde(default = "all_along")]
    signs: [f64; 3],
    #[serde(default)]
    offsets: [f64; 3],
    place: [f64; 3],
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
enum FileLegKind {
    FiveBar,
    Serial,
}

fn all_along() -> [f64; 3] {
    [1.0; 3]
}

impl FileLeg {
    /// The leg that is meant, of a robot that has these axes and these legs already.
    pub fn leg(&self, has: &[AxisId], legs: &[RobotLeg]) -> Result<RobotLeg, RobotLegError> {
        let is_word = |text: &str| {
            let mut letters = text.chars();
            !text.is_empty() && letters.all(|c| c.is_ascii_alphanumeric() || "-_".contains(c))
        };
        let is_taken = legs.iter().any(|leg| leg.name == self.name);
        if !is_word(&self.name) || is_taken || kind_called(&self.name).is_some() {
            return Err(RobotLegError::Name(self.name.clone()));
        }
        for sign in self.signs {
            if sign.abs() != 1.0 {
                return Err(RobotLegError::Sign(sign));
            }
        }
        for (field, value) in ["offsets[0]", "offsets[1]", "offsets[2]"]
            .into_iter()
            .zip(self.offsets)
        {
            in_range(field, value, OFFSET_RANGE, "rad")?;
        }
        for (field, value) in ["place[0]", "place[1]", "place[2]"]
            .into_iter()
            .zip(self.place)
        {
            in_range(field, value, PLACE_RANGE, "m")?;
        }
        Ok(RobotLeg {
            name: self.name.clone(),
            kinematics: self.kinematics()?,
            axes: self.axes(has, legs)?,
            signs: self.signs,
            offsets: self.offsets,
            place: self.place,
        })
    }

    fn kinematics(&self) -> Result<Leg, RobotLegError> {
        let Self {
            hip, upper, lower, ..
        } = *self;
        match (self.kind, self.motor_offset) {
            (FileLegKind::FiveBar, Some(motor_offset)) => {
                Ok(Leg::FiveBar(FiveBar::new(FiveBarLengths {
                    motor_offset,
                    hip,
                    upper,
                    lower,
                })?))
            }
            (FileLegKind::FiveBar, None) => Err(RobotLegError::NoMotorOffset),
            (FileLegKind::Serial, None) => Ok(Leg::Serial(Serial::new(SerialLengths {
                hip,
                upper,
                lower,
            })?)),
            (FileLegKind::Serial, Some(offset)) => Err(RobotLegError::MotorOffset(offset)),
        }
    }

    fn axes(&self, has: &[AxisId], legs: &[RobotLeg]) -> Result<[AxisId; 3], RobotLegError> {
        let mut free: Vec<AxisId> = has.to_vec();
        free.retain(|axis| legs.iter().all(|leg| !leg.axes.contains(axis)));
        let mut take = |number: u8| {
            let place = free.iter().position(|axis| axis.get() == number);
            place
                .map(|place| free.swap_remove(place))
                .ok_or(RobotLegError::Axis(number))
        };
        let [first, second, third] = self.axes;
        Ok([take(first)?, take(second)?, take(third)?])
    }
}

/// The legs of the robot that is assumed where no file names one: serial ones in pairs, of the size
/// of a small research quadruped, so that a trot of 2.5 Hz at 0.5 m/s is within the axes' default
/// limits. An axis at 0 has its leg hang straight down, and the right legs are the left ones
/// in a mirror.
pub(super) fn assumed() -> Vec<RobotLeg> {
    let mut legs = Vec::new();
    for (index, (name, forward, side)) in [
        ("front-left", 0.19, 1.0),
        ("front-right", 0.19, -1.0),
        ("rear-left", -0.19, 1.0),
        ("rear-right", -0.19, -1.0),
    ]
    .into_iter()
    .enumerate()
    {
        let first = 3 * index as u8 + 1;
        let axes = [first, first + 1, first + 2].map(AxisId::new);
        let lengths = SerialLengths {
            hip: side * ASSUMED.hip,
            ..ASSUMED
        };
        if let ([Some(thigh), Some(knee), Some(abduction)], Ok(serial)) =
            (axes, Serial::new(lengths))
        {
            legs.push(RobotLeg {
                name: name.to_owned(),
                kinematics: Leg::Serial(serial),
                axes: [thigh, knee, abduction],
                signs: [side, side, 1.0],
                offsets: [-side * FRAC_PI_2, -side * PI, 0.0],
                place: [forward, side * 0.11, 0.0],
            });
        }
    }
    legs
}

/// The published leg of this kind, if it is the name of one.
fn kind_called(name: &str) -> Option<Leg> {
    match name {
        "five-bar" => Some(Leg::published_five_bar()),
        "serial" => Some(Leg::published_serial()),
        _ => None,
    }
}

/// A leg to compute with, and the robot's own one if it is one of those.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChosenLeg<'a> {
    /// Its geometry.
    pub kinematics: Leg,
    /// Its place in the robot.
    pub mounted: Option<&'a RobotLeg>,
}

/// The leg that `--leg` means: the one of this name, or, where `is_named` says that the legs are from
/// a file, the first of this kind; without such legs the published one of it.
pub(super) fn choose<'a>(
    legs: &'a [RobotLeg],
    is_named: bool,
    wanted: &str,
) -> Result<ChosenLeg<'a>, UnknownLeg> {
    let kind = kind_called(wanted);
    let fits = |leg: &&RobotLeg| match kind {
        Some(kind) => std::mem::discriminant(&kind) == std::mem::discriminant(&leg.kinematics),
        None => leg.name == wanted,
    };
    let is_published = kind.is_some() && !is_named;
    if !is_published && let Some(leg) = legs.iter().find(fits) {
        return Ok(ChosenLeg {
            kinematics: leg.kinematics,
            mounted: Some(leg),
        });
    }
    match kind {
        Some(kinematics) if !is_named || legs.is_empty() => Ok(ChosenLeg {
            kinematics,
            mounted: None,
        }),
        _ => {
            let names = legs.iter().map(|leg| leg.name.as_str());
            let kinds = ["five-bar", "serial"].into_iter();
            let there: Vec<&str> = if is_named && !legs.is_empty() {
                names.collect()
            } else {
                kinds.chain(names).collect()
            };
            Err(UnknownLeg {
                wanted: wanted.to_owned(),
                there: there.join(", "),
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::robot::Robot;
    use std::path::Path;

    const LEG: &str = "[[axis]]\nid = 1\n[[axis]]\nid = 2\n[[axis]]\nid = 3\n[[leg]]\n\
        name = \"a\"\nkind = \"five-bar\"\nmotor_offset = 0.03\nhip = 0.06\nupper = 0.1\n\
        lower = 0.16\naxes = [1, 2, 3]\nsigns = [1, -1, 1]\noffsets = [0.5, 0.0, 0.0]\n\
        place = [0.1, 0.1, 0.0]\n";

    fn parse(text: &str) -> Result<Robot, String> {
        Robot::parse(text, Path::new("robot.toml")).map_err(|error| error.to_string())
    }

    #[test]
    fn axes_and_joints_are_each_other_s_inverse() {
        let robot = parse(LEG).expect("valid");
        let leg = &robot.legs()[0];
        assert_eq!(leg.axis_positions([1.0, 2.0, 3.0]), [1.5, -2.0, 3.0]);
        assert_eq!(leg.axis_rates([1.0, 2.0, 3.0]), [1.0, -2.0, 3.0]);
        assert_eq!(leg.joints([1.5, -2.0, 3.0]), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn bad_legs_say_what_is_wrong() {
        for (good, bad, words) in [
            ("\"a\"", "\"\"", "name = \"\""),
            ("\"a\"", "\"serial\"", "name = \"serial\""),
            ("five-bar", "six-bar", "six-bar"),
            ("motor_offset = 0.03\n", "", "motor_offset is missing"),
            ("\"five-bar\"", "\"serial\"", "a serial leg has none"),
            ("0.03", "-0.03", "motor_offset = -0.03"),
            ("upper = 0.1\n", "upper = nan\n", "upper = NaN"),
            ("lower = 0.16", "lower = 0.0", "from 0.001 to 10 m"),
            ("[1, 2, 3]", "[1, 2, 2]", "axes names 2"),
            ("[1, 2, 3]", "[1, 2, 4]", "axes names 4"),
            ("[1, -1, 1]", "[1, 0, 1]", "signs names 0"),
            ("[0.5, 0.0, 0.0]", "[0.5, inf, 0.0]", "offsets[1] = inf"),
            ("[0.1, 0.1, 0.0]", "[0.1, 0.1, 99.0]", "place[2] = 99"),
            ("place", "position", "position"),
        ] {
            assert!(LEG.contains(good), "{good}");
            let message = parse(&LEG.replace(good, bad)).expect_err(bad);
            assert!(message.contains(words), "{message}");
        }
        // The second leg wants what the first one has.
        let again = LEG.split_once("[[leg]]").expect("a leg").1;
        let message = parse(&format!("{LEG}[[leg]]{again}")).expect_err("twice");
        assert!(message.contains("name = \"a\""), "{message}");
        let other = again.replace("\"a\"", "\"b\"");
        let message = parse(&format!("{LEG}[[leg]]{other}")).expect_err("twice");
        assert!(message.contains("leg b: axes names 1"), "{message}");
    }

    #[test]
    fn the_robot_that_is_assumed_hangs_straight_and_is_a_mirror_of_itself() {
        let robot = Robot::default();
        let legs = robot.legs();
        assert_eq!(legs.len(), 4);
        let axes = legs.iter().flat_map(|leg| leg.axes).map(|axis| axis.get());
        assert!(axes.eq(1..=12));
        for leg in legs {
            let foot = leg.kinematics.foot(leg.joints([0.0; 3])).expect("a foot");
            let below = [0.0, 0.0, -0.4];
            assert!(
                foot.iter().zip(below).all(|(a, b)| (a - b).abs() < 1e-15),
                "{foot:?}"
            );
        }
        let at = |leg: usize, y: f64| {
            let joints = legs[leg].kinematics.joints([0.02, y, -0.3]);
            legs[leg].axis_positions(joints.expect("in reach"))
        };
        let (left, right) = (at(0, 0.03), at(1, -0.03));
        assert!(left.iter().zip(right).all(|(a, b)| (a + b).abs() < 1e-15));
    }
}
