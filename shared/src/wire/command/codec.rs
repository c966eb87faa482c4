//! Commands as frames, and back.

use super::{Action, AssignPart, Command, Item, ProfileKind, wire_steps, wire_velocity_steps};
use crate::time::{BusTime, Tick, Ticks};
use crate::units::{Acceleration, Jerk, Position, Velocity};
use crate::wire::form::Form;
use crate::wire::frame::Frame;
use crate::wire::id::{Address, Function, split};
use crate::wire::layout::{
    ACCELERATION_SHIFT, Addressing, Field, JERK_SHIFT, POSITION_SHIFT, Sender,
    VELOCITY_LIMIT_SHIFT, VELOCITY_SHIFT, assign, control, host_heartbeat, knot, parameter_read,
    parameter_write, peak_limits, plain_move, ramp_limits, stop, stream_begin, sync,
    trapezoid_shape, trigger,
};
use crate::wire::place::Word;
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
                let length = Form::of(function).map_or(0, |form| form.length);
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
        let meaningless = |field: &'static str, value| DecodeError::Value {
            function,
            field,
            value,
        };
        let moved = |profile, staged| Self::Move {
            profile,
            staged,
            target: Position::from_counts(word.get(&plain_move::TARGET) << POSITION_SHIFT),
            duration: Ticks(word.get(&plain_move::DURATION) as u32),
            sequence: word.byte(&plain_move::SEQUENCE),
        };
        let command = match function {
            Function::EmergencyStop => Self::EmergencyStop,
            Function::Sync => Self::Sync {
                counter: word.byte(&sync::COUNTER),
                time: BusTime(word.get(&sync::TIME) as u64),
            },
            Function::Trigger => Self::Trigger {
                group: word.byte(&trigger::GROUP),
                session: word.get(&trigger::SESSION) as u16,
                start: Tick(word.get(&trigger::START) as u64),
            },
            Function::Stop => Self::Stop {
                sequence: word.byte(&stop::SEQUENCE),
            },
            Function::HostHeartbeat => Self::HostHeartbeat {
                session: word.get(&host_heartbeat::SESSION) as u16,
            },
            Function::Control => Self::Control {
                action: Action::try_from(word.byte(&control::ACTION)).map_err(|_| {
                    meaningless(control::ACTION.name, word.get(&control::ACTION) as u64)
                })?,
                sequence: word.byte(&control::SEQUENCE),
                session: word.get(&control::SESSION) as u16,
            },
            Function::TrapezoidShape => Self::TrapezoidShape {
                acceleration: Ticks(word.get(&trapezoid_shape::ACCELERATION) as u32),
                deceleration: Ticks(word.get(&trapezoid_shape::DECELERATION) as u32),
                sequence: word.byte(&trapezoid_shape::SEQUENCE),
            },
            Function::RampLimits => {
                let limit = |steps: i64| Acceleration::from_counts(steps << ACCELERATION_SHIFT);
                Self::RampLimits {
                    acceleration: limit(word.get(&ramp_limits::ACCELERATION)),
                    deceleration: limit(word.get(&ramp_limits::DECELERATION)),
                    sequence: word.byte(&ramp_limits::SEQUENCE),
                }
            }
            Function::PeakLimits => Self::PeakLimits {
                velocity: Velocity::from_counts(
                    word.get(&peak_limits::VELOCITY) << VELOCITY_LIMIT_SHIFT,
                ),
                jerk: Jerk::from_counts(word.get(&peak_limits::JERK) << JERK_SHIFT),
                sequence: word.byte(&peak_limits::SEQUENCE),
            },
            Function::MoveBeta => moved(ProfileKind::Beta, false),
            Function::MoveTrapezoid => moved(ProfileKind::Trapezoid, false),
            Function::MoveSCurve => moved(ProfileKind::SCurve, false),
            Function::StageBeta => moved(ProfileKind::Beta, true),
            Function::StageTrapezoid => moved(ProfileKind::Trapezoid, true),
            Function::StageSCurve => moved(ProfileKind::SCurve, true),
            Function::StreamBegin => Self::StreamBegin {
                start: Tick(word.get(&stream_begin::START) as u64),
                period: word.byte(&stream_begin::PERIOD),
                number: word.byte(&stream_begin::NUMBER),
                sequence: word.byte(&stream_begin::SEQUENCE),
            },
            Function::Knot => Self::Knot {
                position: Position::from_counts(word.get(&knot::POSITION) << POSITION_SHIFT),
                velocity: Velocity::from_counts(word.get(&knot::VELOCITY) << VELOCITY_SHIFT),
                number: word.byte(&knot::NUMBER),
            },
            Function::ParameterRead => Self::ParameterRead {
                parameter: word.byte(&parameter_read::PARAMETER),
                item: Item::try_from(word.byte(&parameter_read::ITEM)).map_err(|_| {
                    meaningless(
                        parameter_read::ITEM.name,
                        word.get(&parameter_read::ITEM) as u64,
                    )
                })?,
            },
            Function::ParameterWrite => Self::ParameterWrite {
                parameter: word.byte(&parameter_write::PARAMETER),
                value: word.get(&parameter_write::VALUE),
                sequence: word.byte(&parameter_write::SEQUENCE),
            },
            Function::Assign => Self::Assign(match word.get(&assign::PART) {
                0 => AssignPart::ChipFirst(chip_half(word.get(&assign::CHIP_FIRST))),
                1 => AssignPart::ChipLast(chip_half(word.get(&assign::CHIP_LAST))),
                2 => AssignPart::Axis {
                    axis: word.byte(&assign::AXIS),
                    new_axis: word.byte(&assign::NEW_AXIS),
                    sequence: word.byte(&assign::SEQUENCE),
                },
                _ => {
                    return Err(meaningless(
                        assign::PART.name,
                        word.get(&assign::PART) as u64,
                    ));
                }
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
) -> Result<Option<(Function, Address, Word)>, DecodeError> {
    let unknown = DecodeError::UnknownFunction { id: frame.id() };
    let (function, address) = split(frame.id()).ok_or(unknown)?;
    let form = Form::of(function).ok_or(unknown)?;
    if form.sender != sender {
        return Ok(None);
    }
    let addressed = match form.addressing {
        Addressing::All => address == Address::All,
        Addressing::One => address != Address::All,
        Addressing::Any => true,
    };
    if !addressed {
        return Err(DecodeError::Address { function });
    }
    let (length, expected) = (frame.data().len(), usize::from(form.length));
    if length != expected {
        return Err(DecodeError::Length {
            function,
            length,
            expected,
        });
    }
    Ok(Some((function, address, Word(frame.word()))))
}
