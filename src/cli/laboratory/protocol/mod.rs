//! `tactpad protocol`: measuring plans.

mod drawing;

use std::fmt;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde::Serialize;

use crate::cli::failure::Failure;
use crate::cli::files::destination::{Destination, Folder};
use crate::cli::files::device::PadOptions;
use crate::cli::files::tables;
use crate::cli::number;
use crate::cli::printing::pictures;
use crate::cli::printing::written::{both_print, is_stdout, tell};
use tactpad::pad::device::Patch;
use tactpad::tables::measured::Table;
use tactpad::tables::measured::zero::ZERO;
use tactpad::tables::plans::{self, REACH_S, distinct_places};

/// Arguments of `tactpad protocol`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad protocol recommended --seed 1 --out plan.csv")]
#[group(skip)]
pub(crate) struct Arguments {
    /// The plan to write.
    plan: Plan,
    /// A number that the recommended plan is drawn by: the same seed gives the same plan. Nothing in the paper's plan is drawn.
    #[arg(long, default_value = "0", value_parser = number::seed, allow_hyphen_values = true)]
    seed: u64,
    /// The plan to write, as CSV; a file that is there is replaced, and - is standard output.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    pad: PadOptions,
    /// Draw where the contacts are into this folder, as SVG and PNG.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Print one JSON document: what the plan holds.
    #[arg(long)]
    json: bool,
}

/// The plans that there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Plan {
    /// The paper's calibration: 648 contacts at 72 places, in order, loading only.
    Paper,
    /// Random order, both approaches, two dwells, replicates, zeros, ramps: it separates what the paper's confounds.
    Recommended,
}

/// The contents of a plan.
#[derive(Serialize)]
struct PlanReport {
    plan: Plan,
    seed: u64,
    /// Of the table.
    rows: usize,
    /// Static contacts.
    presses: usize,
    /// Places of static contacts.
    places: usize,
    /// Static readings of the untouched pad.
    zeros: usize,
    /// Time series.
    trials: usize,
    /// With [`REACH_S`] for each contact and each trial.
    minutes: f64,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { plan, seed, out, pad, figures, json } = arguments;
    if *json && is_stdout(out) {
        return Err(both_print("--out -"));
    }
    let device = pad.read()?;
    pad.spare(out)?;
    let to = Destination::of(out)?;
    let folder = figures.as_deref().map(Folder::of).transpose()?;
    let table = plan.table(&device.contact, *seed);
    tables::write(&to, &table)?;
    let report = PlanReport::of(*plan, *seed, &table);
    if let Some(folder) = &folder {
        let name = format!("protocol-{}", plan.name());
        pictures::write(folder, &name, &drawing::places(report.title(), &table, &device))?;
    }
    report.print(out, *json)
}

impl Plan {
    fn table(self, patch: &Patch, seed: u64) -> Table {
        match self {
            Self::Paper => plans::paper::plan(patch),
            Self::Recommended => plans::recommended::plan(patch, seed),
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Recommended => "recommended",
        }
    }
}

impl PlanReport {
    fn of(plan: Plan, seed: u64, table: &Table) -> Self {
        let zero = table.sessions.iter().position(|name| name == ZERO);
        let samples = || table.rows.iter().filter(|row| row.trial.is_none());
        let presses: Vec<_> = samples().filter(|row| row.session != zero).collect();
        Self {
            plan,
            seed,
            rows: table.rows.len(),
            presses: presses.len(),
            places: distinct_places(presses.iter().copied()).len(),
            zeros: samples().count() - presses.len(),
            trials: table.trials.len(),
            minutes: (plans::duration_s(table) / 60.0).round(),
        }
    }

    fn title(&self) -> String {
        match self.plan {
            Plan::Paper => "The paper’s plan".to_owned(),
            Plan::Recommended => format!("The recommended plan, seed {}", self.seed),
        }
    }

    fn print(&self, out: &Path, json: bool) -> Result<(), Failure> {
        tell(self, out, json)
    }
}

impl fmt::Display for PlanReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { presses, places, zeros, minutes, .. } = self;
        writeln!(f, "{}: {presses} static contacts at {places} places, {zeros} zeros", self.title())?;
        match self.plan {
            Plan::Paper => writeln!(f, "216 normal ones, then 3 × 144 inclined ones, all of them loading")?,
            Plan::Recommended => writeln!(
                f,
                "in random order, from below and from above, held 2 or 20 s; then ramps and a held load: {} series",
                self.trials
            )?,
        }
        write!(
            f,
            "It takes {minutes} minutes if a contact takes {REACH_S} s to reach. docs/protocol.md says why so"
        )
    }
}
