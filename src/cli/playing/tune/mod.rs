//! `tactpad tune`: fits a profile to a hand.

mod arguments;
mod force_range;
mod report;

use std::io::Write;
use std::path::Path;

pub(super) use self::arguments::Arguments;
use self::report::{HeldOut, Pair, TuneReport};
use super::profile;
use crate::cli::failure::Failure;
use crate::cli::files::tables;
use crate::cli::files::text_file;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::{print_json, stdout};
use tactpad::lab::tuning::fitting::{Fitted, Study};
use tactpad::lab::tuning::labels::Labels;
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::check::OutputChoice;

/// With fewer labels none are left to try a fit on that has not seen them.
const HELD_OUT_MIN: usize = 40;

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match (&arguments.labelled, &arguments.capture) {
        (Some(labelled), _) => fit_labelled(arguments, labelled),
        (None, Some(capture)) => force_range::run(arguments, capture),
        // The arguments ask for one of them.
        (None, None) => Err(Failure::Unusable("name a recording".into())),
    }
}

fn fit_labelled(arguments: &Arguments, labelled: &Path) -> Result<(), Failure> {
    let Arguments { profile: name, write, json, .. } = arguments;
    let read = profile::read(name, OutputChoice::AsWritten)?;
    let labels = read_labels(labelled, read.profile())?;
    let capture = arguments.capture(labelled)?;
    let stored = write.as_deref().map(|to| arguments.stored(to, &capture)).transpose()?;
    let trace = arguments.trace(&capture, read.profile())?;
    let last = labels.labels().last().map_or(0, |label| label.begin_us);
    if last >= trace.duration_us() {
        return Err(Failure::Unusable(format!(
            "{} has a label at {:.1} s, and {} lasts {:.1} s: times count from the recording's first sample",
            labelled.display(),
            last as f64 * 1e-6,
            capture.display(),
            trace.duration_us() as f64 * 1e-6
        )));
    }
    let study = Study { trace: &trace, labels: &labels, delay_max_us: 1_000 * u64::from(arguments.delay_ms) };
    let fitted = fit(&study, read.text())?;
    let held_out = held_out(&study, read.text(), read.profile())?;
    let mut outcome = TuneReport::of(&study, read.profile(), &fitted, held_out);
    if let Some(stored) = stored.filter(|_| !fitted.changes.is_empty()) {
        outcome.written = Some(stored.write(&fitted.text)?.display().to_string());
    }
    if *json { print_json(&outcome) } else { Ok(writeln!(stdout(), "{outcome}")?) }
}

fn fit(study: &Study<'_>, text: &str) -> Result<Fitted, Failure> {
    let progress = Progress::begin("trying numbers");
    let fitted = study.fit(text, &|done, of| progress.part(done, of, "trying numbers"));
    // It was read before.
    fitted.ok_or_else(|| Failure::Failed("the profile cannot be fitted".into()))
}

/// Fits to the first half of the labels and counts what is right in the second; nothing if they are few.
fn held_out(study: &Study<'_>, text: &str, given: &Profile) -> Result<Option<HeldOut>, Failure> {
    let all = study.labels.labels();
    let Some(first) = all.get(all.len() / 2).filter(|_| all.len() >= HELD_OUT_MIN) else { return Ok(None) };
    let halves = [(0, first.begin_us), (first.begin_us, u64::MAX)]
        .map(|(from_us, to_us)| (study.trace.between(from_us, to_us), study.labels.between(from_us, to_us)));
    let [first, second] = halves.each_ref().map(|(trace, labels)| Study { trace, labels, ..*study });
    let fitted = fit(&first, text)?;
    let [before, after] = [given, &fitted.profile].map(|profile| second.score(profile).correct());
    Ok(Some(HeldOut { events: second.labels.labels().len(), correct: Pair { before, after } }))
}

/// Reads the table of labels.
fn read_labels(path: &Path, profile: &Profile) -> Result<Labels, Failure> {
    let text = text_file::read(path).map_err(|why| {
        Failure::Unusable(format!(
            "{} cannot be read: {why}; name a table of what was meant when",
            path.display()
        ))
    })?;
    let labels = Labels::read(&text, profile);
    let labels = labels.map_err(|error| Failure::Unusable(format!("{}:{error}", path.display())))?;
    tables::warn(path, labels.open_end());
    Ok(labels)
}
