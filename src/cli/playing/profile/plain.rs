//! `tactpad profile show --plain` and `sheet`: what a profile does, in plain words.

use std::io::Write;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use super::chosen;
use crate::cli::failure::Failure;
use crate::cli::files::destination::Destination;
use crate::cli::printing::date::date;
use crate::cli::printing::written::stdout;
use tactpad::lab::play::sheet::Sheet;
use tactpad::pipeline::mapping::plain::summary::{Part, Reader, Summary};
use tactpad::pipeline::mapping::read::check::OutputChoice;

/// Prints what a profile does, a line for each thing, in columns.
pub(super) fn print(profile: &str) -> Result<(), Failure> {
    let summary = Summary::of(chosen::read(profile, OutputChoice::AsWritten)?.profile(), Reader::Tuner);
    let width =
        |of: fn(&Part) -> &str| summary.does.iter().map(|part| of(part).chars().count()).max().unwrap_or(0);
    let [hands, given] = [width(|part| &part.hand), width(|part| &part.gives)];
    let mut out = stdout();
    writeln!(out, "{}, played on the {}\n", summary.name, summary.output)?;
    for Part { hand, gives, numbers, .. } in &summary.does {
        writeln!(out, "{}", format!("{hand:hands$}   {gives:given$}   {numbers}").trim_end())?;
    }
    let settings = summary.hand.iter().map(|(word, _)| word.chars().count()).max().unwrap_or(0);
    writeln!(out)?;
    for (word, value) in &summary.hand {
        writeln!(out, "{word:settings$}   {value}")?;
    }
    Ok(())
}

/// Writes the sheet of a profile, or prints it.
pub(super) fn sheet(profile: &str, out: Option<&Path>) -> Result<(), Failure> {
    let read = chosen::read(profile, OutputChoice::AsWritten)?;
    let sheet = Sheet::of_profile(read.profile(), &today());
    let html = || sheet.html(&format!("{}, tactpad", read.profile().name)).into_bytes();
    let Some(path) = out else { return Ok(stdout().write_all(&html())?) };
    let kind = path.extension().map(|it| it.to_ascii_lowercase()).unwrap_or_default();
    let bytes = match kind.to_str() {
        Some("html" | "htm") => html(),
        Some("svg") => sheet.svg().into_bytes(),
        Some("pdf") => sheet.pdf(),
        _ => {
            return Err(Failure::Unusable(format!(
                "{}: a sheet is HTML, SVG or PDF; let its name end in .html, .svg or .pdf",
                path.display()
            )));
        }
    };
    Destination::of(path)?.write(&bytes)
}

/// The day, in universal time.
#[expect(
    clippy::disallowed_methods,
    reason = "a sheet says on which day it was made; nothing is decided by that"
)]
fn today() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let date = date(since.as_secs() * 1_000);
    date.split(' ').next().unwrap_or_default().to_owned()
}
