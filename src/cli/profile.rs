//! `tactpad profile`: list, show, check.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use clap::{Args, Subcommand};
use serde::Serialize;

use super::{Failure, print_json};
use crate::mapping::check::{self, OutputChoice};
use crate::mapping::diag::{Diagnostic, Severity};
use crate::mapping::profile::Profile;
use crate::mapping::shipped;

/// Arguments of `tactpad profile`.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Names of the profiles that are inside the program.
    List,
    /// Print a profile's text, to begin one's own with: tactpad profile show contra > my-contra.toml
    Show {
        /// A name from `profile list`, or a file.
        profile: String,
    },
    /// Say everything that is wrong with a profile: tactpad profile check my-contra.toml
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
        Action::Show { profile } => Ok(io::stdout().write_all(text(profile)?.as_bytes())?),
        Action::Check { profile, json } => report(profile, *json),
    }
}

/// The text of a shipped profile or of a file. A name with a dot or a slash is a file's.
pub(super) fn text(profile: &str) -> Result<String, Failure> {
    if let Some(text) = shipped::text(profile) {
        return Ok(text.to_owned());
    }
    if !Path::new(profile).exists() && !profile.contains(['.', '/']) {
        let names: Vec<_> = shipped::names().collect();
        let names = names.join(", ");
        return Err(Failure::Unusable(format!(
            "there is no profile {profile:?}: choose one of {names}, or give a file"
        )));
    }
    fs::read_to_string(profile)
        .map_err(|error| Failure::Unusable(format!("profile {profile} cannot be read: {error}")))
}

/// Reads a profile that is to be used. Warnings go to stderr; errors make it unusable.
pub(super) fn read(profile: &str, output: OutputChoice) -> Result<(String, Profile), Failure> {
    let text = text(profile)?;
    let (read, diagnostics) = check::read(&text, output);
    let mut told: String = diagnostics.iter().map(|diagnostic| diagnostic.render(profile) + "\n").collect();
    match read {
        Some(read) => {
            let _ = io::stderr().write_all(told.as_bytes());
            Ok((text, read))
        }
        None => {
            told.insert_str(0, &format!("profile {profile} cannot be used\n"));
            Err(Failure::Unusable(told.trim_end().to_owned()))
        }
    }
}

fn list() -> Result<(), Failure> {
    for name in shipped::names() {
        writeln!(io::stdout(), "{name}")?;
    }
    Ok(())
}

fn report(profile: &str, json: bool) -> Result<(), Failure> {
    let text = text(profile)?;
    let (read, diagnostics) = check::read(&text, OutputChoice::AsWritten);
    let errors = diagnostics.iter().filter(|diagnostic| diagnostic.severity == Severity::Error).count();
    if json {
        print_json(&CheckReport { ok: read.is_some(), diagnostics: &diagnostics })?;
    } else {
        for diagnostic in &diagnostics {
            writeln!(io::stdout(), "{}", diagnostic.render(profile))?;
        }
    }
    match read {
        Some(read) if !json => Ok(writeln!(io::stdout(), "{profile}: {} is in order", read.name)?),
        Some(_) => Ok(()),
        None => Err(Failure::Failed(format!("profile {profile} has {errors} error(s)"))),
    }
}
