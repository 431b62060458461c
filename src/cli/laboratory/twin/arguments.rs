//! The arguments of `tactpad twin`.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::failure::Failure;
use crate::cli::files::device::PadOptions;
use crate::cli::number;
use crate::cli::playing::profile;
use crate::cli::printing::seconds;
use crate::cli::printing::written::{is_same, written_over};

/// Said with everything that the twin makes.
pub(crate) const NUMERICAL: &str = "a numerical twin: no hardware was measured";

/// Arguments of `tactpad twin`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad twin --plan paper --seed 1 --out measured.csv --truth truth.csv\n\n\
                        The same pad 5,000 cycles later: tactpad twin --plan paper --state pad.life --out first.csv, then \
                        tactpad twin --plan paper --state pad.life --cycles 5000 --seed 1 --out later.csv\n\n\
                        Play: tactpad twin --plan play --seconds 120 --out game.cap, then tactpad replay game.cap\n\n\
                        Without --device and --imperfections the pad has the imperfections that reproduce the paper's figures."
)]
pub(crate) struct Arguments {
    /// What is measured: paper or recommended, as `tactpad protocol` writes them, or a file of the same form. Or what a hand
    /// does, as a capture: play, or presses anywhere.
    #[arg(long, value_name = "PLAN")]
    pub(super) plan: PathBuf,
    #[command(flatten)]
    pub(super) pad: PadOptions,
    /// A number that all random draws follow from: the same seed gives the same file. With --state the plan, the
    /// hand and the rig follow from it, not the pad.
    #[arg(long, default_value = "0", value_parser = number::seed, allow_hyphen_values = true)]
    pub(super) seed: u64,
    /// The measured CSV, or the capture, to write; a file that is there is replaced, and - is standard output.
    #[arg(long, value_name = "FILE")]
    pub(super) out: PathBuf,
    /// The true contacts, row for row, which no rig would know; of a capture, every 10 ms while the pad is touched.
    #[arg(long, value_name = "FILE")]
    pub(super) truth: Option<PathBuf>,
    /// Takes up the pad's life where this file left it, if it is there, and writes it back: one pad in many runs.
    #[arg(long, value_name = "FILE")]
    pub(super) state: Option<PathBuf>,
    /// How many times the pad is loaded before the plan begins, for a second each.
    #[arg(long, value_name = "N", value_parser = parse_cycles, allow_hyphen_values = true)]
    pub(super) cycles: Option<u32>,
    /// Write the cycles of load up to each row as `cycle`, as a rig can count them: by them ageing is told.
    #[arg(long)]
    pub(super) count_cycles: bool,
    /// With --plan play or presses: how many seconds it lasts, 120 without it.
    #[arg(long, value_parser = seconds::parse, allow_hyphen_values = true)]
    pub(super) seconds: Option<f64>,
    /// With --plan play or presses: the profile that is played and kept in the capture, by its name or file; super-mario
    /// without it.
    #[arg(long)]
    pub(super) profile: Option<String>,
    /// With --plan play or presses: touch no farther from the centre than this.
    #[arg(long, value_name = "MM", value_parser = number::millimetres, allow_hyphen_values = true)]
    pub(super) within_mm: Option<f64>,
    /// With --plan play or presses: lay a weight of this many grams on five marks afterwards.
    #[arg(long, value_name = "G", value_parser = number::grams, requires = "weights", allow_hyphen_values = true)]
    pub(super) weight_g: Option<f64>,
    /// With --weight-g: the CSV to write that says when the weight rested on which mark.
    #[arg(long, value_name = "FILE", requires = "weight_g")]
    pub(super) weights: Option<PathBuf>,
    /// Print one JSON document: what was made.
    #[arg(long)]
    pub(super) json: bool,
}

fn parse_cycles(text: &str) -> Result<u32, String> {
    number::whole(text, &["cycles"], 0..=u32::MAX, "a whole number of cycles from 0 up, such as 5000")
}

impl Arguments {
    /// The files to write, each with its option.
    fn written(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let files = [
            ("--out", Some(&self.out)),
            ("--truth", self.truth.as_ref()),
            ("--state", self.state.as_ref()),
            ("--weights", self.weights.as_ref()),
        ];
        files.into_iter().filter_map(|(option, file)| Some((option, file?.as_path())))
    }

    /// Refuses files that would be written over although they are read, or are written twice.
    pub(super) fn keep_apart(&self) -> Result<(), Failure> {
        for (index, (option, written)) in self.written().enumerate() {
            self.pad.spare(written)?;
            if is_same(&self.plan, written) {
                return Err(written_over(written, "is the plan"));
            }
            let profile = self.profile.as_deref().and_then(profile::file);
            if profile.is_some_and(|profile| is_same(&profile, written)) {
                return Err(written_over(written, "is the profile"));
            }
            if let Some((other, _)) = self.written().take(index).find(|(_, other)| is_same(other, written)) {
                return Err(Failure::Unusable(format!("{other} and {option} name one file; name two")));
            }
        }
        Ok(())
    }

    /// Refuses what belongs to the other kind of plan.
    pub(super) fn refuse_foreign(&self, is_capture: bool) -> Result<(), Failure> {
        let of_captures = [
            ("--seconds", self.seconds.is_some()),
            ("--profile", self.profile.is_some()),
            ("--within-mm", self.within_mm.is_some()),
            ("--weight-g", self.weight_g.is_some()),
        ];
        let of_tables = [("--count-cycles", self.count_cycles)];
        let (foreign, whose): (&[_], _) = match is_capture {
            true => (&of_tables, "measuring plans"),
            false => (&of_captures, "--plan play and --plan presses"),
        };
        match foreign.iter().find(|(_, is_given)| *is_given) {
            Some((option, _)) => {
                let plan = self.plan.display();
                Err(Failure::Unusable(format!("{option} belongs to {whose}, not to {plan}: leave it out")))
            }
            None => Ok(()),
        }
    }
}
