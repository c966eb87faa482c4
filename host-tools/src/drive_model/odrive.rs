//! A model of an ODrive on CANSimple. Sources: see `canter_shared::drive::odrive`.

use super::shaft::Shaft;
use super::{Make, Model, Seen, frame};
use canter_shared::drive::settings::OdriveFirmware;
use canter_shared::wire::frame::Frame;
use std::collections::VecDeque;

/// By default a heartbeat in 100 ms and estimates in 10 ms.
const HEARTBEAT_PERIOD: u32 = 100;
const ESTIMATE_PERIOD: u32 = 10;

/// Ticks from the order to the loop.
const CLOSING: u32 = 5;

const IDLE: u8 = 1;
const CLOSED_LOOP: u8 = 8;

/// `ODRIVE_ERROR_DC_BUS_UNDER_VOLTAGE`, and `AXIS_ERROR_DC_BUS_UNDER_VOLTAGE` of 0.5.
const UNDERVOLTAGE: [u32; 2] = [0x0000_0200, 0x0000_0002];
/// `WATCHDOG_TIMER_EXPIRED`.
const STARVED: [u32; 2] = [0x0100_0000, 0x0000_0800];

/// One axis of an ODrive.
#[derive(Debug)]
pub struct OdriveModel {
    node: u16,
    firmware: OdriveFirmware,
    watchdog: u32,
    shaft: Shaft,
    state: u8,
    errors: u32,
    /// Control mode and input mode.
    modes: (u32, u32),
    /// Turns and turns/s.
    input: f64,
    feed_forward: f64,
    closing: u32,
    fed: u32,
    ticks: u32,
    estimate_period: u32,
    out: VecDeque<Frame>,
}

impl OdriveModel {
    /// One at rest at `turns`.
    pub fn new(make: &Make, node: u8, turns: f64) -> Self {
        Self {
            node: u16::from(node) << 5,
            firmware: make.firmware,
            // Off by default, as in the drive.
            watchdog: make.watchdog.unwrap_or(0),
            shaft: Shaft::new(turns),
            state: if make.starts_enabled {
                CLOSED_LOOP
            } else {
                IDLE
            },
            errors: 0,
            modes: (3, 1),
            input: turns,
            feed_forward: 0.0,
            closing: 0,
            fed: 0,
            // So that drives do not all speak at once.
            ticks: 7 * u32::from(node),
            estimate_period: ESTIMATE_PERIOD,
            out: VecDeque::new(),
        }
    }

    /// The same with estimates each so many ms, at least 1: its `encoder_msg_rate_ms`.
    pub fn with_estimates_each(self, period: u32) -> Self {
        Self {
            estimate_period: period.max(1),
            ..self
        }
    }

    fn error(&mut self, bits: [u32; 2]) {
        let [of_6, of_5] = bits;
        self.errors |= match self.firmware {
            OdriveFirmware::V6 => of_6,
            OdriveFirmware::V5 => of_5,
        };
        self.drop_out();
    }

    fn ask_for(&mut self, state: u32) {
        match state {
            1 => self.drop_out(),
            // Not with errors, and not in another mode than the setpoints are meant for.
            8 if self.errors == 0 && self.modes == (3, 1) => self.closing = CLOSING,
            _ => {}
        }
    }
}

fn word(data: &[u8], at: usize) -> Option<[u8; 4]> {
    data.get(at..at + 4)?.try_into().ok()
}

impl Model for OdriveModel {
    fn receive(&mut self, frame: &Frame) {
        if frame.id() & !0x1F != self.node {
            return;
        }
        self.fed = 0;
        let data = frame.data();
        let number = |at| word(data, at).map(u32::from_le_bytes);
        match frame.id() & 0x1F {
            0x07 => {
                if let Some(state) = number(0) {
                    self.ask_for(state);
                }
            }
            0x0B => {
                if let (Some(control), Some(input)) = (number(0), number(4)) {
                    self.modes = (control, input);
                }
            }
            0x0C if data.len() == 8 => {
                if let Some(turns) = word(data, 0) {
                    self.input = f32::from_le_bytes(turns).into();
                    self.feed_forward = 1e-3 * f64::from(i16::from_le_bytes([data[4], data[5]]));
                }
            }
            0x18 => self.errors = 0,
            _ => {}
        }
    }

    fn tick(&mut self) {
        self.ticks += 1;
        self.fed += 1;
        if self.watchdog > 0 && self.fed > self.watchdog && self.errors == 0 {
            self.error(STARVED);
        }
        if self.closing > 0 {
            self.closing -= 1;
            if self.closing == 0 {
                self.state = CLOSED_LOOP;
            }
        }
        if self.state == CLOSED_LOOP {
            self.shaft.follow(self.input, self.feed_forward);
        } else {
            self.shaft.coast();
        }
        if self.ticks.is_multiple_of(HEARTBEAT_PERIOD) {
            let [a, b, c, d] = self.errors.to_le_bytes();
            self.out
                .push_back(frame(self.node | 0x01, &[a, b, c, d, self.state, 0, 0, 0]));
        }
        if self.ticks.is_multiple_of(self.estimate_period) {
            let position = (self.shaft.position as f32).to_le_bytes();
            let velocity = (self.shaft.velocity as f32).to_le_bytes();
            let data = [position, velocity].concat();
            self.out.push_back(frame(self.node | 0x09, &data));
        }
    }

    fn poll_transmit(&mut self) -> Option<Frame> {
        self.out.pop_front()
    }

    fn fail(&mut self) {
        self.error(UNDERVOLTAGE);
    }

    fn drop_out(&mut self) {
        self.state = IDLE;
        self.closing = 0;
    }

    fn restart(&mut self) {
        self.drop_out();
        self.errors = 0;
        self.fed = 0;
        self.input = self.shaft.position;
        self.out.clear();
    }

    fn seen(&self) -> Seen {
        Seen {
            enabled: self.state == CLOSED_LOOP,
            faulted: self.errors != 0,
            position: self.shaft.position,
            target: self.input,
        }
    }
}
