//! A servo drive with the machine behind it: inertia, friction, a motor of limited torque, an
//! encoder of limited resolution, and the drive's own control loop.
//!
//! All is in f64 and uses nothing but the four operations and comparisons, which IEEE 754 defines
//! to the last bit: every machine gives the same.

mod model;

use std::cell::RefCell;
use std::rc::Rc;

use canter_shared::drive::{Condition, Drive, DriveCommand, DriveReport, Trouble};
use canter_shared::time::Tick;
use canter_shared::units::{COUNTS_PER_RADIAN, Position, Velocity};

use super::disturbance::DriveTrouble;
pub use model::{PlantError, PlantModel, PlantValues};

/// Seconds between two setpoints.
const TICK: f64 = 1e-3;

/// Turns of the drive's control loop in a tick: 4 kHz.
const LOOPS: u32 = 4;

/// Seconds of one turn of the control loop.
const STEP: f64 = TICK / LOOPS as f64;

/// Ticks between the order to enable and following.
const ENABLE_TICKS: u8 = 2;

/// How quickly a position error is made up for: 1/s, about 25 Hz.
const POSITION_GAIN: f64 = 150.0;

/// How quickly a velocity error is made up for: 1/s, about 100 Hz.
const VELOCITY_GAIN: f64 = 600.0;

/// How quickly what friction the drive does not know of is learned: 1/s.
const INTEGRAL_GAIN: f64 = 60.0;

/// How quickly the drive's estimate follows the encoder: 1/s, about 160 Hz.
const ESTIMATE_GAIN: f64 = 1_000.0;

/// Where a shaft really is, whatever its encoder says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PlantState {
    /// Where it is.
    pub position: Position,
    /// How fast it turns.
    pub velocity: Velocity,
}

/// What the drive's control loop remembers.
#[derive(Debug, Clone, Copy, Default)]
struct Loop {
    /// Where the shaft seems to be, in rad, and how fast, in rad/s.
    position: f64,
    velocity: f64,
    /// The torque that it has learned to need, in N m.
    integral: f64,
}

/// A setpoint in rad, rad/s and rad/s^2.
#[derive(Debug, Clone, Copy, Default)]
struct Target {
    position: f64,
    velocity: f64,
    acceleration: f64,
}

/// What follows from the values, so that the control loop need not divide.
#[derive(Debug, Clone, Copy)]
struct Factors {
    /// rad in one count of the encoder, and counts in one rad.
    count: f64,
    counts: f64,
    /// Change of velocity in a step by 1 N m.
    per_torque: f64,
    /// What a step of viscous friction leaves of a velocity.
    damping: f64,
    /// What a step of Coulomb friction takes of a velocity.
    taken: f64,
    /// N m for each rad/s of velocity error, and the part of it that is learned in a step.
    gain: f64,
    learning: f64,
}

impl Factors {
    fn of(values: &PlantValues) -> Self {
        let counts = f64::from(values.encoder) / std::f64::consts::TAU;
        let per_torque = STEP / values.inertia;
        let gain = values.inertia * VELOCITY_GAIN;
        Self {
            count: 1.0 / counts,
            counts,
            per_torque,
            // Friction at the end of the step, so that it never turns the shaft round.
            damping: 1.0 / (1.0 + per_torque * values.viscous),
            taken: per_torque * values.coulomb,
            gain,
            learning: gain * INTEGRAL_GAIN * STEP,
        }
    }
}

/// The plant at some instant.
#[derive(Debug, Clone)]
pub(super) struct Plant {
    values: PlantValues,
    factors: Factors,
    /// The shaft, in rad and rad/s.
    position: f64,
    velocity: f64,
    control: Loop,
    target: Target,
    /// Ticks for which it was told to be enabled, up to [`ENABLE_TICKS`].
    enabling: u8,
    /// What it has, and for how many more ticks.
    trouble: Option<(DriveTrouble, u64)>,
    /// It has disabled itself and waits until it is told to be disabled.
    tripped: bool,
    report: DriveReport,
}

impl Plant {
    /// At rest at zero, the drive disabled.
    pub(super) fn new(model: &PlantModel) -> Self {
        let values = *model.values();
        Self {
            values,
            factors: Factors::of(&values),
            position: 0.0,
            velocity: 0.0,
            control: Loop::default(),
            target: Target::default(),
            enabling: 0,
            trouble: None,
            tripped: false,
            report: DriveReport {
                condition: Condition::Disabled,
                position: Position::ZERO,
                velocity: Velocity::ZERO,
            },
        }
    }

    pub(super) fn report(&self) -> DriveReport {
        self.report
    }

    pub(super) fn state(&self) -> PlantState {
        let counts = |value: f64| (value * COUNTS_PER_RADIAN) as i64;
        PlantState {
            position: Position::from_counts(counts(self.position)),
            velocity: Velocity::from_counts(counts(self.velocity)),
        }
    }

    pub(super) fn trouble(&mut self, trouble: DriveTrouble, ticks: u64) {
        self.trouble = Some((trouble, ticks));
    }

    /// The drive has no power for `ticks`.
    pub(super) fn coast(&mut self, ticks: u64) {
        self.enabling = 0;
        self.tripped = false;
        for tick in 0..ticks {
            if self.velocity == 0.0 {
                self.pass(ticks - tick);
                break;
            }
            self.advance();
            self.pass(1);
        }
        self.measure();
        self.control.position = self.report.position.radians();
        self.control.velocity = 0.0;
        self.report.velocity = Velocity::ZERO;
        self.report.condition = Condition::Disabled;
    }

    /// Some ticks of its trouble are over.
    fn pass(&mut self, ticks: u64) {
        if let Some((_, left)) = &mut self.trouble {
            *left = left.saturating_sub(ticks);
            if *left == 0 {
                self.trouble = None;
            }
        }
    }

    fn has(&self, trouble: DriveTrouble) -> bool {
        self.trouble.is_some_and(|(what, _)| what == trouble)
    }

    fn is_following(&self) -> bool {
        self.enabling >= ENABLE_TICKS
    }

    /// Goes on for a tick with the setpoint that it has, then takes the next one.
    pub(super) fn take(&mut self, command: &DriveCommand) {
        self.advance();
        self.pass(1);
        self.measure();
        let silent = self.has(DriveTrouble::Silence);
        let faulted = self.has(DriveTrouble::Fault);
        self.tripped = command.enable && (self.tripped || self.has(DriveTrouble::Disable));
        if !command.enable || silent || faulted || self.tripped {
            self.enabling = 0;
        } else if !self.is_following() {
            self.enabling += 1;
            self.control.integral = 0.0;
        }
        self.target = Target {
            position: command.position.radians(),
            velocity: command.velocity.radians(),
            acceleration: command.acceleration.radians(),
        };
        self.report.condition = if silent {
            Condition::Lost
        } else if faulted {
            Condition::Faulted(Trouble::Other)
        } else if self.is_following() {
            Condition::Enabled
        } else {
            Condition::Disabled
        };
    }

    /// The encoder and the drive's estimate go into the report; a silent drive's stays as it was.
    fn measure(&mut self) {
        if !self.has(DriveTrouble::Silence) {
            let measured = self.encoder();
            self.report.position = Position::from_counts(round(measured * COUNTS_PER_RADIAN));
            self.report.velocity =
                Velocity::from_counts(round(self.control.velocity * COUNTS_PER_RADIAN));
        }
    }

    /// What the encoder shows, in rad.
    fn encoder(&self) -> f64 {
        round(self.position * self.factors.counts) as f64 * self.factors.count
    }

    fn advance(&mut self) {
        let blocked = self.has(DriveTrouble::Blocked);
        for step in 0..LOOPS {
            let torque = self.control(f64::from(step) * STEP);
            if blocked {
                self.velocity = 0.0;
            } else {
                self.turn(torque);
            }
        }
    }

    /// One turn of the control loop, `since` seconds after the setpoint: the torque that it wants.
    /// A cascade of position and velocity with everything known fed forward, as servo drives have.
    fn control(&mut self, since: f64) -> f64 {
        let measured = self.encoder();
        let target = self.target;
        let follows = self.is_following();
        // The estimate knows the acceleration that it should see, so it need not lag behind.
        let state = &mut self.control;
        let expected = if follows { target.acceleration } else { 0.0 };
        state.position += STEP * (state.velocity + 0.5 * STEP * expected);
        let error = measured - state.position;
        state.position += 2.0 * ESTIMATE_GAIN * STEP * error;
        state.velocity += STEP * (expected + ESTIMATE_GAIN * ESTIMATE_GAIN * error);
        if !follows {
            return 0.0;
        }
        let velocity = target.velocity + since * target.acceleration;
        let gone = since * (target.velocity + 0.5 * since * target.acceleration);
        let mut off = target.position + gone - state.position;
        // What the encoder cannot tell apart is not worked at.
        if velocity == 0.0 && off.abs() <= 0.51 * self.factors.count {
            off = 0.0;
        }
        let slow = velocity + POSITION_GAIN * off - state.velocity;
        let values = &self.values;
        // At a standstill it is overcome towards where the shaft should be.
        let way = if velocity == 0.0 { off } else { velocity };
        let friction = values.coulomb * sign(way) + values.viscous * velocity;
        let known = values.inertia * target.acceleration + values.compensation * friction;
        let wanted = known + self.factors.gain * slow + state.integral;
        let torque = wanted.clamp(-values.torque, values.torque);
        // At the limit there is nothing to learn.
        if wanted == torque {
            state.integral += self.factors.learning * slow;
        }
        torque
    }

    /// The shaft under a torque, for one turn of the control loop.
    fn turn(&mut self, torque: f64) {
        let factors = &self.factors;
        let free = (self.velocity + factors.per_torque * torque) * factors.damping;
        // Coulomb friction takes away velocity until there is none.
        let velocity = if free.abs() <= factors.taken {
            0.0
        } else {
            free - factors.taken * sign(free)
        };
        self.position += STEP * 0.5 * (self.velocity + velocity);
        self.velocity = velocity;
    }
}

/// The nearest integer.
fn round(value: f64) -> i64 {
    (value + 0.5 * sign(value)) as i64
}

/// -1, 0 or 1.
fn sign(value: f64) -> f64 {
    if value > 0.0 {
        1.0
    } else if value < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// A node's end of the plant, which outlives the node.
#[derive(Debug, Clone)]
pub(super) struct Servo(pub(super) Rc<RefCell<Plant>>);

impl Drive for Servo {
    fn command(&mut self, _tick: Tick, command: DriveCommand) {
        self.0.borrow_mut().take(&command);
    }

    fn report(&self) -> DriveReport {
        self.0.borrow().report()
    }
}
