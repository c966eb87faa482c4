//! The faults of an axis: one table, with cause and cure.

use num_enum::{IntoPrimitive, TryFromPrimitive};

/// Why an axis stopped and stays stopped until the fault is cleared. On the wire 0 is no fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, IntoPrimitive, TryFromPrimitive)]
#[repr(u8)]
pub enum Fault {
    /// Somebody sent an emergency stop.
    EmergencyStop = 1,
    /// The session that held the axis fell silent.
    HostTimeout = 2,
    /// The drive fell silent.
    DriveLost = 3,
    /// The drive stopped by itself.
    DriveFault = 4,
    /// The drive did not enable in time.
    EnableTimeout = 5,
}

impl Fault {
    /// Every fault, in the order of their numbers.
    pub const ALL: [Self; 5] = [
        Self::EmergencyStop,
        Self::HostTimeout,
        Self::DriveLost,
        Self::DriveFault,
        Self::EnableTimeout,
    ];

    /// The name on the command line, in the DBC and in the documents.
    pub const fn name(self) -> &'static str {
        match self {
            Self::EmergencyStop => "emergency_stop",
            Self::HostTimeout => "host_timeout",
            Self::DriveLost => "drive_lost",
            Self::DriveFault => "drive_fault",
            Self::EnableTimeout => "enable_timeout",
        }
    }

    /// What made it.
    pub const fn cause(self) -> &'static str {
        match self {
            Self::EmergencyStop => "an emergency stop frame arrived",
            Self::HostTimeout => {
                "the session that held the axis sent no heartbeat for host.timeout (0.25 s)"
            }
            Self::DriveLost => "the drive sent nothing for too long",
            Self::DriveFault => "the drive disabled itself or reported a fault of its own",
            Self::EnableTimeout => "the drive did not enable within 1 s",
        }
    }

    /// What to do about it.
    pub const fn cure(self) -> &'static str {
        match self {
            Self::EmergencyStop => "see that it is safe, then clear and enable",
            Self::HostTimeout => {
                "look for a host that crashed, hung or lost the bus, then clear and enable"
            }
            Self::DriveLost => "check the drive's power and bus, then clear and enable",
            Self::DriveFault => "read the fault with the drive's own tool, then clear and enable",
            Self::EnableTimeout => {
                "check the drive's power and its own state, then clear and enable"
            }
        }
    }
}
