//! The command lines of `plan` and `compare`.

use canter::notation::seconds;
use canter::profile::vibration::Resonance;
use canter::profile::{AskedLimits, Kind, Request};
use canter_shared::motion::bounds::{LARGEST, SMALLEST};
use clap::{Args, ValueEnum};

/// Where a move goes and how fast it may be, in the caller's own unit.
#[derive(Args)]
pub struct Way {
    /// Where the move starts.
    #[arg(long, value_name = "X", value_parser = number, allow_hyphen_values = true)]
    pub from: f64,
    /// Where it ends.
    #[arg(long, value_name = "X", value_parser = number, allow_hyphen_values = true)]
    pub to: f64,
    /// The largest velocity, per second.
    #[arg(long, value_name = "V", value_parser = limit, allow_hyphen_values = true)]
    pub vmax: Option<f64>,
    /// The largest acceleration, per second squared.
    #[arg(long, value_name = "A", value_parser = limit, allow_hyphen_values = true)]
    pub amax: Option<f64>,
    /// The largest deceleration, per second squared; as the acceleration without it.
    #[arg(long, value_name = "A", value_parser = limit, allow_hyphen_values = true)]
    pub dmax: Option<f64>,
    /// The largest jerk, per second cubed; a trapezoid keeps none.
    #[arg(long, value_name = "J", value_parser = limit, allow_hyphen_values = true)]
    pub jmax: Option<f64>,
}

impl Way {
    /// The limits that were named.
    pub fn limits(&self) -> AskedLimits {
        AskedLimits {
            velocity: self.vmax,
            acceleration: self.amax,
            deceleration: self.dmax,
            jerk: self.jmax,
        }
    }
}

#[derive(Args)]
pub struct Plan {
    /// The shape of the move.
    #[arg(long, value_enum, default_value_t = PlanProfile::Beta)]
    pub profile: PlanProfile,
    #[command(flatten)]
    pub way: Way,
    /// The velocity at the start.
    #[arg(long, value_name = "V", value_parser = number, allow_hyphen_values = true, default_value_t = 0.0, hide_default_value = true)]
    pub v0: f64,
    /// The velocity at the end.
    #[arg(long, value_name = "V", value_parser = number, allow_hyphen_values = true, default_value_t = 0.0, hide_default_value = true)]
    pub v1: f64,
    /// The acceleration at the start.
    #[arg(long, value_name = "A", value_parser = number, allow_hyphen_values = true, default_value_t = 0.0, hide_default_value = true)]
    pub a0: f64,
    /// The acceleration at the end.
    #[arg(long, value_name = "A", value_parser = number, allow_hyphen_values = true, default_value_t = 0.0, hide_default_value = true)]
    pub a1: f64,
    /// The time at which it starts, in s; before it and after the end the move coasts.
    #[arg(long, value_name = "S", value_parser = number, allow_hyphen_values = true, default_value_t = 0.0, hide_default_value = true)]
    pub t0: f64,
    /// How long it lasts, in s; as quick as the limits allow without it.
    #[arg(long, value_name = "S", value_parser = seconds, allow_hyphen_values = true)]
    pub duration: Option<f64>,
    /// The exponent of the beta curve, from 2 to 5; 2.5 without it.
    #[arg(long, value_name = "P", value_parser = exponent, allow_hyphen_values = true)]
    pub p: Option<f64>,
    /// A row every so many seconds; without it 1001 rows, or with --device one each ms.
    #[arg(long, value_name = "S", value_parser = seconds, allow_hyphen_values = true)]
    pub dt: Option<f64>,
    /// A row for each time in this file, one in each line, in their order; - is stdin.
    #[arg(long, value_name = "FILE", conflicts_with = "dt")]
    pub at: Option<String>,
    /// How it is printed.
    #[arg(long, value_enum, default_value_t = PlanFormat::Csv)]
    pub format: PlanFormat,
    /// The f64 library's curve, which is the default.
    #[arg(long)]
    pub exact: bool,
    /// The very setpoints that a node sends, each ms, in rad; limits that are not named are an
    /// axis's defaults.
    #[arg(long, conflicts_with = "exact")]
    pub device: bool,
}

impl Plan {
    /// What is asked.
    pub fn request(&self) -> Request {
        Request {
            kind: self.profile.into(),
            from: self.way.from,
            to: self.way.to,
            start_velocity: self.v0,
            stop_velocity: self.v1,
            start_acceleration: self.a0,
            stop_acceleration: self.a1,
            limits: self.way.limits(),
            duration: self.duration,
            exponent: self.p,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
pub enum PlanProfile {
    /// The beta S-curve.
    Beta,
    /// Constant acceleration, cruise, constant deceleration.
    Trapezoid,
    /// Constant jerk in seven pieces, time-optimal.
    SCurve,
    /// A polynomial of degree 3.
    Cubic,
    /// A polynomial of degree 5.
    Quintic,
    /// A polynomial of degree 7.
    Septic,
}

impl From<PlanProfile> for Kind {
    fn from(profile: PlanProfile) -> Self {
        match profile {
            PlanProfile::Beta => Self::Beta,
            PlanProfile::Trapezoid => Self::Trapezoid,
            PlanProfile::SCurve => Self::SCurve,
            PlanProfile::Cubic => Self::Cubic,
            PlanProfile::Quintic => Self::Quintic,
            PlanProfile::Septic => Self::Septic,
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PlanFormat {
    /// Rows of t,position,velocity,acceleration,jerk.
    Csv,
    /// One document: duration, peaks, pieces; rows where --dt or --at asks for them.
    Json,
    /// A picture with the limits drawn in.
    Svg,
}

#[derive(Args)]
pub struct Compare {
    #[command(flatten)]
    pub way: Way,
    /// The frequency of a mass on a spring that the axis carries, in Hz.
    #[arg(long, value_name = "HZ", value_parser = frequency, allow_hyphen_values = true)]
    pub resonance: Option<f64>,
    /// Its damping ratio, from 0 to below 1.
    #[arg(long, value_name = "Z", value_parser = damping, allow_hyphen_values = true, default_value_t = 0.05, requires = "resonance")]
    pub damping: f64,
    /// Which input shapers to show too; with --resonance all of them.
    #[arg(long, value_enum, requires = "resonance")]
    pub shaper: Option<ShaperArgument>,
    /// How it is printed.
    #[arg(long, value_enum, default_value_t = CompareFormat::Text)]
    pub format: CompareFormat,
}

impl Compare {
    /// The mass on a spring that was named.
    pub fn mass_on_a_spring(&self) -> Option<Resonance> {
        let damping = self.damping;
        self.resonance
            .map(|frequency| Resonance { frequency, damping })
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ShaperArgument {
    /// Zero vibration.
    Zv,
    /// Zero vibration and derivative: forgives a frequency that is a little off.
    Zvd,
    /// Extra-insensitive: forgives more, for a little vibration.
    Ei,
    /// Each of them.
    All,
    /// None.
    None,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum CompareFormat {
    /// A table and a sentence.
    Text,
    /// The table as CSV.
    Csv,
    /// One document.
    Json,
    /// The curves over each other, and what they leave swinging over the frequency.
    Svg,
}

fn in_range(text: &str, least: f64, most: f64) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        // A NaN is in no range.
        Ok(value) if (least..=most).contains(&value) => Ok(value),
        _ => Err(format!("it must be a number from {least:e} to {most:e}")),
    }
}

fn number(text: &str) -> Result<f64, String> {
    in_range(text, -LARGEST, LARGEST)
}

fn limit(text: &str) -> Result<f64, String> {
    in_range(text, SMALLEST, LARGEST)
}

fn exponent(text: &str) -> Result<f64, String> {
    in_range(text, 2.0, 5.0)
}

fn frequency(text: &str) -> Result<f64, String> {
    in_range(text, 1e-9, 1e9)
}

fn damping(text: &str) -> Result<f64, String> {
    in_range(text, 0.0, 0.99)
}
