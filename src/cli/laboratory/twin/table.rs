//! Measuring plans: what is written, and what is told of it.

use std::io::Write as _;
use std::path::Path;

use serde::Serialize;

use super::arguments::{Arguments, NUMERICAL};
use super::life::{self, LifeFile};
use crate::cli::failure::Failure;
use crate::cli::files::destination::Destination;
use crate::cli::files::field::field_of;
use crate::cli::files::tables;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::{print_json, say, stdout};
use tactpad::lab::rig::measurement::{Measurement, carry_on};
use tactpad::pad::device::Device;
use tactpad::pad::twin::life::Life;
use tactpad::tables::measured::columns::TableKind;
use tactpad::tables::measured::{Row, Table};
use tactpad::tables::plans;

/// Memory that a row takes: the plan's, the measured one, the true contact and its cycles.
const ROW_BYTES: usize = 600;

/// The report of a table.
#[derive(Serialize)]
struct TableReport {
    rows: usize,
    trials: usize,
    seconds: f64,
    /// Age of the pad in the end, in seconds.
    pad_seconds: f64,
    pad_cycles: f64,
    twin: &'static str,
}

/// Carries out a measuring plan.
pub(super) fn make(arguments: &Arguments, prints_table: bool) -> Result<(), Failure> {
    let Arguments { plan: path, seed, cycles, .. } = arguments;
    let device = arguments.pad.read_imperfect()?;
    let plan = planned(path, &device, *seed)?;
    tables::within_memory(&path.display().to_string(), plan.rows.len(), ROW_BYTES, |most| {
        format!("cut the plan into parts of {most} rows, and let --state keep the pad between them")
    })?;
    let to = Destination::of(&arguments.out)?;
    let truth_to = arguments.truth.as_deref().map(Destination::of).transpose()?;
    let kept = arguments.state.as_deref().map(LifeFile::of).transpose()?;
    let life = life::begun(kept.as_ref(), &device, *seed)?;
    life::fits(&plan, path, &life, *cycles)?;
    let field = field_of(&device)?;
    let progress = Progress::begin("carrying out the plan");
    let life = life::after(*cycles, life, &device, &field);
    let (measurement, life) = carry_on(&plan, &device, &field, life, *seed);
    let measurement = if arguments.count_cycles { measurement.counted() } else { measurement };
    drop(progress);
    tables::write(&to, &measurement.table)?;
    if let Some(to) = truth_to {
        tables::write(&to, &true_contacts(&measurement))?;
    }
    if let Some(kept) = &kept {
        kept.write(&life, &device)?;
    }
    report(arguments, &measurement, &life, prints_table)
}

/// The plan of this name, or in this file.
fn planned(plan: &Path, device: &Device, seed: u64) -> Result<Table, Failure> {
    match plan.to_str() {
        Some("paper") => Ok(plans::paper::plan(&device.contact)),
        Some("recommended") => Ok(plans::recommended::plan(&device.contact, seed)),
        _ => tables::on_the_plate(plan, TableKind::Plan, device),
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

fn report(
    arguments: &Arguments,
    measurement: &Measurement,
    life: &Life,
    prints_table: bool,
) -> Result<(), Failure> {
    let Table { rows, trials, .. } = &measurement.table;
    let outcome = TableReport {
        rows: rows.len(),
        trials: trials.len(),
        seconds: rows.last().and_then(|row| row.t_s).unwrap_or_default(),
        pad_seconds: life.state.age_s(),
        pad_cycles: life.around.cycles,
        twin: NUMERICAL,
    };
    if arguments.json {
        return print_json(&outcome);
    }
    let TableReport { rows, trials, seconds, .. } = outcome;
    let lived = match arguments.state {
        Some(_) => life::told(life),
        None => String::new(),
    };
    let told =
        format!("{rows} rows, {trials} time series, {seconds:.0} s on the pad's clock{lived}; {NUMERICAL}");
    if prints_table {
        say(told);
        return Ok(());
    }
    Ok(writeln!(stdout(), "{told}")?)
}
