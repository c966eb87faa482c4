//! `canter dbc`, `completions`, `man`: for other tools.

use crate::arguments::Arguments;
use crate::context::print_all;
use anyhow::{Context as _, Result};
use clap::CommandFactory;
use clap_complete::Shell;

/// The protocol for CAN tools.
pub fn dbc() -> Result<()> {
    print(canter::dbc::generate().as_bytes())
}

/// The command line for a shell.
pub fn completions(shell: Shell) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "canter", &mut script);
    print(&script)
}

/// The command line for `man`, all verbs on one page after the other.
pub fn man() -> Result<()> {
    let mut command = Arguments::command();
    // Made whole first: options for all verbs and their names with the command's in front.
    command.build();
    let mut page = Vec::new();
    write_page(&command, &mut page)?;
    print(&page)
}

fn write_page(command: &clap::Command, page: &mut Vec<u8>) -> Result<()> {
    clap_mangen::Man::new(command.clone())
        .render(page)
        .context("cannot write the manual page")?;
    for verb in command.get_subcommands() {
        if verb.get_name() != "help" {
            write_page(verb, page)?;
        }
    }
    Ok(())
}

fn print(text: &[u8]) -> Result<()> {
    let text = std::str::from_utf8(text).context("what was made is no text")?;
    print_all(text.lines().map(str::to_owned))
}
