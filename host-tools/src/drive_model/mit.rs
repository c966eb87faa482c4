//! A model of a CubeMars AK80-9 in mini-cheetah mode. Sources: see `canter_shared::drive::mit`.

use super::shaft::Shaft;
use super::{Make, Model, Seen, frame};
use canter_shared::wire::frame::Frame;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// An AK80-9's ranges: rad, rad/s, Nm/rad, Nm s/rad, Nm.
const POSITION: f64 = 12.5;
const VELOCITY: f64 = 50.0;
const KP: f64 = 500.0;
const KD: f64 = 5.0;
const TORQUE: f64 = 18.0;

/// What it turns, in kg m^2.
const INERTIA: f64 = 0.01;

/// Silence after which a board goes limp, in ms.
const LIMP: u32 = 25;

/// The error byte of a supply that is too low, and for how many ticks it is.
const UNDERVOLTAGE: u8 = 4;
const ILL: u32 = 200;

/// A setpoint as it was told: rad, rad/s, gains, Nm.
#[derive(Debug, Clone, Copy, Default)]
struct Told {
    position: f64,
    velocity: f64,
    kp: f64,
    kd: f64,
    torque: f64,
}

/// One drive.
#[derive(Debug)]
pub struct MitModel {
    node: u8,
    watchdog: u32,
    shaft: Shaft,
    in_mode: bool,
    told: Told,
    fed: u32,
    error: u8,
    /// Ticks until its supply is well again.
    ill: u32,
    out: VecDeque<Frame>,
}

impl MitModel {
    /// One at rest at `turns`.
    pub fn new(make: &Make, node: u8, turns: f64) -> Self {
        Self {
            node,
            watchdog: make.watchdog.unwrap_or(LIMP),
            shaft: Shaft::new(turns),
            in_mode: make.starts_enabled,
            told: Told::default(),
            fed: 0,
            error: 0,
            ill: 0,
            out: VecDeque::new(),
        }
    }

    fn answer(&mut self) {
        let position = to_code(self.shaft.position * TAU, POSITION, 16);
        let velocity = to_code(self.shaft.velocity * TAU, VELOCITY, 12);
        let current = to_code(0.0, TORQUE, 12);
        let data = [
            self.node,
            (position >> 8) as u8,
            position as u8,
            (velocity >> 4) as u8,
            ((velocity << 4) | (current >> 8)) as u8,
            current as u8,
            35,
            self.error,
        ];
        self.out.push_back(frame(self.node.into(), &data));
    }

    fn limp(&mut self) {
        self.told = Told {
            kp: 0.0,
            kd: 0.0,
            torque: 0.0,
            ..self.told
        };
    }
}

/// The code of a value between minus and plus `end`.
fn to_code(value: f64, end: f64, bits: u32) -> u16 {
    let most = f64::from((1u32 << bits) - 1);
    ((value + end) * most / (2.0 * end)).clamp(0.0, most) as u16
}

/// The value of a code between `least` and `most`.
fn from_code(code: u64, least: f64, most: f64, bits: u32) -> f64 {
    code as f64 * (most - least) / f64::from((1u32 << bits) - 1) + least
}

impl Model for MitModel {
    fn receive(&mut self, frame: &Frame) {
        let Ok(data) = <[u8; 8]>::try_from(frame.data()) else {
            return;
        };
        if frame.id() != u16::from(self.node) {
            return;
        }
        let word = u64::from_be_bytes(data);
        match (word >> 8 == u64::MAX >> 8, data[7]) {
            (true, 0xFC) => {
                // What it was told before is forgotten.
                self.told = Told::default();
                self.in_mode = self.error == 0;
            }
            (true, 0xFD) => self.in_mode = false,
            (true, 0xFE) => self.shaft.position = 0.0,
            _ => {
                let bits = |from: u32, count: u32| word >> from & ((1 << count) - 1);
                self.told = Told {
                    position: from_code(bits(48, 16), -POSITION, POSITION, 16),
                    velocity: from_code(bits(36, 12), -VELOCITY, VELOCITY, 12),
                    kp: from_code(bits(24, 12), 0.0, KP, 12),
                    kd: from_code(bits(12, 12), 0.0, KD, 12),
                    torque: from_code(bits(0, 12), -TORQUE, TORQUE, 12),
                };
                self.fed = 0;
            }
        }
        self.answer();
    }

    fn tick(&mut self) {
        self.fed += 1;
        self.ill = self.ill.saturating_sub(1);
        if self.ill == 0 {
            // No frame forgets an error: it ends with its cause.
            self.error = 0;
        }
        if self.watchdog > 0 && self.fed > self.watchdog {
            self.limp();
        }
        if self.in_mode {
            let told = self.told;
            self.shaft.push(|position, velocity| {
                let torque = told.kp * (told.position - position * TAU)
                    + told.kd * (told.velocity - velocity * TAU)
                    + told.torque;
                torque / INERTIA / TAU
            });
        } else {
            self.shaft.coast();
        }
    }

    fn poll_transmit(&mut self) -> Option<Frame> {
        self.out.pop_front()
    }

    fn fail(&mut self) {
        self.error = UNDERVOLTAGE;
        self.ill = ILL;
        self.in_mode = false;
    }

    fn drop_out(&mut self) {
        self.in_mode = false;
    }

    fn restart(&mut self) {
        self.in_mode = false;
        self.error = 0;
        self.told = Told::default();
        self.out.clear();
    }

    fn seen(&self) -> Seen {
        Seen {
            enabled: self.in_mode && self.told.kp > 0.0,
            faulted: self.error != 0,
            position: self.shaft.position,
            target: self.told.position / TAU,
        }
    }
}
