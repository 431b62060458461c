//! `tactpad evaluate`: a decoder's errors on a measured file.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::device::Pad;
use super::written::stdout;
use super::{Failure, decoder_file, print_json, tables};
use crate::contact::Decoder;
use crate::contact::recording::Recording;
use crate::device::Device;
use crate::evaluation::{self, Errors};
use crate::measured::columns::Kind;
use crate::measured::{Label, Table, zero};
use crate::network::Zero;
use crate::shipped;

/// Arguments of `tactpad evaluate`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad evaluate --decoder pad.decoder --measured unseen.csv --truth truth.csv"
)]
pub(super) struct Arguments {
    /// A decoder that `adapt` or `train` wrote; without it the one inside the program.
    #[arg(long, value_name = "FILE")]
    decoder: Option<PathBuf>,
    /// The measured file.
    #[arg(long, value_name = "M.csv")]
    measured: PathBuf,
    /// The true contacts of its rows, as `twin --truth` writes them.
    #[arg(long, value_name = "T.csv")]
    truth: Option<PathBuf>,
    #[command(flatten)]
    pad: Pad,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

/// What is found.
#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    by_labels: Errors,
    /// Share of the rows that are not one finger on the decoder's pad; null for a decoder that does not warn.
    warned: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    truth: Option<ByTruth>,
}

#[derive(Serialize)]
struct ByTruth {
    #[serde(flatten)]
    errors: Errors,
    /// Share of the true contacts in the decoder's 95 % regions; null for a decoder without.
    coverage95: Option<f64>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { decoder, measured, truth, pad, json } = arguments;
    let device = pad.read()?;
    let decoder = decoder.as_deref().map_or_else(|| Ok(shipped::decoder()), decoder_file::read)?;
    let table = tables::read(measured, Kind::Measured, device.plate.diameter_mm)?;
    let truth =
        truth.as_ref().map(|path| tables::read(path, Kind::Plan, device.plate.diameter_mm)).transpose()?;
    if let Some(truth) = truth.as_ref().filter(|truth| truth.rows.len() != table.rows.len()) {
        let (rows, truths) = (table.rows.len(), truth.rows.len());
        let measured = measured.display();
        return Err(Failure::Unusable(format!(
            "{measured} has {rows} rows, and its truth {truths}: give both of one run"
        )));
    }
    let taken = taken(&decoder, &table, &device).ok_or_else(|| {
        Failure::Unusable(format!(
            "{}: no row without force says what the untouched pad reads, and neither does the decoder; measure some, or \
             adapt a decoder to a table without such rows",
            measured.display()
        ))
    })?;
    let report = report(&decoder, &taken, truth.as_ref());
    if report.by_labels.rows == 0 {
        return Err(Failure::Unusable(format!(
            "{}: no row has a contact and its nine channels",
            measured.display()
        )));
    }
    if *json { print_json(&report) } else { print(&report) }
}

/// The table as the decoder takes it. `None` if nothing says what the untouched pad reads, and the decoder has to know.
fn taken(decoder: &Decoder, table: &Table, device: &Device) -> Option<Table> {
    let full_scale_n = device.contact.full_scale_n;
    let raw = || Recording::raw(table.clone(), full_scale_n);
    let recording = Recording::of(table.clone(), full_scale_n)
        .or_else(|| decoder.zero_uv().map(|zero_uv| raw().less(zero_uv)))
        .or_else(|| (decoder.zero() == Zero::Raw).then(raw))?;
    Some(recording.taken(decoder))
}

fn report(decoder: &Decoder, taken: &Table, truth: Option<&Table>) -> Report {
    let places = zero::contacts(taken);
    let rows = taken.rows_at(&places);
    let found = evaluation::decoded(decoder, &rows);
    let labels: Vec<Label> = rows.iter().map(|row| row.label).collect();
    let by_truth = |truth: &Table| {
        let truths: Vec<Label> = places.iter().map(|at| truth.rows[*at].label).collect();
        ByTruth {
            errors: evaluation::errors(&found, &truths),
            coverage95: evaluation::coverage95(decoder, &rows, &truths),
        }
    };
    Report {
        by_labels: evaluation::errors(&found, &labels),
        warned: evaluation::warned(decoder, &rows),
        truth: truth.map(by_truth),
    }
}

fn print(report: &Report) -> Result<(), Failure> {
    let mut to = stdout();
    writeln!(to, "{} contacts", report.by_labels.rows)?;
    writeln!(to, "                 MAE mm  distance mm   RMSE mm   MAE N")?;
    let mut line = |name: &str, errors: &Errors| {
        let Errors { position_mae_mm, position_mean_euclid_mm, position_rmse_mm, force_mae_n, .. } = errors;
        writeln!(
            to,
            "{name:<14} {position_mae_mm:>8.3} {position_mean_euclid_mm:>12.3} {position_rmse_mm:>9.3} {force_mae_n:>7.4}"
        )
    };
    line("by its labels", &report.by_labels)?;
    if let Some(truth) = &report.truth {
        line("by the truth", &truth.errors)?;
        if let Some(coverage95) = truth.coverage95 {
            writeln!(to, "{:.1} % of the truths lie in the decoder's 95 % regions", 100.0 * coverage95)?;
        }
    }
    if let Some(warned) = report.warned {
        writeln!(to, "{:.1} % of the contacts are not one finger on the decoder's pad", 100.0 * warned)?;
    }
    Ok(())
}
