//! `tactpad train`: stage I of the paper's decoder.

use std::fmt;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use crate::cli::failure::Failure;
use crate::cli::files::decoder_file;
use crate::cli::files::destination::{Destination, Folder};
use crate::cli::files::device::PadOptions;
use crate::cli::files::field::field_of;
use crate::cli::number;
use crate::cli::printing::pictures;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::{both_print, is_stdout, tell};
use tactpad::lab::scdf::drawing::{self, NAMES};
use tactpad::lab::scdf::simulation::{PAPER, Pretrained, examples, pretrain};
use tactpad::lab::scdf::{EPOCHS_MAX, HIDDEN, schematic};
use tactpad::network::Example;
use tactpad::network::training::Epoch;
use tactpad::network::training::score::{Score, Scores};

/// Arguments of `tactpad train`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad train --seed 1 --out scdf.onnx --figures figures\n\n\
                        It takes half a minute. Then adapt it to a pad: tactpad adapt --method scdf --from scdf.onnx")]
pub(crate) struct Arguments {
    /// The network to write, as ONNX; a file that is there is replaced, and - is standard output.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// A number that contacts, split, first weights and order are drawn by: the same seed gives the same file.
    #[arg(long, default_value = "0", value_parser = number::seed, allow_hyphen_values = true)]
    seed: u64,
    #[command(flatten)]
    pad: PadOptions,
    /// Write the figures train-network, train-loss and train-scatter-x to -fz into this folder, as SVG and PNG.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Print one JSON document: scores on the test's contacts, the paper's beside them, and the loss of each epoch.
    #[arg(long)]
    json: bool,
}

/// The report of `tactpad train`.
#[derive(Serialize)]
struct TrainReport {
    seed: u64,
    widths: Vec<usize>,
    parameters: usize,
    /// Contacts that it was tested on.
    test_rows: usize,
    /// In standardised units.
    test: Scores,
    paper: Score,
    validation_mse: f64,
    curve: Vec<Epoch>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { out, seed, pad, figures, json } = arguments;
    if *json && is_stdout(out) {
        return Err(both_print("--out -"));
    }
    pad.spare(out)?;
    let device = pad.read()?;
    let to = Destination::of(out)?;
    let folder = figures.as_deref().map(Folder::of).transpose()?;
    let examples = examples(&device, &field_of(&device)?, *seed);
    let pretrained = trained(examples, *seed);
    decoder_file::write_network(&to, &pretrained.trained.network)?;
    if let Some(folder) = &folder {
        pictures::write(folder, "train-network", &schematic::network(&pretrained.trained.network))?;
        let loss = drawing::training("Stage I", &pretrained.trained.curve, Some(PAPER));
        pictures::write(folder, "train-loss", &loss)?;
        for (name, figure) in drawing::scatters(&pretrained) {
            pictures::write(folder, &format!("train-scatter-{name}"), &figure)?;
        }
    }
    let outcome = TrainReport::of(&pretrained, *seed);
    tell(&outcome, out, *json)
}

fn trained(examples: Vec<Example>, seed: u64) -> Pretrained {
    let progress = Progress::begin("training the network");
    pretrain(HIDDEN, examples, seed, |Epoch { number, validation_mse, .. }| {
        let what = format_args!("epoch {number}: mean squared error {validation_mse:.4}");
        progress.part(*number, EPOCHS_MAX, what);
    })
}

impl TrainReport {
    fn of(pretrained: &Pretrained, seed: u64) -> Self {
        let Pretrained { trained, scores, test } = pretrained;
        Self {
            seed,
            widths: trained.network.widths(),
            parameters: trained.network.parameters(),
            test_rows: test.len(),
            test: *scores,
            paper: PAPER,
            validation_mse: trained.validation_mse,
            curve: trained.curve.clone(),
        }
    }
}

impl fmt::Display for TrainReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let widths: Vec<_> = self.widths.iter().map(usize::to_string).collect();
        writeln!(f, "{}: {} weights, {} epochs", widths.join("-"), self.parameters, self.curve.len())?;
        writeln!(f, "on {} contacts that it has not seen, in standardised units:", self.test_rows)?;
        write!(f, "{:<6} {:>8} {:>8} {:>8}", "", "MSE", "MAE", "R²")?;
        let rows = [("all", &self.test.all), ("paper", &self.paper)];
        for (name, Score { mse, mae, r2 }) in rows.into_iter().chain(NAMES.into_iter().zip(&self.test.each)) {
            write!(f, "\n{name:<6} {mse:>8.4} {mae:>8.4} {r2:>8.4}")?;
        }
        Ok(())
    }
}
