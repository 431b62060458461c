//! The process that lifts keys of an X server if the bridge is killed. It is this program; nobody types its verb.

use std::env;
use std::path::PathBuf;
use std::process::Command;

use crate::cli::failure::Failure;
use tactpad::bridge::sink::x11::guard;

/// The name of the verb.
pub(in crate::cli) const VERB: &str = "guard-keys";

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Arguments {
    /// The record of what the bridge holds.
    record: PathBuf,
}

/// This program as a guardian; `None` where its file is not known.
pub(super) fn program() -> Option<Command> {
    let mut program = Command::new(env::current_exe().ok()?);
    program.arg(VERB);
    Some(program)
}

pub(in crate::cli) fn run(arguments: &Arguments) -> Result<(), Failure> {
    guard(&arguments.record).map(|_| ()).map_err(|error| Failure::Failed(error.to_string()))
}
