//! Commands as frames, and back.

use super::{Action, AssignPart, Command, Item, ProfileKind, wire_steps, wire_velocity_steps};
use crate::time::{BusTime, Tick, Ticks};
use crate::units::{Acceleration, Jerk, Position, Velocity};
use crate::wire::frame::Frame;
use crate::wire::id::{Address, Function, split};
use crate::wire::layout::{
    self, ACCELERATION_SHIFT, Addressing, Field, JERK_SHIFT, Layout, POSITION_SHIFT, Sender,
    VELOCITY_LIMIT_SHIFT, VELOCITY_SHIFT, assign, control, host_heartbeat, knot, parameter_read,
    parameter_write, peak_limits, plain_move, ramp_limits, stop, stream_begin, sync,
    trapezoid_shape, trigger,
};
use crate::wire::report::{chip_half, chip_word};
use crate::wire::{DecodeError, FieldError};

/// Builds a payload field by field, and keeps the first value that does not fit.
struct Payload {
    function: Function,
    word: u64,
    error: Option<FieldError>,
}

impl Payload {
    fn put(mut self, field: &Field, raw: i64) -> Self {
        let (minimum, maximum) = field.range();
        if !(minimum..=maximum).contains(&raw) {
            self.error.get_or_insert(FieldError {
                function: self.function,
                field: field.name,
                value: raw,
                minimum,
                maximum,
            });
        }
        self.word = field.put(self.word, raw);
        self
    }
}

/// An unsigned value as a raw one; what does not fit an i64 fits no field either.
fn raw(value: u64) -> i64 {
    i64::try_from(value).unwrap_or(i64::MAX)
}

impl Command {
    /// The command as a frame to `address`.
    ///
    /// # Errors
    /// A value that its field cannot carry.
    pub fn encode(&self, address: Address) -> Result<Frame, FieldError> {
        let function = self.function();
        let empty = Payload {
            function,
            word: 0,
            error: None,
        };
        let payload = match *self {
            Self::EmergencyStop | Self::IdentityRequest => empty,
            Self::Sync { counter, time } => empty
                .put(&sync::COUNTER, counter.into())
                .put(&sync::TIME, raw(time.0)),
            Self::Trigger {
                group,
                session,
                start,
            } => empty
                .put(&trigger::GROUP, group.into())
                .put(&trigger::SESSION, session.into())
                .put(&trigger::START, raw(start.0)),
            Self::Stop { sequence } => empty.put(&stop::SEQUENCE, sequence.into()),
            Self::HostHeartbeat { session } => empty.put(&host_heartbeat::SESSION, session.into()),
            Self::Control {
                action,
                sequence,
                session,
            } => empty
                .put(&control::ACTION, u8::from(action).into())
                .put(&control::SEQUENCE, sequence.into())
                .put(&control::SESSION, session.into()),
            Self::TrapezoidShape {
                acceleration,
                deceleration,
                sequence,
            } => empty
                .put(&trapezoid_shape::ACCELERATION, acceleration.0.into())
                .put(&trapezoid_shape::DECELERATION, deceleration.0.into())
                .put(&trapezoid_shape::SEQUENCE, sequence.into()),
            Self::RampLimits {
                acceleration,
                deceleration,
                sequence,
            } => {
                let steps = |value: Acceleration| value.counts() >> ACCELERATION_SHIFT;
                empty
                    .put(&ramp_limits::ACCELERATION, steps(acceleration))
                    .put(&ramp_limits::DECELERATION, steps(deceleration))
                    .put(&ramp_limits::SEQUENCE, sequence.into())
            }
            Self::PeakLimits {
                velocity,
                jerk,
                sequence,
            } => empty
                .put(
                    &peak_limits::VELOCITY,
                    velocity.counts() >> VELOCITY_LIMIT_SHIFT,
                )
                .put(&peak_limits::JERK, jerk.counts() >> JERK_SHIFT)
                .put(&peak_limits::SEQUENCE, sequence.into()),
            Self::Move {
                target,
                duration,
                sequence,
                ..
            } => empty
                .put(&plain_move::TARGET, wire_steps(target))
                .put(&plain_move::DURATION, duration.0.into())
                .put(&plain_move::SEQUENCE, sequence.into()),
            Self::StreamBegin {
                start,
                period,
                number,
                sequence,
            } => empty
                .put(&stream_begin::START, raw(start.0))
                .put(&stream_begin::PERIOD, period.into())
                .put(&stream_begin::NUMBER, number.into())
                .put(&stream_begin::SEQUENCE, sequence.into()),
            Self::Knot {
                position,
                velocity,
                number,
            } => empty
                .put(&knot::POSITION, wire_steps(position))
                .put(&knot::VELOCITY, wire_velocity_steps(velocity))
                .put(&knot::NUMBER, number.into()),
            Self::ParameterRead { parameter, item } => empty
                .put(&parameter_read::PARAMETER, parameter.into())
                .put(&parameter_read::ITEM, u8::from(item).into()),
            Self::ParameterWrite {
                parameter,
                value,
                sequence,
            } => empty
                .put(&parameter_write::PARAMETER, parameter.into())
                .put(&parameter_write::VALUE, value)
                .put(&parameter_write::SEQUENCE, sequence.into()),
            Self::Assign(AssignPart::ChipFirst(half)) => empty
                .put(&assign::PART, 0)
                .put(&assign::CHIP_FIRST, chip_word(half)),
            Self::Assign(AssignPart::ChipLast(half)) => empty
                .put(&assign::PART, 1)
                .put(&assign::CHIP_LAST, chip_word(half)),
            Self::Assign(AssignPart::Axis {
                axis,
                new_axis,
                sequence,
            }) => empty
                .put(&assign::PART, 2)
                .put(&assign::AXIS, axis.into())
                .put(&assign::NEW_AXIS, new_axis.into())
                .put(&assign::SEQUENCE, sequence.into()),
        };
        match payload.error {
            Some(error) => Err(error),
            None => {
                let length = Layout::of(function).map_or(0, |layout| layout.length);
                let id = address.frame_id(function);
                Ok(Frame::from_word(id, payload.word, length))
            }
        }
    }

    /// What a frame from a host means, and for whom it is; `Ok(None)` for an axis's report.
    ///
    /// # Errors
    /// A frame that is not of this protocol, or not whole.
    pub fn decode(frame: &Frame) -> Result<Option<(Address, Self)>, DecodeError> {
        let (function, address, word) = match open(frame, Sender::Host)? {
            Some(opened) => opened,
            None => return Ok(None),
        };
        let byte = |field: &Field| field.get(word) as u8;
        let meaningless = |field: &Field| DecodeError::Value {
            function,
            field: field.name,
            value: field.get(word) as u64,
        };
        let ticks = |field: &Field| Ticks(field.get(word) as u32);
        let moved = |profile, staged| Self::Move {
            profile,
            staged,
            target: Position::from_counts(plain_move::TARGET.get(word) << POSITION_SHIFT),
            duration: ticks(&plain_move::DURATION),
            sequence: byte(&plain_move::SEQUENCE),
        };
        let command = match function {
            Function::EmergencyStop => Self::EmergencyStop,
            Function::Sync => Self::Sync {
                counter: byte(&sync::COUNTER),
                time: BusTime(sync::TIME.get(word) as u64),
            },
            Function::Trigger => Self::Trigger {
                group: byte(&trigger::GROUP),
                session: trigger::SESSION.get(word) as u16,
                start: Tick(trigger::START.get(word) as u64),
            },
            Function::Stop => Self::Stop {
                sequence: byte(&stop::SEQUENCE),
            },
            Function::HostHeartbeat => Self::HostHeartbeat {
                session: host_heartbeat::SESSION.get(word) as u16,
            },
            Function::Control => Self::Control {
                action: Action::try_from(byte(&control::ACTION))
                    .map_err(|_| meaningless(&control::ACTION))?,
                sequence: byte(&control::SEQUENCE),
                session: control::SESSION.get(word) as u16,
            },
            Function::TrapezoidShape => Self::TrapezoidShape {
                acceleration: ticks(&trapezoid_shape::ACCELERATION),
                deceleration: ticks(&trapezoid_shape::DECELERATION),
                sequence: byte(&trapezoid_shape::SEQUENCE),
            },
            Function::RampLimits => {
                let limit = |field: &Field| {
                    Acceleration::from_counts(field.get(word) << ACCELERATION_SHIFT)
                };
                Self::RampLimits {
                    acceleration: limit(&ramp_limits::ACCELERATION),
                    deceleration: limit(&ramp_limits::DECELERATION),
                    sequence: byte(&ramp_limits::SEQUENCE),
                }
            }
            Function::PeakLimits => Self::PeakLimits {
                velocity: Velocity::from_counts(
                    peak_limits::VELOCITY.get(word) << VELOCITY_LIMIT_SHIFT,
                ),
                jerk: Jerk::from_counts(peak_limits::JERK.get(word) << JERK_SHIFT),
                sequence: byte(&peak_limits::SEQUENCE),
            },
            Function::MoveBeta => moved(ProfileKind::Beta, false),
            Function::MoveTrapezoid => moved(ProfileKind::Trapezoid, false),
            Function::MoveSCurve => moved(ProfileKind::SCurve, false),
            Function::StageBeta => moved(ProfileKind::Beta, true),
            Function::StageTrapezoid => moved(ProfileKind::Trapezoid, true),
            Function::StageSCurve => moved(ProfileKind::SCurve, true),
            Function::StreamBegin => Self::StreamBegin {
                start: Tick(stream_begin::START.get(word) as u64),
                period: byte(&stream_begin::PERIOD),
                number: byte(&stream_begin::NUMBER),
                sequence: byte(&stream_begin::SEQUENCE),
            },
            Function::Knot => Self::Knot {
                position: Position::from_counts(knot::POSITION.get(word) << POSITION_SHIFT),
                velocity: Velocity::from_counts(knot::VELOCITY.get(word) << VELOCITY_SHIFT),
                number: byte(&knot::NUMBER),
            },
            Function::ParameterRead => Self::ParameterRead {
                parameter: byte(&parameter_read::PARAMETER),
                item: Item::try_from(byte(&parameter_read::ITEM))
                    .map_err(|_| meaningless(&parameter_read::ITEM))?,
            },
            Function::ParameterWrite => Self::ParameterWrite {
                parameter: byte(&parameter_write::PARAMETER),
                value: parameter_write::VALUE.get(word),
                sequence: byte(&parameter_write::SEQUENCE),
            },
            Function::Assign => Self::Assign(match assign::PART.get(word) {
                0 => AssignPart::ChipFirst(chip_half(word, &assign::CHIP_FIRST)),
                1 => AssignPart::ChipLast(chip_half(word, &assign::CHIP_LAST)),
                2 => AssignPart::Axis {
                    axis: byte(&assign::AXIS),
                    new_axis: byte(&assign::NEW_AXIS),
                    sequence: byte(&assign::SEQUENCE),
                },
                _ => return Err(meaningless(&assign::PART)),
            }),
            Function::IdentityRequest => Self::IdentityRequest,
            Function::Acknowledgement
            | Function::Started
            | Function::Fault
            | Function::Feedback
            | Function::Heartbeat
            | Function::Parameter
            | Function::Identity => return Ok(None),
        };
        Ok(Some((address, command)))
    }
}

/// Checks a frame of `sender` against its layout: function, address, payload; `None` where the
/// other side sends such frames.
pub(in crate::wire) fn open(
    frame: &Frame,
    sender: Sender,
) -> Result<Option<(Function, Address, u64)>, DecodeError> {
    let unknown = DecodeError::UnknownFunction { id: frame.id() };
    let (function, address) = split(frame.id()).ok_or(unknown)?;
    let layout = layout::Layout::of(function).ok_or(unknown)?;
    if layout.sender != sender {
        return Ok(None);
    }
    let addressed = match layout.addressing {
        Addressing::All => address == Address::All,
        Addressing::One => address != Address::All,
        Addressing::Any => true,
    };
    if !addressed {
        return Err(DecodeError::Address { function });
    }
    let (length, expected) = (frame.data().len(), usize::from(layout.length));
    if length != expected {
        return Err(DecodeError::Length {
            function,
            length,
            expected,
        });
    }
    Ok(Some((function, address, frame.word())))
}
