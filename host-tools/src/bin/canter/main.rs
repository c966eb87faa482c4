//! The command `canter`: parses the command line, runs one verb, maps errors to exit codes.

mod arguments;
mod commander;
mod context;
mod verb;

use arguments::Arguments;
use clap::Parser;
use std::io::Write;
use std::process::ExitCode;

fn main() -> ExitCode {
    // clap itself ends with exit code 2 where the command line is wrong.
    let arguments = Arguments::parse();
    let json = arguments.json;
    match verb::run(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if json {
                let told = serde_json::json!({ "error": format!("{error:#}") });
                // It may be stdout that failed; stderr has it as well.
                let _ = writeln!(std::io::stdout(), "{told}");
            }
            eprintln!("error: {error:#}");
            if verb::is_usage(&error) {
                return ExitCode::from(2);
            }
            ExitCode::FAILURE
        }
    }
}
