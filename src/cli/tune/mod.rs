//! `tactpad tune`: fits a profile to a hand.

mod force_range;
mod report;
mod words;

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use self::report::{HeldOut, Outcome, Pair};
use super::decoder_file::Choice;
use super::failure::Failure;
use super::profile::{self, Stored};
use super::progress::Progress;
use super::recording::{Profiles, Recording};
use super::text_file;
use super::written::{both_print, is_same, is_stdout, print_json, stdout, written_over};
use tactpad::lab::tuning::fitting::{Fitted, Study};
use tactpad::lab::tuning::labels::Labels;
use tactpad::lab::tuning::trace::{Trace, Tracer};
use tactpad::pipeline::mapping::check::OutputChoice;
use tactpad::pipeline::mapping::profile::Profile;

/// With fewer labels none are left to try a fit on that has not seen them.
const HELD_OUT_MIN: usize = 40;

/// Arguments of `tactpad tune`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad tune game.cap --labelled game.csv --profile super-mario --write mine\n\n\
    The table begins with the line begin_s,end_s,meant. Each line below it is a press: seconds since the recording's \
    first sample by the pad's clock, and what was meant: up, down, left, right, button 1, a control's name as \
    BTN_SOUTH, several as right+BTN_SOUTH, or none.\n\n\
    Without a table: tactpad record range.cap --seconds 30, in which the person presses again and again, up to the \
    middle as lightly as feels sure and after it as hard as is comfortable; then tactpad tune range.cap --force-range \
    --profile super-mario --write mine"
)]
pub(super) struct Arguments {
    /// The capture that tactpad record made; without it the one beside the table, game.cap for game.csv.
    capture: Option<PathBuf>,
    /// A CSV of what was meant when: begin_s,end_s,meant.
    #[arg(long, value_name = "FILE", required_unless_present = "force_range")]
    labelled: Option<PathBuf>,
    /// Fit the normal forces alone, to presses that are light in the recording's first half and hard in its second.
    #[arg(long, conflicts_with_all = ["labelled", "delay_ms"], requires = "capture")]
    force_range: bool,
    /// The profile to begin with: a name or a file.
    #[arg(long)]
    profile: String,
    /// Without it the contacts are those of the decoder that the capture was recorded with.
    #[command(flatten)]
    decoder: Choice,
    /// The profile may decide so late, in milliseconds; one that is later already may stay so.
    #[arg(long, value_name = "MS", default_value_t = 200, value_parser = clap::value_parser!(u32).range(0..=5_000))]
    delay_ms: u32,
    /// Write the fitted profile: a new one of your own, by its name, or a file. Comments and layout stay.
    #[arg(long, value_name = "NAME|FILE")]
    write: Option<String>,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
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
    let mut outcome = Outcome::of(&study, read.profile(), &fitted, held_out);
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
    Labels::read(&text, profile).map_err(|error| Failure::Unusable(format!("{}:{error}", path.display())))
}

impl Arguments {
    /// The capture, or the one beside the table.
    fn capture(&self, labelled: &Path) -> Result<PathBuf, Failure> {
        if let Some(capture) = &self.capture {
            return Ok(capture.clone());
        }
        let beside = labelled.with_extension("cap");
        if beside.exists() {
            return Ok(beside);
        }
        Err(Failure::Unusable(format!(
            "there is no {} beside the table: name the capture, as tactpad tune game.cap --labelled {}",
            beside.display(),
            labelled.display()
        )))
    }

    /// Where the profile is to be written, which is no file that is read.
    fn stored(&self, to: &str, capture: &Path) -> Result<Stored, Failure> {
        let stored = Stored::of(to, &self.profile)?;
        let table = self.labelled.as_deref().map(|labelled| (labelled, "is the table"));
        for (read, what) in [(capture, "is the recording")].into_iter().chain(table) {
            if let Some(path) = stored.path().filter(|path| is_same(path, read)) {
                return Err(written_over(path, what));
            }
        }
        match stored.path() {
            Some(path) if self.json && is_stdout(path) => Err(both_print("--write -")),
            _ => Ok(stored),
        }
    }

    /// The contacts of the capture.
    fn trace(&self, capture: &Path, profile: &Profile) -> Result<Trace, Failure> {
        let _progress = Progress::begin("reading the recording");
        let mut recording = Recording::open(capture)?;
        let mut tracer = Tracer::new(recording.decoder(&self.decoder)?, profile.clone());
        recording.each(Profiles::Skipped, |now, call| {
            tracer.apply(now, call);
            Ok(())
        })?;
        Ok(tracer.finish())
    }
}
