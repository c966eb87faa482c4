//! Why a command was refused: the reason codes of acknowledgements, one table.

use num_enum::{IntoPrimitive, TryFromPrimitive};

/// The answer to a command, and what the acknowledgement's detail then says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, IntoPrimitive, TryFromPrimitive)]
#[repr(u8)]
pub enum Reason {
    /// Done, or begun. Detail of a move: ticks until it has arrived; of a staged one: its duration.
    Accepted = 0,
    /// No session holds the axis.
    NotHeld = 1,
    /// Another session holds the axis. Detail: that session.
    HeldByOther = 2,
    /// The axis is not enabled. Detail: its state.
    NotEnabled = 3,
    /// A fault is latched. Detail: its number.
    FaultLatched = 4,
    /// The target is outside the travel.
    OutsideTravel = 5,
    /// The duration is too short for the limits. Detail: the least duration in ticks.
    TooFast = 6,
    /// The move would last too long.
    TooLong = 7,
    /// The sequence number is not ahead of the last one. Detail: the last one.
    StaleSequence = 8,
    /// The start time of the trigger has passed. Detail: by how many ticks.
    TooLate = 9,
    /// The drive is lost or has a fault of its own.
    DriveNotReady = 10,
    /// Not while the axis moves.
    Moving = 11,
    /// A field holds a value that means nothing.
    BadValue = 12,
    /// A newer move took its place before it left. Detail: the newer number.
    Overtaken = 13,
    /// A stop called it off.
    Stopped = 14,
    /// No parameter has this number. Detail: that number.
    UnknownParameter = 15,
    /// The value is outside the parameter's range, or contradicts another one. Detail: the number
    /// of the parameter.
    OutOfRange = 16,
    /// Only while the axis is disabled. Detail: its state.
    NotDisabled = 17,
    /// The parameters could not be written; what was saved before is still there.
    SaveFailed = 18,
    /// No stream has begun, or it is over.
    NotStreaming = 19,
    /// The stream holds as many knots as it can. Detail: ticks until there is room.
    StreamFull = 20,
    /// More knots are missing than can be bridged. Detail: how many.
    KnotsMissing = 21,
    /// The curve to the knot would break the acceleration limit.
    TooStrong = 22,
    /// From the knot, no stop ends inside the travel.
    CannotStop = 23,
    /// Another axis of the node has this id, or no axis has the old one. Detail: that id.
    IdTaken = 24,
    /// The parameters are locked.
    Locked = 25,
}

impl Reason {
    /// Every reason, in the order of their codes.
    pub const ALL: [Self; 26] = [
        Self::Accepted,
        Self::NotHeld,
        Self::HeldByOther,
        Self::NotEnabled,
        Self::FaultLatched,
        Self::OutsideTravel,
        Self::TooFast,
        Self::TooLong,
        Self::StaleSequence,
        Self::TooLate,
        Self::DriveNotReady,
        Self::Moving,
        Self::BadValue,
        Self::Overtaken,
        Self::Stopped,
        Self::UnknownParameter,
        Self::OutOfRange,
        Self::NotDisabled,
        Self::SaveFailed,
        Self::NotStreaming,
        Self::StreamFull,
        Self::KnotsMissing,
        Self::TooStrong,
        Self::CannotStop,
        Self::IdTaken,
        Self::Locked,
    ];

    /// What it means, for a person; a host adds the axis and the detail.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Accepted => "accepted",
            Self::NotHeld => "no session holds the axis",
            Self::HeldByOther => "another session holds the axis",
            Self::NotEnabled => "the axis is not enabled",
            Self::FaultLatched => "a fault is latched",
            Self::OutsideTravel => "the target is outside the travel",
            Self::TooFast => "the duration is too short for the limits",
            Self::TooLong => "the move would last too long",
            Self::StaleSequence => "the sequence number is not ahead of the last one",
            Self::TooLate => "the start time has passed",
            Self::DriveNotReady => "the drive is lost or has a fault of its own",
            Self::Moving => "not while the axis moves",
            Self::BadValue => "a field holds a value that means nothing",
            Self::Overtaken => "a newer move took its place before it left",
            Self::Stopped => "a stop called it off",
            Self::UnknownParameter => "no parameter has this number",
            Self::OutOfRange => "the value is outside its range, or contradicts another parameter",
            Self::NotDisabled => "only while the axis is disabled",
            Self::SaveFailed => "the parameters could not be written",
            Self::NotStreaming => "no stream has begun, or it is over",
            Self::StreamFull => "the stream holds as many knots as it can",
            Self::KnotsMissing => "more knots are missing than can be bridged",
            Self::TooStrong => "the curve to the knot would break the acceleration limit",
            Self::CannotStop => "from the knot, no stop ends inside the travel",
            Self::IdTaken => "the node has no axis of the old id, or one of the new id",
            Self::Locked => "the parameters are locked",
        }
    }

    /// What to do about it.
    pub const fn cure(self) -> &'static str {
        match self {
            Self::Accepted => "",
            Self::NotHeld => "send hold first",
            Self::HeldByOther => "wait until that session releases it, or stop it",
            Self::NotEnabled => "enable it first",
            Self::FaultLatched => "clear the fault first",
            Self::OutsideTravel => "choose a target inside limits.position_min and position_max",
            Self::TooFast => "allow the least duration or more",
            Self::TooLong => "choose a shorter move or higher limits",
            Self::StaleSequence => "number commands upwards, or hold the axis again",
            Self::TooLate => "name a later start time",
            Self::DriveNotReady => {
                "see to its power and its bus; clear takes back a fault of its own"
            }
            Self::Moving => "stop the axis and wait until it rests",
            Self::BadValue => "see the protocol's table",
            Self::Overtaken => "wait for a move's answer before the next",
            Self::Stopped => "send it again if it is still wanted",
            Self::UnknownParameter => {
                "see the table of parameters, and the node's protocol version"
            }
            Self::OutOfRange => "read its minimum and maximum",
            Self::NotDisabled => "disable the axis first",
            Self::SaveFailed => "try again; if it stays so, the node's memory is worn out",
            Self::NotStreaming => "begin a stream first",
            Self::StreamFull => "send the knot again when there is room",
            Self::KnotsMissing => "send knots without gaps; begin again if too many were lost",
            Self::TooStrong => "change the velocity more gently",
            Self::CannotStop => "slow down earlier",
            Self::IdTaken => "ask with scan which ids the node has",
            Self::Locked => "send configure first, and again after enable",
        }
    }
}
