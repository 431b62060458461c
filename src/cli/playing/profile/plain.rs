//! `tactpad profile show --plain`: what a profile does, in plain words.

use std::io::Write;

use super::chosen;
use crate::cli::failure::Failure;
use crate::cli::printing::written::stdout;
use tactpad::pipeline::mapping::plain::summary::{Part, Summary};
use tactpad::pipeline::mapping::read::check::OutputChoice;

/// Prints what a profile does, a line for each thing, in columns.
pub(super) fn print(profile: &str) -> Result<(), Failure> {
    let summary = Summary::of(chosen::read(profile, OutputChoice::AsWritten)?.profile());
    let width =
        |of: fn(&Part) -> &str| summary.does.iter().map(|part| of(part).chars().count()).max().unwrap_or(0);
    let [hands, given] = [width(|part| &part.hand), width(|part| &part.gives)];
    let mut out = stdout();
    writeln!(out, "{}, played on the {}\n", summary.name, summary.output)?;
    for Part { hand, gives, numbers } in &summary.does {
        writeln!(out, "{}", format!("{hand:hands$}   {gives:given$}   {numbers}").trim_end())?;
    }
    let settings = summary.hand.iter().map(|(word, _)| word.chars().count()).max().unwrap_or(0);
    writeln!(out)?;
    for (word, value) in &summary.hand {
        writeln!(out, "{word:settings$}   {value}")?;
    }
    Ok(())
}
