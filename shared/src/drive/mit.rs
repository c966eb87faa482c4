//! The mini-cheetah mode: bgkatz boards, CubeMars AK and the like.
//!
//! Layouts: bgkatz/motorcontrol, Core/Src/can.c and stm32f4xx_it.c; CubeMars' AK manual V1.0.8 p. 48-49.
//! Each frame to a drive is answered with where it is; nothing is sent unasked, and nothing in an answer
//! says whether the drive holds torque. So a drive that shall hold none is told so again and again, which
//! is also how it is heard.
//!
//! | file | what it holds |
//! |---|---|
//! | `model` | ranges by model |
//! | `packing` | numbers to bits and back |

mod model;
mod packing;

pub use model::{DEFAULT_MODEL, MODELS, MitRanges, preset};
pub use packing::{ENTER, EXIT, KD_RANGE, KP_RANGE, Setpoint, ZERO, pack, unpack};

use super::scale::{self, Scale};
use super::settings::DriveSettings;
use super::{Condition, Drive, DriveCommand, DriveReport, Trouble};
use crate::time::Tick;
use crate::units::{COUNTS_PER_RADIAN, Position, Velocity};
use crate::wire::frame::Frame;
use core::f32::consts::TAU;

/// What is special about a drive in this mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MitSettings {
    /// Its ranges.
    pub ranges: MitRanges,
    /// Stiffness, in Nm/rad, 0 to 500.
    pub kp: f32,
    /// Damping, in Nm s/rad, 0 to 5.
    pub kd: f32,
    /// The id that a bgkatz board answers to.
    pub master: u16,
}

const RADIANS_PER_COUNT: f32 = (1.0 / COUNTS_PER_RADIAN) as f32;

/// Ticks between two words to a drive without torque.
const IDLE_PERIOD: u16 = 10;

/// Ticks after which a drive that has not answered is told again to enter its mode.
const PATIENCE: u16 = 50;

/// Bytes of an answer with an error code; without one there is a byte less.
const LONG_ANSWER: usize = 8;
const SHORT_ANSWER: usize = 7;

/// How far the drive has come with its enabling.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    /// To be without torque.
    Idle,
    /// It was told so many ticks ago to enter its mode, and has not answered that.
    Entering(u16),
    /// It gets setpoints, and has not answered one.
    Leading,
    /// It has answered a setpoint.
    Following,
}

/// The link to one drive.
#[derive(Debug, Clone)]
pub struct Mit {
    node: u8,
    mit: MitSettings,
    scale: Scale,
    timeout: u16,
    period: u16,
    order: Order,
    wait: u16,
    /// The next payload.
    due: Option<u64>,
    /// Whether the axis wants torque.
    wanted: bool,
    /// A trouble of the drive, kept until the axis has taken its order back.
    trouble: Option<Trouble>,
    position: Position,
    velocity: Velocity,
    age: u16,
}

impl Mit {
    /// A drive that has not been heard yet.
    pub fn new(settings: &DriveSettings) -> Self {
        Self {
            node: settings.node,
            mit: settings.mit,
            scale: settings.scale(),
            timeout: settings.timeout.0.min(u16::MAX.into()) as u16,
            period: settings.period.0.clamp(1, u16::MAX.into()) as u16,
            order: Order::Idle,
            wait: 0,
            due: None,
            wanted: false,
            trouble: None,
            position: Position::ZERO,
            velocity: Velocity::ZERO,
            age: u16::MAX,
        }
    }

    /// The setpoint for the drive; `None` where its position is outside the drive's range.
    fn setpoint(&self, command: &DriveCommand) -> Option<Setpoint> {
        let position = self.scale.position(command.position) as f32 * RADIANS_PER_COUNT;
        (libm::fabsf(position) <= self.mit.ranges.position).then(|| Setpoint {
            position,
            velocity: TAU * self.scale.velocity(command.velocity),
            kp: self.mit.kp,
            kd: self.mit.kd,
            torque: self.scale.torque(command.acceleration),
        })
    }

    #[inline(never)]
    fn lead(&mut self, command: &DriveCommand) {
        match self.setpoint(command) {
            Some(setpoint) => {
                self.due = Some(pack(&self.mit.ranges, &setpoint));
            }
            // It would end at the range's end, which is another place: no torque is better.
            None => {
                self.trouble = Some(Trouble::Range);
                self.let_go();
            }
        }
    }

    fn let_go(&mut self) {
        self.order = Order::Idle;
        self.due = Some(EXIT);
        self.wait = IDLE_PERIOD;
    }

    #[inline(never)]
    fn take_answer(&mut self, data: &[u8]) {
        let &[
            _,
            position_high,
            position_low,
            velocity_high,
            low,
            ref rest @ ..,
        ] = data
        else {
            return;
        };
        self.age = 0;
        let position = u16::from_be_bytes([position_high, position_low]);
        let velocity = u16::from(velocity_high) << 4 | u16::from(low >> 4);
        let ranges = &self.mit.ranges;
        let place = unpack(position.into(), ranges.position, 16) * COUNTS_PER_RADIAN as f32;
        self.position = self.scale.axis_position(scale::whole(place));
        let speed = unpack(velocity.into(), ranges.velocity, 12);
        self.velocity = self.scale.axis_velocity(speed / TAU);
        // Byte 7 of a CubeMars drive; an answer of bgkatz has none.
        let error = rest.get(2).copied().unwrap_or(0);
        if error != 0 {
            self.trouble = Some(match error {
                1 => Trouble::Temperature,
                2 => Trouble::Current,
                3 => Trouble::Overvoltage,
                4 => Trouble::Undervoltage,
                5 => Trouble::Encoder,
                6 => Trouble::Motor,
                _ => Trouble::Other,
            });
        } else if position == 0 || position == u16::MAX {
            // At the end of its range it may be anywhere beyond.
            self.trouble = Some(Trouble::Range);
        } else if !self.wanted {
            self.trouble = None;
        }
        // What is still due was not what it answered. It is led only once it has answered the word to enter:
        // one that never got it, since its bus was gone for a while, answers setpoints all the same, and
        // follows none.
        if self.due.is_none() {
            self.order = match self.order {
                Order::Entering(_) => Order::Leading,
                Order::Leading => Order::Following,
                order => order,
            };
        }
    }
}

impl Drive for Mit {
    #[inline(never)]
    fn command(&mut self, _tick: Tick, command: DriveCommand) {
        self.age = self.age.saturating_add(1);
        self.wanted = command.enable;
        self.wait = self.wait.saturating_sub(1);
        match self.order {
            Order::Idle if command.enable && self.trouble.is_none() => {
                self.order = Order::Entering(0);
                self.due = Some(ENTER);
                self.wait = 1;
            }
            Order::Idle => {
                if self.wait == 0 {
                    self.let_go();
                }
            }
            _ if !command.enable => self.let_go(),
            Order::Entering(PATIENCE) => {
                self.order = Order::Entering(0);
                self.due = Some(ENTER);
            }
            Order::Entering(ago) => self.order = Order::Entering(ago + 1),
            Order::Leading | Order::Following => {
                if self.wait == 0 {
                    self.wait = self.period;
                    self.lead(&command);
                }
            }
        }
    }

    fn report(&self) -> DriveReport {
        let condition = if self.age > self.timeout {
            Condition::Lost
        } else if let Some(trouble) = self.trouble {
            Condition::Faulted(trouble)
        } else if self.order == Order::Following {
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
        let data = frame.data();
        let is_answer = match data.len() {
            SHORT_ANSWER => frame.id() == self.mit.master,
            // A board that was taught to send its errors may answer to its master too.
            LONG_ANSWER => frame.id() == u16::from(self.node) || frame.id() == self.mit.master,
            _ => false,
        };
        let is_own = is_answer && data.first() == Some(&self.node);
        if is_own {
            self.take_answer(data);
        }
        is_own
    }

    fn poll_transmit(&mut self) -> Option<Frame> {
        let word = self.due.take()?;
        Some(Frame::from_word(self.node.into(), word, 8))
    }
}
