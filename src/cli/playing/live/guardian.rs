//! The process that lifts keys of an X server if the bridge is killed. It is this program; nobody types its word.

use std::env;
use std::ffi::OsString;
use std::process::Command;

use crate::cli::failure::Failure;
use tactpad::bridge::sink::x11::guard;

/// The word that makes this program a guardian; it is none of the verbs.
const WORD: &str = "guard-keys";

/// This program as a guardian; `None` where its file is not known.
pub(super) fn program() -> Option<Command> {
    let mut program = Command::new(env::current_exe().ok()?);
    program.arg(WORD);
    Some(program)
}

/// Guards the record that these words name, if they make a guardian of this process.
pub(crate) fn outcome(mut words: impl Iterator<Item = OsString>) -> Option<Result<(), Failure>> {
    let record = words.nth(1).filter(|word| word == WORD).and_then(|_| words.next())?;
    Some(guard(record.as_ref()).map(|_| ()).map_err(|error| Failure::Failed(error.to_string())))
}
