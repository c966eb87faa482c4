//! What ODrive's error bits mean.
//!
//! 0.6: odriverobotics/ros_odrive, odrive_base/include/odrive_enums.h, `ODriveError`. 0.5: `Axis.Error`
//! of odriverobotics/ODrive's tools/odrive/enums.py; where a motor, an encoder or a controller has
//! errors of its own the heartbeat has a flag for it.

use crate::drive::Trouble;
use crate::drive::settings::OdriveFirmware;

/// The flags of a 0.5 heartbeat, above the 32 bits of `axis_error`: motor, encoder, controller.
const MOTOR: u64 = 1 << 40;
const ENCODER: u64 = 1 << 48;
const CONTROLLER: u64 = 1 << 56;

/// Bits and their meaning, the likelier cause first: one trouble often brings others along.
const V6: &[(u64, Trouble)] = &[
    (0x0000_6000, Trouble::Temperature),
    (0x0000_0900, Trouble::Overvoltage),
    (0x0000_0200, Trouble::Undervoltage),
    (0x0000_1400, Trouble::Current),
    (0x0000_0008, Trouble::Encoder),
    (0x0401_8000, Trouble::Following),
    (0x1000_0020, Trouble::Motor),
    (0x0100_0040, Trouble::Starved),
    (0x4000_0010, Trouble::Setup),
    (0x0000_0001, Trouble::Restart),
];

const V5: &[(u64, Trouble)] = &[
    (0x0004_0000, Trouble::Temperature),
    (0x0000_0800, Trouble::Starved),
    (0x0000_0004, Trouble::Overvoltage),
    (0x0000_0002, Trouble::Undervoltage),
    (MOTOR | 0x0000_0040, Trouble::Motor),
    (ENCODER | 0x0008_0180, Trouble::Encoder),
    (CONTROLLER | 0x0000_3200, Trouble::Following),
    (0x0000_0001, Trouble::Setup),
];

/// The errors in a heartbeat; 0 for none.
pub(super) fn of_heartbeat(firmware: OdriveFirmware, word: u64) -> u64 {
    match firmware {
        OdriveFirmware::V6 => word & u64::from(u32::MAX),
        OdriveFirmware::V5 => word & (u64::from(u32::MAX) | MOTOR | ENCODER | CONTROLLER),
    }
}

/// What they mean.
pub(super) fn meaning(firmware: OdriveFirmware, errors: u64) -> Trouble {
    let table = match firmware {
        OdriveFirmware::V6 => V6,
        OdriveFirmware::V5 => V5,
    };
    let first = table.iter().find(|(bits, _)| errors & bits != 0);
    first.map_or(Trouble::Other, |(_, trouble)| *trouble)
}
