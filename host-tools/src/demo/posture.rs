//! Where the robot really was: its joints as they were measured, through its legs' geometry.

use super::Walk;
use super::{Performance, Samples};
use crate::gait::{LEGS, Mount, Pose};
use crate::leg::LegError;
use crate::walk::Phase;
use canter_shared::time::Tick;

/// The robot at one moment. Places are seen from the body: forward, left, up, in m.
#[derive(Debug, Clone, PartialEq)]
pub struct Posture {
    /// Since the walk's start, in s.
    pub time: f64,
    /// What it was doing.
    pub phase: Phase,
    /// The joints of each leg, in their order along it.
    pub limbs: [Vec<[f64; 3]>; LEGS],
    /// The feet.
    pub feet: [[f64; 3]; LEGS],
    /// Which feet were to be on the ground.
    pub grounded: [bool; LEGS],
    /// The body above the feet that are on the ground, in m.
    pub height: f64,
    /// How far the body has gone forward, in m, as the feet on the ground say.
    pub way: f64,
    /// Where it is on the ground, by the same feet.
    pub pose: Pose,
}

/// The robot at every tick of its walk.
///
/// # Errors
/// Joint angles that its legs cannot have.
pub fn postures(performance: &Performance, walk: &Walk) -> Result<Vec<Posture>, LegError> {
    let mut postures: Vec<Posture> = Vec::with_capacity(walk.ideal.len());
    for (index, (phase, state)) in walk.ideal.iter().enumerate() {
        let tick = Tick(walk.start.0 + index as u64);
        let mut posture = Posture {
            time: state.time,
            phase: *phase,
            limbs: Default::default(),
            feet: Default::default(),
            grounded: state.grounded,
            height: 0.0,
            way: 0.0,
            pose: Pose::default(),
        };
        for (leg, mount) in walk.quadruped.mounts.iter().enumerate() {
            let axes = measured(&performance.samples, mount, tick);
            posture.limbs[leg] = mount.limb(axes)?;
            let foot = mount.leg.kinematics.foot(mount.leg.joints(axes))?;
            for (place, (foot, hip)) in posture.feet[leg]
                .iter_mut()
                .zip(foot.iter().zip(mount.leg.place))
            {
                *place = foot + hip;
            }
        }
        posture.settle(postures.last());
        postures.push(posture);
    }
    Ok(postures)
}

/// Where the axes of a leg were at a tick, in rad; zero where nobody saw them.
fn measured(samples: &Samples, mount: &Mount, tick: Tick) -> [f64; 3] {
    mount.leg.axes.map(|axis| {
        let sample = samples.at(axis, tick);
        sample.map_or(0.0, |sample| sample.measured.radians())
    })
}

impl Posture {
    /// Puts the body on its feet: as the feet on the ground go backward and round, the body goes forward
    /// and round the other way.
    fn settle(&mut self, before: Option<&Self>) {
        let on: Vec<usize> = (0..LEGS).filter(|leg| self.grounded[*leg]).collect();
        let mean = |posture: &Self, legs: &[usize], side: usize| {
            let sum: f64 = legs.iter().map(|leg| posture.feet[*leg][side]).sum();
            sum / legs.len() as f64
        };
        if on.is_empty() {
            self.height = before.map_or(0.0, |before| before.height);
        } else {
            self.height = -mean(self, &on, 2);
        }
        let Some(before) = before else {
            return;
        };
        (self.way, self.pose) = (before.way, before.pose);
        let mut steady = on;
        steady.retain(|leg| before.grounded[*leg]);
        if steady.is_empty() {
            return;
        }
        // The turn that brings the feet that stay from where they were seen to where they are seen, by
        // least squares, and the shift that is left.
        let (was, is) = (
            [0, 1].map(|side| mean(before, &steady, side)),
            [0, 1].map(|side| mean(self, &steady, side)),
        );
        let (mut along, mut across) = (0.0, 0.0);
        for leg in &steady {
            let [a, b] = [(before, was), (self, is)].map(|(posture, middle)| {
                [0, 1].map(|side| posture.feet[*leg][side] - middle[side])
            });
            along += a[0] * b[0] + a[1] * b[1];
            across += a[1] * b[0] - a[0] * b[1];
        }
        let turned = across.atan2(along);
        let (sin, cos) = turned.sin_cos();
        let shift = [
            was[0] - cos * is[0] + sin * is[1],
            was[1] - sin * is[0] - cos * is[1],
        ];
        let [x, y] = before.pose.place(shift);
        self.pose = Pose {
            x,
            y,
            yaw: before.pose.yaw + turned,
        };
        self.way += shift[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Feet that stay on the ground tell how the body goes round a circle.
    #[test]
    fn feet_on_the_ground_tell_where_the_body_is() {
        let places = [[0.2, 0.1], [0.2, -0.1], [-0.2, 0.1], [-0.2, -0.1]];
        let seen_from = |pose: Pose, grounded: [bool; LEGS]| {
            let (sin, cos) = pose.yaw.sin_cos();
            let foot = |[x, y]: [f64; 2]| {
                let (x, y) = (x - pose.x, y - pose.y);
                [cos * x + sin * y, cos * y - sin * x, -0.3]
            };
            Posture {
                time: 0.0,
                phase: Phase::Walking,
                limbs: Default::default(),
                feet: places.map(foot),
                grounded,
                height: 0.0,
                way: 0.0,
                pose: Pose::default(),
            }
        };
        let mut last: Option<Posture> = None;
        for step in 0..=100 {
            let yaw = 5e-3 * f64::from(step);
            let pose = Pose {
                x: yaw.sin(),
                y: 1.0 - yaw.cos(),
                yaw,
            };
            let pair = step % 2 == 0;
            let mut posture = seen_from(pose, [true, pair, !pair, true]);
            posture.settle(last.as_ref());
            let seen = posture.pose;
            let off = [seen.x - pose.x, seen.y - pose.y, seen.yaw - pose.yaw];
            assert!(off.iter().all(|off| off.abs() < 1e-12), "{step}: {off:?}");
            assert!((posture.height - 0.3).abs() < 1e-15);
            last = Some(posture);
        }
    }
}
