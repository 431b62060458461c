//! `tactpad ablation`: all decoders on the twin, beside the paper's Table 3.

mod report;
mod tables;
mod timing;

use std::path::{Path, PathBuf};

use clap::Args;

use self::report::AblationReport;
use crate::cli::failure::Failure;
use crate::cli::files::decoder_file;
use crate::cli::files::destination::Folder;
use crate::cli::files::device::PadOptions as PadFiles;
use crate::cli::files::field::field_of;
use crate::cli::laboratory::twin::NUMERICAL;
use crate::cli::number;
use crate::cli::printing::pictures;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::print_json;
use tactpad::lab::ablation::entries::ENTRIES;
use tactpad::lab::ablation::trials::Trials;
use tactpad::lab::ablation::{Pad, Subject};
use tactpad::lab::scdf::simulation::{examples, pretrain};
use tactpad::lab::scdf::{EPOCHS_MAX, HIDDEN};
use tactpad::network::training::Epoch;
use tactpad::network::{Network, Zero};
use tactpad::plot::figure::Figure;

/// Arguments of `tactpad ablation`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad ablation --seed 1 --out ablation\n\n\
                  It takes one or two minutes. Without --device and --imperfections the pad has the imperfections that \
                  reproduce the paper's figures.")]
pub(crate) struct Arguments {
    #[command(flatten)]
    pad: PadFiles,
    /// A number that all random draws follow from: the pad is calibrated with this seed; the contacts that
    /// are tried have the next two.
    #[arg(long, default_value = "1", value_parser = number::seed, allow_hyphen_values = true)]
    seed: u64,
    /// A network that train wrote, of this pad without its imperfections; else one is trained.
    #[arg(long, value_name = "FILE")]
    network: Option<PathBuf>,
    /// Write the table as CSV, and the plots as SVG and PNG, into this folder.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let network = arguments.network.as_deref().map(tared_network).transpose()?;
    let (designed, device) = (arguments.pad.designed()?, arguments.pad.read_imperfect()?);
    let folder = arguments.out.as_deref().map(Folder::of).transpose()?;
    let (nominal, field) = (field_of(&designed)?, field_of(&device)?);
    let subject = Subject {
        designed: Pad { device: &designed, field: &nominal },
        actual: Pad { device: &device, field: &field },
        seed: arguments.seed,
    };
    let network = network.unwrap_or_else(|| trained(&subject));
    let trials = trials(&subject, &network)?;
    let files = match &folder {
        Some(folder) => write_plots(folder, &trials.figures(&subject))?,
        None => Vec::new(),
    };
    let mut report = AblationReport {
        statement: format!("This is {NUMERICAL}."),
        seed: arguments.seed,
        rows: report::rows(&trials),
        files,
    };
    if let Some(folder) = &folder {
        report.files.push(tables::write_csv(folder, &report.rows)?);
    }
    if arguments.json { print_json(&report) } else { Ok(tables::print(&report)?) }
}

/// Writes the plots, and says the names of their SVG files.
fn write_plots(folder: &Folder, figures: &[(String, Figure)]) -> Result<Vec<String>, Failure> {
    let written =
        figures.iter().map(|(name, figure)| pictures::write(folder, name, figure).map(|[svg, _]| svg));
    written.collect()
}

/// A network of stage I from a file.
fn tared_network(path: &Path) -> Result<Network, Failure> {
    let network = decoder_file::read_network(path)?;
    if network.zero == Zero::Tared {
        return Ok(network);
    }
    Err(Failure::Unusable(format!(
        "network {} takes raw channels, and here they are relative to the untouched pad: name one that tactpad train wrote",
        path.display()
    )))
}

fn trained(subject: &Subject<'_>) -> Network {
    let Subject { designed, seed, .. } = *subject;
    let examples = examples(designed.device, designed.field, seed);
    let progress = Progress::begin("training the network");
    let report = |Epoch { number, .. }: &Epoch| {
        progress.part(*number, EPOCHS_MAX, format_args!("training the network: epoch {number}"));
    };
    pretrain(HIDDEN, examples, seed, report).trained.network
}

fn trials(subject: &Subject<'_>, network: &Network) -> Result<Trials, Failure> {
    let progress = Progress::begin("fitting the decoders");
    let report = |done: usize| {
        let what = format_args!("{done} of {} decoders are fitted", ENTRIES.len());
        progress.part(done, ENTRIES.len(), what);
    };
    report(0);
    Trials::of(subject, network, report).map_err(|error| Failure::Failed(error.to_string()))
}
