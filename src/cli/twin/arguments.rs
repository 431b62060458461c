//! The arguments of `tactpad twin`.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::device::Pad;
use crate::cli::failure::Failure;
use crate::cli::written::{is_same, written_over};

/// Said with everything that the twin makes.
pub(crate) const NUMERICAL: &str = "a numerical twin: no hardware was measured";

/// Arguments of `tactpad twin`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad twin --plan paper --seed 1 --out measured.csv --truth truth.csv\n\n\
                        The same pad 5,000 cycles later: tactpad twin --plan paper --state pad.life --out first.csv, then \
                        tactpad twin --plan paper --state pad.life --cycles 5000 --seed 1 --out later.csv\n\n\
                        Without --device and --imperfections the pad has those that come out as the paper's figures."
)]
pub(crate) struct Arguments {
    /// What is measured: paper or recommended, as `tactpad protocol` writes them, or a file of the same form.
    #[arg(long, value_name = "PLAN")]
    pub(super) plan: PathBuf,
    #[command(flatten)]
    pub(super) pad: Pad,
    /// Draws what is random: the same seed gives the same file. Of a pad that --state takes up it draws the plan, the hand
    /// and the rig, not the pad.
    #[arg(long, default_value = "0")]
    pub(super) seed: u64,
    /// The measured CSV to write; a file that is there is replaced, and - is standard output.
    #[arg(long, value_name = "FILE")]
    pub(super) out: PathBuf,
    /// The true contacts, row for row, which no rig would know.
    #[arg(long, value_name = "FILE")]
    pub(super) truth: Option<PathBuf>,
    /// Takes up the pad's life where this file left it, if it is there, and writes it back: one pad in many runs.
    #[arg(long, value_name = "FILE")]
    pub(super) state: Option<PathBuf>,
    /// Load the pad so many times before the plan begins, a second each.
    #[arg(long, value_name = "N")]
    pub(super) cycles: Option<u32>,
    /// Write the cycles of load up to each row as `cycle`, as a rig can count them: by them ageing is told.
    #[arg(long)]
    pub(super) count_cycles: bool,
    /// Print one JSON document: what was made.
    #[arg(long)]
    pub(super) json: bool,
}

impl Arguments {
    /// The files to write, each with its option.
    fn written(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let files =
            [("--out", Some(&self.out)), ("--truth", self.truth.as_ref()), ("--state", self.state.as_ref())];
        files.into_iter().filter_map(|(option, file)| Some((option, file?.as_path())))
    }

    /// Refuses files that would be written over although they are read, or are written twice.
    pub(super) fn keep_apart(&self) -> Result<(), Failure> {
        for (index, (option, written)) in self.written().enumerate() {
            self.pad.spare(written)?;
            if is_same(&self.plan, written) {
                return Err(written_over(written, "is the plan"));
            }
            if let Some((other, _)) = self.written().take(index).find(|(_, other)| is_same(other, written)) {
                return Err(Failure::Unusable(format!("{other} and {option} name one file; name two")));
            }
        }
        Ok(())
    }
}
