//! `tactpad source`: descriptions of pads: list, show, check, begin.

use std::io::Write;
use std::path::Path;

use clap::{Args, Subcommand};
use serde::Serialize;

use crate::cli::failure::{Failure, if_read};
use crate::cli::files::text_file;
use crate::cli::printing::written::{print_json, printable, stdout};
use tactpad::source::read::read;
use tactpad::source::{Measures, Origin, Source, shipped};
use tactpad::toml_text::diag::Diagnostic;

/// Where a new description begins.
const TEMPLATE: &str = "load-cells";

/// Arguments of `tactpad source`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad source show load-cells\n\n\
    A description says where a pad's numbers come from, what they are, and how they are a contact on the plate that profiles are \
    made for. `tactpad run --pad load-cells:/dev/ttyUSB0` plays with one inside the program, `--source FILE` names one of your own.")]
pub(crate) struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// List the descriptions inside the program.
    #[command(after_help = "Example: tactpad source list")]
    List {
        /// Print one JSON document.
        #[arg(long)]
        json: bool,
    },
    /// Print a description's text.
    #[command(after_help = "Example: tactpad source show load-cells > my-board.toml")]
    Show {
        /// A name from `source list`, or a file.
        source: String,
    },
    /// Say everything that is wrong with a description.
    #[command(after_help = "Example: tactpad source check my-board.toml")]
    Check {
        /// A name from `source list`, or a file.
        source: String,
        /// Print one JSON document.
        #[arg(long)]
        json: bool,
    },
    /// Print a new description to begin with, in which each key is explained.
    #[command(after_help = "Example: tactpad source new my-board > my-board.toml")]
    New {
        /// The new description's name: small letters, digits and -.
        #[arg(default_value = "my-pad")]
        name: String,
    },
    /// Print the JSON Schema of descriptions, for editors and programs.
    #[command(after_help = "Example: tactpad source schema > source.schema.json")]
    Schema,
}

#[derive(Serialize)]
struct SourceList {
    sources: Vec<ListedSource>,
}

#[derive(Serialize)]
struct ListedSource {
    name: &'static str,
    title: String,
    /// Where its numbers come from.
    origin: &'static str,
    channels: Vec<String>,
    /// What profiles can bind: place and force into the plate, and shear where it is measured.
    measures: Vec<&'static str>,
}

#[derive(Serialize)]
struct CheckReport<'a> {
    ok: bool,
    diagnostics: &'a [Diagnostic],
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.action {
        Action::List { json } => list(*json),
        Action::Show { source } => Ok(stdout().write_all(find(source)?.text.as_bytes())?),
        Action::Check { source, json } => check(source, *json),
        Action::New { name } => new(name),
        Action::Schema => Ok(stdout().write_all(shipped::schema().as_bytes())?),
    }
}

/// A description's text, and what findings call the place where it stands.
pub(crate) struct FoundSource {
    pub(crate) text: String,
    pub(crate) place: String,
}

/// The text of the description `name`. A name with a dot or a slash is a file's.
pub(crate) fn find(name: &str) -> Result<FoundSource, Failure> {
    if let Some(text) = shipped::text(name) {
        return Ok(FoundSource { text: text.to_owned(), place: name.to_owned() });
    }
    let path = Path::new(name);
    if !name.contains(['.', '/']) && !path.exists() {
        return Err(unknown(name));
    }
    let place = printable(&path.display().to_string());
    let text = text_file::read(path).map_err(|why| {
        Failure::Unusable(format!("description {place} cannot be read: {why}; name another file"))
    })?;
    Ok(FoundSource { text, place })
}

/// The error for a name that no description has.
pub(crate) fn unknown(name: &str) -> Failure {
    let known = shipped::names().collect::<Vec<_>>().join(", ");
    Failure::Unusable(format!(
        "there is no description {name:?}: choose one of {known}, or give a file of your own with --source (`tactpad source new`)"
    ))
}

/// Reads a description that is to be used; all that is wrong with it makes it unusable.
pub(crate) fn usable(found: &FoundSource) -> Result<Source, Failure> {
    let FoundSource { text, place } = found;
    let (source, diagnostics) = read(text);
    source.ok_or_else(|| {
        let messages: Vec<String> = diagnostics.iter().map(|diagnostic| diagnostic.render(place)).collect();
        Failure::Unusable(format!("description {place} cannot be used\n{}", messages.join("\n")))
    })
}

fn list(json: bool) -> Result<(), Failure> {
    let listed = |name: &'static str| {
        let source = read(shipped::text(name)?).0?;
        let mut measures = vec!["place", "fz"];
        if source.has_shear() {
            measures.extend(["fx", "fy"]);
        }
        let (origin, channels) = (origin(&source), source.channel_names());
        Some(ListedSource { name, title: source.title, origin, channels, measures })
    };
    let sources: Vec<ListedSource> = shipped::names().filter_map(listed).collect();
    if json {
        return print_json(&SourceList { sources });
    }
    for ListedSource { name, title, .. } in &sources {
        writeln!(stdout(), "{name:<18} {title}")?;
    }
    Ok(())
}

const fn origin(source: &Source) -> &'static str {
    match source.origin {
        Origin::Lines(_) => "lines",
        Origin::Wire => "wire",
        Origin::Evdev(_) => "evdev",
    }
}

/// Says what there is to say about a description; it fails if that has errors.
fn check(name: &str, json: bool) -> Result<(), Failure> {
    let FoundSource { text, place } = find(name)?;
    let (source, diagnostics) = read(&text);
    if_read(print(&place, source.as_ref(), &diagnostics, json))?;
    source.map(|_| ()).ok_or_else(|| Failure::Failed(format!("description {place} has errors")))
}

fn print(
    place: &str,
    source: Option<&Source>,
    diagnostics: &[Diagnostic],
    json: bool,
) -> Result<(), Failure> {
    if json {
        return print_json(&CheckReport { ok: source.is_some(), diagnostics });
    }
    for diagnostic in diagnostics {
        writeln!(stdout(), "{}", diagnostic.render(place))?;
    }
    let Some(source) = source else { return Ok(()) };
    let what = match &source.measures {
        Measures::Contact(touching) if touching.force.is_none() => "place, and one force".to_owned(),
        Measures::Contact(_) => "place and fz, no fx, no fy".to_owned(),
        Measures::Cells(cells, _) => format!("{} load cells: place and fz, no fx, no fy", cells.len()),
        Measures::Wrench(..) => "six axes: place, fx, fy and fz".to_owned(),
    };
    Ok(writeln!(stdout(), "{place}: {} is in order ({what})", source.name)?)
}

/// Prints the shipped description with another name.
fn new(name: &str) -> Result<(), Failure> {
    let was = format!("name = \"{TEMPLATE}\"");
    let text = shipped::text(TEMPLATE).unwrap_or_default().replacen(&was, &format!("name = \"{name}\""), 1);
    if read(&text).0.is_none() {
        return Err(Failure::Unusable(format!(
            "{name:?} cannot be the name of a description: take 1 to 32 small letters, digits and -"
        )));
    }
    Ok(stdout().write_all(text.as_bytes())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_has_a_name_that_is_replaced() {
        assert!(shipped::text(TEMPLATE).unwrap().contains(&format!("\nname = \"{TEMPLATE}\"\n")));
    }
}
