//! The arguments of `tactpad tune`, and the files that they name.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::failure::Failure;
use crate::cli::files::decoder_file::DecoderChoice;
use crate::cli::files::recording::{Profiles, Recording};
use crate::cli::number;
use crate::cli::playing::profile::ProfileDestination;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::{both_print, is_same, is_stdout, written_over};
use tactpad::lab::tuning::trace::{Trace, Tracer};
use tactpad::pipeline::mapping::profile::Profile;

/// Arguments of `tactpad tune`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad tune game.cap --labelled game.csv --profile super-mario --write mine\n\n\
    The table begins with the line begin_s,end_s,meant. Each line below it is a press: seconds since the recording's \
    first sample by the pad's clock, and what was meant: up, down, left, right, button 1, a control's name as \
    BTN_SOUTH, several as right+BTN_SOUTH, or none.\n\n\
    Without a table: tactpad record range.cap --pad auto --force-range, which says when to press lightly and when \
    hard; then tactpad tune range.cap --force-range --profile super-mario --write mine"
)]
pub(crate) struct Arguments {
    /// The capture that tactpad record made; without it the one beside the table, game.cap for game.csv.
    pub(super) capture: Option<PathBuf>,
    /// A CSV of what was meant when: begin_s,end_s,meant.
    #[arg(long, value_name = "FILE", required_unless_present = "force_range")]
    pub(super) labelled: Option<PathBuf>,
    /// Fit the normal forces alone, to presses that are light in the recording's first half and hard in its second.
    #[arg(long, conflicts_with_all = ["labelled", "delay_ms"], requires = "capture")]
    pub(super) force_range: bool,
    /// The profile to begin with: a name or a file.
    #[arg(long)]
    pub(super) profile: String,
    /// Without it the contacts are those of the decoder that the capture was recorded with.
    #[command(flatten)]
    pub(super) decoder: DecoderChoice,
    /// How late the profile may decide at most, in milliseconds; a profile that is later already may stay so.
    #[arg(long, value_name = "MS", default_value_t = 200, value_parser = parse_delay, allow_hyphen_values = true)]
    pub(super) delay_ms: u32,
    /// Write the fitted profile: a new one of your own, by its name, or a file. Comments and layout stay.
    #[arg(long, value_name = "NAME|FILE")]
    pub(super) write: Option<String>,
    /// Print one JSON document.
    #[arg(long)]
    pub(super) json: bool,
}

/// The milliseconds that a profile may take.
fn parse_delay(text: &str) -> Result<u32, String> {
    number::whole(text, &["ms"], 0..=5_000, "milliseconds from 0 to 5000, such as 200 or 200ms")
}

impl Arguments {
    /// The capture, or the one beside the table.
    pub(super) fn capture(&self, labelled: &Path) -> Result<PathBuf, Failure> {
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
    pub(super) fn stored(&self, to: &str, capture: &Path) -> Result<ProfileDestination, Failure> {
        let stored = ProfileDestination::of(to, &self.profile)?;
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
    pub(super) fn trace(&self, capture: &Path, profile: &Profile) -> Result<Trace, Failure> {
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
