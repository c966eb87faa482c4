//! `canter drive`.

use canter::drive_model::{Trial, Trouble};
use canter::notation::seconds;
use canter_shared::drive::settings::{DriveKind, OdriveFirmware};
use clap::{Args, ValueEnum};

#[derive(Args)]
pub struct Drive {
    /// What drives they are.
    #[arg(long, value_enum)]
    pub kind: DriveKindArgument,
    /// Their ids: 1-3 or 1,2,5.
    #[arg(long, value_name = "LIST", value_parser = super::axes)]
    pub nodes: super::AxisVector,
    /// Which ODrive.
    #[arg(long, value_enum, default_value_t = FirmwareArgument::V6)]
    pub firmware: FirmwareArgument,
    /// Where their shafts are at the beginning, in turns.
    #[arg(long, value_name = "TURNS", default_value_t = 0.0, allow_hyphen_values = true, value_parser = turns)]
    pub position: f64,
    /// Silence of the node after which a drive stops by itself, in s; 0 never. Without it as the drive is
    /// by default: mit after 0.025, the others never.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub watchdog: Option<f64>,
    /// They hold torque at the beginning, as some that another program has left.
    #[arg(long)]
    pub start_enabled: bool,
    /// The drive that gets into trouble; the first one without it.
    #[arg(long, value_name = "NODE", value_parser = clap::value_parser!(u8).range(1..=63))]
    pub trouble_node: Option<u8>,
    /// So long after it was enabled first, its supply is too low, in s.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub fault_at: Option<f64>,
    /// ... its power goes, and comes 2 s later.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub reboot_at: Option<f64>,
    /// ... nobody hears it any more.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub silent_at: Option<f64>,
    /// ... it hears nobody any more.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub deaf_at: Option<f64>,
    /// ... it stops by itself, without a fault.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub drop_out_at: Option<f64>,
}

impl Drive {
    /// The trouble that was asked for.
    pub fn trials(&self) -> Vec<Trial> {
        let all = [
            (Trouble::Fault, self.fault_at),
            (Trouble::Reboot, self.reboot_at),
            (Trouble::Silence, self.silent_at),
            (Trouble::Deaf, self.deaf_at),
            (Trouble::DropOut, self.drop_out_at),
        ];
        let trial = |(trouble, at): (Trouble, Option<f64>)| {
            let after = milliseconds(at?);
            Some(Trial { trouble, after })
        };
        all.into_iter().filter_map(trial).collect()
    }

    /// The watchdog that was asked for, in ms.
    pub fn watchdog(&self) -> Option<u32> {
        self.watchdog.map(milliseconds)
    }
}

fn milliseconds(seconds: f64) -> u32 {
    (seconds * 1e3).round() as u32
}

/// Drives count in 32 bits, and their turns in fewer.
fn turns(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(turns) if (-1_000.0..=1_000.0).contains(&turns) => Ok(turns),
        _ => Err("must be a number from -1000 to 1000".to_owned()),
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DriveKindArgument {
    /// No drive: setpoints are followed in the node.
    Simulated,
    /// ODrive, CANSimple.
    Odrive,
    /// The mini-cheetah mode: bgkatz boards, CubeMars AK and the like.
    Mit,
    /// CANopen, CiA 402, cyclic synchronous position.
    Cia402,
}

impl From<DriveKindArgument> for DriveKind {
    fn from(kind: DriveKindArgument) -> Self {
        match kind {
            DriveKindArgument::Simulated => Self::Simulated,
            DriveKindArgument::Odrive => Self::Odrive,
            DriveKindArgument::Mit => Self::Mit,
            DriveKindArgument::Cia402 => Self::Cia402,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
pub enum FirmwareArgument {
    /// 0.6: Pro, S1, Micro.
    #[value(name = "0.6")]
    V6,
    /// 0.5: v3.
    #[value(name = "0.5")]
    V5,
}

impl From<FirmwareArgument> for OdriveFirmware {
    fn from(firmware: FirmwareArgument) -> Self {
        match firmware {
            FirmwareArgument::V6 => Self::V6,
            FirmwareArgument::V5 => Self::V5,
        }
    }
}
