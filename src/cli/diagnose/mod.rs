//! `tactpad diagnose`: what measured contacts show that the model of the pad gets wrong, and why.

mod against;
mod arguments;
mod document;
mod files;
mod numbers;
mod report;
mod text;

use std::path::Path;

pub(super) use self::arguments::Arguments;
use self::arguments::{destination, folder};
use self::document::Document;
use self::files::{file_name, write_report};
use super::destination::Destination;
use super::failure::Failure;
use super::field::{changes_of, field_of};
use super::progress::Progress;
use super::tables;
use super::written::{is_stdout, print_json, say, stdout};
use tactpad::lab::diagnosis::extension::extended;
use tactpad::lab::diagnosis::report::Diagnosis;
use tactpad::lab::diagnosis::{self, Unfit};
use tactpad::pad::changes::FieldChange;
use tactpad::pad::device::Device;
use tactpad::tables::measured::Table;
use tactpad::tables::measured::columns::Kind;

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(earlier) = &arguments.against {
        return against::run(arguments, earlier);
    }
    let Arguments { measured, pad, save_device, report, without, json, .. } = arguments;
    let saved = save_device.as_deref().map(|path| destination(path, arguments)).transpose()?;
    let device = pad.read()?;
    let folder = report.as_deref().map(|path| folder(path, arguments)).transpose()?;
    let table = tables::read(measured, Kind::Measured, device.plate.radius_mm())?;
    // It takes a while until the engine itself could say so.
    diagnosis::check(&table).map_err(|why| unfit(measured, &why))?;
    let diagnosis = diagnosed(&table, &device, without).map_err(|why| match why {
        Why::Unfit(why) => unfit(measured, &why),
        Why::NoField(failure) => failure,
    })?;
    if let Some(to) = saved {
        save(&to, &device, &diagnosis, &table)?;
    }
    if let Some(folder) = folder {
        let subject = report::Subject {
            diagnosis: &diagnosis,
            measured: file_name(measured),
            model: format!("the model of {}", device.name),
            unit: "µV",
            load_unit: Some("N"),
            plate: Some(report::Plate::of(&device)),
        };
        write_report(&folder, &report::page(&subject), &diagnosis)?;
    }
    if *json {
        return print_json(&Document::of(&diagnosis));
    }
    if save_device.as_deref().is_some_and(is_stdout) {
        say(text::Report(&diagnosis));
        return Ok(());
    }
    use std::io::Write as _;
    Ok(write!(stdout(), "{}", text::Report(&diagnosis))?)
}

/// Why there is no diagnosis.
enum Why {
    Unfit(Unfit),
    NoField(Failure),
}

fn diagnosed(table: &Table, device: &Device, without: &[String]) -> Result<Diagnosis, Why> {
    let field = field_of(device).map_err(Why::NoField)?;
    let flaws = flaws(device);
    let solve = |device: &Device| field_of(device).ok();
    let pad = diagnosis::Pad { device, field: &field, flaws: &flaws, solve: &solve, without };
    let _progress = Progress::begin("looking for causes");
    diagnosis::diagnose(table, &pad).map_err(Why::Unfit)
}

/// What flaws of a module change; none where that cannot be had.
fn flaws(device: &Device) -> Vec<FieldChange> {
    match changes_of(device) {
        Ok(changes) => changes.0,
        Err(Failure::Failed(why) | Failure::Unusable(why)) => {
            say(format_args!("open frames and loose bonds are not looked for: {why}"));
            Vec::new()
        }
        Err(Failure::Unread) => Vec::new(),
    }
}

fn unfit(measured: &Path, why: &Unfit) -> Failure {
    Failure::Unusable(format!("{}: {why}", measured.display()))
}

fn save(to: &Destination, device: &Device, diagnosis: &Diagnosis, table: &Table) -> Result<(), Failure> {
    let last_cycle = table.rows.iter().filter_map(|row| row.cycle).reduce(f64::max);
    let (device, left_out) = extended(device, diagnosis, last_cycle);
    to.write(device.to_toml().as_bytes())?;
    if !left_out.is_empty() {
        say(format_args!(
            "named, but not in the saved device, which cannot hold it: {}",
            left_out.join(", ")
        ));
    }
    if diagnosis.findings.iter().any(|finding| !finding.confounded_with.is_empty()) {
        say("confounded causes are not in the saved device");
    }
    Ok(())
}
