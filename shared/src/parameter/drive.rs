//! What the parameters mean for the link to the drive.

use super::table::Parameter;
use super::values::{ParameterError, Values};
use crate::drive::mit::{MitRanges, MitSettings, preset};
use crate::drive::settings::{DriveKind, DriveSettings, OdriveFirmware};
use crate::drive::{cia402, odrive};
use crate::time::Ticks;
use crate::units::{COUNTS_PER_RADIAN, Position, whole};
use core::f64::consts::TAU;

/// How much of a range is left free at each of its ends: a drive at the very end may be beyond it. Four
/// steps of 16 bits.
const MARGIN: f64 = 1.0 / 8_192.0;

impl Values {
    /// What the link must know of the axis's drive.
    #[inline(never)]
    pub fn drive(&self) -> DriveSettings {
        let number = |parameter: Parameter| parameter.in_unit(self.get(parameter)) as f32;
        let raw = |parameter| self.get(parameter);
        DriveSettings {
            kind: kind(self),
            node: raw(Parameter::DriveNode) as u8,
            gear: raw(Parameter::GearRatio) as u64,
            reversed: raw(Parameter::DriveDirection) != 0,
            offset: Position::from_counts(whole(
                Parameter::DriveOffset.in_unit(raw(Parameter::DriveOffset)) * COUNTS_PER_RADIAN,
            )),
            inertia: number(Parameter::DriveInertia),
            timeout: Ticks(raw(Parameter::DriveTimeout) as u32),
            period: Ticks(raw(Parameter::DrivePeriod) as u32),
            odrive_firmware: OdriveFirmware::try_from(raw(Parameter::OdriveFirmware) as u8)
                .unwrap_or(OdriveFirmware::V6),
            mit: MitSettings {
                ranges: ranges(self),
                kp: number(Parameter::MitKp),
                kd: number(Parameter::MitKd),
                master: raw(Parameter::MitMaster) as u16,
            },
            increments: raw(Parameter::DriveIncrements) as u32,
            rated_torque: number(Parameter::RatedTorque),
        }
    }
}

fn kind(values: &Values) -> DriveKind {
    DriveKind::try_from(values.get(Parameter::DriveKind) as u8).unwrap_or(DriveKind::Simulated)
}

fn ranges(values: &Values) -> MitRanges {
    let number = |parameter: Parameter| parameter.in_unit(values.get(parameter)) as f32;
    preset(values.get(Parameter::MitModel) as usize).unwrap_or_else(|| MitRanges {
        position: number(Parameter::MitPosition),
        velocity: number(Parameter::MitVelocity),
        torque: number(Parameter::MitTorque),
    })
}

/// Between which places, in rad of the axis, the drive can be told to go; `None` where that is everywhere.
pub(super) fn reach(values: &Values) -> Option<(f64, f64)> {
    let at_drive = match kind(values) {
        DriveKind::Simulated | DriveKind::Odrive => return None,
        DriveKind::Mit => f64::from(ranges(values).position),
        DriveKind::Cia402 => {
            cia402::REACH as f64 * TAU / values.get(Parameter::DriveIncrements) as f64
        }
    };
    let number = |parameter: Parameter| parameter.in_unit(values.get(parameter));
    let half = at_drive * (1.0 - MARGIN) / number(Parameter::GearRatio);
    let middle = number(Parameter::DriveOffset);
    Some((middle - half, middle + half))
}

/// That the drive can have its id.
pub(super) fn node_fits(values: &Values, changed: Parameter) -> Result<(), ParameterError> {
    let node = values.get(Parameter::DriveNode);
    let ids = match kind(values) {
        DriveKind::Simulated => return Ok(()),
        DriveKind::Odrive => 0..=i64::from(odrive::LAST_NODE),
        // 0 is everybody.
        DriveKind::Mit | DriveKind::Cia402 => 1..=i64::from(cia402::LAST_NODE),
    };
    // What a board that answers to its own id would say and what it is told would be the same frames.
    let answers_itself = kind(values) == DriveKind::Mit && node == values.get(Parameter::MitMaster);
    if ids.contains(&node) && !answers_itself {
        return Ok(());
    }
    Err(ParameterError::Contradiction {
        parameter: changed,
        other: match changed {
            Parameter::DriveNode if answers_itself => Parameter::MitMaster,
            Parameter::DriveNode => Parameter::DriveKind,
            _ => Parameter::DriveNode,
        },
    })
}
