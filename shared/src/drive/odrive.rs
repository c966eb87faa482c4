//! ODrive over CANSimple, firmware 0.5 and 0.6.
//!
//! Layouts: odriverobotics/ODrive, docs/can-protocol.rst and Firmware/communication/can/can_simple.cpp
//! (0.5); odriverobotics/ros_odrive, odrive_base/include/can_simple_messages.hpp (0.6). An id is
//! `node << 5 | command`. Of the drive two frames are heard, heartbeat and encoder estimates; both must
//! be switched on in the drive, as they are by default.
//!
//! | file | what it holds |
//! |---|---|
//! | `errors` | what its error bits mean |

mod errors;

use super::scale::{self, Scale};
use super::settings::{DriveSettings, OdriveFirmware};
use super::{Condition, Drive, DriveCommand, DriveReport};
use crate::time::Tick;
use crate::units::{COUNTS_PER_TURN, Position, Velocity};
use crate::wire::frame::Frame;

/// The greatest node id.
pub const LAST_NODE: u8 = 63;

/// Bits of an id below the node's.
const COMMAND_BITS: u16 = 5;

/// The drive's state, and its errors.
pub const HEARTBEAT: u16 = 0x01;
/// The state that the drive shall be in.
pub const SET_AXIS_STATE: u16 = 0x07;
/// Where the drive is, and how fast.
pub const GET_ENCODER_ESTIMATES: u16 = 0x09;
/// What the drive controls, and from which input.
pub const SET_CONTROLLER_MODE: u16 = 0x0B;
/// A setpoint.
pub const SET_INPUT_POS: u16 = 0x0C;
/// The drive shall forget its errors.
pub const CLEAR_ERRORS: u16 = 0x18;

/// Without torque.
pub const IDLE: u8 = 1;
/// Follows its input.
pub const CLOSED_LOOP: u8 = 8;

/// Position control from the input as it is: 3, 1.
const POSITION_PASSTHROUGH: u64 = 3 | 1 << 32;

/// Ticks without a heartbeat, of which there is one in 100 ms by default, until the drive is lost: three
/// may be late or fail.
const HEARTBEAT_TIMEOUT: u16 = 350;

/// Ticks between two words to a drive that is not enabled: its own watchdog, where it is on, wants to be
/// fed in every state, and its input shall be where it is.
const IDLE_PERIOD: u16 = 20;

/// Ticks after which a drive that still reports idle is told again to enable: two of its heartbeats.
const PATIENCE: u16 = 200;

/// What is to be sent, in this order.
const ORDER: [(u8, u16); 4] = [
    (CLEAR, CLEAR_ERRORS),
    (MODE, SET_CONTROLLER_MODE),
    (SETPOINT, SET_INPUT_POS),
    (STATE, SET_AXIS_STATE),
];
const CLEAR: u8 = 1;
const MODE: u8 = 2;
const SETPOINT: u8 = 4;
const STATE: u8 = 8;

/// How far the drive has come with its enabling.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    /// To be idle.
    Idle,
    /// To be enabled, but it has not been told yet.
    Wanted,
    /// It was told so many ticks ago.
    Told(u16),
    /// It was enabled; whatever it does now, it is not told again.
    Done,
}

/// The link to one ODrive.
#[derive(Debug, Clone)]
pub struct Odrive {
    node: u16,
    firmware: OdriveFirmware,
    scale: Scale,
    timeout: u16,
    period: u16,
    order: Order,
    /// Ticks until the next setpoint.
    wait: u16,
    due: u8,
    setpoint: u64,
    state: u8,
    errors: u64,
    position: Position,
    velocity: Velocity,
    /// Ticks since the last heartbeat and the last estimate.
    heartbeat_age: u16,
    estimate_age: u16,
}

impl Odrive {
    /// A drive that has not been heard yet.
    pub fn new(settings: &DriveSettings) -> Self {
        Self {
            node: u16::from(settings.node & LAST_NODE) << COMMAND_BITS,
            firmware: settings.odrive_firmware,
            scale: settings.scale(),
            timeout: settings.timeout.0.min(u16::MAX.into()) as u16,
            period: settings.period.0.clamp(1, u16::MAX.into()) as u16,
            order: Order::Idle,
            wait: 0,
            due: 0,
            setpoint: 0,
            state: 0,
            errors: 0,
            position: Position::ZERO,
            velocity: Velocity::ZERO,
            heartbeat_age: u16::MAX,
            estimate_age: u16::MAX,
        }
    }

    fn hear_heartbeat(&mut self, word: u64) {
        self.heartbeat_age = 0;
        self.state = (word >> 32) as u8;
        self.errors = errors::of_heartbeat(self.firmware, word);
        match self.order {
            // It was left enabled by somebody, or did not hear that it shall be idle.
            Order::Idle | Order::Wanted if self.state == CLOSED_LOOP => self.due |= STATE,
            Order::Told(_) if self.state == CLOSED_LOOP => self.order = Order::Done,
            Order::Told(ago) if ago > PATIENCE && self.state == IDLE => self.order = Order::Wanted,
            _ => {}
        }
    }

    #[inline(never)]
    fn hear_estimates(&mut self, word: u64) {
        self.estimate_age = 0;
        let turns = |bits: u64| f32::from_bits(bits as u32);
        // What is no number is no place: the axis finds that nothing can carry it.
        let place = scale::whole(turns(word) * COUNTS_PER_TURN as f32);
        self.position = self.scale.axis_position(place);
        self.velocity = self.scale.axis_velocity(turns(word >> 32));
    }

    /// Position f32 in turns, velocity i16 and torque i16 in thousandths of a turn/s and of a Nm. An f32
    /// resolves 2^-24 of the position: 61 microturns at 1000 turns.
    fn encode(&self, command: &DriveCommand) -> u64 {
        let turns = self.scale.position(command.position) as f32 / COUNTS_PER_TURN as f32;
        // Beyond the greatest i16 the feed-forward is the greatest.
        let velocity = libm::roundf(1_000.0 * self.scale.velocity(command.velocity)) as i16;
        let torque = libm::roundf(1_000.0 * self.scale.torque(command.acceleration)) as i16;
        u64::from(turns.to_bits())
            | u64::from(velocity as u16) << 32
            | u64::from(torque as u16) << 48
    }

    fn frame(&self, command: u16) -> Frame {
        let (word, length) = match command {
            CLEAR_ERRORS => (0, u8::from(self.firmware == OdriveFirmware::V6)),
            SET_CONTROLLER_MODE => (POSITION_PASSTHROUGH, 8),
            SET_INPUT_POS => (self.setpoint, 8),
            _ if matches!(self.order, Order::Idle | Order::Wanted) => (IDLE.into(), 4),
            _ => (CLOSED_LOOP.into(), 4),
        };
        Frame::from_word(self.node | command, word, length)
    }

    fn is_lost(&self) -> bool {
        self.estimate_age > self.timeout || self.heartbeat_age > HEARTBEAT_TIMEOUT
    }

    /// What the axis wants has changed, or has not been begun.
    fn take_order(&mut self, enable: bool) {
        self.order = match self.order {
            Order::Idle if enable => {
                self.wait = 0;
                Order::Wanted
            }
            Order::Idle => return,
            _ if !enable => {
                self.due = STATE;
                self.wait = IDLE_PERIOD;
                Order::Idle
            }
            // A drive that calibrates itself is not interrupted: then the axis's patience ends first.
            Order::Wanted if self.state == IDLE && self.errors == 0 => {
                self.due |= MODE | SETPOINT | STATE;
                Order::Told(0)
            }
            Order::Told(ago) => Order::Told(ago.saturating_add(1)),
            same => same,
        };
    }
}

impl Drive for Odrive {
    fn command(&mut self, _tick: Tick, command: DriveCommand) {
        self.heartbeat_age = self.heartbeat_age.saturating_add(1);
        self.estimate_age = self.estimate_age.saturating_add(1);
        if command.reset {
            self.due |= CLEAR;
        }
        self.take_order(command.enable);
        self.wait = self.wait.saturating_sub(1);
        // One that still follows its input must not be told to go to where it was a little ago.
        let hushed = self.is_lost() || self.state == CLOSED_LOOP;
        if self.wait > 0 || hushed && self.order == Order::Idle {
            return;
        }
        self.due |= SETPOINT;
        if self.order == Order::Idle {
            self.wait = IDLE_PERIOD;
            self.setpoint = self.encode(&DriveCommand {
                position: self.position,
                ..DriveCommand::default()
            });
        } else {
            self.wait = self.period;
            self.setpoint = self.encode(&command);
        }
    }

    fn report(&self) -> DriveReport {
        let condition = if self.is_lost() {
            Condition::Lost
        } else if self.errors != 0 {
            Condition::Faulted(errors::meaning(self.firmware, self.errors))
        } else if self.order == Order::Done && self.state == CLOSED_LOOP {
            Condition::Enabled
        } else {
            Condition::Disabled
        };
        DriveReport {
            condition,
            position: self.position,
            velocity: self.velocity,
        }
    }

    #[inline(never)]
    fn receive(&mut self, frame: &Frame) -> bool {
        if frame.id() >> COMMAND_BITS != self.node >> COMMAND_BITS || frame.data().len() != 8 {
            return false;
        }
        match frame.id() ^ self.node {
            HEARTBEAT => self.hear_heartbeat(frame.word()),
            GET_ENCODER_ESTIMATES => self.hear_estimates(frame.word()),
            _ => return false,
        }
        true
    }

    fn poll_transmit(&mut self) -> Option<Frame> {
        let (bit, command) = ORDER.into_iter().find(|(bit, _)| self.due & bit != 0)?;
        self.due &= !bit;
        Some(self.frame(command))
    }
}
