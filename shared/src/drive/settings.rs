//! What a link must know of its drive. The parameters `drive.*` say it, see `parameter::drive`.

use super::mit::MitSettings;
use super::scale::Scale;
use crate::time::Ticks;
use crate::units::{COUNTS_PER_TURN, Position};
use num_enum::{IntoPrimitive, TryFromPrimitive};

/// The languages of drives, in the order of the parameter `drive.kind`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, IntoPrimitive, TryFromPrimitive)]
#[repr(u8)]
pub enum DriveKind {
    /// No drive: setpoints are followed inside the node.
    Simulated = 0,
    /// ODrive's CANSimple.
    Odrive = 1,
    /// The mini-cheetah mode.
    Mit = 2,
    /// CANopen's cyclic synchronous position mode.
    Cia402 = 3,
}

/// The generations of ODrive's firmware, in the order of the parameter `drive.odrive_firmware`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, IntoPrimitive, TryFromPrimitive)]
#[repr(u8)]
pub enum OdriveFirmware {
    /// 0.6: ODrive Pro, S1 and Micro.
    V6 = 0,
    /// 0.5: ODrive v3.
    V5 = 1,
}

/// What a link must know of its drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveSettings {
    /// Its language.
    pub kind: DriveKind,
    /// Its id on the drives' bus.
    pub node: u8,
    /// Turns of its shaft in one turn of the axis, in steps of 10^-9; at least 1.
    pub gear: u64,
    /// Whether the two turn against each other.
    pub reversed: bool,
    /// Where the axis is when the drive reads zero.
    pub offset: Position,
    /// What it accelerates, in kg m^2 at the axis's shaft; 0 gives no feed-forward of torque.
    pub inertia: f32,
    /// Silence after which it is lost.
    pub timeout: Ticks,
    /// Ticks between two setpoints; at least 1.
    pub period: Ticks,
    /// Which ODrive it is.
    pub odrive_firmware: OdriveFirmware,
    /// How it is led in the mini-cheetah mode.
    pub mit: MitSettings,
    /// Increments in one turn of a CiA 402 drive's shaft; at least 1.
    pub increments: u32,
    /// The rated torque of a CiA 402 drive's motor, in Nm at its shaft; 0 where it takes no torque offset.
    pub rated_torque: f32,
}

impl DriveSettings {
    /// The scale to a drive that counts 2^-32 turn of its shaft.
    pub(super) fn scale(&self) -> Scale {
        self.scale_to(COUNTS_PER_TURN as u64)
    }

    /// The scale to a drive with so many units in a turn of its shaft.
    pub(super) fn scale_to(&self, units: u64) -> Scale {
        Scale::new(self.gear, units, self.reversed, self.offset, self.inertia)
    }
}
