//! Where the robot really was: its joints as they were measured, through its legs' geometry.

use super::Walk;
use super::{Performance, Samples};
use crate::gait::{LEGS, Mount};
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
    /// Puts the body on its feet: what a foot on the ground goes backward, the body goes forward.
    fn settle(&mut self, before: Option<&Self>) {
        let (mut height, mut feet) = (0.0, 0.0);
        let (mut forward, mut steady) = (0.0, 0.0);
        for leg in (0..LEGS).filter(|leg| self.grounded[*leg]) {
            height -= self.feet[leg][2];
            feet += 1.0;
            if let Some(before) = before.filter(|before| before.grounded[leg]) {
                forward += before.feet[leg][0] - self.feet[leg][0];
                steady += 1.0;
            }
        }
        let before = before.map_or((0.0, 0.0), |before| (before.height, before.way));
        self.height = if feet > 0.0 { height / feet } else { before.0 };
        self.way = before.1 + if steady > 0.0 { forward / steady } else { 0.0 };
    }
}
