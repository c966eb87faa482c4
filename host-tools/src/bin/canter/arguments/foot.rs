//! The command line of `foot`.

use canter::foot::{CycleRequest, Preset};
use canter::leg::Leg;
use clap::{Args, ValueEnum};

#[derive(Args)]
pub struct Foot {
    /// The shape of the cycle; all of them are compared without it.
    #[arg(long, value_enum)]
    pub preset: Option<Preset>,
    /// How fast the body goes forward, in mm/s, from -10000 to 10000.
    #[arg(
        long,
        value_name = "MM_S",
        allow_hyphen_values = true,
        default_value_t = 500.0
    )]
    pub vx: f64,
    /// How long stance and swing take together, in ms, from 10 to 100000.
    #[arg(
        long,
        value_name = "MS",
        allow_hyphen_values = true,
        default_value_t = 400.0
    )]
    pub period: f64,
    /// How much longer than half of the period the stance is, in percent of it, from -45 to 45.
    #[arg(
        long,
        value_name = "PCT",
        allow_hyphen_values = true,
        default_value_t = 0.0
    )]
    pub overlay: f64,
    /// How far the swing lifts the foot, in mm, from 0 to 1000.
    #[arg(
        long,
        value_name = "MM",
        allow_hyphen_values = true,
        default_value_t = 30.0
    )]
    pub swing: f64,
    /// How far the stance presses the foot into the ground, in mm, from 0 to 1000.
    #[arg(
        long,
        value_name = "MM",
        allow_hyphen_values = true,
        default_value_t = 5.0
    )]
    pub stance: f64,
    /// How far the hip is above the ground, in mm, from 0 to 10000.
    #[arg(
        long,
        value_name = "MM",
        allow_hyphen_values = true,
        default_value_t = 130.0
    )]
    pub height: f64,
    /// Add the joints of this leg to each row, as published: q in rad, dq in rad/s, ddq in rad/s^2.
    #[arg(long, value_enum, requires = "preset")]
    pub leg: Option<FootLeg>,
    /// How many rows, from the start to the end of the cycle.
    #[arg(long, value_name = "N", requires = "preset", default_value_t = 401, value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    pub samples: u32,
    /// A row for each time in this file, in s, one in each line, in their order; - is stdin.
    #[arg(
        long,
        value_name = "FILE",
        requires = "preset",
        conflicts_with = "samples"
    )]
    pub at: Option<String>,
    /// How it is printed: rows as CSV with a preset, the comparison as text without.
    #[arg(long, value_enum)]
    pub format: Option<FootFormat>,
}

impl Foot {
    /// What is asked, in m and s.
    pub fn request(&self) -> CycleRequest {
        CycleRequest {
            speed: self.vx / 1e3,
            period: self.period / 1e3,
            overlay: self.overlay,
            swing: self.swing / 1e3,
            stance: self.stance / 1e3,
            height: self.height / 1e3,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
pub enum FootLeg {
    /// Two thighs side by side that carry one foot.
    FiveBar,
    /// A thigh and a shank.
    Serial,
}

impl From<FootLeg> for Leg {
    fn from(leg: FootLeg) -> Self {
        match leg {
            FootLeg::FiveBar => Self::published_five_bar(),
            FootLeg::Serial => Self::published_serial(),
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FootFormat {
    /// A table to read; of the comparison only.
    Text,
    /// Rows.
    Csv,
    /// One document.
    Json,
    /// A picture.
    Svg,
}
