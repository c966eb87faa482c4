//! `canter watch`.

use canter::notation::seconds;
use clap::Args;

/// What a period may be, in s.
const SHORTEST: f64 = 0.02;
const LONGEST: f64 = 60.0;

#[derive(Args)]
pub struct Watch {
    /// How often it is shown, in s, from 0.02 to 60; 0.1 on a terminal and 1 otherwise without it.
    #[arg(long, value_name = "S", value_parser = period)]
    pub period: Option<f64>,
    /// For how long it watches, in s; until it is ended without it.
    #[arg(long = "for", value_name = "S", value_parser = seconds)]
    pub span: Option<f64>,
}

fn period(text: &str) -> Result<f64, String> {
    let period = seconds(text).map_err(|error| error.to_string())?;
    if (SHORTEST..=LONGEST).contains(&period) {
        Ok(period)
    } else {
        Err(format!(
            "`{text}` is no period to watch at: it must be from {SHORTEST} to {LONGEST} s"
        ))
    }
}
