//! `tactpad profile`: list, show, check.

use std::io::{self, Write};
use std::path::Path;

use clap::{Args, Subcommand};
use serde::Serialize;

use super::failure::{Failure, if_read};
use super::text_file;
use super::written::{print_json, stdout};
use tactpad::pipeline::mapping::check::{self, OutputChoice};
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::shipped;
use tactpad::toml_text::diag::Diagnostic;

/// Arguments of `tactpad profile`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad profile check my-contra.toml")]
pub(super) struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Names of the profiles that are inside the program.
    #[command(after_help = "Example: tactpad profile list")]
    List,
    /// Print a profile's text, to begin one's own with.
    #[command(after_help = "Example: tactpad profile show contra > my-contra.toml")]
    Show {
        /// A name from `profile list`, or a file.
        profile: String,
    },
    /// Say everything that is wrong with a profile.
    #[command(after_help = "Example: tactpad profile check my-contra.toml")]
    Check {
        /// A name from `profile list`, or a file.
        profile: String,
        /// Print one JSON document.
        #[arg(long)]
        json: bool,
    },
}

#[derive(Serialize)]
struct CheckReport<'a> {
    ok: bool,
    diagnostics: &'a [Diagnostic],
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.action {
        Action::List => list(),
        Action::Show { profile } => Ok(stdout().write_all(text(profile)?.as_bytes())?),
        Action::Check { profile, json } => report(profile, *json),
    }
}

/// The text of a shipped profile or of a file. A name with a dot or a slash is a file's.
pub(super) fn text(profile: &str) -> Result<String, Failure> {
    if let Some(text) = shipped::text(profile) {
        return Ok(text.to_owned());
    }
    let names: Vec<_> = shipped::names().collect();
    let names = names.join(", ");
    if !Path::new(profile).exists() && !profile.contains(['.', '/']) {
        return Err(Failure::Unusable(format!(
            "there is no profile {profile:?}: choose one of {names}, or give a file"
        )));
    }
    text_file::read(Path::new(profile)).map_err(|why| {
        Failure::Unusable(format!(
            "profile {profile} cannot be read: {why}; name another file, or one of {names}"
        ))
    })
}

/// Reads a profile that is to be used. Warnings go to stderr; errors make it unusable.
pub(super) fn read(profile: &str, output: OutputChoice) -> Result<ReadProfile, Failure> {
    let (read, diagnostics) = ReadProfile::read(&text(profile)?, output);
    let mut told: String = diagnostics.iter().map(|diagnostic| diagnostic.render(profile) + "\n").collect();
    match read {
        Some(read) => {
            // Where people cannot be warned, the profile still plays.
            let _ = io::stderr().write_all(told.as_bytes());
            Ok(read)
        }
        None => {
            told.insert_str(0, &format!("profile {profile} cannot be used\n"));
            Err(Failure::Unusable(told.trim_end().to_owned()))
        }
    }
}

fn list() -> Result<(), Failure> {
    for name in shipped::names() {
        writeln!(stdout(), "{name}")?;
    }
    Ok(())
}

fn report(profile: &str, json: bool) -> Result<(), Failure> {
    let text = text(profile)?;
    let (read, diagnostics) = check::read(&text, OutputChoice::AsWritten);
    if_read(print(profile, read.as_ref(), &diagnostics, json))?;
    read.map(|_| ()).ok_or_else(|| Failure::Failed(format!("profile {profile} has errors")))
}

fn print(
    profile: &str,
    read: Option<&Profile>,
    diagnostics: &[Diagnostic],
    json: bool,
) -> Result<(), Failure> {
    if json {
        return print_json(&CheckReport { ok: read.is_some(), diagnostics });
    }
    for diagnostic in diagnostics {
        writeln!(stdout(), "{}", diagnostic.render(profile))?;
    }
    read.map_or(Ok(()), |read| Ok(writeln!(stdout(), "{profile}: {} is in order", read.name)?))
}
