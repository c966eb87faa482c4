//! The faults of an axis: one table, with cause and cure.

use crate::drive::Trouble;
use crate::parameter::Parameter;
use num_enum::{IntoPrimitive, TryFromPrimitive};

macro_rules! faults {
    ($($(#[$doc:meta])* $fault:ident = $number:literal, $name:literal, $cause:literal, $cure:literal;)*) => {
        /// Why an axis stopped and stays stopped until the fault is cleared. On the wire 0 is no
        /// fault.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, IntoPrimitive, TryFromPrimitive)]
        #[repr(u8)]
        pub enum Fault {
            $($(#[$doc])* $fault = $number,)*
        }

        impl Fault {
            /// Every fault, in the order of their numbers.
            pub const ALL: [Self; [$($number),*].len()] = [$(Self::$fault),*];

            /// The name on the command line, in the DBC and in the documents.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$fault => $name,)*
                }
            }

            /// What made it.
            pub const fn cause(self) -> &'static str {
                match self {
                    $(Self::$fault => $cause,)*
                }
            }

            /// What to do about it.
            pub const fn cure(self) -> &'static str {
                match self {
                    $(Self::$fault => $cure,)*
                }
            }
        }
    };
}

faults! {
    /// Somebody sent an emergency stop.
    EmergencyStop = 1, "emergency_stop",
        "an emergency stop frame arrived",
        "see that it is safe, then clear and enable";
    /// The session that held the axis fell silent.
    HostTimeout = 2, "host_timeout",
        "the session that held the axis sent no heartbeat for host.timeout",
        "look for a host that crashed, hung or lost the bus, then clear and enable";
    /// The drive fell silent.
    DriveLost = 3, "drive_lost",
        "the drive sent nothing for too long",
        "check the drive's power and bus, then clear and enable";
    /// The drive stopped by itself.
    DriveFault = 4, "drive_fault",
        "the drive disabled itself or reported a fault of its own",
        "read the fault with the drive's own tool, then clear and enable";
    /// The drive did not enable in time.
    EnableTimeout = 5, "enable_timeout",
        "the drive did not enable within 1 s",
        "check the drive's power and its own state, then clear and enable";
    /// The knots of a stream came too late.
    StreamUnderrun = 6, "stream_underrun",
        "a stream ran out of knots while the axis moved",
        "look for a host that is too slow or a bus that is too full, then clear and enable";
    /// The drive does not follow.
    FollowingError = 7, "following_error",
        "the drive was farther from its setpoint than following.error for following.time",
        "look for something that blocks the axis or a drive that is tuned too softly, then clear and enable";
    /// The drive is outside of the travel.
    OutsideTravel = 8, "outside_travel",
        "the drive left the travel by more than following.error",
        "bring the axis back by hand or from a place outside, then clear and enable";
    /// The drive is faster than it may be.
    Overspeed = 9, "overspeed",
        "the drive was faster than limits.velocity by more than overspeed.margin",
        "look for a drive that runs away or swings, then clear and enable";
    /// The drive reports what cannot be.
    FeedbackRange = 10, "feedback_range",
        "the drive reported a position or a velocity that the protocol cannot carry",
        "check the encoder and the drive's units, then clear and enable";
    /// The node's bus controller gave up.
    BusOff = 11, "bus_off",
        "the node's controller went off the bus after too many errors",
        "check wiring, termination and bit rate, then clear and enable";
    /// Another node sends as this axis.
    DuplicateAxis = 12, "duplicate_axis",
        "another node on the bus sends with this axis's id",
        "give one of the two another id with scan --assign, then clear and enable";
    /// What was saved cannot be read.
    ParametersLost = 13, "parameters_lost",
        "the saved parameters cannot be read; the defaults hold",
        "set and save the parameters anew, then clear and enable";
    /// The drive is too hot.
    DriveTemperature = 14, "drive_temperature",
        "the drive says that it or its motor is too hot",
        "let it cool, look for a load that is too high, then clear and enable";
    /// The drive had too much current.
    DriveCurrent = 15, "drive_current",
        "the drive says that it had too much current",
        "look for a short, a blocked axis or limits that ask for too much, then clear and enable";
    /// The drive's supply is too high.
    DriveOvervoltage = 16, "drive_overvoltage",
        "the drive says that its supply is too high",
        "brake more softly or give the energy a way (brake resistor), then clear and enable";
    /// The drive's supply is too low.
    DriveUndervoltage = 17, "drive_undervoltage",
        "the drive says that its supply is too low",
        "check the supply and its cables, then clear and enable";
    /// The drive's encoder failed.
    DriveEncoder = 18, "drive_encoder",
        "the drive says that its encoder failed",
        "check the encoder, its cable and its calibration, then clear and enable";
    /// The drive's motor or power stage failed.
    DriveMotor = 19, "drive_motor",
        "the drive says that its motor or its power stage failed",
        "check the motor's phases and read the fault with the drive's own tool, then clear and enable";
    /// The drive heard nothing for too long.
    DriveStarved = 20, "drive_starved",
        "the drive says that it was told nothing for too long",
        "check the drives' bus and the drive's own time-out, then clear and enable";
    /// The drive did not follow, or passed a limit of its own.
    DriveFollowing = 21, "drive_following",
        "the drive says that it did not follow or passed a limit of its own",
        "look for something that blocks the axis and at the drive's own limits, then clear and enable";
    /// The drive is where its protocol cannot tell.
    DriveRange = 22, "drive_range",
        "the drive is, or should go, where its protocol cannot tell",
        "bring the axis back by hand, check drive.gear_ratio and drive.offset, then clear and enable";
    /// The drive refused to be set up.
    DriveSetup = 23, "drive_setup",
        "the drive refused what it was set up with, or says that it is not set up",
        "calibrate it and compare docs/drives.md with what it can do, then clear and enable";
    /// The drive began anew.
    DriveRestart = 24, "drive_restart",
        "the drive began anew by itself",
        "check its power, then clear and enable";
    // From here on the node's own.
    /// The node's program found something that cannot be, and began anew.
    NodePanic = 32, "node_panic",
        "the node's firmware found something that cannot be, and began anew",
        "report it with what was going on, then clear and enable";
    /// The node's processor could not go on.
    NodeHardFault = 33, "node_hard_fault",
        "the node's processor had a hardware fault, and the node began anew",
        "look for an unsteady supply; else report it with what was going on, then clear and enable";
    /// The node's control loop was late or stood still.
    WatchdogReset = 34, "watchdog_reset",
        "the node's control loop did not get on, and its watchdog reset it",
        "look for a bus that is flooded; else report it with what was going on, then clear and enable";
}

impl From<Trouble> for Fault {
    fn from(trouble: Trouble) -> Self {
        match trouble {
            Trouble::Other => Self::DriveFault,
            Trouble::Temperature => Self::DriveTemperature,
            Trouble::Current => Self::DriveCurrent,
            Trouble::Overvoltage => Self::DriveOvervoltage,
            Trouble::Undervoltage => Self::DriveUndervoltage,
            Trouble::Encoder => Self::DriveEncoder,
            Trouble::Motor => Self::DriveMotor,
            Trouble::Starved => Self::DriveStarved,
            Trouble::Following => Self::DriveFollowing,
            Trouble::Range => Self::DriveRange,
            Trouble::Setup => Self::DriveSetup,
            Trouble::Restart => Self::DriveRestart,
        }
    }
}

impl Fault {
    /// The parameter that says how the axis comes to rest; `None` where nothing is left to choose:
    /// an emergency stop is a controlled stop, and a drive that is gone cannot be led.
    pub const fn reaction(self) -> Option<Parameter> {
        match self {
            Self::HostTimeout => Some(Parameter::HostReaction),
            Self::StreamUnderrun => Some(Parameter::StreamReaction),
            Self::FollowingError | Self::OutsideTravel | Self::Overspeed | Self::FeedbackRange => {
                Some(Parameter::FollowingReaction)
            }
            Self::BusOff | Self::DuplicateAxis => Some(Parameter::BusReaction),
            _ => None,
        }
    }

    /// Whether the drive itself is gone, stopped or not there: it cannot be led to rest.
    pub const fn is_of_drive(self) -> bool {
        const FIRST: u8 = Fault::DriveTemperature as u8;
        const LAST: u8 = Fault::DriveRestart as u8;
        matches!(
            self,
            Self::DriveLost | Self::DriveFault | Self::EnableTimeout
        ) || matches!(self as u8, FIRST..=LAST)
    }
}
