//! `tactpad diagnose --play`: what changed in a pad between two captures of play.

use std::fmt;
use std::io::Write as _;
use std::path::Path;

use serde::Serialize;

use super::arguments::Arguments;
use super::document::Finding;
use super::engine::flaws;
use super::text::{cause, sized};
use crate::cli::adapt::play::heard;
use crate::cli::decoder_file;
use crate::cli::failure::Failure;
use crate::cli::field::field_of;
use crate::cli::progress::Progress;
use crate::cli::wrapped::hanging;
use crate::cli::written::{print_json, stdout};
use tactpad::lab::diagnosis::report;
use tactpad::lab::play::change::{ChangeError, Changed, Which, changed};
use tactpad::lab::play::reader::Reader;
use tactpad::quantity::CHANNEL_NAMES;

/// Version of the document's form.
const SCHEMA: u32 = 1;
/// What no press tells.
const UNSEEN: &str = "A gain that all channels share, and a shift or turn of all modules, stay unseen: no press tells them. A known \
                      weight tells the gain (tactpad weigh).";

#[derive(Serialize)]
struct Document<'c> {
    schema: u32,
    verdict: &'static str,
    findings: Vec<Finding<'c>>,
    presses: Presses,
    inflation: f64,
    least_module_gain: f64,
    unseen: [&'static str; 3],
    gatekeepers: [(); 0],
}

#[derive(Serialize)]
struct Presses {
    earlier: usize,
    later: usize,
}

pub(super) fn run(arguments: &Arguments, paths: [&Path; 2]) -> Result<(), Failure> {
    let device = arguments.pad.read()?;
    let [earlier, later] = paths;
    let before = heard_before(earlier)?;
    let after = heard(later, None)?;
    same_pad([&before, &after], paths)?;
    let field = field_of(&device)?;
    let flaws = flaws(&device);
    let windows = [before.finish(), after.finish()];
    let found = {
        let progress = Progress::begin("looking for changes");
        let report = |done: usize, of: usize| progress.part(done, of, "looking for changes");
        changed(windows.each_ref().map(Vec::as_slice), (&device, &field), &flaws, &report)
    };
    let found = found.map_err(|error| refused(&error, paths))?;
    let channels = CHANNEL_NAMES.map(str::to_owned);
    if arguments.json {
        return print_json(&Document::of(&found, &channels));
    }
    Ok(write!(stdout(), "{}", Text(&found, &channels))?)
}

/// The earlier capture. A decoder in its place is told as such.
fn heard_before(path: &Path) -> Result<Reader, Failure> {
    heard(path, None).map_err(|failure| {
        if decoder_file::read(path).is_err() {
            return failure;
        }
        let path = path.display();
        Failure::Unusable(format!(
            "{path} is a decoder, and --play is held against play: name an earlier capture"
        ))
    })
}

fn same_pad(readers: [&Reader; 2], [earlier, later]: [&Path; 2]) -> Result<(), Failure> {
    let [before, after] = readers.map(Reader::serial_number);
    match before.zip(after) {
        Some((before, after)) if before != after => Err(Failure::Unusable(format!(
            "{} is of the pad {after} and {} of the pad {before}: take two captures of one pad",
            later.display(),
            earlier.display()
        ))),
        _ => Ok(()),
    }
}

fn refused(error: &ChangeError, [earlier, later]: [&Path; 2]) -> Failure {
    let name = match error.which() {
        Some(Which::Earlier) => earlier.display().to_string(),
        Some(Which::Later) => later.display().to_string(),
        None => format!("{} against {}", later.display(), earlier.display()),
    };
    Failure::Unusable(format!("{name}: {error}"))
}

impl<'c> Document<'c> {
    fn of(found: &'c Changed, channels: &[String]) -> Self {
        let [earlier, later] = found.presses;
        Self {
            schema: SCHEMA,
            verdict: if found.findings.is_empty() { "no_change" } else { "changed" },
            findings: found.findings.iter().map(|it| Finding::of(it, channels)).collect(),
            presses: Presses { earlier, later },
            inflation: found.inflation,
            least_module_gain: found.least_module_gain,
            unseen: ["gain of all channels", "shift of all modules", "turn of all modules"],
            gatekeepers: [],
        }
    }
}

/// A change with its numbers, and what play does not tell it from.
fn told(finding: &report::Finding, channels: &[String]) -> String {
    let text = format!("{}; p {:.0e}", sized(finding, channels), finding.p_value);
    let others = finding.confounded_with.iter().map(|(effect, target)| cause(effect, target, channels));
    let others: Vec<String> = others.collect();
    if others.is_empty() {
        text + "."
    } else {
        format!("{text}. Play does not tell it from {}.", others.join(", or from "))
    }
}

/// What people read.
struct Text<'c>(&'c Changed, &'c [String]);

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(found, channels) = self;
        let [earlier, later] = found.presses;
        let held = format!("{later} presses against {earlier} earlier ones, in tenths of a second");
        let least = 100.0 * found.least_module_gain;
        let first = match found.findings.as_slice() {
            [] => format!(
                "No change ({held}). A module whose gain had changed by {least:.1} % would have been found in 95 of 100 such plays."
            ),
            _ => format!("The pad has changed ({held}):"),
        };
        writeln!(f, "{}", hanging("", &first))?;
        for (number, finding) in (1..).zip(&found.findings) {
            writeln!(f, "\n{}", hanging(&format!("{number:>3}  "), &told(finding, channels)))?;
        }
        writeln!(f, "\n{}", hanging("", UNSEEN))
    }
}
