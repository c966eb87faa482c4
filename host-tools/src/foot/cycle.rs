//! One cycle of one foot.

use super::error::FootError;
use super::preset::{Preset, curves};
use super::step::Step;
use crate::leg::FootMotion;
use crate::notation::Range;
use canter_shared::motion::bezier::Bezier;
use canter_shared::motion::trajectory::Trajectory;

use super::law::BUMP;

/// What a foot is asked to do. Lengths are in m, and the ranges are those of [`Cycle::new`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CycleRequest {
    /// How fast the body goes forward, in m/s; the foot goes back as fast while it stands.
    pub speed: f64,
    /// How long stance and swing take together, in s.
    pub period: f64,
    /// How much longer than half of the period the stance is, in percent of the period.
    pub overlay: f64,
    /// How far the swing lifts the foot, in m.
    pub swing: f64,
    /// How far the stance presses the foot into the ground, in m.
    pub stance: f64,
    /// How far the hip is above the ground, in m.
    pub height: f64,
}

const SPEED: Range = Range {
    field: "the speed (--vx)",
    unit: "m/s",
    least: -10.0,
    most: 10.0,
    cure: "--vx is in mm/s",
};
const PERIOD: Range = Range {
    field: "the period (--period)",
    unit: "s",
    least: 0.01,
    most: 100.0,
    cure: "--period is in ms",
};
const OVERLAY: Range = Range {
    field: "the overlay (--overlay)",
    unit: "%",
    least: -45.0,
    most: 45.0,
    cure: "it is the share of the period that the stance has beyond half",
};
const SWING: Range = Range {
    field: "the height of the swing (--swing)",
    unit: "m",
    least: 0.0,
    most: 1.0,
    cure: "--swing is in mm",
};
const STANCE: Range = Range {
    field: "the depth of the stance (--stance)",
    unit: "m",
    least: 0.0,
    most: 1.0,
    cure: "--stance is in mm",
};
const HEIGHT: Range = Range {
    field: "the height of the hip (--height)",
    unit: "m",
    least: 0.0,
    most: 10.0,
    cure: "--height is in mm, downwards from the hip",
};

/// Which half of a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// On the ground.
    Stance,
    /// In the air.
    Swing,
}

impl Phase {
    /// Its name in a table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stance => "stance",
            Self::Swing => "swing",
        }
    }
}

/// One coordinate over one phase.
#[derive(Debug, Clone)]
pub(super) enum Curve {
    Line {
        start: f64,
        velocity: f64,
    },
    /// `centre + amplitude * sin(rate * time + angle)`.
    Sine {
        centre: f64,
        amplitude: f64,
        rate: f64,
        angle: f64,
    },
    Bezier {
        base: f64,
        curve: Bezier,
    },
    Bump {
        base: f64,
        height: f64,
        duration: f64,
    },
}

impl Curve {
    /// Position, velocity and acceleration.
    fn at(&self, time: f64) -> [f64; 3] {
        match self {
            Self::Line { start, velocity } => [start + velocity * time, *velocity, 0.0],
            Self::Sine {
                centre,
                amplitude,
                rate,
                angle,
            } => {
                let (sine, cosine) = (rate * time + angle).sin_cos();
                [
                    centre + amplitude * sine,
                    amplitude * rate * cosine,
                    -amplitude * rate * rate * sine,
                ]
            }
            Self::Bezier { base, curve } => {
                let sample = curve.at(time);
                [base + sample.position, sample.velocity, sample.acceleration]
            }
            Self::Bump {
                base,
                height,
                duration,
            } => {
                let [value, velocity, acceleration] = BUMP.at(time / duration);
                [
                    base + height * value,
                    height * velocity / duration,
                    height * acceleration / (duration * duration),
                ]
            }
        }
    }
}

/// How the foot goes through one phase.
#[derive(Debug, Clone)]
pub(super) enum Motion {
    Plane { x: Box<Curve>, z: Box<Curve> },
    Step(Box<Step>),
}

/// One cycle of one foot in the plane of its leg, stance first, as seen from the hip.
#[derive(Debug, Clone)]
pub struct Cycle {
    preset: Preset,
    stance: Motion,
    swing: Motion,
    stance_duration: f64,
    swing_duration: f64,
    period: f64,
}

impl Cycle {
    /// The cycle of a preset.
    ///
    /// The stance lasts `period * (0.5 + overlay / 100)`, and meanwhile the foot goes from
    /// half of the way forward to half of it back.
    ///
    /// # Errors
    /// [`FootError::Value`] for a speed beyond 10 m/s, a period outside of 10 ms to 100 s, an overlay
    /// beyond 45 %, a swing or a stance outside of 0 to 1 m, a height outside of 0 to 10 m, and
    /// anything that is no number.
    pub fn new(preset: Preset, request: &CycleRequest) -> Result<Self, FootError> {
        SPEED.check(request.speed)?;
        PERIOD.check(request.period)?;
        OVERLAY.check(request.overlay)?;
        SWING.check(request.swing)?;
        STANCE.check(request.stance)?;
        HEIGHT.check(request.height)?;
        let stance_duration = request.period * (0.5 + request.overlay / 100.0);
        let swing_duration = request.period - stance_duration;
        let (stance, swing) = curves(preset, request, stance_duration, swing_duration)?;
        Ok(Self {
            preset,
            stance,
            swing,
            stance_duration,
            swing_duration,
            period: request.period,
        })
    }

    /// Which preset it is.
    pub fn preset(&self) -> Preset {
        self.preset
    }

    /// How long the cycle lasts, in s.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// How long a phase lasts, in s.
    pub fn duration(&self, phase: Phase) -> f64 {
        match phase {
            Phase::Stance => self.stance_duration,
            Phase::Swing => self.swing_duration,
        }
    }

    /// Which phase it is at a time, in s, and how much of it is over, in s.
    ///
    /// The swing begins when the stance has lasted its time. A cycle follows the other; the end
    /// of the first, exactly, is its touch-down and not yet the next stance.
    pub fn phase(&self, time: f64) -> (Phase, f64) {
        let time = if time == self.period {
            time
        } else {
            time.rem_euclid(self.period)
        };
        if time < self.stance_duration {
            (Phase::Stance, time)
        } else {
            (
                Phase::Swing,
                (time - self.stance_duration).min(self.swing_duration),
            )
        }
    }

    /// How the foot moves at a time, in s, as [`Self::phase`] counts it.
    pub fn at(&self, time: f64) -> FootMotion {
        let (phase, elapsed) = self.phase(time);
        self.during(phase, elapsed)
    }

    /// How the foot moves when so much of a phase is over, in s: both sides of each seam can be seen.
    pub fn during(&self, phase: Phase, elapsed: f64) -> FootMotion {
        let elapsed = elapsed.clamp(0.0, self.duration(phase));
        let motion = match phase {
            Phase::Stance => &self.stance,
            Phase::Swing => &self.swing,
        };
        match motion {
            Motion::Step(step) => step.at(elapsed),
            Motion::Plane { x, z } => {
                let (x, z) = (x.at(elapsed), z.at(elapsed));
                FootMotion {
                    position: [x[0], 0.0, z[0]],
                    velocity: [x[1], 0.0, z[1]],
                    acceleration: [x[2], 0.0, z[2]],
                }
            }
        }
    }
}
