//! What `canter log` can be asked.

use canter::bus::Bitrate;
use clap::{Args, Subcommand};

use super::bitrate;

#[derive(Args)]
pub struct LogArguments {
    #[command(subcommand)]
    pub action: LogAction,
}

#[derive(Subcommand)]
pub enum LogAction {
    /// Say what each frame means.
    Decode(LogFile),
    /// Show how full the bus was, and of what.
    Stats(LogStats),
    /// Send what hosts sent, once more, on the bus of --can: nodes that follow its SYNCs move as they did.
    Replay(LogFile),
}

#[derive(Args)]
pub struct LogFile {
    /// A log as `candump -L` or the demonstration writes it, or - for stdin.
    #[arg(value_name = "FILE")]
    pub file: String,
    /// Only what was on this interface, such as can0.
    #[arg(long, value_name = "NAME")]
    pub interface: Option<String>,
}

#[derive(Args)]
pub struct LogStats {
    #[command(flatten)]
    pub log: LogFile,
    /// The bus's bit rate in bit/s.
    #[arg(long, value_name = "RATE", value_parser = bitrate, default_value = "1000000")]
    pub bitrate: Bitrate,
}
