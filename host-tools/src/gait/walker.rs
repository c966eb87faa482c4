//! One foot on the ground or above it.

use crate::foot::Step;
use crate::foot::law::BUMP;
use crate::leg::FootMotion;

#[derive(Debug, Clone)]
pub enum Footing {
    /// Pushing down from a time on for some time; for no time where it only stands.
    Ground { since: f64, push: f64, depth: f64 },
    /// From a time to another.
    Air {
        since: f64,
        until: f64,
        step: Box<Step>,
        to: [f64; 2],
    },
}

#[derive(Debug, Clone)]
pub struct Walker {
    /// Where the foot is, or lifted off.
    pub place: [f64; 2],
    pub footing: Footing,
    /// The whole number at which it lifts.
    pub cycle: f64,
    /// Whether it has ended its last step.
    pub home: bool,
}

impl Walker {
    /// The foot on the ground and above it, in m, at a time within what it does now.
    pub fn foot(&self, time: f64) -> FootMotion {
        let [x, y] = self.place;
        match &self.footing {
            Footing::Air { since, step, .. } => {
                let mut motion = step.at(time - since);
                motion.position[0] += x;
                motion.position[1] += y;
                motion
            }
            Footing::Ground { since, push, depth } => {
                let mut motion = FootMotion {
                    position: [x, y, 0.0],
                    ..FootMotion::default()
                };
                if *push > 0.0 {
                    let [down, rate, acceleration] = BUMP.at((time - since) / push);
                    motion.position[2] = -depth * down;
                    motion.velocity[2] = -depth * rate / push;
                    motion.acceleration[2] = -depth * acceleration / (push * push);
                }
                motion
            }
        }
    }
}
