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
}

impl Reason {
    /// Every reason, in the order of their codes.
    pub const ALL: [Self; 13] = [
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
            Self::DriveNotReady => "look at the drive",
            Self::Moving => "stop the axis and wait until it rests",
            Self::BadValue => "see the protocol's table",
        }
    }
}
