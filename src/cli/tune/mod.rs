//! `tactpad tune`: fits a profile to a hand.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::decoder_file::Choice;
use super::failure::Failure;
use super::profile;
use super::progress::Progress;
use super::recording::{Profiles, Recording};
use super::text_file;
use super::written::{print_json, stdout};
use tactpad::lab::tuning::confusion::Confusion;
use tactpad::lab::tuning::labels::Labels;
use tactpad::lab::tuning::scoring::{AFTER_US, Score};
use tactpad::lab::tuning::trace::{Trace, Tracer};
use tactpad::pipeline::mapping::check::OutputChoice;
use tactpad::pipeline::mapping::profile::Profile;

/// Arguments of `tactpad tune`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad tune --labelled game.csv --profile super-mario\n\n\
    The table begins with the line begin_s,end_s,meant. Each line below it is a press: seconds since the recording's \
    first sample by the pad's clock, and what was meant: up, down, left, right, button 1, a control's name as \
    BTN_SOUTH, several as right+BTN_SOUTH, or none.")]
pub(super) struct Arguments {
    /// The capture that tactpad record made; without it the one beside the table, game.cap for game.csv.
    capture: Option<PathBuf>,
    /// A CSV of what was meant when: begin_s,end_s,meant.
    #[arg(long, value_name = "FILE")]
    labelled: PathBuf,
    /// The profile to begin with: a name or a file.
    #[arg(long)]
    profile: String,
    /// Without it the contacts are those of the decoder that the capture was recorded with.
    #[command(flatten)]
    decoder: Choice,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

/// What came of it.
#[derive(Serialize)]
struct Outcome {
    events: usize,
    correct: usize,
    confusion: Confusion,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let read = profile::read(&arguments.profile, OutputChoice::AsWritten)?;
    let labels = read_labels(&arguments.labelled, read.profile())?;
    let trace = arguments.trace(read.profile())?;
    let score = Score::of(read.profile(), &trace, &labels, AFTER_US);
    let outcome = Outcome {
        events: labels.labels().len(),
        correct: score.correct(),
        confusion: Confusion::of(&labels, &score),
    };
    if arguments.json {
        return print_json(&outcome);
    }
    let share = 100.0 * score.share();
    Ok(writeln!(
        stdout(),
        "{} of {} correct ({share:.1} %)\n{}",
        outcome.correct,
        outcome.events,
        outcome.confusion
    )?)
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
    /// The contacts of the capture.
    fn trace(&self, profile: &Profile) -> Result<Trace, Failure> {
        let beside = self.labelled.with_extension("cap");
        let path = self.capture.as_deref().unwrap_or(&beside);
        if self.capture.is_none() && !path.exists() {
            return Err(Failure::Unusable(format!(
                "there is no {} beside the table: name the capture, as tactpad tune game.cap --labelled {}",
                path.display(),
                self.labelled.display()
            )));
        }
        let progress = Progress::begin("reading the recording");
        let mut recording = Recording::open(path)?;
        let mut tracer = Tracer::new(recording.decoder(&self.decoder)?, profile.clone());
        recording.each(Profiles::Skipped, |now, call| {
            tracer.apply(now, call);
            Ok(())
        })?;
        drop(progress);
        Ok(tracer.finish())
    }
}
