//! Where the numbers of a described pad come from.

use crate::source::codes::{self, CODES, InputCode};
use crate::source::{Evdev, Lines, Origin, Reports};
use crate::toml_text::diag::Findings;
use crate::toml_text::section::{Bounds, Placed, Section};

pub(super) const EVDEV_KEYS: [&str; 7] =
    ["names", "has", "lacks", "grab", "silent_ms", "channels", "reports"];
pub(super) const LINES_KEYS: [&str; 3] = ["baud", "columns", "decimals"];

/// Origins, of which a description has one.
pub(super) const ORIGINS: [&str; 3] = ["lines", "wire", "evdev"];

/// Reports that are read beside a driver.
pub(super) const REPORTS: [(&str, Reports); 1] = [("balance-board", Reports::BalanceBoard)];

/// A device has no more names.
const NAMES_MAX: usize = 16;

const SILENT_MS: Bounds<u32> = Bounds { low: 50, high: 60_000, default: 1_000 };
const BAUD: Bounds<u32> = Bounds { low: 300, high: 4_000_000, default: 115_200 };
const DECIMALS: Bounds<u32> = Bounds { low: 0, high: 6, default: 2 };

/// A line's numbers are counted so far.
const COLUMN_MAX: f64 = 32.0;

/// Reads it; `channels` is how many the numbers are, if that is known.
pub(super) fn read_origin(
    root: &Section<'_>,
    channels: Option<usize>,
    findings: &mut Findings<'_>,
) -> Option<Origin> {
    let there: Vec<&str> = ORIGINS.into_iter().filter(|key| root.place_of(key).is_some()).collect();
    let help = "write [lines] for lines of text on a serial port, [evdev] for an input device of the system, or [wire] for \
                frames as firmware-proto/README.md has them";
    match there[..] {
        [] => {
            findings.misplaced(root.at, "the description does not say where the numbers come from", help);
            None
        }
        ["lines"] => {
            let lines = root.table("lines", "[lines]".into(), &LINES_KEYS, findings)?;
            read_lines(&lines, channels, findings).map(Origin::Lines)
        }
        ["wire"] => root.table("wire", "[wire]".into(), &[], findings).map(|_| Origin::Wire),
        ["evdev"] => {
            let evdev = root.table("evdev", "[evdev]".into(), &EVDEV_KEYS, findings)?;
            read_evdev(&evdev, channels, findings).map(Origin::Evdev)
        }
        [_] => None,
        [first, second, ..] => {
            let at = root.place_of(second).unwrap_or(root.at);
            let message = format!("numbers come from one place: there are [{first}] and [{second}]");
            findings.error(at, message, "take one of them out");
            None
        }
    }
}

fn read_lines(lines: &Section<'_>, channels: Option<usize>, findings: &mut Findings<'_>) -> Option<Lines> {
    let baud = lines.whole("baud", BAUD, findings);
    let decimals = lines.whole("decimals", DECIMALS, findings);
    let channels = channels?;
    let columns = match lines.place_of("columns") {
        None => Some((1..=channels).collect()),
        Some(at) => lines.reals::<f64>("columns", channels, findings).and_then(|columns| {
            let whole = |column: &Placed<f64>| {
                let is_column = column.value.fract() == 0.0 && (1.0..=COLUMN_MAX).contains(&column.value);
                if !is_column {
                    let message = format!("\"columns\" are counted from 1 to {COLUMN_MAX}");
                    findings.error(column.at, message, "the first number of a line is 1");
                }
                is_column.then_some(column.value as usize)
            };
            let columns: Option<Vec<usize>> = columns.iter().map(whole).collect();
            let is_double =
                |columns: &Vec<usize>| (1..columns.len()).any(|k| columns[..k].contains(&columns[k]));
            if columns.as_ref().is_some_and(is_double) {
                findings.error(at, "\"columns\" has a number twice", "each channel has a column of its own");
            }
            columns
        }),
    };
    Some(Lines { baud: baud?.value, columns: columns?, decimals: decimals?.value as u8 })
}

fn read_evdev(table: &Section<'_>, wanted: Option<usize>, findings: &mut Findings<'_>) -> Option<Evdev> {
    let names = match table.place_of("names") {
        None => Some(Vec::new()),
        Some(_) => table
            .some_texts("names", NAMES_MAX, findings)
            .map(|names| names.iter().map(|name| name.value.to_owned()).collect::<Vec<_>>()),
    };
    let [has, lacks] = ["has", "lacks"].map(|key| read_codes(table, key, findings));
    let grabs = if table.place_of("grab").is_none() { Some(false) } else { table.flag("grab", findings) };
    let silent_ms = match table.place_of("silent_ms") {
        None => Some(None),
        Some(_) => table.whole("silent_ms", SILENT_MS, findings).map(|silent_ms| Some(silent_ms.value)),
    };
    let wanted = wanted?;
    let channels = match (wanted, table.place_of("channels")) {
        (0, Some(at)) => {
            findings.error(at, "\"channels\" are for load cells and six axes", "take it out, or [contact]");
            None
        }
        (0, None) => Some(Vec::new()),
        _ => {
            table.require(
                "channels",
                "name an axis for each channel, as in channels = [\"ABS_X\", …]",
                findings,
            );
            let axes = table.words("channels", &codes::AXES, findings);
            let at = table.place_of("channels").unwrap_or(table.at);
            if axes.as_ref().is_some_and(|axes| axes.len() != wanted) {
                findings.error(
                    at,
                    format!("\"channels\" must be {wanted} axes"),
                    "one for each channel, in their order",
                );
            }
            axes.map(|axes| axes.iter().map(|axis| axis.value).collect::<Vec<_>>())
        }
    };
    let reports = table.word("reports", &REPORTS, findings);
    if reports.is_none() && table.place_of("reports").is_some() {
        return None;
    }
    if let (0, Some(reports)) = (wanted, reports) {
        let help = "take it out: a device that tells contacts has none that are known";
        findings.error(reports.at, "\"reports\" are for load cells", help);
    }
    let evdev = Evdev {
        names: names?,
        has: has?,
        lacks: lacks?,
        grabs: grabs?,
        silent_ms: silent_ms?,
        channels: channels?,
        reports: reports.map(|reports| reports.value),
    };
    if evdev.names.is_empty() && evdev.has.is_empty() {
        let help =
            "write names = [\"…\"] with a part of its name, or has = [\"ABS_X\", …] with what it reports";
        findings.error(table.at, "[evdev] does not say which device is meant", help);
    }
    Some(evdev)
}

fn read_codes(table: &Section<'_>, key: &str, findings: &mut Findings<'_>) -> Option<Vec<InputCode>> {
    if table.place_of(key).is_none() {
        return Some(Vec::new());
    }
    let codes = table.words(key, &CODES, findings)?;
    Some(codes.iter().map(|code| code.value).collect())
}
