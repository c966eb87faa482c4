//! Functions and axis ids, which make up a frame's 11-bit id.

use core::fmt;
use num_enum::{IntoPrimitive, TryFromPrimitive};

/// Bits of the axis in an id.
pub const AXIS_BITS: u32 = 6;

/// Bits of the function in an id.
pub const FUNCTION_BITS: u32 = 11 - AXIS_BITS;

/// The greatest axis id.
pub const LAST_AXIS: u8 = (1 << AXIS_BITS) - 1;

/// What a frame is for, the upper five bits of its id: the lower, the sooner it gets the bus.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, IntoPrimitive, TryFromPrimitive,
)]
#[repr(u8)]
pub enum Function {
    /// Stop now and latch a fault, from anybody.
    EmergencyStop = 0,
    /// The commander's clock.
    Sync = 1,
    /// Start what was staged, all at one bus time.
    Trigger = 2,
    /// A knot of a stream.
    Knot = 3,
    /// Controlled stop, from anybody.
    Stop = 4,
    /// The commander is alive.
    HostHeartbeat = 5,
    /// Hold, release, enable, disable, clear.
    Control = 6,
    /// The ramps of the next trapezoid.
    TrapezoidShape = 7,
    /// Move along a beta S-curve, now.
    MoveBeta = 8,
    /// Move along a trapezoid, now.
    MoveTrapezoid = 9,
    /// Move along a jerk-limited s-curve, now.
    MoveSCurve = 10,
    /// The largest acceleration and deceleration of the next s-curve.
    RampLimits = 11,
    /// Move along a beta S-curve, at the trigger.
    StageBeta = 12,
    /// Move along a trapezoid, at the trigger.
    StageTrapezoid = 13,
    /// Move along a jerk-limited s-curve, at the trigger.
    StageSCurve = 14,
    /// The largest velocity and jerk of the next s-curve.
    PeakLimits = 15,
    /// The answer to a command.
    Acknowledgement = 16,
    /// When a move began.
    Started = 17,
    /// A fault was latched.
    Fault = 18,
    /// Begin a stream of knots.
    StreamBegin = 19,
    /// Where the axis is.
    Feedback = 20,
    /// State, commander and counters.
    Heartbeat = 24,
    /// What is the value of a parameter?
    ParameterRead = 25,
    /// Change a parameter.
    ParameterWrite = 26,
    /// The value of a parameter.
    Parameter = 27,
    /// Who is there?
    IdentityRequest = 28,
    /// Chip, firmware and protocol of a node.
    Identity = 29,
    /// Give an axis another id, by the chip that it belongs to.
    Assign = 30,
}

/// One axis on a bus, 1 to 63.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AxisId(u8);

impl AxisId {
    /// An axis id; `None` for 0 and for more than 63.
    pub const fn new(id: u8) -> Option<Self> {
        if id >= 1 && id <= LAST_AXIS {
            Some(Self(id))
        } else {
            None
        }
    }

    /// The id as a number.
    pub const fn get(self) -> u8 {
        self.0
    }
}

impl fmt::Display for AxisId {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.0, formatter)
    }
}

/// Whom a command is for, or which axis a report is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Address {
    /// Every axis on the bus.
    All,
    /// One axis.
    Axis(AxisId),
}

impl Address {
    /// Whether `axis` is meant.
    pub fn includes(self, axis: AxisId) -> bool {
        match self {
            Self::All => true,
            Self::Axis(only) => only == axis,
        }
    }

    /// The id of a frame of `function` to or from this address.
    pub fn frame_id(self, function: Function) -> u16 {
        let axis = match self {
            Self::All => 0,
            Self::Axis(axis) => axis.get(),
        };
        (u16::from(u8::from(function)) << AXIS_BITS) | u16::from(axis)
    }
}

impl From<AxisId> for Address {
    fn from(axis: AxisId) -> Self {
        Self::Axis(axis)
    }
}

/// Takes a frame's id apart; `None` where no function has the upper bits.
pub fn split(id: u16) -> Option<(Function, Address)> {
    let function = Function::try_from(u8::try_from(id >> AXIS_BITS).ok()?).ok()?;
    let axis = (id & u16::from(LAST_AXIS)) as u8;
    Some((
        function,
        AxisId::new(axis).map_or(Address::All, Address::Axis),
    ))
}
