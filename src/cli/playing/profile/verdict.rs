//! `tactpad profile check`: everything that is wrong with a profile.

use std::io::Write;

use serde::Serialize;

use super::chosen::{self, ProfileSource};
use crate::cli::failure::{Failure, if_read};
use crate::cli::printing::written::{print_json, stdout};
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad::toml_text::diag::Diagnostic;

#[derive(Serialize)]
struct CheckReport<'a> {
    ok: bool,
    diagnostics: &'a [Diagnostic],
}

/// Says what there is to say about the profile `name`; it fails if that has errors.
pub(super) fn run(name: &str, json: bool) -> Result<(), Failure> {
    let ProfileSource { text, place } = chosen::find(name)?;
    let (read, diagnostics) = check::read(&text, OutputChoice::AsWritten);
    if_read(print(&place, read.as_ref(), &diagnostics, json))?;
    read.map(|_| ()).ok_or_else(|| Failure::Failed(format!("profile {place} has errors")))
}

fn print(place: &str, read: Option<&Profile>, diagnostics: &[Diagnostic], json: bool) -> Result<(), Failure> {
    if json {
        return print_json(&CheckReport { ok: read.is_some(), diagnostics });
    }
    for diagnostic in diagnostics {
        writeln!(stdout(), "{}", diagnostic.render(place))?;
    }
    read.map_or(Ok(()), |read| Ok(writeln!(stdout(), "{place}: {} is in order", read.name)?))
}
