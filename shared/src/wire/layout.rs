//! The table of frames: every field of every frame, once.
//!
//! A payload is one little-endian word; a field is `bits` of it from `start` on. The value that
//! is meant is `raw * factor` in `unit`.

use super::id::Function;
use super::place::Place;
use crate::units::Position;

/// The values that a field's numbers have names for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choices {
    /// Plain numbers.
    None,
    /// [`super::command::Action`].
    Action,
    /// The CiA 402 state of an axis.
    State,
    /// The faults of an axis.
    Fault,
    /// [`super::reason::Reason`].
    Reason,
    /// [`Function`].
    Function,
    /// [`super::report::Board`].
    Board,
    /// [`crate::parameter::Parameter`].
    Parameter,
    /// [`super::command::Item`].
    Item,
}

/// Who sends a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sender {
    /// The host to the nodes.
    Host,
    /// A node to everybody.
    Node,
}

/// Which addresses a frame may carry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Addressing {
    /// 0 only.
    All,
    /// 1 to 63.
    One,
    /// 0 to 63.
    Any,
}

/// A field: where it lies and what it means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// Its name, unique in its frame.
    pub name: &'static str,
    /// The least significant bit's place in the payload.
    pub start: u32,
    /// Its width in bits, 1 to 63.
    pub bits: u32,
    /// Whether it is a two's complement number.
    pub signed: bool,
    /// What one means, in `unit`.
    pub factor: f64,
    /// The unit; empty for plain numbers.
    pub unit: &'static str,
    /// Names of its values.
    pub choices: Choices,
    /// Which value of the frame's first field this one belongs to; `None` where it is always there.
    pub part: Option<u8>,
}

/// A frame: its function and its fields.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layout {
    /// What it is for.
    pub function: Function,
    /// Who sends it.
    pub sender: Sender,
    /// Which addresses it may carry.
    pub addressing: Addressing,
    /// Bytes of payload: as many as the fields need.
    pub length: u8,
    /// The fields in the order of their bits.
    pub fields: &'static [Field],
}

impl Field {
    const fn unsigned(name: &'static str, start: u32, bits: u32) -> Self {
        Self {
            name,
            start,
            bits,
            signed: false,
            factor: 1.0,
            unit: "",
            choices: Choices::None,
            part: None,
        }
    }

    const fn signed(mut self) -> Self {
        self.signed = true;
        self
    }

    const fn unit(mut self, factor: f64, unit: &'static str) -> Self {
        self.factor = factor;
        self.unit = unit;
        self
    }

    const fn choices(mut self, choices: Choices) -> Self {
        self.choices = choices;
        self
    }

    const fn part(mut self, part: u8) -> Self {
        self.part = Some(part);
        self
    }

    /// Where it lies.
    #[inline(always)]
    pub const fn place(&self) -> Place {
        Place {
            start: self.start as u8,
            bits: self.bits as u8,
            signed: self.signed,
        }
    }

    /// The least and greatest raw value.
    #[inline(always)]
    pub const fn range(&self) -> (i64, i64) {
        self.place().range()
    }

    /// The raw value in a payload.
    #[inline(always)]
    pub const fn get(&self, word: u64) -> i64 {
        self.place().get(word)
    }

    /// The payload with this field set; a raw value out of range is cut to its nearer end.
    #[inline(always)]
    pub fn put(&self, word: u64, raw: i64) -> u64 {
        self.place().put(word, raw)
    }
}

/// Positions on the wire are in steps of 2^-23 turn (0.75 microrad): 34 bits hold +-1024 turns.
pub const POSITION_FACTOR: f64 = 1.0 / (1u64 << 23) as f64;
/// Bits that a position in counts of 2^-32 turn loses on the wire.
pub const POSITION_SHIFT: u32 = 32 - 23;
/// One step of a position on the wire.
pub const POSITION_STEP: Position = Position::from_counts(1 << POSITION_SHIFT);
/// Velocities on the wire are in steps of 2^-14 turn/s (0.38 mrad/s): 24 bits hold +-512 turn/s.
pub const VELOCITY_FACTOR: f64 = 1.0 / (1u64 << 14) as f64;
/// Bits that a velocity in counts/s loses on the wire.
pub const VELOCITY_SHIFT: u32 = 32 - 14;

/// Accelerations on the wire are in steps of 2^-10 turn/s^2 (6.1 mrad/s^2): 28 bits hold 2^18 turn/s^2.
pub const ACCELERATION_FACTOR: f64 = 1.0 / (1u64 << 10) as f64;
/// Bits that an acceleration in counts/s^2 loses on the wire.
pub const ACCELERATION_SHIFT: u32 = 32 - 10;
/// Velocity limits on the wire are in steps of 2^-13 turn/s (0.77 mrad/s): 24 bits hold 2048 turn/s.
pub const VELOCITY_LIMIT_FACTOR: f64 = 1.0 / (1u64 << 13) as f64;
/// Bits that a velocity limit in counts/s loses on the wire.
pub const VELOCITY_LIMIT_SHIFT: u32 = 32 - 13;
/// Jerks on the wire are in steps of 2^-4 turn/s^3 (0.39 rad/s^3): 32 bits hold 2^28 turn/s^3.
pub const JERK_FACTOR: f64 = 1.0 / (1u64 << 4) as f64;
/// Bits that a jerk in counts/s^3 loses on the wire.
pub const JERK_SHIFT: u32 = 32 - 4;

const TICK: f64 = 1e-3;
const MICROSECOND: f64 = 1e-6;

macro_rules! fields {
    ($($(#[$doc:meta])* $module:ident { $($field:ident = $value:expr;)* })*) => {
        $($(#[$doc])* pub mod $module {
            #![allow(missing_docs, reason = "a field's name and unit are in its value")]
            use super::*;
            $(pub const $field: Field = $value;)*
            /// All of them.
            pub const FIELDS: &[Field] = &[$($field),*];
        })*
    };
}

fields! {
    /// SYNC.
    sync {
        COUNTER = Field::unsigned("counter", 0, 8);
        TIME = Field::unsigned("time", 8, 56).unit(MICROSECOND, "s");
    }
    /// Trigger.
    trigger {
        GROUP = Field::unsigned("group", 0, 8);
        SESSION = Field::unsigned("session", 8, 16);
        START = Field::unsigned("start", 24, 40).unit(TICK, "s");
    }
    /// Knot.
    knot {
        POSITION = Field::unsigned("position", 0, 34).signed().unit(POSITION_FACTOR, "turn");
        VELOCITY = Field::unsigned("velocity", 34, 24).signed().unit(VELOCITY_FACTOR, "turn/s");
        NUMBER = Field::unsigned("number", 58, 6);
    }
    /// Stop.
    stop {
        SEQUENCE = Field::unsigned("sequence", 0, 8);
    }
    /// Host heartbeat.
    host_heartbeat {
        SESSION = Field::unsigned("session", 0, 16);
    }
    /// Control.
    control {
        ACTION = Field::unsigned("action", 0, 8).choices(Choices::Action);
        SEQUENCE = Field::unsigned("sequence", 8, 8);
        SESSION = Field::unsigned("session", 16, 16);
    }
    /// Trapezoid shape.
    trapezoid_shape {
        ACCELERATION = Field::unsigned("acceleration", 0, 22).unit(TICK, "s");
        DECELERATION = Field::unsigned("deceleration", 22, 22).unit(TICK, "s");
        SEQUENCE = Field::unsigned("sequence", 56, 8);
    }
    /// Ramp limits.
    ramp_limits {
        ACCELERATION = Field::unsigned("acceleration", 0, 28).unit(ACCELERATION_FACTOR, "turn/s^2");
        DECELERATION = Field::unsigned("deceleration", 28, 28).unit(ACCELERATION_FACTOR, "turn/s^2");
        SEQUENCE = Field::unsigned("sequence", 56, 8);
    }
    /// Peak limits.
    peak_limits {
        VELOCITY = Field::unsigned("velocity", 0, 24).unit(VELOCITY_LIMIT_FACTOR, "turn/s");
        JERK = Field::unsigned("jerk", 24, 32).unit(JERK_FACTOR, "turn/s^3");
        SEQUENCE = Field::unsigned("sequence", 56, 8);
    }
    /// Every plain move, at once or staged.
    plain_move {
        TARGET = Field::unsigned("target", 0, 34).signed().unit(POSITION_FACTOR, "turn");
        DURATION = Field::unsigned("duration", 34, 22).unit(TICK, "s");
        SEQUENCE = Field::unsigned("sequence", 56, 8);
    }
    /// Acknowledgement.
    acknowledgement {
        SEQUENCE = Field::unsigned("sequence", 0, 8);
        FUNCTION = Field::unsigned("function", 8, 8).choices(Choices::Function);
        REASON = Field::unsigned("reason", 16, 8).choices(Choices::Reason);
        DETAIL = Field::unsigned("detail", 24, 32);
    }
    /// Started.
    started {
        SEQUENCE = Field::unsigned("sequence", 0, 8);
        TIME = Field::unsigned("time", 8, 56).unit(MICROSECOND, "s");
    }
    /// Fault.
    fault {
        FAULT = Field::unsigned("fault", 0, 8).choices(Choices::Fault);
        TIME = Field::unsigned("time", 8, 56).unit(MICROSECOND, "s");
    }
    /// Stream begin.
    stream_begin {
        START = Field::unsigned("start", 0, 40).unit(TICK, "s");
        PERIOD = Field::unsigned("period", 40, 8).unit(TICK, "s");
        NUMBER = Field::unsigned("number", 48, 6);
        SEQUENCE = Field::unsigned("sequence", 56, 8);
    }
    /// Feedback.
    feedback {
        POSITION = Field::unsigned("position", 0, 34).signed().unit(POSITION_FACTOR, "turn");
        VELOCITY = Field::unsigned("velocity", 34, 24).signed().unit(VELOCITY_FACTOR, "turn/s");
        STATE = Field::unsigned("state", 58, 4).choices(Choices::State);
        MOVING = Field::unsigned("moving", 62, 1);
        TARGET_REACHED = Field::unsigned("target_reached", 63, 1);
    }
    /// Heartbeat.
    heartbeat {
        STATE = Field::unsigned("state", 0, 8).choices(Choices::State);
        FAULT = Field::unsigned("fault", 8, 8).choices(Choices::Fault);
        SESSION = Field::unsigned("session", 16, 16);
        BUS_OFF = Field::unsigned("bus_off", 32, 8);
        ERROR_FRAMES = Field::unsigned("error_frames", 40, 8);
        LOST = Field::unsigned("lost", 48, 8);
        REJECTED = Field::unsigned("rejected", 56, 8);
    }
    /// Parameter read.
    parameter_read {
        PARAMETER = Field::unsigned("parameter", 0, 8).choices(Choices::Parameter);
        ITEM = Field::unsigned("item", 8, 8).choices(Choices::Item);
    }
    /// Parameter write.
    parameter_write {
        PARAMETER = Field::unsigned("parameter", 0, 8).choices(Choices::Parameter);
        VALUE = Field::unsigned("value", 8, 48).signed();
        SEQUENCE = Field::unsigned("sequence", 56, 8);
    }
    /// Parameter.
    parameter {
        PARAMETER = Field::unsigned("parameter", 0, 8).choices(Choices::Parameter);
        ITEM = Field::unsigned("item", 8, 8).choices(Choices::Item);
        VALUE = Field::unsigned("value", 16, 48).signed();
    }
    /// Identity: three frames told apart by their part.
    identity {
        PART = Field::unsigned("part", 0, 8);
        PROTOCOL_MAJOR = Field::unsigned("protocol_major", 8, 8).part(0);
        PROTOCOL_MINOR = Field::unsigned("protocol_minor", 16, 8).part(0);
        BOARD = Field::unsigned("board", 24, 8).part(0).choices(Choices::Board);
        FIRMWARE_MAJOR = Field::unsigned("firmware_major", 32, 8).part(0);
        FIRMWARE_MINOR = Field::unsigned("firmware_minor", 40, 8).part(0);
        FIRMWARE_PATCH = Field::unsigned("firmware_patch", 48, 8).part(0);
        CHIP_FIRST = Field::unsigned("chip_first", 8, 48).part(1);
        CHIP_LAST = Field::unsigned("chip_last", 8, 48).part(2);
    }
    /// Assign: three frames told apart by their part.
    assign {
        PART = Field::unsigned("part", 0, 8);
        CHIP_FIRST = Field::unsigned("chip_first", 8, 48).part(0);
        CHIP_LAST = Field::unsigned("chip_last", 8, 48).part(1);
        AXIS = Field::unsigned("axis", 8, 8).part(2);
        NEW_AXIS = Field::unsigned("new_axis", 16, 8).part(2);
        SEQUENCE = Field::unsigned("sequence", 24, 8).part(2);
    }
}

const fn layout(
    function: Function,
    sender: Sender,
    addressing: Addressing,
    fields: &'static [Field],
) -> Layout {
    let mut bits = 0;
    let mut index = 0;
    while index < fields.len() {
        let end = fields[index].start + fields[index].bits;
        if end > bits {
            bits = end;
        }
        index += 1;
    }
    Layout {
        function,
        sender,
        addressing,
        length: bits.div_ceil(8) as u8,
        fields,
    }
}

/// Every frame of the protocol, in the order of priority.
pub const LAYOUTS: [Layout; 28] = {
    use Addressing::{All, Any, One};
    use Sender::{Host, Node};
    [
        layout(Function::EmergencyStop, Host, Any, &[]),
        layout(Function::Sync, Host, All, sync::FIELDS),
        layout(Function::Trigger, Host, All, trigger::FIELDS),
        layout(Function::Knot, Host, One, knot::FIELDS),
        layout(Function::Stop, Host, Any, stop::FIELDS),
        layout(Function::HostHeartbeat, Host, All, host_heartbeat::FIELDS),
        layout(Function::Control, Host, One, control::FIELDS),
        layout(Function::TrapezoidShape, Host, One, trapezoid_shape::FIELDS),
        layout(Function::MoveBeta, Host, One, plain_move::FIELDS),
        layout(Function::MoveTrapezoid, Host, One, plain_move::FIELDS),
        layout(Function::MoveSCurve, Host, One, plain_move::FIELDS),
        layout(Function::RampLimits, Host, One, ramp_limits::FIELDS),
        layout(Function::StageBeta, Host, One, plain_move::FIELDS),
        layout(Function::StageTrapezoid, Host, One, plain_move::FIELDS),
        layout(Function::StageSCurve, Host, One, plain_move::FIELDS),
        layout(Function::PeakLimits, Host, One, peak_limits::FIELDS),
        layout(
            Function::Acknowledgement,
            Node,
            One,
            acknowledgement::FIELDS,
        ),
        layout(Function::Started, Node, One, started::FIELDS),
        layout(Function::Fault, Node, One, fault::FIELDS),
        layout(Function::StreamBegin, Host, One, stream_begin::FIELDS),
        layout(Function::Feedback, Node, One, feedback::FIELDS),
        layout(Function::Heartbeat, Node, One, heartbeat::FIELDS),
        layout(Function::ParameterRead, Host, One, parameter_read::FIELDS),
        layout(Function::ParameterWrite, Host, One, parameter_write::FIELDS),
        layout(Function::Parameter, Node, One, parameter::FIELDS),
        layout(Function::IdentityRequest, Host, Any, &[]),
        layout(Function::Identity, Node, One, identity::FIELDS),
        layout(Function::Assign, Host, All, assign::FIELDS),
    ]
};

impl Layout {
    /// The layout of a function.
    pub fn of(function: Function) -> Option<&'static Self> {
        LAYOUTS.iter().find(|layout| layout.function == function)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_do_not_overlap_and_fit() {
        for layout in &LAYOUTS {
            for (index, field) in layout.fields.iter().enumerate() {
                assert!(field.start + field.bits <= 64);
                for other in &layout.fields[..index] {
                    let together =
                        field.part.is_none() || other.part.is_none() || field.part == other.part;
                    let apart = other.start + other.bits <= field.start;
                    assert!(apart || !together, "{:?} {}", layout.function, field.name);
                }
            }
        }
    }

    #[test]
    fn put_and_get_are_inverse_at_the_edges() {
        for field in LAYOUTS.iter().flat_map(|layout| layout.fields) {
            let (least, greatest) = field.range();
            for raw in [least, least + 1, 0, greatest - 1, greatest] {
                for background in [0, u64::MAX] {
                    assert_eq!(field.get(field.put(background, raw)), raw.max(least));
                }
            }
            assert_eq!(field.get(field.put(0, i64::MAX)), greatest);
            assert_eq!(field.get(field.put(0, i64::MIN)), least);
        }
    }
}
