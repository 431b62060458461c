//! Tables of contacts, plans and measured tables, as files.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use super::destination::Destination;
use crate::cli::failure::Failure;
use crate::cli::printing::written::{reason, say};
use tactpad::pad::device::{Device, Patch};
use tactpad::tables::measured::Table;
use tactpad::tables::measured::columns::TableKind;
use tactpad::tables::measured::ending::OpenEnd;
use tactpad::tables::measured::error::{Fault, ReadError};
use tactpad::tables::measured::{read, write};
use tactpad::tables::units::Units;

/// Places are often written to two decimals; so rounded, one on the rim may lie this far beyond it.
const RIM_TOLERANCE_MM: f64 = 0.01;

/// A verb takes this much memory for tables at most: half of what a small machine has.
const MEMORY_BYTES_MAX: usize = 4_000_000_000;

/// Reads a table of contacts, all of which must be on the plate.
pub(crate) fn on_the_plate(path: &Path, kind: TableKind, device: &Device) -> Result<Table, Failure> {
    let contacts = read(path, kind, device.plate.radius_mm())?;
    for row in &contacts.rows {
        within_the_rim([row.label.x_mm, row.label.y_mm], &device.contact)
            .map_err(|why| Failure::Unusable(format!("{}:{}: {why}", path.display(), row.line)))?;
    }
    Ok(contacts)
}

/// Refuses a contact whose patch would reach over the plate's rim.
///
/// The field ends there. Taking such a contact at the rim would write a row whose place and channels do not belong
/// together, and a decoder would learn it.
pub(crate) fn within_the_rim([x_mm, y_mm]: [f64; 2], patch: &Patch) -> Result<(), String> {
    let radius_mm = x_mm.hypot(y_mm);
    let Patch { patch_radius_mm, max_centre_radius_mm, .. } = patch;
    if radius_mm <= max_centre_radius_mm + RIM_TOLERANCE_MM {
        return Ok(());
    }
    Err(format!(
        "the contact is {radius_mm:.2} mm from the centre, and a finger of {patch_radius_mm} mm radius stays on the \
         plate up to {max_centre_radius_mm} mm; move it or leave it out"
    ))
}

/// Reads a table whose places lie within ±`place_max_mm`.
pub(crate) fn read(path: &Path, kind: TableKind, place_max_mm: f64) -> Result<Table, Failure> {
    written_in(path, kind, place_max_mm, &Units::default(), "")
}

/// The same of labels and channels that are written in these units, and stay so; `way_out` is for numbers that are too large.
pub(crate) fn written_in(
    path: &Path,
    kind: TableKind,
    place_max_mm: f64,
    units: &Units,
    way_out: &str,
) -> Result<Table, Failure> {
    let refused = |error: ReadError| {
        let is_too_large = matches!(error.fault, Fault::OutOfRange { .. });
        let way_out = if is_too_large { way_out } else { "" };
        match refusal(path, kind, error) {
            Failure::Unusable(why) => Failure::Unusable(why + way_out),
            failure => failure,
        }
    };
    let file = File::open(path).map_err(|error| refused(ReadError { line: 1, fault: Fault::Io(error) }))?;
    let table = read::written_in(BufReader::new(file), kind, place_max_mm, units).map_err(refused)?;
    warn(path, table.open_end.as_ref());
    Ok(table)
}

/// Refuses rows for which a verb would take more memory than it may, at so many bytes each; `way_out` gets how many it takes.
pub(crate) fn within_memory(
    names: &str,
    rows: usize,
    row_bytes: usize,
    way_out: impl FnOnce(usize) -> String,
) -> Result<(), Failure> {
    let most = MEMORY_BYTES_MAX / row_bytes;
    if rows <= most {
        return Ok(());
    }
    let gigabytes = |bytes: usize| bytes as f64 / 1e9;
    let (needed, taken) = (gigabytes(rows * row_bytes), gigabytes(MEMORY_BYTES_MAX));
    let way_out = way_out(most);
    Err(Failure::Unusable(format!(
        "{names}: {rows} rows would take {needed:.1} GB of memory, and {taken:.0} GB are the most that is taken; {way_out}"
    )))
}

/// The way out where a verb draws no rows itself.
pub(crate) fn fewer_rows(most: usize) -> String {
    format!("leave rows out, evenly over the measurement, down to {most}")
}

/// Says that a table's last line may be cut off.
pub(crate) fn warn(path: &Path, open_end: Option<&OpenEnd>) {
    if let Some(end) = open_end {
        say(format_args!("warning: {}:{}: {end}", path.display(), end.line));
    }
}

/// Writes a table.
pub(crate) fn write(to: &Destination, table: &Table) -> Result<(), Failure> {
    let mut writing = to.begin()?;
    write::table(&mut writing, table)?;
    writing.finish()
}

fn refusal(path: &Path, kind: TableKind, error: ReadError) -> Failure {
    let path = path.display();
    let what = match kind {
        TableKind::Contacts => "of contacts",
        TableKind::Plan => "that holds a plan",
        TableKind::Measured => "of measured contacts",
    };
    Failure::Unusable(match error.fault {
        Fault::Io(error) => format!("{path} cannot be read: {}; name a CSV file {what}", reason(&error)),
        fault => format!("{path}:{}: {fault}", error.line),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_for_which_memory_would_not_do_are_refused_with_the_figures_and_the_way_out() {
        let judged = |rows| within_memory("m.csv", rows, 5_000, |most| format!("take {most}"));
        assert!(judged(800_000).is_ok());
        let Err(Failure::Unusable(why)) = judged(1_500_000) else { panic!("it is too large") };
        assert_eq!(
            why,
            "m.csv: 1500000 rows would take 7.5 GB of memory, and 4 GB are the most that is taken; take 800000"
        );
    }

    #[test]
    fn contacts_end_where_the_patch_would_leave_the_plate() {
        let patch = Device::nominal().contact;
        for place in [[0.0, 0.0], [29.0, 0.0], [0.0, -29.009], [20.51, 20.51]] {
            assert_eq!(within_the_rim(place, &patch), Ok(()));
        }
        for place in [[29.011, 0.0], [-20.52, 20.52], [30.0, 30.0]] {
            let why = within_the_rim(place, &patch).unwrap_err();
            assert!(why.starts_with("the contact is ") && why.contains("up to 29 mm"), "{why}");
        }
    }
}
