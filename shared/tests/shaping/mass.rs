//! What a mode of the machine makes of setpoints and of impulses.

use canter_shared::motion::Setpoint;
use canter_shared::motion::shaping::Shaping;
use canter_shared::units::COUNTS_PER_TURN;
use core::f64::consts::TAU;

/// A mass on a spring whose other end follows the setpoints, held from tick to tick.
///
/// x'' + 2 zeta w x' + w^2 x = w^2 u has an exact step over a tick of constant u: the state's
/// difference from (u, 0) turns and shrinks.
struct Mass {
    /// Its distance from rest and its velocity over the damped frequency, both from the last u.
    position: f64,
    velocity: f64,
    input: f64,
    decay: f64,
    ratio: f64,
    turn: (f64, f64),
    amplitude: f64,
}

impl Mass {
    fn new(frequency: f64, damping: f64, input: f64) -> Self {
        let natural = TAU * frequency / 1e3;
        let damped = natural * (1.0 - damping * damping).sqrt();
        Self {
            position: 0.0,
            velocity: 0.0,
            input,
            decay: (-damping * natural).exp(),
            ratio: damping * natural / damped,
            turn: damped.sin_cos(),
            amplitude: 0.0,
        }
    }

    /// One tick at this input.
    fn step(&mut self, input: f64) {
        self.position -= input - self.input;
        self.input = input;
        let (sine, cosine) = self.turn;
        let Self {
            position: x,
            velocity: v,
            ratio: r,
            ..
        } = *self;
        self.position = self.decay * (x * cosine + (v + r * x) * sine);
        self.velocity = self.decay * (v * cosine - (r * v + (1.0 + r * r) * x) * sine);
        let phase = self.velocity + r * self.position;
        self.amplitude = self.position.hypot(phase);
    }
}

/// What a mode still swings by, in turns, when the last of these setpoints has been given.
pub fn residual(setpoints: &[Setpoint], frequency: f64, damping: f64) -> f64 {
    let turns = |setpoint: &Setpoint| setpoint.position.counts() as f64 / COUNTS_PER_TURN as f64;
    let mut mass = Mass::new(frequency, damping, turns(&setpoints[0]));
    for setpoint in setpoints {
        mass.step(turns(setpoint));
    }
    mass.amplitude
}

/// What is left of the swing that a unit impulse leaves, when the last impulse has come: the
/// percentage vibration of Singer and Seering.
pub fn vibration(shaping: &Shaping, in_ticks: bool, frequency: f64, damping: f64) -> f64 {
    let impulses = if in_ticks {
        shaping.impulses_in_ticks()
    } else {
        shaping.impulses()
    };
    let natural = TAU * frequency;
    let damped = natural * (1.0 - damping * damping).sqrt();
    let last = impulses.last().expect("impulses").time;
    let (mut cosines, mut sines) = (0.0, 0.0);
    for impulse in &impulses {
        let growth = impulse.amplitude * (damping * natural * (impulse.time - last)).exp();
        let (sine, cosine) = (damped * impulse.time).sin_cos();
        cosines += growth * cosine;
        sines += growth * sine;
    }
    f64::hypot(cosines, sines)
}
