//! The wire protocol: bytes to meaning and back. `docs/protocol.md` is the same for people.
//!
//! Classic CAN with 11-bit ids: `id = function << 6 | axis`, axis 1 to 63, 0 for all. A lower
//! function wins the bus. Every field of every frame stands once, in [`layout`]; the codec reads
//! and writes by that table, and the DBC and the documents are checked against it.
//!
//! | file | what it holds |
//! |---|---|
//! | `frame` | a CAN frame |
//! | `id` | functions and axis ids |
//! | `layout` | the table of frames and fields |
//! | `form`, `place` | what of it a device needs: who sends a frame, and where its fields lie |
//! | `command` | what a host says |
//! | `report` | what an axis says |
//! | `reason` | why a command was refused |
//! | `slcan` | frames as ASCII lines, for serial adapters |

pub mod command;
pub mod form;
pub mod frame;
pub mod id;
pub mod layout;
pub mod place;
pub mod reason;
pub mod report;
pub mod slcan;

use core::fmt;
use id::Function;

/// The protocol's version: another major number is another protocol, a greater minor number only
/// adds to it.
pub const PROTOCOL_VERSION: ProtocolVersion = ProtocolVersion { major: 1, minor: 2 };

/// A version of the protocol.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProtocolVersion {
    /// Differs where two cannot talk to each other.
    pub major: u8,
    /// Grows with each addition.
    pub minor: u8,
}

/// Why a frame has no meaning here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DecodeError {
    /// Nothing in this version has this function.
    UnknownFunction {
        /// The frame's id.
        id: u16,
    },
    /// The function is known, but not with this many bytes.
    Length {
        /// The frame's function.
        function: Function,
        /// How many bytes it has.
        length: usize,
        /// How many bytes it should have.
        expected: usize,
    },
    /// A field holds a value that means nothing.
    Value {
        /// The frame's function.
        function: Function,
        /// The field's name.
        field: &'static str,
        /// Its value.
        value: u64,
    },
    /// The function goes to one axis, but the frame is to all; or the other way round.
    Address {
        /// The frame's function.
        function: Function,
    },
}

impl fmt::Display for DecodeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownFunction { id } => {
                write!(formatter, "frame id {id:#05x} has no known function")
            }
            Self::Length {
                function,
                length,
                expected,
            } => write!(
                formatter,
                "{function:?} must have {expected} bytes, but has {length}"
            ),
            Self::Value {
                function,
                field,
                value,
            } => write!(
                formatter,
                "{function:?} has no meaning for {field} = {value}"
            ),
            Self::Address { function } => {
                write!(
                    formatter,
                    "{function:?} is sent to the wrong kind of address"
                )
            }
        }
    }
}

impl core::error::Error for DecodeError {}

/// A value that its field on the wire cannot carry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FieldError {
    /// The frame's function.
    pub function: Function,
    /// The field's name.
    pub field: &'static str,
    /// The raw value that was refused.
    pub value: i64,
    /// The least raw value.
    pub minimum: i64,
    /// The greatest raw value.
    pub maximum: i64,
}

impl fmt::Display for FieldError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "{} of {:?} must be from {} to {}, but is {}",
            self.field, self.function, self.minimum, self.maximum, self.value
        )
    }
}

impl core::error::Error for FieldError {}
