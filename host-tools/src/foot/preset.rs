//! The cycles that there are.
//!
//! All but `swing` are those of the published planner FootTrajectoryPlanner; their control points
//! are those that the program itself uses, since the signs in its text are wrong.

use super::cycle::{Curve, CycleRequest, Motion};
use super::error::FootError;
use super::step::Step;
use crate::leg::FootMotion;
use canter_shared::motion::bezier::Bezier;
use std::f64::consts::{PI, TAU};
use std::fmt;

/// A shape of a cycle; on the command line by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Preset {
    /// A circle of 40 mm around the place of rest, whatever the speed.
    Circle,
    /// A line back and half a sine above it.
    Cosine,
    /// A Bezier curve of 12 points, after the MIT Cheetah.
    Mit,
    /// Bezier curves of 8 points for x and 17 for z.
    Pat92fr,
    /// The same with other points, which hurry more at the start.
    Pat92fr2,
    /// Ours: at rest over the ground at both ends, and without a step of acceleration.
    Swing,
}

impl Preset {
    /// All of them, the published ones first.
    pub const ALL: [Self; 6] = [
        Self::Circle,
        Self::Cosine,
        Self::Mit,
        Self::Pat92fr,
        Self::Pat92fr2,
        Self::Swing,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Circle => "circle",
            Self::Cosine => "cosine",
            Self::Mit => "mit",
            Self::Pat92fr => "pat92fr",
            Self::Pat92fr2 => "pat92fr2",
            Self::Swing => "swing",
        }
    }
}

impl fmt::Display for Preset {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// The radius of the circle, in m.
const RADIUS: f64 = 0.04;

/// Stance and swing of a preset.
pub(super) fn curves(
    preset: Preset,
    request: &CycleRequest,
    stance_duration: f64,
    swing_duration: f64,
) -> Result<(Motion, Motion), FootError> {
    let ground = -request.height;
    let speed = request.speed;
    let half = 0.5 * speed * stance_duration;
    let push_rate = PI / stance_duration;
    let back = Curve::Line {
        start: half,
        velocity: -speed,
    };
    let push = Curve::Sine {
        centre: ground,
        amplitude: -request.stance,
        rate: push_rate,
        angle: 0.0,
    };
    // What the published curves start and end with: the velocity of the stance, over as many equal
    // parts of the swing as the curve's degree, so that it has no acceleration there.
    let forward = |parts: f64| speed * swing_duration / parts;
    let upward = request.stance * push_rate * swing_duration / 16.0;
    let lift = request.swing;
    let top = 1.2 * lift;
    let bezier = |points: &[f64], base: f64| -> Result<Curve, FootError> {
        let curve = Bezier::new(points, swing_duration)?;
        Ok(Curve::Bezier { base, curve })
    };
    let eight = |middle: f64| {
        let part = forward(7.0);
        let (once, twice) = (half + part, half + 2.0 * part);
        [-half, -once, -twice, middle, middle, twice, once, half]
    };
    let seventeen = |last: f64| {
        let twice = 2.0 * upward;
        [
            0.0, upward, twice, lift, lift, lift, lift, lift, lift, lift, top, top, lift, last,
            twice, upward, 0.0,
        ]
    };
    let (x, z) = match preset {
        Preset::Circle => return Ok(circle(ground, request.period, stance_duration)),
        Preset::Swing => {
            let stance = Motion::Plane {
                x: Box::new(back),
                z: Box::new(Curve::Bump {
                    base: ground,
                    height: -request.stance,
                    duration: stance_duration,
                }),
            };
            let standing = |x: f64| FootMotion {
                position: [x, 0.0, ground],
                velocity: [-speed, 0.0, 0.0],
                acceleration: [0.0; 3],
            };
            let step = Step::new(&standing(-half), &standing(half), lift, swing_duration)?;
            return Ok((stance, Motion::Step(Box::new(step))));
        }
        Preset::Cosine => {
            let x = Curve::Line {
                start: -half,
                velocity: 2.0 * half / swing_duration,
            };
            let z = Curve::Sine {
                centre: ground,
                amplitude: lift,
                rate: PI / swing_duration,
                angle: 0.0,
            };
            (x, z)
        }
        Preset::Mit => {
            let part = forward(11.0);
            let (once, twice) = (half + part, half + 2.0 * part);
            let x = [
                -half, -once, -twice, -twice, -twice, 0.0, 0.0, 0.0, twice, twice, once, half,
            ];
            let z = [
                0.0, 0.0, lift, lift, lift, lift, lift, top, top, top, 0.0, 0.0,
            ];
            (bezier(&x, 0.0)?, bezier(&z, ground)?)
        }
        Preset::Pat92fr => (bezier(&eight(0.0), 0.0)?, bezier(&seventeen(lift), ground)?),
        Preset::Pat92fr2 => (
            bezier(&eight(0.5 * half), 0.0)?,
            bezier(&seventeen(4.0 * upward), ground)?,
        ),
    };
    Ok((plane(back, push), plane(x, z)))
}

fn plane(x: Curve, z: Curve) -> Motion {
    Motion::Plane {
        x: Box::new(x),
        z: Box::new(z),
    }
}

/// A circle that starts in front of its centre and goes up, backwards and down.
fn circle(ground: f64, period: f64, stance_duration: f64) -> (Motion, Motion) {
    let rate = TAU / period;
    let from = |angle: f64| {
        let sine = |centre, angle| Curve::Sine {
            centre,
            amplitude: RADIUS,
            rate,
            angle,
        };
        plane(sine(0.0, angle + 0.5 * PI), sine(ground, angle))
    };
    (from(0.0), from(rate * stance_duration))
}
