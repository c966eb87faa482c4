//! What a host says to the axes.

use super::frame::Frame;
use super::id::{Address, Function, split};
use super::layout::{
    self, ACCELERATION_SHIFT, Addressing, Field, JERK_SHIFT, Layout, POSITION_SHIFT, Sender,
    VELOCITY_LIMIT_SHIFT, control, host_heartbeat, peak_limits, plain_move, ramp_limits, stop,
    sync, trapezoid_shape, trigger,
};
use super::{DecodeError, FieldError};
use crate::time::{BusTime, Tick, Ticks};
use crate::units::{Acceleration, Jerk, Position, Velocity};
use num_enum::{IntoPrimitive, TryFromPrimitive};

/// One commander's claim to axes: a number that it draws at random when it begins, not zero.
pub type Session = u16;

/// What a control frame asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, IntoPrimitive, TryFromPrimitive)]
#[repr(u8)]
pub enum Action {
    /// Take the axis for this session.
    Hold = 1,
    /// Give the axis back; it stays as it is.
    Release = 2,
    /// Go to operation enabled, at the place where the drive is.
    Enable = 3,
    /// Stop, then go to switch on disabled.
    Disable = 4,
    /// Forget a latched fault; the axis stays disabled.
    Clear = 5,
}

impl Action {
    /// Every action, in the order of their codes.
    pub const ALL: [Self; 5] = [
        Self::Hold,
        Self::Release,
        Self::Enable,
        Self::Disable,
        Self::Clear,
    ];
}

/// The profile of a plain move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ProfileKind {
    /// The beta S-curve.
    Beta,
    /// The trapezoid.
    Trapezoid,
    /// The jerk-limited s-curve.
    SCurve,
}

/// A command, with everything in the units of this crate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Stop now and latch a fault.
    EmergencyStop,
    /// The commander's clock.
    Sync {
        /// Counts SYNCs, to see lost ones.
        counter: u8,
        /// The bus time at which the frame was sent.
        time: BusTime,
    },
    /// Start the moves that were staged with sequence `group`.
    Trigger {
        /// The sequence number that those moves were staged with.
        group: u8,
        /// The session that staged them.
        session: Session,
        /// The tick to leave at.
        start: Tick,
    },
    /// Controlled stop.
    Stop {
        /// Comes back in the answer.
        sequence: u8,
    },
    /// The commander is alive.
    HostHeartbeat {
        /// The session whose axes it keeps.
        session: Session,
    },
    /// Hold, release, enable, disable, clear.
    Control {
        /// What is asked for.
        action: Action,
        /// The command's number.
        sequence: u8,
        /// The session that asks.
        session: Session,
    },
    /// The ramps of the next trapezoid.
    TrapezoidShape {
        /// How long to accelerate.
        acceleration: Ticks,
        /// How long to decelerate.
        deceleration: Ticks,
        /// The command's number.
        sequence: u8,
    },
    /// The largest acceleration and deceleration of the next s-curve, rounded down to whole
    /// steps of the wire; the axis's own limits hold beside them.
    RampLimits {
        /// The largest acceleration.
        acceleration: Acceleration,
        /// The largest deceleration.
        deceleration: Acceleration,
        /// The command's number.
        sequence: u8,
    },
    /// The largest velocity and jerk of the next s-curve, rounded down to whole steps of the
    /// wire; the axis's own limits hold beside them.
    PeakLimits {
        /// The largest velocity.
        velocity: Velocity,
        /// The largest jerk.
        jerk: Jerk,
        /// The command's number.
        sequence: u8,
    },
    /// Move along a profile.
    Move {
        /// Which profile.
        profile: ProfileKind,
        /// Wait for a trigger rather than leave at once.
        staged: bool,
        /// Where to come to rest.
        target: Position,
        /// From leaving to rest.
        duration: Ticks,
        /// The command's number; for a staged move its group.
        sequence: u8,
    },
    /// Who is there?
    IdentityRequest,
}

/// The nearest position that the wire can carry: at most 2^-24 turn (0.37 microrad) away.
pub const fn wire_position(position: Position) -> Position {
    Position::from_counts(wire_steps(position) << POSITION_SHIFT)
}

/// The largest acceleration that the wire can carry and that is not above this one.
pub const fn wire_acceleration(acceleration: Acceleration) -> Acceleration {
    Acceleration::from_counts(down(acceleration.counts(), ACCELERATION_SHIFT))
}

/// The largest velocity limit that the wire can carry and that is not above this one.
pub const fn wire_velocity_limit(velocity: Velocity) -> Velocity {
    Velocity::from_counts(down(velocity.counts(), VELOCITY_LIMIT_SHIFT))
}

/// The largest jerk that the wire can carry and that is not above this one.
pub const fn wire_jerk(jerk: Jerk) -> Jerk {
    Jerk::from_counts(down(jerk.counts(), JERK_SHIFT))
}

const fn down(counts: i64, shift: u32) -> i64 {
    counts >> shift << shift
}

pub(super) const fn wire_steps(position: Position) -> i64 {
    let half = 1 << (POSITION_SHIFT - 1);
    position.counts().saturating_add(half) >> POSITION_SHIFT
}

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
    /// The function that carries the command.
    pub fn function(&self) -> Function {
        match self {
            Self::EmergencyStop => Function::EmergencyStop,
            Self::Sync { .. } => Function::Sync,
            Self::Trigger { .. } => Function::Trigger,
            Self::Stop { .. } => Function::Stop,
            Self::HostHeartbeat { .. } => Function::HostHeartbeat,
            Self::Control { .. } => Function::Control,
            Self::TrapezoidShape { .. } => Function::TrapezoidShape,
            Self::RampLimits { .. } => Function::RampLimits,
            Self::PeakLimits { .. } => Function::PeakLimits,
            Self::Move {
                profile, staged, ..
            } => match (profile, staged) {
                (ProfileKind::Beta, false) => Function::MoveBeta,
                (ProfileKind::Trapezoid, false) => Function::MoveTrapezoid,
                (ProfileKind::Beta, true) => Function::StageBeta,
                (ProfileKind::Trapezoid, true) => Function::StageTrapezoid,
                (ProfileKind::SCurve, false) => Function::MoveSCurve,
                (ProfileKind::SCurve, true) => Function::StageSCurve,
            },
            Self::IdentityRequest => Function::IdentityRequest,
        }
    }

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
                action: Action::try_from(byte(&control::ACTION)).map_err(|_| {
                    DecodeError::Value {
                        function,
                        field: control::ACTION.name,
                        value: control::ACTION.get(word) as u64,
                    }
                })?,
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
            Function::IdentityRequest => Self::IdentityRequest,
            Function::Acknowledgement
            | Function::Started
            | Function::Fault
            | Function::Feedback
            | Function::Heartbeat
            | Function::Identity => return Ok(None),
        };
        Ok(Some((address, command)))
    }
}

/// Checks a frame of `sender` against its layout: function, address, payload; `None` where the
/// other side sends such frames.
pub(super) fn open(
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
