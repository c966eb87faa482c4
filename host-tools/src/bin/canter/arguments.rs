//! The command line's shape.

mod drive;
mod foot;
mod gait;
mod leg;
mod log;
mod param;
mod path;
mod profile;
mod watch;

pub use drive::{Drive, DriveKindArgument};
pub use foot::{Foot, FootFormat};
pub use gait::{GaitAction, GaitArguments, GaitFormat, GaitPlan, GaitRun};
pub use leg::{LegAction, LegArguments};
pub use log::{LogAction, LogArguments, LogFile, LogStats};
pub use param::{Param, ParamAction, ParamSet};
pub use path::{Path, PathFormat};
pub use profile::{Compare, CompareFormat, Plan, PlanFormat, ShaperArgument};
pub use watch::Watch;

use canter::bus::{Address, AddressError, Bitrate};
use canter::client::{ChipId, ChipIdError, Goal, Target};
use canter::notation::{AxisList, angle, parse_axes, rate, seconds};
use canter::soak::Faults;
use canter_shared::wire::command::ProfileKind;
use canter_shared::wire::id::AxisId;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// The longest soak: ten years of robots.
const MOST_HOURS: f64 = 87_600.0;

/// Moves CAN servo axes smoothly and together.
///
/// Angles are rad unless deg or turn stands behind: 1.5, 90deg, 0.25turn. Data goes to stdout and
/// words to stderr. Exit code: 0 done, 1 failed or refused, 2 wrong usage.
#[derive(Parser)]
#[command(version, arg_required_else_help = true)]
pub struct Arguments {
    /// The bus: sim, vcan0, socketcan:can0, slcan:/dev/ttyACM0, slcan:tcp:HOST:PORT.
    #[arg(long, global = true, env = "CANTER_CAN", value_name = "BUS")]
    pub can: Option<BusAddress>,
    /// The robot file: axes and their limits.
    #[arg(long, global = true, value_name = "FILE")]
    pub robot: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long, global = true)]
    pub json: bool,
    #[command(subcommand)]
    pub verb: Verb,
}

/// A bus that was named, as it was written and as it is meant.
#[derive(Debug, Clone)]
pub struct BusAddress(pub Address);

impl std::str::FromStr for BusAddress {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        text.parse().map(Self)
    }
}

#[derive(Subcommand)]
pub enum Verb {
    /// Move, walk and stop a simulated robot of 12 axes, with a report to look at.
    Demo(Demo),
    /// Run axis nodes on a bus, in real time, from the firmware's own core.
    Node(Node),
    /// Run models of servo drives on a bus, in real time, to try nodes on.
    Drive(Drive),
    /// Find the nodes on the bus, and give their axes other ids.
    Scan(Scan),
    /// Print the state of every axis on the bus.
    Status,
    /// Show the state of every axis on the bus as it changes: a live screen, or lines.
    ///
    /// It only listens. On a terminal it is a screen, otherwise the table of `canter status` each period. With
    /// --json it is a document each period, on a line of its own: `time`, of the bus's own clock, in s; and `axes`,
    /// as `canter status` has them, each with `silent`: whether it was not heard for 0.5 s.
    Watch(Watch),
    /// Enable axes where they are.
    Enable(Axes),
    /// Stop and disable axes.
    Disable(Axes),
    /// Forget latched faults; the axes stay disabled.
    Clear(Axes),
    /// Bring axes to rest inside their limits, whoever moves them.
    Stop(Axes),
    /// Emergency stop: come to rest and latch a fault.
    Estop(Axes),
    /// Make where disabled axes are their zero, or any other position.
    Zero(Zero),
    /// Move axes, together.
    Move(Move),
    /// Read and change what is set about the axes: limits, time-outs, reactions.
    Param(Param),
    /// Plan one move of one axis, offline, in units of your own.
    Plan(Plan),
    /// Time a path through waypoints within every axis's limits; with --run, move along it.
    Path(Path),
    /// Show the profiles side by side for one move: durations, peaks, vibration.
    Compare(Compare),
    /// Show a foot's cycle, or all presets of it side by side.
    Foot(Foot),
    /// Compute a leg's joints from its foot, or its foot from its joints, offline.
    Leg(LegArguments),
    /// Show the gaits, plan walks offline, and walk on the robot.
    Gait(GaitArguments),
    /// Read a log of the bus: what it says, how full the bus was, its commands once more.
    Log(LogArguments),
    /// Prove the promise: random robots, commands, hostile traffic and faults, in virtual time.
    Soak(Soak),
    /// Print canter.dbc: the protocol for other tools.
    Dbc,
    /// Print what a shell needs to complete this command line.
    Completions(Completions),
    /// Print the manual page.
    Man,
}

#[derive(Args)]
pub struct Completions {
    /// Which shell.
    #[arg(value_enum)]
    pub shell: clap_complete::Shell,
}

#[derive(Args)]
pub struct Soak {
    /// The first seed: each is a robot of its own, and what happens to it in 36 s.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// How many simulated hours; 100 seeds make one.
    #[arg(long, value_name = "H", default_value_t = 1.0, value_parser = hours)]
    pub hours: f64,
    /// What may go wrong: all, none, or some of them by name, such as lost,reset,hostile.
    #[arg(long, value_name = "LIST", default_value = "all")]
    pub faults: Faults,
    /// How many axes each robot has, 1 to 12; the seed decides without it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=12))]
    pub axes: Option<u8>,
    /// How many seeds at once; one for each processor without it.
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Where the log of a violation goes.
    #[arg(long, value_name = "FILE", default_value = "bus.log")]
    pub log: PathBuf,
    /// Play such a log again instead.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["seed", "hours", "faults", "axes", "threads"])]
    pub replay: Option<PathBuf>,
}

fn bitrate(text: &str) -> Result<Bitrate, String> {
    let rate = text.parse().ok().and_then(Bitrate::from_bits_per_second);
    rate.ok_or_else(|| String::from("write a usual bit rate, such as 1000000, 500000 or 250000"))
}

fn hours(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(hours) if hours > 0.0 && hours <= MOST_HOURS => Ok(hours),
        _ => Err(format!("must be a number over 0 and up to {MOST_HOURS}")),
    }
}

#[derive(Args)]
pub struct Demo {
    /// Where report.html, setpoints.csv and bus.log go.
    #[arg(long, value_name = "DIR", default_value = "canter-demo")]
    pub out: PathBuf,
    /// The same seed gives the same files, byte for byte.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

#[derive(Args)]
pub struct Node {
    /// The axes to run: 1-12 or 1,2,5.
    #[arg(long, value_name = "LIST", value_parser = axes)]
    pub axes: AxisVector,
    /// The drive behind each axis: the parameter drive.kind of all of them, which is simulated without it.
    #[arg(long, value_enum)]
    pub drive: Option<DriveKindArgument>,
    /// The bus of the drives, which is not the one of --can: ids would collide.
    #[arg(long, value_name = "BUS")]
    pub drive_can: Option<BusAddress>,
    /// Keep the parameters and the axes' ids here over an end of the process; made where it is
    /// missing. What it keeps goes before the robot file.
    #[arg(long, value_name = "FILE")]
    pub store: Option<PathBuf>,
    /// Write every setpoint here, as CSV.
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
}

#[derive(Args)]
pub struct Scan {
    /// Give the axis OLD of a chip, or its only one, the id NEW: CHIP=NEW or CHIP/OLD=NEW. It must be
    /// disabled, and nobody may hold it.
    #[arg(long, value_name = "CHIP[/OLD]=NEW", value_parser = assignment)]
    pub assign: Option<Assignment>,
    /// Keep the new id, and the parameters as they are, over a loss of power.
    #[arg(long, requires = "assign")]
    pub save: bool,
}

/// Which axis of which chip gets which id.
#[derive(Clone, Copy)]
pub struct Assignment {
    pub chip: ChipId,
    pub old: Option<AxisId>,
    pub new: AxisId,
}

fn assignment(text: &str) -> Result<Assignment, String> {
    let axis = |text: &str| {
        let axes = parse_axes(text).map_err(|error| error.to_string())?;
        match axes[..] {
            [axis] => Ok(axis),
            _ => Err(format!("`{text}` is no single axis")),
        }
    };
    let (which, new) = text
        .split_once('=')
        .ok_or("write CHIP=NEW, with the chip as `canter scan` shows it")?;
    let (chip, old) = match which.split_once('/') {
        Some((chip, old)) => (chip, Some(axis(old)?)),
        None => (which, None),
    };
    Ok(Assignment {
        chip: chip
            .parse()
            .map_err(|error: ChipIdError| error.to_string())?,
        old,
        new: axis(new)?,
    })
}

#[derive(Args)]
pub struct Axes {
    /// The axes: 1-12, 1,2,5 or all.
    #[arg(value_name = "AXES")]
    pub axes: AxisList,
}

#[derive(Args)]
pub struct Zero {
    /// The axes: 1-12, 1,2,5 or all.
    #[arg(value_name = "AXES")]
    pub axes: AxisList,
    /// What their position shall read there.
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true, default_value = "0")]
    pub at: f64,
    /// Keep it over a reset, with all else that was changed since the last time.
    #[arg(long)]
    pub save: bool,
}

#[derive(Args)]
pub struct Move {
    /// Where each axis is to go: 1=90deg 2=-0.5turn 3-4=1.5.
    #[arg(required = true, value_name = "AXIS=POSITION", value_parser = goal)]
    pub goals: Vec<GoalArgument>,
    /// The shape of the move.
    #[arg(long, value_enum, default_value_t = ProfileArgument::Beta)]
    pub profile: ProfileArgument,
    /// Positions are differences from where the axes are.
    #[arg(long)]
    pub relative: bool,
    /// How long the move lasts, in s; as quick as the limits allow without it.
    #[arg(long, value_name = "S", value_parser = seconds, allow_hyphen_values = true)]
    pub duration: Option<f64>,
    /// The largest velocity, in rad/s.
    #[arg(long, value_name = "RATE", value_parser = rate, allow_hyphen_values = true)]
    pub vmax: Option<f64>,
    /// The largest acceleration, in rad/s^2.
    #[arg(long, value_name = "RATE", value_parser = rate, allow_hyphen_values = true)]
    pub amax: Option<f64>,
    /// The largest deceleration, in rad/s^2; as the acceleration without it.
    #[arg(long, value_name = "RATE", value_parser = rate, allow_hyphen_values = true)]
    pub dmax: Option<f64>,
    /// The largest jerk, in rad/s^3.
    #[arg(long, value_name = "RATE", value_parser = rate, allow_hyphen_values = true)]
    pub jmax: Option<f64>,
    /// Each axis as quick as it can be, instead of all arriving together.
    #[arg(long)]
    pub independent: bool,
    /// Enable the axes first where they are not.
    #[arg(long)]
    pub enable: bool,
}

#[derive(Clone, Copy, ValueEnum)]
pub enum ProfileArgument {
    /// The beta S-curve.
    Beta,
    /// Constant acceleration, cruise, constant deceleration.
    Trapezoid,
    /// The quickest that keeps a limit of the jerk.
    SCurve,
}

impl From<ProfileArgument> for ProfileKind {
    fn from(profile: ProfileArgument) -> Self {
        match profile {
            ProfileArgument::Beta => Self::Beta,
            ProfileArgument::Trapezoid => Self::Trapezoid,
            ProfileArgument::SCurve => Self::SCurve,
        }
    }
}

/// Axes in a newtype, so that clap takes the list as one value.
#[derive(Clone)]
pub struct AxisVector(pub Vec<AxisId>);

fn axes(text: &str) -> Result<AxisVector, canter::notation::AxisListError> {
    parse_axes(text).map(AxisVector)
}

/// One `AXES=POSITION`.
#[derive(Clone)]
pub struct GoalArgument {
    axes: Vec<AxisId>,
    radians: f64,
}

impl GoalArgument {
    /// The goals that are meant.
    pub fn goals(&self, relative: bool) -> impl Iterator<Item = Goal> + '_ {
        self.axes.iter().map(move |axis| Goal {
            axis: *axis,
            target: if relative {
                Target::Relative(self.radians)
            } else {
                Target::Absolute(self.radians)
            },
        })
    }
}

fn goal(text: &str) -> Result<GoalArgument, String> {
    let (axes, position) = text
        .split_once('=')
        .ok_or("write AXIS=POSITION, such as `1=90deg`")?;
    Ok(GoalArgument {
        axes: parse_axes(axes).map_err(|error| error.to_string())?,
        radians: angle(position).map_err(|error| error.to_string())?,
    })
}
