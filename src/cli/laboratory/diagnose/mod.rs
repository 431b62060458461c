//! `tactpad diagnose`: what measured contacts show that the model of the pad gets wrong, and why.

mod against;
mod any_sensor;
mod arguments;
pub(crate) mod changes;
pub(crate) mod document;
mod files;
mod numbers;
mod play;
mod prediction;
mod report;
pub(crate) mod text;

use std::path::PathBuf;

pub(crate) use self::arguments::Arguments;
use self::arguments::{destination, folder};
use self::document::DiagnosisDocument;
use self::files::{file_name, write_report};
use crate::cli::failure::Failure;
use crate::cli::files::destination::Destination;
use crate::cli::files::field::{field_of, flaws, solve};
use crate::cli::files::tables;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::{is_same, is_stdout, print_json, say, stdout};
use tactpad::lab::diagnosis::extension::extended;
use tactpad::lab::diagnosis::report::Diagnosis;
use tactpad::lab::diagnosis::{self, DiagnosisError};
use tactpad::lab::effect::Effect;
use tactpad::lab::tangent::SimulatedPad;
use tactpad::pad::device::Device;
use tactpad::tables::measured::Table;

/// Memory that the search for causes takes for each row, with what it repeats of it.
const ROW_BYTES: usize = 32_000;

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let is_of_any_sensor = arguments.against.is_some() || arguments.model.is_some();
    if arguments.meant.are_said() && is_of_any_sensor {
        return Err(Failure::Unusable(
            "--frame, --sign and --units say how labels of a pad are meant, and --against and --model take them as they are written; \
             turn the columns before, or leave these options out"
                .into(),
        ));
    }
    match (&arguments.play, arguments.measured.as_slice()) {
        (Some(later), _) => match &arguments.against {
            Some(earlier) => play::run(arguments, [earlier, later]),
            None => Err(Failure::Unusable("name the capture of before with --against".into())),
        },
        (None, [measured]) => match (&arguments.model, &arguments.against) {
            (Some(predicted), _) => prediction::run(arguments, measured, predicted),
            (None, Some(earlier)) => against::run(arguments, measured, earlier),
            (None, None) => of_tables(arguments),
        },
        (None, _) if is_of_any_sensor => Err(Failure::Unusable(
            "--against and --model take one table; leave all --measured but one out, or join the tables' rows in one file".into(),
        )),
        (None, _) => of_tables(arguments),
    }
}

/// Diagnoses measured tables of one pad.
fn of_tables(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { measured: paths, pad, meant, save_device, next, report, without, json, .. } = arguments;
    let to = |path: &Option<PathBuf>, option: &str| {
        path.as_deref().map(|path| destination(path, option, arguments)).transpose()
    };
    for (at, path) in paths.iter().enumerate() {
        if paths[..at].iter().any(|before| is_same(before, path)) {
            return Err(Failure::Unusable(format!(
                "--measured {} is given twice, and the same rows know nothing more; name it once",
                path.display()
            )));
        }
    }
    let (saved, plan) = (to(save_device, "--save-device")?, to(next, "--next")?);
    let device = pad.read()?;
    let folder = report.as_deref().map(|path| folder(path, arguments)).transpose()?;
    let tables = paths.iter().map(|path| meant.read(path, &device)).collect::<Result<Vec<_>, Failure>>()?;
    let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    let measured = &names.join(" and ");
    let rows = tables.iter().map(|table| table.rows.len()).sum();
    tables::within_memory(measured, rows, ROW_BYTES, tables::fewer_rows)?;
    let field = field_of(&device)?;
    // It takes a while until the engine itself could say so.
    let known = SimulatedPad::known(&device, &field);
    if tables.len() > 1 {
        names.iter().zip(&tables).try_for_each(|(name, table)| meant.ask(name, table, &known))?;
    }
    let table = Table::joined(tables);
    diagnosis::check(&table, &known).map_err(|why| unfit(measured, &why))?;
    let progress = Progress::begin("looking for causes");
    let flaws = flaws(&device);
    let model = SimulatedPad { flaws: &flaws, solve: &solve, ..known };
    let diagnosis = diagnosis::diagnose(&table, &model, without).map_err(|why| unfit(measured, &why))?;
    drop(progress);
    if let Some(to) = saved {
        save(&to, &device, &diagnosis, &table)?;
    }
    match plan {
        Some(to) if !diagnosis.next.plan.rows.is_empty() => tables::write(&to, &diagnosis.next.plan)?,
        Some(_) => say("no further contacts would tell more, so no plan is written"),
        None => {}
    }
    if let Some(folder) = folder {
        let subject = report::Subject {
            diagnosis: &diagnosis,
            measured: paths.iter().map(|path| file_name(path)).collect::<Vec<_>>().join(" and "),
            model: format!("the model of {}", device.name),
            unit: "µV",
            load_unit: Some("N"),
            plate: Some(report::Plate::of(&device)),
        };
        write_report(&folder, &report::page(&subject), &diagnosis)?;
    }
    if *json {
        return print_json(&DiagnosisDocument::of(&diagnosis));
    }
    if [save_device, next].iter().any(|it| it.as_deref().is_some_and(is_stdout)) {
        say(text::DiagnosisText(&diagnosis));
        return Ok(());
    }
    use std::io::Write as _;
    Ok(write!(stdout(), "{}", text::DiagnosisText(&diagnosis))?)
}

fn unfit(measured: &str, why: &DiagnosisError) -> Failure {
    Failure::Unusable(format!("{measured}: {why}"))
}

fn save(to: &Destination, device: &Device, diagnosis: &Diagnosis, table: &Table) -> Result<(), Failure> {
    let last_cycle = table.rows.iter().filter_map(|row| row.cycle).reduce(f64::max);
    let (device, left_out) = extended(device, diagnosis, last_cycle);
    to.write(device.to_toml().as_bytes())?;
    if !left_out.is_empty() {
        let names: Vec<&str> = left_out.into_iter().map(Effect::name).collect();
        say(format_args!("named, but not in the saved device, which cannot hold it: {}", names.join(", ")));
    }
    if diagnosis.findings.iter().any(|finding| !finding.confounded_with.is_empty()) {
        say("confounded causes are not in the saved device");
    }
    Ok(())
}
