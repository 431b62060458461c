//! `tactpad ablation`: all decoders on the twin, beside the paper's Table 3.

mod plots;
mod tables;
mod timing;

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use clap::Args;
use serde::Serialize;

use super::device::Pad as PadFiles;
use super::field_cache::field_of;
use super::progress::Progress;
use super::twin::NUMERICAL;
use super::{Failure, decoder_file, print_json};
use crate::ablation::entries::{ENTRIES, Entry};
use crate::ablation::fitting::decoders;
use crate::ablation::unseen::{Judged, Least, Unseen, unseen};
use crate::ablation::{Pad, Subject};
use crate::contact::Decoder;
use crate::evaluation::Errors;
use crate::network::training::Epoch;
use crate::network::{Network, Zero};
use crate::scdf::HIDDEN;
use crate::scdf::simulation::{examples, pretrain};

/// Arguments of `tactpad ablation`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad ablation --seed 1 --out ablation\n\n\
                  It takes one or two minutes. Without --device and --imperfections the pad has those that come out as the \
                  paper's figures.")]
pub(super) struct Arguments {
    #[command(flatten)]
    pad: PadFiles,
    /// Draws what is random: the pad is calibrated with this seed; the contacts that are tried have the next two.
    #[arg(long, default_value = "1")]
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

/// Everything that the verb finds out.
#[derive(Serialize)]
struct Report {
    /// Whose figures these are.
    statement: String,
    /// What the decoders learnt from.
    seed: u64,
    rows: Vec<Row>,
    /// Files that were written.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    files: Vec<String>,
}

/// A decoder and its errors.
#[derive(Serialize)]
struct Row {
    #[serde(flatten)]
    entry: Entry,
    /// Median time of one decode, one processor; null where this program has no clock.
    decode_us: Option<f64>,
    unseen: Vec<Tried>,
}

/// Its errors on one table.
#[derive(Clone, Copy, Serialize)]
struct Tried {
    plan: &'static str,
    seed: u64,
    contacts: usize,
    /// Against the truth.
    truth: Errors,
    /// Against what the rig wrote.
    labels: Errors,
    /// Share of the truths in the decoder's 95 % regions; null for a decoder without.
    coverage95: Option<f64>,
    /// The least that the twin's noise allows.
    bound: Least,
}

/// What is tried on what, and what came of it.
struct Trials {
    unseen: [Unseen; 2],
    decoders: Vec<Decoder>,
    /// For each of the unseen tables, for each decoder.
    judged: [Vec<Judged>; 2],
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(path) = arguments.out.as_deref().filter(|path| path.exists() && !path.is_dir()) {
        return Err(Failure::Unusable(format!("{} is no folder; name another", path.display())));
    }
    let network = arguments.network.as_deref().map(tared_network).transpose()?;
    let (designed, device) = (arguments.pad.designed()?, arguments.pad.read_imperfect()?);
    let (nominal, field) = (field_of(&designed)?, field_of(&device)?);
    let subject = Subject {
        designed: Pad { device: &designed, field: &nominal },
        actual: Pad { device: &device, field: &field },
        seed: arguments.seed,
    };
    let mut progress = Progress::begin();
    let network = network.unwrap_or_else(|| trained(&subject, &mut progress));
    let trials = Trials::of(&subject, &network, progress)?;
    let files = match &arguments.out {
        Some(folder) => plots::write(folder, &subject, &trials)?,
        None => Vec::new(),
    };
    let mut report = Report {
        statement: format!("This is {NUMERICAL}."),
        seed: arguments.seed,
        rows: trials.rows(),
        files,
    };
    if let Some(folder) = &arguments.out {
        report.files.push(tables::write_csv(folder, &report.rows)?);
    }
    if arguments.json { print_json(&report) } else { Ok(tables::print(&report)?) }
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

fn trained(subject: &Subject<'_>, progress: &mut Progress) -> Network {
    let Subject { designed, seed, .. } = *subject;
    let examples = examples(designed.device, designed.field, seed);
    let report = |Epoch { number, .. }: &Epoch| {
        progress.step(format_args!("training the network on simulated contacts: epoch {number}"));
    };
    pretrain(HIDDEN, examples, seed, report).trained.network
}

impl Trials {
    fn of(subject: &Subject<'_>, network: &Network, progress: Progress) -> Result<Self, Failure> {
        let progress = Mutex::new(progress);
        let report = |done: usize| {
            if let Ok(mut progress) = progress.lock() {
                progress.step(format_args!("{done} of {} decoders are fitted", ENTRIES.len()));
            }
        };
        report(0);
        let decoders = decoders(*subject, network, ENTRIES, report)
            .map_err(|error| Failure::Failed(error.to_string()))?;
        let unseen = unseen(subject);
        let judged = unseen.each_ref().map(|table| decoders.iter().map(|it| table.judged(it)).collect());
        Ok(Self { unseen, decoders, judged })
    }

    fn rows(&self) -> Vec<Row> {
        let row = |(index, entry): (usize, &Entry)| Row {
            entry: *entry,
            decode_us: timing::median_us(&self.decoders[index], &self.unseen),
            unseen: self
                .unseen
                .iter()
                .zip(&self.judged)
                .map(|(it, judged)| Tried::of(it, &judged[index]))
                .collect(),
        };
        ENTRIES.iter().enumerate().map(row).collect()
    }
}

impl Tried {
    fn of(unseen: &Unseen, judged: &Judged) -> Self {
        Self {
            plan: unseen.plan,
            seed: unseen.seed,
            contacts: unseen.truths().len(),
            truth: judged.by_truth,
            labels: judged.by_labels,
            coverage95: judged.coverage95,
            bound: unseen.least(unseen.truths()),
        }
    }
}
