//! What can go wrong between a host and its axes.

use super::assign::ChipId;
use crate::bus::BusError;
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::limits::LimitError;
use canter_shared::parameter::{Parameter, ParameterError};
use canter_shared::units::UnitError;
use canter_shared::wire::FieldError;
use canter_shared::wire::id::{AxisId, Function};
use canter_shared::wire::reason::Reason;

/// What went wrong, where, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// An axis does not answer.
    #[error("axis {axis} does not answer on {bus}: `canter scan` lists the axes that do")]
    NoAnswer {
        /// Which axis.
        axis: AxisId,
        /// On which bus.
        bus: String,
    },
    /// Nobody is on the bus.
    #[error(
        "no axis was heard on {bus}: check its power, wiring and bit rate, or start one with `canter node`"
    )]
    NobodyThere {
        /// Which bus.
        bus: String,
    },
    /// An axis refused a command.
    #[error("axis {axis} refused {function:?}: {}", refusal(*.reason, *.detail))]
    Refused {
        /// Which axis.
        axis: AxisId,
        /// Which command.
        function: Function,
        /// Why.
        reason: Reason,
        /// What the reason's table says.
        detail: u32,
    },
    /// The bus loses so many knots that a stream is not safe.
    #[error(
        "axis {axis} lost {lost} of its last {of} knots: check the bus's wiring, termination and bit rate, and who else sends on it"
    )]
    Lossy {
        /// Which axis.
        axis: AxisId,
        /// How many were lost.
        lost: u64,
        /// Of how many.
        of: u64,
    },
    /// An axis is not enabled.
    #[error(
        "axis {axis} is not enabled ({state}): run `canter enable {axis}` first, or add --enable"
    )]
    NotEnabled {
        /// Which axis.
        axis: AxisId,
        /// What it is instead.
        state: State,
    },
    /// An axis has a fault.
    #[error("axis {axis} has the fault {}: {}; {}", .fault.name(), .fault.cause(), .fault.cure())]
    Faulted {
        /// Which axis.
        axis: AxisId,
        /// Which fault.
        fault: Fault,
    },
    /// An axis did not do in time what it was told to.
    #[error("axis {axis} did not {what} within {seconds} s")]
    TooSlow {
        /// Which axis.
        axis: AxisId,
        /// What it was to do.
        what: &'static str,
        /// How long it was given.
        seconds: f64,
    },
    /// An axis was stopped on the way by somebody.
    #[error(
        "axis {axis} came to rest at {position} rad instead of {target} rad: it was stopped on the way"
    )]
    StoppedShort {
        /// Which axis.
        axis: AxisId,
        /// Where it rests.
        position: f64,
        /// Where it should.
        target: f64,
    },
    /// A node speaks another protocol.
    #[error("axis {axis} speaks protocol {theirs}, this host {ours}: update the older of the two")]
    Protocol {
        /// Which axis.
        axis: AxisId,
        /// The node's major version.
        theirs: u8,
        /// The host's.
        ours: u8,
    },
    /// Two nodes answer for one axis.
    #[error("two nodes answer as axis {axis}: moving one would move both; give one another id")]
    Doubled {
        /// The id that both have.
        axis: AxisId,
    },
    /// A target is outside the travel.
    #[error(
        "target {target} rad of axis {axis} is outside its travel of {minimum} to {maximum} rad"
    )]
    OutsideTravel {
        /// Which axis.
        axis: AxisId,
        /// What was asked for, in rad.
        target: f64,
        /// The least position in rad.
        minimum: f64,
        /// The greatest position in rad.
        maximum: f64,
    },
    /// A limit that was asked for is less than the least that the wire can tell an axis.
    #[error(
        "{field} of {value} {unit} for axis {axis} is too small for the wire: choose at least {least:.3} {unit}"
    )]
    BelowStep {
        /// Which axis.
        axis: AxisId,
        /// The flag.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The least value.
        least: f64,
        /// The unit of both.
        unit: &'static str,
    },
    /// A limit that was asked for is above the axis's own.
    #[error(
        "{field} of {value} is above the limit of axis {axis}, {limit}: choose {limit} or less"
    )]
    AboveLimit {
        /// Which axis.
        axis: AxisId,
        /// Which limit.
        field: &'static str,
        /// What was asked for.
        value: f64,
        /// What the axis allows.
        limit: f64,
    },
    /// The chosen duration is too short.
    #[error(
        "a duration of {asked} s is too short for axis {axis}: its limits allow {shortest} s or more"
    )]
    TooShort {
        /// Which axis.
        axis: AxisId,
        /// What was asked for, in s.
        asked: f64,
        /// The least that its limits allow, in s.
        shortest: f64,
    },
    /// The move would take too long.
    #[error("the move of axis {axis} would last longer than 4194 s: raise the limits or move less")]
    TooLong {
        /// Which axis.
        axis: AxisId,
    },
    /// A move without any axis.
    #[error("no axis to move: name at least one as AXIS=POSITION")]
    NoGoals,
    /// A stream with too few or too many knots in one period.
    #[error("{knots} knots in one period for {axes} axes: give each axis one")]
    KnotCount {
        /// How many axes are led.
        axes: usize,
        /// How many knots there were.
        knots: usize,
    },
    /// A stream whose last knot moves.
    #[error(
        "the knots of axis {axis} end in motion, so the axes were stopped: end a stream at rest"
    )]
    EndsInMotion {
        /// Which axis.
        axis: AxisId,
    },
    /// A limit is out of range.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// A value is outside a parameter's range, or contradicts another one.
    #[error("axis {axis}: {source}")]
    Parameter {
        /// Which axis.
        axis: AxisId,
        /// Which parameter, and its range.
        source: ParameterError,
    },
    /// A parameter may not change now.
    #[error(
        "{} of axis {axis} changes only while the axis is disabled, and it is {state}: \
         run `canter disable {axis}` first", .parameter.entry().name
    )]
    ChangesDisabled {
        /// Which axis.
        axis: AxisId,
        /// Which parameter.
        parameter: Parameter,
        /// What the axis is instead.
        state: State,
    },
    /// No node of that chip answers.
    #[error("no node with the chip {chip} answers on {bus}: `canter scan` lists the chips that do")]
    NoChip {
        /// Which chip.
        chip: ChipId,
        /// On which bus.
        bus: String,
    },
    /// A chip has several axes.
    #[error("the chip {chip} has the axes {axes}: say which one, as {chip}/OLD=NEW")]
    WhichAxis {
        /// Which chip.
        chip: ChipId,
        /// Its axes.
        axes: String,
    },
    /// An id is in use.
    #[error("axis {axis} is there already: choose an id that `canter scan` does not list")]
    IdInUse {
        /// The id.
        axis: AxisId,
    },
    /// A quantity is out of range.
    #[error("axis {axis}: {source}")]
    Quantity {
        /// Which axis.
        axis: AxisId,
        /// Which quantity, and its range.
        source: UnitError,
    },
    /// A value does not fit its frame.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// The person at the terminal ended it.
    #[error("interrupted; the axes were stopped")]
    Interrupted,
}

fn refusal(reason: Reason, detail: u32) -> String {
    let meaning = reason.meaning();
    let cure = reason.cure();
    match reason {
        Reason::NotHeld => String::from(
            "no session holds the axis: the heartbeats of this host came too late for it, so see \
             that host and bus are not overloaded, and try again",
        ),
        Reason::HeldByOther => format!("session {detail:#06x} holds the axis; {cure}"),
        Reason::FaultLatched => match Fault::try_from(detail as u8) {
            Ok(fault) => format!("the fault {} is latched; {}", fault.name(), fault.cure()),
            Err(_) => format!("{meaning}; {cure}"),
        },
        Reason::OutOfRange | Reason::UnknownParameter => match Parameter::try_from(detail as u8) {
            Ok(parameter) => format!("{}: {meaning}; {cure}", parameter.entry().name),
            Err(_) => format!("{meaning}; {cure}"),
        },
        Reason::NotDisabled => match State::try_from(detail as u8) {
            Ok(state) => {
                format!("{meaning}, and it or another axis of its node is {state}; {cure}")
            }
            Err(_) => format!("{meaning}; {cure}"),
        },
        Reason::TooFast => format!("{meaning}; allow {} s or more", f64::from(detail) / 1e3),
        Reason::TooLate => format!("the start was {detail} ms ago; {cure}"),
        _ => format!("{meaning}; {cure}"),
    }
}
