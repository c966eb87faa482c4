//! The command line of `gait`.

use super::bitrate;
use canter::bus::Bitrate;
use canter::gait::{Body, Gait, Kind, LEGS, Quadruped, Request};
use canter::notation::{angle, seconds};
use canter::walk::Settings;
use clap::{Args, Subcommand, ValueEnum};

/// The time from row to row where nobody says otherwise, in s.
const STEP: f64 = 0.001;

#[derive(Args)]
pub struct GaitArguments {
    #[command(subcommand)]
    pub action: GaitAction,
}

#[derive(Subcommand)]
pub enum GaitAction {
    /// Show the gaits: who lifts when, for how long, and how high.
    List,
    /// Plan a walk offline: from standing through some cycles back to standing.
    Plan(GaitPlan),
    /// Walk on the robot: stand up, walk as ordered, settle and sit down.
    ///
    /// It begins where the legs hang, sit or stand. Without --orders the keys of a terminal lead: up
    /// and down change the speed, left and right turn, comma and full stop go sideways, 1 to 6 change
    /// the gait (walk, trot, pace, bound, pronk, gallop), 0 stands, space goes nowhere, q or Esc ends.
    /// Ctrl-C settles and sits; a second one stops at once.
    Run(GaitRun),
}

/// Which gait, and what the body does.
#[derive(Args)]
pub struct GaitOptions {
    /// The gait; custom needs --offsets.
    #[arg(value_enum)]
    pub name: GaitName,
    /// Forward, in m/s.
    #[arg(
        long,
        value_name = "M_S",
        allow_hyphen_values = true,
        default_value_t = 0.0
    )]
    pub vx: f64,
    /// To the left, in m/s.
    #[arg(
        long,
        value_name = "M_S",
        allow_hyphen_values = true,
        default_value_t = 0.0
    )]
    pub vy: f64,
    /// Turning to the left: an angle in each second, such as 0.5 or 30deg.
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true, default_value = "0")]
    pub yaw_rate: f64,
    /// The hips above the ground, in m.
    #[arg(long, value_name = "M", allow_hyphen_values = true, default_value_t = Quadruped::HEIGHT)]
    pub height: f64,
    /// The left side up, an angle.
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true, default_value = "0")]
    pub roll: f64,
    /// The nose down, an angle.
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true, default_value = "0")]
    pub pitch: f64,
    /// When each foot comes down, as shares of the cycle: front left, front right, rear left, rear
    /// right, such as 0,0.5,0.5,0; as the gait has it without.
    #[arg(long, value_name = "A,B,C,D", value_parser = offsets)]
    pub offsets: Option<Offsets>,
    /// How long a cycle lasts, in s.
    #[arg(long, value_name = "S", value_parser = seconds, allow_hyphen_values = true)]
    pub period: Option<f64>,
    /// Which share of the cycle a foot is on the ground.
    #[arg(long, value_name = "SHARE", allow_hyphen_values = true)]
    pub duty: Option<f64>,
    /// How much longer it stays there, in percent of the cycle.
    #[arg(long, value_name = "PCT", allow_hyphen_values = true)]
    pub overlay: Option<f64>,
    /// How high a foot is lifted, in m.
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub swing: Option<f64>,
    /// How deep a foot pushes below the ground in the middle of its stance, in m.
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub stance: Option<f64>,
}

#[derive(Args)]
pub struct GaitPlan {
    #[command(flatten)]
    pub options: GaitOptions,
    /// For how many cycles it walks before it stops.
    #[arg(long, value_name = "N", default_value_t = 4, conflicts_with = "steady")]
    pub cycles: u32,
    /// One cycle of a walk without start and stop instead.
    #[arg(long)]
    pub steady: bool,
    /// The time from row to row, in s; 0.001 without it. With JSON it asks for the rows too.
    #[arg(long, value_name = "S", value_parser = seconds, allow_hyphen_values = true)]
    pub dt: Option<f64>,
    /// How it is printed.
    #[arg(long, value_enum, default_value_t = GaitFormat::Csv)]
    pub format: GaitFormat,
}

#[derive(Args)]
pub struct GaitRun {
    #[command(flatten)]
    pub options: GaitOptions,
    /// The hips above the ground where it sits, in m; half the height without it.
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub sit: Option<f64>,
    /// For how many cycles it walks. Without it and --duration it walks until the orders end, four
    /// cycles at least.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub cycles: Option<u32>,
    /// For how long it walks, in s.
    #[arg(long, value_name = "S", value_parser = seconds, allow_hyphen_values = true, conflicts_with = "cycles")]
    pub duration: Option<f64>,
    /// A file of orders, or - for stdin, one line each: `vx 0.3`, `vy -0.1 yaw 20deg`, `height 0.28`,
    /// `roll 5deg`, `gait pace`, `wait 2`, `stop`.
    #[arg(long, value_name = "FILE")]
    pub orders: Option<String>,
    /// Enable the axes first where they are not.
    #[arg(long)]
    pub enable: bool,
    /// The bus's bit rate in bit/s, for what the walk takes of it: 1000000 without it, or what --can
    /// says.
    #[arg(long, value_name = "RATE", value_parser = bitrate)]
    pub bitrate: Option<Bitrate>,
}

impl GaitOptions {
    /// The gait, none to stand; `None` for a custom gait without offsets.
    pub fn gait(&self) -> Option<Option<Gait>> {
        let gait = match self.name.kind() {
            Some(Kind::Stand) => None,
            Some(kind) => Some(kind.gait()?),
            None => {
                self.offsets?;
                Some(Kind::Trot.gait()?)
            }
        };
        Some(gait.map(|usual| {
            Gait {
                offsets: self
                    .offsets
                    .map_or(usual.offsets, |Offsets(offsets)| offsets),
                period: self.period.unwrap_or(usual.period),
                duty: self.duty.unwrap_or(usual.duty),
                overlay: self.overlay.map_or(usual.overlay, |percent| percent / 1e2),
                swing: self.swing.unwrap_or(usual.swing),
                stance: self.stance.unwrap_or(usual.stance),
            }
        }))
    }

    /// What the body does.
    pub fn body(&self) -> Body {
        Body {
            vx: self.vx,
            vy: self.vy,
            yaw_rate: self.yaw_rate,
            height: self.height,
            roll: self.roll,
            pitch: self.pitch,
        }
    }
}

impl GaitPlan {
    /// What is asked; `None` for a custom gait without offsets.
    pub fn request(&self) -> Option<Request> {
        Some(Request {
            gait: self.options.gait()?,
            body: self.options.body(),
            cycles: self.cycles,
            step: self.dt.unwrap_or(STEP),
            steady: self.steady,
        })
    }
}

impl GaitRun {
    /// How it walks; `None` for a custom gait without offsets.
    pub fn settings(&self) -> Option<Settings> {
        let usual = Settings::new(self.options.gait()?, self.options.body());
        Some(Settings {
            sitting: self.sit.unwrap_or(usual.sitting),
            ..usual
        })
    }
}

/// A gait's name on the command line.
#[derive(Clone, Copy, ValueEnum)]
pub enum GaitName {
    /// All feet on the ground.
    Stand,
    /// One foot after the other.
    Walk,
    /// The diagonal pairs in turn.
    Trot,
    /// The pairs of a side in turn.
    Pace,
    /// The front pair and the rear pair in turn.
    Bound,
    /// All four together.
    Pronk,
    /// The rear feet shortly one after the other, then the front feet.
    Gallop,
    /// By --offsets; the rest as a trot where it is not named.
    Custom,
}

impl GaitName {
    fn kind(self) -> Option<Kind> {
        Some(match self {
            Self::Stand => Kind::Stand,
            Self::Walk => Kind::Walk,
            Self::Trot => Kind::Trot,
            Self::Pace => Kind::Pace,
            Self::Bound => Kind::Bound,
            Self::Pronk => Kind::Pronk,
            Self::Gallop => Kind::Gallop,
            Self::Custom => return None,
        })
    }

    /// How it is written.
    pub fn name(self) -> &'static str {
        self.kind().map_or("custom", Kind::name)
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum GaitFormat {
    /// Rows: the time, each axis, each foot, the body.
    Csv,
    /// One document: the gait, its duration, each axis's peaks; rows where --dt asks for them.
    Json,
    /// Foot paths, the axes' curves, stick figures.
    Svg,
}

/// One phase offset for each leg.
#[derive(Clone, Copy)]
pub struct Offsets(pub [f64; LEGS]);

fn offsets(text: &str) -> Result<Offsets, String> {
    let words = "write four numbers from 0 to 1, such as 0,0.5,0.5,0";
    let values: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let values = values.map_err(|_| words)?;
    Ok(Offsets(values.try_into().map_err(|_| words)?))
}
