//! What the parameters mean: the one place where raw values become limits, times and reactions.

use super::drive;
use super::table::Parameter;
use super::values::{ParameterError, Values};
use crate::limits::{LimitValues, Limits};
use crate::motion::shaping::{ShaperKind, Shaping};
use crate::time::Ticks;
use crate::units::{COUNTS_PER_RADIAN, Position, Velocity, whole};
use num_enum::{IntoPrimitive, TryFromPrimitive};

/// How an axis comes to rest when something has gone wrong; the harder the greater.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, IntoPrimitive, TryFromPrimitive,
)]
#[repr(u8)]
pub enum Reaction {
    /// As quickly as the limits allow, jerk among them.
    ControlledStop = 0,
    /// With the deceleration limit at once, whatever the jerk.
    QuickStop = 1,
    /// Not at all: torque is taken away.
    Disable = 2,
}

/// The reaction to each kind of trouble that leaves a choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reactions {
    /// A silent host.
    pub host: Reaction,
    /// A stream that has run dry.
    pub stream: Reaction,
    /// A drive that does not do what it is told.
    pub following: Reaction,
    /// A bus that failed, or another node with the same id.
    pub bus: Reaction,
}

/// What an axis is set to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// What the axis may do.
    ///
    /// Its travel is that of the parameters, or as much of it as the drive can be told.
    pub limits: Limits,
    /// Silence of the holding session after which the axis stops.
    pub host_timeout: Ticks,
    /// What is done about trouble.
    pub reactions: Reactions,
    /// How far the drive may be from its setpoint and outside the travel; `None` does not watch.
    pub following_error: Option<Position>,
    /// How long the drive may be farther away than that.
    pub following_time: Ticks,
    /// The speed that the drive may not pass; `None` does not watch.
    pub overspeed: Option<Velocity>,
    /// What the setpoints are shaped for, if anything.
    pub shaping: Option<Shaping>,
    /// Ticks between two feedback frames.
    pub feedback_period: Ticks,
    /// Ticks between two heartbeats.
    pub heartbeat_period: Ticks,
}

impl Settings {
    /// What values mean that have been looked at already.
    pub(super) fn of_valid(values: &Values) -> Self {
        // They do not contradict each other, so the other arm is never taken.
        Self::of(values, Parameter::PositionMinimum)
            .unwrap_or_else(|_| Self::assemble(values, Limits::default(), None))
    }

    /// What `values` mean, where `changed` is the one that may contradict the others.
    pub(super) fn of(values: &Values, changed: Parameter) -> Result<Self, ParameterError> {
        let limits = limits_of(values, changed)?;
        let shaping = shaping_of(values, changed)?;
        drive::node_fits(values, changed)?;
        Ok(Self::assemble(values, limits, shaping))
    }

    /// The same where these settings are what the values meant before `changed` was: without an f64
    /// unit each number takes hundreds of instructions, and most have not changed.
    pub(super) fn after(
        &self,
        values: &Values,
        changed: Parameter,
    ) -> Result<Self, ParameterError> {
        let (mut limits, mut shaping) = (self.limits, self.shaping);
        match changed {
            Parameter::VelocityLimit
            | Parameter::AccelerationLimit
            | Parameter::DecelerationLimit
            | Parameter::JerkLimit
            | Parameter::PositionMinimum
            | Parameter::PositionMaximum => limits = limits_of(values, changed)?,
            Parameter::ShaperKind | Parameter::ShaperFrequency | Parameter::ShaperDamping => {
                shaping = shaping_of(values, changed)?;
            }
            Parameter::DriveKind | Parameter::DriveNode | Parameter::MitMaster => {
                limits = limits_of(values, changed)?;
                drive::node_fits(values, changed)?;
            }
            Parameter::GearRatio
            | Parameter::DriveOffset
            | Parameter::MitModel
            | Parameter::MitPosition
            | Parameter::DriveIncrements => limits = limits_of(values, changed)?,
            _ => {}
        }
        Ok(Self::assemble(values, limits, shaping))
    }

    /// All that no other value can contradict.
    fn assemble(values: &Values, limits: Limits, shaping: Option<Shaping>) -> Self {
        let ticks = |parameter| Ticks(values.get(parameter) as u32);
        let reaction = |parameter| {
            Reaction::try_from(values.get(parameter) as u8).unwrap_or(Reaction::ControlledStop)
        };
        // Zero is not watched.
        let watched = |parameter: Parameter| {
            let radians = parameter.in_unit(values.get(parameter));
            (radians > 0.0).then(|| whole(radians * COUNTS_PER_RADIAN))
        };
        Self {
            limits,
            host_timeout: ticks(Parameter::HostTimeout),
            reactions: Reactions {
                host: reaction(Parameter::HostReaction),
                stream: reaction(Parameter::StreamReaction),
                following: reaction(Parameter::FollowingReaction),
                bus: reaction(Parameter::BusReaction),
            },
            following_error: watched(Parameter::FollowingError).map(Position::from_counts),
            following_time: ticks(Parameter::FollowingTime),
            overspeed: watched(Parameter::OverspeedMargin)
                .map(|margin| limits.velocity() + Velocity::from_counts(margin)),
            shaping,
            feedback_period: ticks(Parameter::FeedbackPeriod),
            heartbeat_period: ticks(Parameter::HeartbeatPeriod),
        }
    }
}

fn in_unit(values: &Values, parameter: Parameter) -> f64 {
    parameter.in_unit(values.get(parameter))
}

fn limits_of(values: &Values, changed: Parameter) -> Result<Limits, ParameterError> {
    let number = |parameter| in_unit(values, parameter);
    let (mut least, mut greatest) = (
        number(Parameter::PositionMinimum),
        number(Parameter::PositionMaximum),
    );
    // Where the drive cannot be told to go the axis does not go either.
    if let Some((from, to)) = drive::reach(values) {
        (least, greatest) = (least.max(from), greatest.min(to));
    }
    Limits::new(&LimitValues {
        velocity: number(Parameter::VelocityLimit),
        acceleration: number(Parameter::AccelerationLimit),
        deceleration: number(Parameter::DecelerationLimit),
        jerk: number(Parameter::JerkLimit),
        position_minimum: least,
        position_maximum: greatest,
    })
    // Each is in its range, so only the travel's ends can be the wrong way round.
    .map_err(|_| ParameterError::Contradiction {
        parameter: changed,
        other: match changed {
            Parameter::PositionMinimum => Parameter::PositionMaximum,
            _ => Parameter::PositionMinimum,
        },
    })
}

fn shaping_of(values: &Values, changed: Parameter) -> Result<Option<Shaping>, ParameterError> {
    let kind = match values.get(Parameter::ShaperKind) {
        1 => ShaperKind::Zv,
        2 => ShaperKind::Zvd,
        3 => ShaperKind::Ei,
        _ => return Ok(None),
    };
    let frequency = in_unit(values, Parameter::ShaperFrequency);
    Shaping::new(kind, frequency, in_unit(values, Parameter::ShaperDamping))
        .map(Some)
        // A frequency so low that the kind needs a longer memory than there is.
        .map_err(|_| ParameterError::Contradiction {
            parameter: changed,
            other: match changed {
                Parameter::ShaperKind => Parameter::ShaperFrequency,
                _ => Parameter::ShaperKind,
            },
        })
}
