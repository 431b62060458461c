//! `tactpad twin`: measured-like data from the imperfect virtual pad.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::destination::Destination;
use super::device::Pad;
use super::failure::Failure;
use super::field::field_of;
use super::progress::Progress;
use super::tables;
use super::written::{both_print, is_same, is_stdout, print_json, say, stdout, written_over};
use tactpad::lab::rig::measurement::{Measurement, carry_out};
use tactpad::pad::device::Device;
use tactpad::tables::measured::columns::Kind;
use tactpad::tables::measured::{Row, Table};
use tactpad::tables::plans;

/// Said with everything that the twin makes.
pub(super) const NUMERICAL: &str = "a numerical twin: no hardware was measured";

/// Arguments of `tactpad twin`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad twin --plan paper --seed 1 --out measured.csv --truth truth.csv\n\n\
                        Without --device and --imperfections the pad has those that come out as the paper's figures."
)]
pub(super) struct Arguments {
    /// What is measured: paper or recommended, as `tactpad protocol` writes them, or a file of the same form.
    #[arg(long, value_name = "PLAN")]
    plan: PathBuf,
    #[command(flatten)]
    pad: Pad,
    /// Draws what is random: the same seed gives the same file.
    #[arg(long, default_value = "0")]
    seed: u64,
    /// The measured CSV to write; a file that is there is replaced, and - is standard output.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// The true contacts, row for row, which no rig would know.
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// Write the cycles of load up to each row as `cycle`, as a rig can count them: by them ageing is told.
    #[arg(long)]
    count_cycles: bool,
    /// Print one JSON document: what was made.
    #[arg(long)]
    json: bool,
}

/// What was made.
#[derive(Serialize)]
struct Outcome {
    rows: usize,
    trials: usize,
    seconds: f64,
    twin: &'static str,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { plan, pad, seed, out, truth, count_cycles, json } = arguments;
    if *json && is_stdout(out) {
        return Err(both_print("--out -"));
    }
    for written in [Some(out), truth.as_ref()].into_iter().flatten() {
        pad.spare(written)?;
        if is_same(plan, written) {
            return Err(written_over(written, "is the plan"));
        }
    }
    if truth.as_ref().is_some_and(|truth| is_same(truth, out)) {
        return Err(Failure::Unusable("--out and --truth name one file; name two".into()));
    }
    let device = pad.read_imperfect()?;
    let plan = planned(plan, &device, *seed)?;
    let (to, truth_to) = (Destination::of(out)?, truth.as_deref().map(Destination::of).transpose()?);
    let field = field_of(&device)?;
    let progress = Progress::begin("carrying out the plan");
    let measurement = carry_out(&plan, &device, &field, *seed);
    let measurement = if *count_cycles { measurement.counted() } else { measurement };
    drop(progress);
    tables::write(&to, &measurement.table)?;
    if let Some(to) = truth_to {
        tables::write(&to, &true_contacts(&measurement))?;
    }
    report(&measurement, *json, is_stdout(out))
}

/// The plan of this name, or in this file.
fn planned(plan: &Path, device: &Device, seed: u64) -> Result<Table, Failure> {
    match plan.to_str() {
        Some("paper") => Ok(plans::paper::plan(&device.contact)),
        Some("recommended") => Ok(plans::recommended::plan(&device.contact, seed)),
        _ => tables::on_the_plate(plan, Kind::Plan, device),
    }
}

/// The truth as a table of contacts.
fn true_contacts(measurement: &Measurement) -> Table {
    let rows = measurement.table.rows.iter().zip(&measurement.truth);
    Table {
        rows: rows.map(|(row, truth)| Row { t_s: row.t_s, ..Row::of(*truth) }).collect(),
        ..Table::default()
    }
}

fn report(measurement: &Measurement, json: bool, prints_table: bool) -> Result<(), Failure> {
    let Table { rows, trials, .. } = &measurement.table;
    let seconds = rows.last().and_then(|row| row.t_s).unwrap_or_default();
    let outcome = Outcome { rows: rows.len(), trials: trials.len(), seconds, twin: NUMERICAL };
    if json {
        return print_json(&outcome);
    }
    let Outcome { rows, trials, .. } = outcome;
    let told = format!("{rows} rows, {trials} time series, {seconds:.0} s on the pad's clock; {NUMERICAL}");
    if prints_table {
        say(told);
        return Ok(());
    }
    use std::io::Write as _;
    Ok(writeln!(stdout(), "{told}")?)
}
