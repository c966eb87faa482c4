//! The command line of `canter param`.

use canter::notation::{AxisList, ParameterTextError, parameter_named};
use canter_shared::parameter::Parameter;
use canter_shared::wire::id::AxisId;
use clap::{Args, Subcommand};
use std::path::PathBuf;

#[derive(Args)]
pub struct Param {
    #[command(subcommand)]
    pub action: ParamAction,
}

#[derive(Subcommand)]
pub enum ParamAction {
    /// Print one parameter of an axis.
    Get {
        /// Its name, such as limits.velocity.
        #[arg(value_name = "NAME", value_parser = name)]
        parameter: Name,
        /// The axis.
        #[arg(long, value_name = "N", value_parser = axis)]
        axis: AxisId,
    },
    /// Change one parameter of some axes, which must be at rest.
    Set(ParamSet),
    /// Print all parameters of an axis.
    List {
        /// The axis.
        #[arg(long, value_name = "N", value_parser = axis)]
        axis: AxisId,
    },
    /// Keep the parameters of the axes' nodes over a loss of power; the nodes must be disabled.
    Save {
        /// The axes: 1-12, 1,2,5 or all.
        #[arg(long, value_name = "AXES")]
        axis: AxisList,
    },
    /// Set all parameters of some axes to their defaults; the axes must be disabled.
    Restore {
        /// The axes: 1-12, 1,2,5 or all.
        #[arg(long, value_name = "AXES")]
        axis: AxisList,
    },
    /// Write the parameters of some axes to a file, or to stdout.
    Export {
        /// The axes: 1-12, 1,2,5 or all.
        #[arg(long, value_name = "AXES")]
        axis: AxisList,
        /// The file; stdout without it.
        #[arg(value_name = "FILE")]
        file: Option<PathBuf>,
    },
    /// Set what a file says, as export writes it. It is checked first: a bad file changes nothing.
    Import {
        /// The file.
        #[arg(value_name = "FILE")]
        file: PathBuf,
        /// Save afterwards.
        #[arg(long)]
        save: bool,
    },
}

#[derive(Args)]
pub struct ParamSet {
    /// Its name, such as limits.velocity.
    #[arg(value_name = "NAME", value_parser = name)]
    pub parameter: Name,
    /// Its value in its unit, or with one: 20, 90deg, 0.25turn, 180deg/s, 250ms; a choice by name.
    #[arg(value_name = "VALUE", allow_hyphen_values = true)]
    pub value: String,
    /// The axes: 1-12, 1,2,5 or all.
    #[arg(long, value_name = "AXES")]
    pub axis: AxisList,
    /// Save afterwards; the axes' nodes must be disabled.
    #[arg(long)]
    pub save: bool,
}

/// A parameter, by its name.
#[derive(Clone, Copy)]
pub struct Name(pub Parameter);

fn name(text: &str) -> Result<Name, ParameterTextError> {
    parameter_named(text).map(Name)
}

fn axis(text: &str) -> Result<AxisId, String> {
    let id = text.parse().ok().and_then(AxisId::new);
    id.ok_or_else(|| format!("`{text}` is no axis: write a number from 1 to 63"))
}
