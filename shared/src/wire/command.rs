//! What a host says to the axes.

mod codec;

use super::id::Function;
use super::layout::{
    ACCELERATION_SHIFT, JERK_SHIFT, POSITION_SHIFT, VELOCITY_LIMIT_SHIFT, VELOCITY_SHIFT,
};
use crate::time::{BusTime, Tick, Ticks};
use crate::units::{Acceleration, Jerk, Position, Velocity};
pub(super) use codec::open;
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
    /// Keep the parameters of all axes of the node over a loss of power.
    Save = 6,
    /// Set the axis's parameters to their defaults, which is not saved yet.
    Restore = 7,
    /// Let the session change parameters, until it enables the axis or gives it back.
    Configure = 8,
}

impl Action {
    /// Every action, in the order of their codes.
    pub const ALL: [Self; 8] = [
        Self::Hold,
        Self::Release,
        Self::Enable,
        Self::Disable,
        Self::Clear,
        Self::Save,
        Self::Restore,
        Self::Configure,
    ];
}

/// What is asked about a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, IntoPrimitive, TryFromPrimitive)]
#[repr(u8)]
pub enum Item {
    /// Its value now.
    Value = 0,
    /// The value that it will have after a loss of power.
    Saved = 1,
    /// The least value that is accepted.
    Minimum = 2,
    /// The greatest value that is accepted.
    Maximum = 3,
    /// The value that it has until it is changed.
    Default = 4,
}

impl Item {
    /// Every item, in the order of their codes.
    pub const ALL: [Self; 5] = [
        Self::Value,
        Self::Saved,
        Self::Minimum,
        Self::Maximum,
        Self::Default,
    ];
}

/// One of the three frames that give an axis another id. A node takes the third only after both
/// others have named its own chip, with no other part between.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AssignPart {
    /// The first six bytes of the chip's id.
    ChipFirst([u8; 6]),
    /// The last six bytes of the chip's id.
    ChipLast([u8; 6]),
    /// What to change.
    Axis {
        /// The axis's id until now, as a number.
        axis: u8,
        /// Its id from now on, as a number.
        new_axis: u8,
        /// Comes back in the answer, which is from the new id.
        sequence: u8,
    },
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
    /// Begin a stream of knots, from rest.
    StreamBegin {
        /// The tick to leave at; the place of the axis then counts as the first knot.
        start: Tick,
        /// Ticks from knot to knot, not 0.
        period: u8,
        /// The number of that first knot, 0 to 63.
        number: u8,
        /// The command's number.
        sequence: u8,
    },
    /// The next knot of the stream.
    Knot {
        /// Where to be.
        position: Position,
        /// How fast to pass through there.
        velocity: Velocity,
        /// Its number, 0 to 63, one more than that of the knot before; 0 follows 63.
        number: u8,
    },
    /// What is a parameter's value?
    ParameterRead {
        /// The parameter's number.
        parameter: u8,
        /// What is asked about it.
        item: Item,
    },
    /// Change a parameter.
    ParameterWrite {
        /// The parameter's number.
        parameter: u8,
        /// Its raw value.
        value: i64,
        /// The command's number.
        sequence: u8,
    },
    /// Give an axis another id.
    Assign(AssignPart),
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

pub(in crate::wire) const fn wire_steps(position: Position) -> i64 {
    let half = 1 << (POSITION_SHIFT - 1);
    position.counts().saturating_add(half) >> POSITION_SHIFT
}

/// The nearest velocity that a knot and feedback can carry, so that nothing at rest seems to creep.
pub const fn wire_velocity(velocity: Velocity) -> Velocity {
    Velocity::from_counts(wire_velocity_steps(velocity) << VELOCITY_SHIFT)
}

pub(in crate::wire) const fn wire_velocity_steps(velocity: Velocity) -> i64 {
    let half = 1 << (VELOCITY_SHIFT - 1);
    velocity.counts().saturating_add(half) >> VELOCITY_SHIFT
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
            Self::StreamBegin { .. } => Function::StreamBegin,
            Self::Knot { .. } => Function::Knot,
            Self::ParameterRead { .. } => Function::ParameterRead,
            Self::ParameterWrite { .. } => Function::ParameterWrite,
            Self::Assign(_) => Function::Assign,
            Self::IdentityRequest => Function::IdentityRequest,
        }
    }
}
