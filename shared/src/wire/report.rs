//! What an axis says, to everybody on the bus.

use super::command::{Item, Session, open, wire_steps, wire_velocity_steps};
use super::form::Form;
use super::frame::Frame;
use super::id::{Address, AxisId, Function};
use super::layout::{
    POSITION_SHIFT, Sender, VELOCITY_SHIFT, acknowledgement, fault, feedback, heartbeat, identity,
    parameter, started,
};
use super::place::Word;
use super::reason::Reason;
use super::{DecodeError, ProtocolVersion};
use crate::time::BusTime;
use crate::units::{Position, Velocity};
use num_enum::{IntoPrimitive, TryFromPrimitive};

/// What a node is built on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, IntoPrimitive, TryFromPrimitive)]
#[repr(u8)]
pub enum Board {
    /// The simulated robot inside a host command.
    Simulated = 0,
    /// A process on a host.
    Host = 1,
    /// An emulated Cortex-M4F.
    Emulated = 2,
    /// ST's Nucleo board with an STM32G474RE.
    NucleoG474re = 16,
    /// ST's Nucleo board with an STM32F446RE.
    NucleoF446re = 17,
    /// ST's Nucleo board with an STM32H743ZI, in its second form.
    NucleoH743zi2 = 18,
}

impl Board {
    /// Every board, in the order of their codes.
    pub const ALL: [Self; 6] = [
        Self::Simulated,
        Self::Host,
        Self::Emulated,
        Self::NucleoG474re,
        Self::NucleoF446re,
        Self::NucleoH743zi2,
    ];

    /// The board's name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Simulated => "simulated",
            Self::Host => "host",
            Self::Emulated => "emulated",
            Self::NucleoG474re => "nucleo-g474re",
            Self::NucleoF446re => "nucleo-f446re",
            Self::NucleoH743zi2 => "nucleo-h743zi2",
        }
    }
}

/// What an axis says. States and faults are their numbers here; `axis` has their names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Report {
    /// The answer to a command.
    Acknowledgement {
        /// The command's number.
        sequence: u8,
        /// The command's function.
        function: Function,
        /// Accepted, or why not.
        reason: Reason,
        /// What the reason's table says.
        detail: u32,
    },
    /// A move began.
    Started {
        /// The command's number.
        sequence: u8,
        /// When its first setpoint was handed to the drive.
        time: BusTime,
    },
    /// A fault was latched.
    Fault {
        /// Its number.
        fault: u8,
        /// When.
        time: BusTime,
    },
    /// Where the axis is.
    Feedback {
        /// Where the drive is.
        position: Position,
        /// How fast it is.
        velocity: Velocity,
        /// The axis's state.
        state: u8,
        /// Whether the setpoint moves, or will without another command.
        moving: bool,
        /// Whether the setpoint rests at the target of the last move, or at the end of the last stream:
        /// nothing stopped it before. The drive may still be on its way, or held off by its load.
        target_reached: bool,
    },
    /// State, commander and counters, which wrap.
    Heartbeat {
        /// The axis's state.
        state: u8,
        /// The latched fault, 0 for none.
        fault: u8,
        /// The session that holds the axis, 0 for none.
        session: Session,
        /// Times that the node was off the bus.
        bus_off: u8,
        /// Error frames seen.
        error_frames: u8,
        /// Receptions lost.
        lost: u8,
        /// Commands rejected.
        rejected: u8,
    },
    /// What was asked about a parameter.
    Parameter {
        /// The parameter's number.
        parameter: u8,
        /// What it is.
        item: Item,
        /// The raw value.
        value: i64,
    },
    /// A part of a node's identity.
    Identity(IdentityPart),
}

/// The parts in which a node tells who it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IdentityPart {
    /// What it runs on, and what it runs.
    Version {
        /// The protocol it speaks.
        protocol: ProtocolVersion,
        /// The board's number, see [`Board`].
        board: u8,
        /// The firmware's version: major, minor, patch.
        firmware: [u8; 3],
    },
    /// The first six bytes of the chip's id.
    ChipFirst([u8; 6]),
    /// The last six bytes of the chip's id.
    ChipLast([u8; 6]),
}

impl IdentityPart {
    /// How many parts there are.
    pub const COUNT: u8 = 3;
}

pub(in crate::wire) fn chip_half(half: i64) -> [u8; 6] {
    let [a, b, c, d, e, f, _, _] = half.to_le_bytes();
    [a, b, c, d, e, f]
}

pub(in crate::wire) fn chip_word(half: [u8; 6]) -> i64 {
    let [a, b, c, d, e, f] = half;
    i64::from_le_bytes([a, b, c, d, e, f, 0, 0])
}

impl Report {
    /// The function that carries the report.
    pub fn function(&self) -> Function {
        match self {
            Self::Acknowledgement { .. } => Function::Acknowledgement,
            Self::Started { .. } => Function::Started,
            Self::Fault { .. } => Function::Fault,
            Self::Feedback { .. } => Function::Feedback,
            Self::Heartbeat { .. } => Function::Heartbeat,
            Self::Parameter { .. } => Function::Parameter,
            Self::Identity(_) => Function::Identity,
        }
    }

    /// The report as a frame from `axis`; a position or velocity beyond its field is cut to the
    /// field's end.
    pub fn encode(&self, axis: AxisId) -> Frame {
        let time = |time: BusTime| i64::try_from(time.0).unwrap_or(i64::MAX);
        let empty = Word::default();
        let word = match *self {
            Self::Acknowledgement {
                sequence,
                function,
                reason,
                detail,
            } => empty
                .put(&acknowledgement::SEQUENCE, sequence.into())
                .put(&acknowledgement::FUNCTION, u8::from(function).into())
                .put(&acknowledgement::REASON, u8::from(reason).into())
                .put(&acknowledgement::DETAIL, detail.into()),
            Self::Started { sequence, time: at } => empty
                .put(&started::SEQUENCE, sequence.into())
                .put(&started::TIME, time(at)),
            Self::Fault {
                fault: number,
                time: at,
            } => empty
                .put(&fault::FAULT, number.into())
                .put(&fault::TIME, time(at)),
            Self::Feedback {
                position,
                velocity,
                state,
                moving,
                target_reached,
            } => empty
                .put(&feedback::POSITION, wire_steps(position))
                .put(&feedback::VELOCITY, wire_velocity_steps(velocity))
                .put(&feedback::STATE, state.into())
                .put(&feedback::MOVING, moving.into())
                .put(&feedback::TARGET_REACHED, target_reached.into()),
            Self::Heartbeat {
                state,
                fault,
                session,
                bus_off,
                error_frames,
                lost,
                rejected,
            } => empty
                .put(&heartbeat::STATE, state.into())
                .put(&heartbeat::FAULT, fault.into())
                .put(&heartbeat::SESSION, session.into())
                .put(&heartbeat::BUS_OFF, bus_off.into())
                .put(&heartbeat::ERROR_FRAMES, error_frames.into())
                .put(&heartbeat::LOST, lost.into())
                .put(&heartbeat::REJECTED, rejected.into()),
            Self::Parameter {
                parameter: number,
                item,
                value,
            } => empty
                .put(&parameter::PARAMETER, number.into())
                .put(&parameter::ITEM, u8::from(item).into())
                .put(&parameter::VALUE, value),
            Self::Identity(IdentityPart::Version {
                protocol,
                board,
                firmware: [major, minor, patch],
            }) => empty
                .put(&identity::PART, 0)
                .put(&identity::PROTOCOL_MAJOR, protocol.major.into())
                .put(&identity::PROTOCOL_MINOR, protocol.minor.into())
                .put(&identity::BOARD, board.into())
                .put(&identity::FIRMWARE_MAJOR, major.into())
                .put(&identity::FIRMWARE_MINOR, minor.into())
                .put(&identity::FIRMWARE_PATCH, patch.into()),
            Self::Identity(IdentityPart::ChipFirst(half)) => empty
                .put(&identity::PART, 1)
                .put(&identity::CHIP_FIRST, chip_word(half)),
            Self::Identity(IdentityPart::ChipLast(half)) => empty
                .put(&identity::PART, 2)
                .put(&identity::CHIP_LAST, chip_word(half)),
        };
        let function = self.function();
        let length = Form::of(function).map_or(0, |form| form.length);
        Frame::from_word(Address::Axis(axis).frame_id(function), word.0, length)
    }

    /// What a frame from an axis means, and which axis it is; `Ok(None)` for a host's command.
    ///
    /// # Errors
    /// A frame that is not of this protocol, or not whole.
    pub fn decode(frame: &Frame) -> Result<Option<(AxisId, Self)>, DecodeError> {
        let Some((function, Address::Axis(axis), word)) = open(frame, Sender::Node)? else {
            return Ok(None);
        };
        let bad = |field: &'static str, value| DecodeError::Value {
            function,
            field,
            value,
        };
        let report = match function {
            Function::Acknowledgement => Self::Acknowledgement {
                sequence: word.byte(&acknowledgement::SEQUENCE),
                function: Function::try_from(word.byte(&acknowledgement::FUNCTION)).map_err(
                    |_| {
                        bad(
                            acknowledgement::FUNCTION.name,
                            word.get(&acknowledgement::FUNCTION) as u64,
                        )
                    },
                )?,
                reason: Reason::try_from(word.byte(&acknowledgement::REASON)).map_err(|_| {
                    bad(
                        acknowledgement::REASON.name,
                        word.get(&acknowledgement::REASON) as u64,
                    )
                })?,
                detail: word.get(&acknowledgement::DETAIL) as u32,
            },
            Function::Started => Self::Started {
                sequence: word.byte(&started::SEQUENCE),
                time: BusTime(word.get(&started::TIME) as u64),
            },
            Function::Fault => Self::Fault {
                fault: word.byte(&fault::FAULT),
                time: BusTime(word.get(&fault::TIME) as u64),
            },
            Function::Feedback => Self::Feedback {
                position: Position::from_counts(word.get(&feedback::POSITION) << POSITION_SHIFT),
                velocity: Velocity::from_counts(word.get(&feedback::VELOCITY) << VELOCITY_SHIFT),
                state: word.byte(&feedback::STATE),
                moving: word.get(&feedback::MOVING) == 1,
                target_reached: word.get(&feedback::TARGET_REACHED) == 1,
            },
            Function::Heartbeat => Self::Heartbeat {
                state: word.byte(&heartbeat::STATE),
                fault: word.byte(&heartbeat::FAULT),
                session: word.get(&heartbeat::SESSION) as u16,
                bus_off: word.byte(&heartbeat::BUS_OFF),
                error_frames: word.byte(&heartbeat::ERROR_FRAMES),
                lost: word.byte(&heartbeat::LOST),
                rejected: word.byte(&heartbeat::REJECTED),
            },
            Function::Parameter => Self::Parameter {
                parameter: word.byte(&parameter::PARAMETER),
                item: Item::try_from(word.byte(&parameter::ITEM))
                    .map_err(|_| bad(parameter::ITEM.name, word.get(&parameter::ITEM) as u64))?,
                value: word.get(&parameter::VALUE),
            },
            Function::Identity => Self::Identity(match word.get(&identity::PART) {
                0 => IdentityPart::Version {
                    protocol: ProtocolVersion {
                        major: word.byte(&identity::PROTOCOL_MAJOR),
                        minor: word.byte(&identity::PROTOCOL_MINOR),
                    },
                    board: word.byte(&identity::BOARD),
                    firmware: [
                        word.byte(&identity::FIRMWARE_MAJOR),
                        word.byte(&identity::FIRMWARE_MINOR),
                        word.byte(&identity::FIRMWARE_PATCH),
                    ],
                },
                1 => IdentityPart::ChipFirst(chip_half(word.get(&identity::CHIP_FIRST))),
                2 => IdentityPart::ChipLast(chip_half(word.get(&identity::CHIP_LAST))),
                _ => return Err(bad(identity::PART.name, word.get(&identity::PART) as u64)),
            }),
            _ => return Ok(None),
        };
        Ok(Some((axis, report)))
    }
}
