//! The motion of every foot and joint, as time goes on.

use super::blend::Commands;
use super::body::Body;
use super::error::GaitError;
use super::ground::Pose;
use super::pattern::{Gait, LEG_NAMES, LEGS};
use super::quadruped::{Mount, Quadruped};
use super::rhythm::{Rhythm, when};
use super::walker::{Footing, Walker};
use crate::foot::Step;
use crate::leg::varying::Varying;
use crate::leg::{FootMotion, JointMotion};

/// How far ahead the planner goes in one go, in s.
const MOST_AHEAD: f64 = 60.0;

/// The body changes what it does over one cycle, and over this many s at least.
const SHORTEST_BLEND: f64 = 0.5;

/// How long it looks for what is due in one go, in s.
const LOOK: f64 = 0.01;

/// A foot that is late is in the air for this share of its usual time at least.
const SHORTEST_FLIGHT: f64 = 0.5;

/// What all feet and joints do at one time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// When, in s.
    pub time: f64,
    /// The feet, each seen from its hip.
    pub feet: [FootMotion; LEGS],
    /// The axes of each leg, in the order of its joints, in the axes' own positions.
    pub joints: [JointMotion; LEGS],
    /// Which feet are on the ground.
    pub grounded: [bool; LEGS],
    /// Where the body is on the ground.
    pub pose: Pose,
    /// The feet on the ground and above it, in m.
    pub places: [[f64; 3]; LEGS],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    Standing,
    Walking,
    Stopping,
}

/// Plans the motion of every joint as time goes on.
///
/// It begins standing. Gaits and velocities may be asked for at any time and come in smoothly:
/// position, velocity and acceleration of each joint are continuous. Equal questions at equal
/// times give equal motions, however finely the motion is looked at.
#[derive(Debug, Clone)]
pub struct Planner {
    quadruped: Quadruped,
    time: f64,
    body: Body,
    commands: Commands,
    rhythm: Option<Rhythm>,
    wanted: Option<Gait>,
    pose: Pose,
    walkers: [Walker; LEGS],
    mode: Mode,
}

impl Planner {
    /// A body that stands with its feet below its hips, at time 0; its velocity is for when it walks.
    ///
    /// # Errors
    /// [`Body::check`].
    pub fn new(quadruped: Quadruped, body: Body) -> Result<Self, GaitError> {
        body.check()?;
        let walker = |mount: &Mount| Walker {
            place: mount.neutral(),
            footing: Footing::Ground {
                since: 0.0,
                push: 0.0,
                depth: 0.0,
            },
            cycle: 0.0,
            home: true,
        };
        Ok(Self {
            walkers: quadruped.mounts.each_ref().map(walker),
            quadruped,
            time: 0.0,
            body,
            commands: Commands::new(body.at_rest().values()),
            rhythm: None,
            wanted: None,
            pose: Pose::default(),
            mode: Mode::Standing,
        })
    }

    /// Where the planner is, in s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Whether all feet are on the ground below the hips and no step is to come.
    pub fn is_standing(&self) -> bool {
        self.mode == Mode::Standing
    }

    /// Whether the last command and the last gait have come in wholly.
    pub fn is_settled(&self) -> bool {
        let rhythm = self.rhythm.as_ref();
        self.commands.is_settled()
            && self.wanted.is_none()
            && rhythm.is_none_or(|rhythm| rhythm.settles() <= self.time)
    }

    /// When a foot is to come down next by the rhythm of the gait, in s; none before the first
    /// gait, and for a leg that is none.
    pub fn touch_down(&self, leg: usize) -> Option<f64> {
        let rhythm = self.rhythm.as_ref().filter(|_| leg < LEGS)?;
        let next = rhythm.of_leg(leg, self.time).floor() + 1.0;
        let air = rhythm.air(self.time);
        Some(when(|at| rhythm.of_leg(leg, at), next, self.time, air))
    }

    /// Asks the body for something else. It comes in over a cycle, half a second at least; while
    /// no gait is walked the velocity waits for one.
    ///
    /// # Errors
    /// [`Body::check`]; nothing is changed then.
    pub fn command(&mut self, body: &Body) -> Result<(), GaitError> {
        body.check()?;
        self.body = *body;
        self.blend();
        Ok(())
    }

    /// Asks for a gait: begins to walk, or goes over to it. A change of gait takes three cycles, and
    /// of those asked for in the meantime the latest comes next.
    ///
    /// # Errors
    /// [`Gait::check`]; nothing is changed then.
    pub fn walk(&mut self, gait: &Gait) -> Result<(), GaitError> {
        gait.check()?;
        let time = self.time;
        match (&mut self.rhythm, self.mode) {
            (rhythm, Mode::Standing) => *rhythm = Some(Rhythm::new(gait, time)),
            (Some(rhythm), _) if rhythm.target() == gait => self.wanted = None,
            _ => self.wanted = Some(*gait),
        }
        if self.mode != Mode::Walking {
            self.mode = Mode::Walking;
            let Some(rhythm) = &self.rhythm else {
                return Ok(());
            };
            for (index, walker) in self.walkers.iter_mut().enumerate() {
                walker.home = false;
                if matches!(walker.footing, Footing::Ground { .. }) {
                    // What is due now may have been rounded to a little earlier.
                    walker.cycle = (rhythm.of_lift(index, time) - 1e-9).ceil();
                }
            }
            self.blend();
        }
        self.pass();
        Ok(())
    }

    /// Asks to stand: the body slows down, and each foot makes a last step to below its hip.
    pub fn stop(&mut self) {
        if self.mode == Mode::Walking {
            self.mode = Mode::Stopping;
            self.wanted = None;
            self.blend();
        }
    }

    fn blend(&mut self) {
        let body = if self.mode == Mode::Walking {
            self.body
        } else {
            self.body.at_rest()
        };
        let period = self
            .rhythm
            .as_ref()
            .map_or(0.0, |rhythm| rhythm.target().period);
        self.commands
            .set(self.time, body.values(), period.max(SHORTEST_BLEND));
    }

    /// What all feet and joints do at a time, which is not before the last one.
    ///
    /// # Errors
    /// A time that is over, or more than 60 s ahead; a foot that its leg does not reach.
    pub fn advance(&mut self, time: f64) -> Result<State, GaitError> {
        if !(self.time..=self.time + MOST_AHEAD).contains(&time) {
            return Err(GaitError::Time {
                now: self.time,
                asked: time,
                most: MOST_AHEAD,
            });
        }
        while self.go_on(time)? {}
        self.state()
    }

    /// Goes to what is due next, or to a time. Tells whether there is more.
    fn go_on(&mut self, time: f64) -> Result<bool, GaitError> {
        self.pass();
        let mut next = time
            .min(self.time + LOOK)
            .min(self.commands.due().max(self.time));
        if let (Some(_), Some(rhythm)) = (&self.wanted, &self.rhythm) {
            next = next.min(rhythm.settles().max(self.time));
        }
        let mut who = None;
        for index in 0..LEGS {
            if let Some(due) = self.due(index, next)
                && (who.is_none() || due < next)
            {
                (next, who) = (due, Some(index));
            }
        }
        self.pose = self.pose.after(&self.commands, self.time, next);
        self.time = next;
        if let Some(index) = who {
            self.turn(index)?;
        }
        Ok(who.is_some() || self.time < time)
    }

    fn pass(&mut self) {
        self.commands.pass(self.time);
        if let Some(rhythm) = &mut self.rhythm
            && rhythm.settles() <= self.time
            && let Some(gait) = self.wanted.take()
        {
            rhythm.change(&gait, self.time);
        }
    }

    /// When a foot lifts off or comes down, where that is not after `until`.
    fn due(&self, index: usize, until: f64) -> Option<f64> {
        let walker = &self.walkers[index];
        let due = match &walker.footing {
            Footing::Air { until, .. } => until.max(self.time),
            Footing::Ground { since, push, .. } => {
                let rhythm = self.rhythm.as_ref()?;
                if walker.home {
                    return None;
                }
                let early = self.time.max(since + push);
                if rhythm.of_lift(index, until) < walker.cycle {
                    return None;
                }
                when(|at| rhythm.of_lift(index, at), walker.cycle, early, LOOK)
            }
        };
        (due <= until).then_some(due)
    }

    /// A foot lifts off or comes down, now.
    fn turn(&mut self, index: usize) -> Result<(), GaitError> {
        let time = self.time;
        let Some(rhythm) = &self.rhythm else {
            return Ok(());
        };
        let stops = self.mode == Mode::Stopping && self.commands.is_settled();
        let walker = &mut self.walkers[index];
        if let Footing::Air { to, .. } = walker.footing {
            walker.place = to;
            walker.cycle += 1.0;
            let depth = if walker.home {
                0.0
            } else {
                rhythm.heights(time)[1]
            };
            let lift = when(
                |at| rhythm.of_lift(index, at),
                walker.cycle,
                time,
                rhythm.air(time),
            );
            let push = if depth > 0.0 { lift - time } else { 0.0 };
            walker.footing = Footing::Ground {
                since: time,
                push,
                depth,
            };
            let ended =
                |walker: &Walker| walker.home && matches!(walker.footing, Footing::Ground { .. });
            if self.mode == Mode::Stopping && self.walkers.iter().all(ended) {
                self.mode = Mode::Standing;
            }
            return Ok(());
        }
        let air = rhythm.air(time);
        let down = when(|at| rhythm.of_leg(index, at), walker.cycle + 1.0, time, air);
        let down = down.max(time + SHORTEST_FLIGHT * air);
        let up = when(
            |at| rhythm.of_lift(index, at),
            walker.cycle + 1.0,
            down,
            air,
        );
        // In the middle of its stance a foot is to be below its hip.
        let then = self.pose.after(&self.commands, time, 0.5 * (down + up));
        let to = then.place(self.quadruped.mounts[index].neutral());
        let way = [to[0] - walker.place[0], to[1] - walker.place[1], 0.0];
        let end = FootMotion {
            position: way,
            ..FootMotion::default()
        };
        let clearance = rhythm.heights(time)[0];
        let start = FootMotion::default();
        let step = Box::new(Step::new(&start, &end, clearance, down - time)?);
        walker.footing = Footing::Air {
            since: time,
            until: down,
            step,
            to,
        };
        walker.home = stops;
        Ok(())
    }

    fn state(&self) -> Result<State, GaitError> {
        let [vx, vy, turning, height, roll, pitch] = self.commands.at(self.time);
        let (sin, cos) = self.pose.yaw.sin_cos();
        // The body's velocity and acceleration over the ground, as it sees them itself.
        let over_ground = [
            (vx.value, vx.rate - turning.value * vy.value),
            (vy.value, vy.rate + turning.value * vx.value),
        ];
        let yaw = Varying::new(0.0, turning.value, turning.rate);
        let (against, along) = (yaw.sin(), yaw.cos());
        let [(sin_roll, cos_roll), (sin_pitch, cos_pitch)] =
            [roll, pitch].map(|angle| (angle.sin(), angle.cos()));
        let mut state = State {
            time: self.time,
            pose: self.pose,
            ..State::default()
        };
        for (index, walker) in self.walkers.iter().enumerate() {
            let foot = walker.foot(self.time);
            let [px, py, pz] = foot.position;
            let turn = |x: f64, y: f64| [cos * x + sin * y, cos * y - sin * x];
            let place = turn(px - self.pose.x, py - self.pose.y);
            let velocity = turn(foot.velocity[0], foot.velocity[1]);
            let acceleration = turn(foot.acceleration[0], foot.acceleration[1]);
            let seen = |side: usize| {
                let (body_velocity, body_acceleration) = over_ground[side];
                Varying::new(
                    place[side],
                    velocity[side] - body_velocity,
                    acceleration[side] - body_acceleration,
                )
            };
            // The axes of the body turn too; at this moment they are turned by nothing.
            let (ahead, left) = (seen(0), seen(1));
            let x = along * ahead + against * left;
            let y = along * left - against * ahead;
            let z = Varying::new(pz, foot.velocity[2], foot.acceleration[2]) - height;
            let (x, z) = (cos_pitch * x - sin_pitch * z, sin_pitch * x + cos_pitch * z);
            let (y, z) = (cos_roll * y + sin_roll * z, cos_roll * z - sin_roll * y);
            let mount = &self.quadruped.mounts[index];
            let motion = mount.seen([x, y, z]);
            state.joints[index] = mount.axis_motion(&motion).map_err(|cause| GaitError::Leg {
                leg: LEG_NAMES[index],
                time: self.time,
                cause,
            })?;
            state.feet[index] = motion;
            state.places[index] = foot.position;
            state.grounded[index] = matches!(walker.footing, Footing::Ground { .. });
        }
        Ok(state)
    }
}
