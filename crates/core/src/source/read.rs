//! From a description's text to a [`Source`]: names, types, ranges, and how the numbers stand to each other.
//!
//! `models/sources/README.md` documents every key for people. All findings are reported at once.

use toml::de::DeTable;

use super::codes::{self, CODES, InputCode};
use super::{AXES, Cell, Evdev, Lines, Measures, Origin, Reach, Reports, Source, Touching, Wrench};
use crate::quantity::WEIGHT_N_PER_G;
use crate::toml_text;
use crate::toml_text::diag::{Diagnostic, Findings};
use crate::toml_text::section::{Bounds, Placed, Section};

const ROOT_KEYS: [&str; 11] =
    ["schema", "name", "title", "lines", "wire", "evdev", "area", "force", "cell", "wrench", "contact"];
const EVDEV_KEYS: [&str; 7] = ["names", "has", "lacks", "grab", "silent_ms", "channels", "reports"];
const CONTACT_KEYS: [&str; 6] = ["x", "y", "force", "full_share", "full_n", "touch_n"];
const LINES_KEYS: [&str; 3] = ["baud", "columns", "decimals"];
const AREA_KEYS: [&str; 2] = ["half_width_mm", "half_height_mm"];
const FORCE_KEYS: [&str; 5] = ["unit", "n_per_count", "full_n", "noise_n", "standing_n"];
const CELL_KEYS: [&str; 4] = ["name", "x_mm", "y_mm", "gain"];
const WRENCH_KEYS: [&str; 4] = ["signs", "moment_unit", "nmm_per_count", "height_mm"];

/// Origins, of which a description has one.
const ORIGINS: [&str; 3] = ["lines", "wire", "evdev"];

/// What the numbers are, of which a description has one.
const MEASURES: [&str; 3] = ["cell", "wrench", "contact"];

/// A device has no more names.
const NAMES_MAX: usize = 16;

/// The most cells: eight channels fit into a frame.
pub const CELLS_MAX: usize = firmware_proto::channels::FEW_CHANNELS_MAX;

/// Fewer cells tell no place.
pub const CELLS_MIN: usize = 3;

const HALF_MM: Bounds<f64> = Bounds { low: 5.0, high: 1_000.0, default: 100.0 };
const PLACE_MM: Bounds<f64> = Bounds { low: -1_000.0, high: 1_000.0, default: 0.0 };
const FULL_N: Bounds<f64> = Bounds { low: 0.1, high: 5_000.0, default: 5.0 };
const NOISE_N: Bounds<f64> = Bounds { low: 0.0, high: 100.0, default: 0.05 };
const STANDING_N: Bounds<f64> = Bounds { low: 0.5, high: 4.0, default: 2.0 };
const GAIN: Bounds<f64> = Bounds { low: -100.0, high: 100.0, default: 1.0 };
const FULL_SHARE: Bounds<f64> = Bounds { low: 0.05, high: 1.0, default: 0.8 };
const TOUCH_N: Bounds<f64> = Bounds { low: 0.1, high: 5.0, default: 2.5 };
const PER_COUNT: Bounds<f64> = Bounds { low: -1e6, high: 1e6, default: 1.0 };
const HEIGHT_MM: Bounds<f64> = Bounds { low: -500.0, high: 500.0, default: 0.0 };
const SILENT_MS: Bounds<u32> = Bounds { low: 50, high: 60_000, default: 1_000 };
const BAUD: Bounds<u32> = Bounds { low: 300, high: 4_000_000, default: 115_200 };
const DECIMALS: Bounds<u32> = Bounds { low: 0, high: 6, default: 2 };
const SCHEMA: Bounds<u32> = Bounds { low: 1, high: 1, default: 1 };

/// A line's numbers are counted so far.
pub const COLUMN_MAX: f64 = 32.0;

/// Cells that are so near to one line tell no place across it, mm.
const ACROSS_MIN_MM: f64 = 1.0;

/// A unit of forces: newtons, or what `n_per_count` says.
#[derive(Clone, Copy)]
enum ForceUnit {
    Newtons(f64),
    Count,
}

const FORCE_UNITS: [(&str, ForceUnit); 5] = [
    ("g", ForceUnit::Newtons(WEIGHT_N_PER_G)),
    ("kg", ForceUnit::Newtons(1e3 * WEIGHT_N_PER_G)),
    ("lb", ForceUnit::Newtons(453.592_37 * WEIGHT_N_PER_G)),
    ("N", ForceUnit::Newtons(1.0)),
    ("count", ForceUnit::Count),
];

/// A unit of moments: N mm, or what `nmm_per_count` says.
#[derive(Clone, Copy)]
enum MomentUnit {
    NewtonMillimetres(f64),
    Count,
}

const MOMENT_UNITS: [(&str, MomentUnit); 3] = [
    ("Nmm", MomentUnit::NewtonMillimetres(1.0)),
    ("Nm", MomentUnit::NewtonMillimetres(1e3)),
    ("count", MomentUnit::Count),
];

/// Reports that are read beside a driver.
const REPORTS: [(&str, Reports); 1] = [("balance-board", Reports::BalanceBoard)];

/// Whether a text is meant as a description, sound or not: it has a table that says where numbers come from.
pub fn is_meant(text: &str) -> bool {
    let (tree, _) = DeTable::parse_recoverable(text);
    ORIGINS.iter().any(|origin| tree.get_ref().contains_key(*origin))
}

/// Reads a description from TOML text.
///
/// Returns what there is to say about the text, in its order; after 50 findings a closing one says that there is more. The description
/// is `None` exactly if there is an error among it. A text above [`toml_text::TEXT_BYTES_MAX`] is not read.
pub fn read(text: &str) -> (Option<Source>, Vec<Diagnostic>) {
    let mut findings = Findings::new(text);
    let Some(tree) = toml_text::parse(text, "a description is a few lines of TOML", &mut findings) else {
        return (None, findings.finish());
    };
    let root = Section::root(&tree, "the description", &ROOT_KEYS, &mut findings);
    root.require("schema", "write schema = 1", &mut findings);
    root.whole("schema", SCHEMA, &mut findings);
    let name = read_name(&root, &mut findings);
    root.require("title", "write title = \"…\", what the pad is", &mut findings);
    let title = root.name("title", &mut findings).map(str::to_owned);
    let measures = read_measures(&root, &mut findings);
    let origin = read_origin(&root, measures.as_ref(), &mut findings);
    let reach = match &measures {
        Some(Drafted::Contact(_)) => {
            refuse_reach(&root, &mut findings);
            None
        }
        channels => read_reach(&root, channels.as_ref(), &mut findings),
    };
    let source = (|| {
        let measures = match measures? {
            Drafted::Cells(cells) => Measures::Cells(cells, reach?),
            Drafted::Wrench(wrench, _) => Measures::Wrench(wrench, reach?),
            Drafted::Contact(touching) => Measures::Contact(touching),
        };
        Some(Source { name: name?, title: title?, origin: origin?, measures })
    })();
    let source = source.filter(|_| !findings.failed());
    (source, findings.finish())
}

/// What the numbers are, while units are not known yet.
enum Drafted {
    Cells(Vec<Cell>),
    /// With whether its moments are counts.
    Wrench(Wrench, bool),
    Contact(Touching),
}

impl Drafted {
    /// How many channels they take.
    const fn channels(&self) -> usize {
        match self {
            Self::Cells(cells) => cells.len(),
            Self::Wrench(..) => AXES,
            Self::Contact(_) => 0,
        }
    }
}

fn read_name(root: &Section<'_>, findings: &mut Findings<'_>) -> Option<String> {
    root.require("name", "write name = \"my-pad\", as it is called behind --pad", findings);
    let Placed { value, at } = root.text("name", findings)?;
    let is_plain = |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '-';
    let is_name = (1..=32).contains(&value.len()) && value.chars().all(is_plain) && !value.starts_with('-');
    if !is_name {
        findings.error(
            at,
            "\"name\" must be 1 to 32 small letters, digits and -",
            "as in name = \"my-board\"",
        );
    }
    is_name.then(|| value.to_owned())
}

fn read_origin(root: &Section<'_>, drafted: Option<&Drafted>, findings: &mut Findings<'_>) -> Option<Origin> {
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
            read_lines(&lines, drafted, findings).map(Origin::Lines)
        }
        ["wire"] => root.table("wire", "[wire]".into(), &[], findings).map(|_| Origin::Wire),
        ["evdev"] => {
            let evdev = root.table("evdev", "[evdev]".into(), &EVDEV_KEYS, findings)?;
            read_evdev(&evdev, drafted, findings).map(Origin::Evdev)
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

fn read_lines(lines: &Section<'_>, drafted: Option<&Drafted>, findings: &mut Findings<'_>) -> Option<Lines> {
    let baud = lines.whole("baud", BAUD, findings);
    let decimals = lines.whole("decimals", DECIMALS, findings);
    let channels = drafted?.channels();
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

fn read_measures(root: &Section<'_>, findings: &mut Findings<'_>) -> Option<Drafted> {
    let there: Vec<&str> = MEASURES.into_iter().filter(|key| root.place_of(key).is_some()).collect();
    match there[..] {
        [] => {
            let help = "write one table [[cell]] for each load cell, [wrench] for a sensor of six axes, or [contact] for a device that \
                        tells the place itself";
            findings.misplaced(root.at, "the description does not say what the numbers are", help);
            None
        }
        ["cell"] => read_cells(root, root.place_of("cell")?, findings).map(Drafted::Cells),
        ["wrench"] => {
            let table = root.table("wrench", "[wrench]".into(), &WRENCH_KEYS, findings)?;
            read_wrench(&table, findings).map(|(wrench, per_count)| Drafted::Wrench(wrench, per_count))
        }
        ["contact"] => {
            let table = root.table("contact", "[contact]".into(), &CONTACT_KEYS, findings)?;
            read_contact(root, &table, findings).map(Drafted::Contact)
        }
        [_] => None,
        [first, second, ..] => {
            let at = root.place_of(second).unwrap_or(root.at);
            let message = format!("the numbers are one thing: there are \"{first}\" and \"{second}\"");
            findings.error(at, message, "take one of them out");
            None
        }
    }
}

fn read_contact(root: &Section<'_>, table: &Section<'_>, findings: &mut Findings<'_>) -> Option<Touching> {
    if root.place_of("evdev").is_none() && ORIGINS.iter().any(|key| root.place_of(key).is_some()) {
        let help = "frames carry contacts without a description, and lines of text carry channels";
        findings.error(table.at, "[contact] is for [evdev]", help);
    }
    for key in ["x", "y"] {
        table.require(key, "write the axis by its kernel name, as in x = \"ABS_X\"", findings);
    }
    let [x, y, force] = ["x", "y", "force"].map(|key| table.word(key, &codes::AXES, findings));
    let full_share = table.number("full_share", FULL_SHARE, findings);
    let full_n = table.number("full_n", FULL_N, findings);
    let touch_n = table.number("touch_n", TOUCH_N, findings);
    let force = match (force, table.place_of("force")) {
        (None, Some(_)) => return None,
        (force, _) => force.map(|force| force.value),
    };
    let place = [x?.value, y?.value];
    let is_of_fingers = |axis: &u16| *axis >= codes::MT_FIRST;
    let of_fingers = place.iter().chain(&force).filter(|axis| is_of_fingers(axis)).count();
    if of_fingers != 0 && of_fingers != place.iter().chain(&force).count() {
        findings.error(
            table.at,
            "[contact] mixes axes of fingers, ABS_MT_…, with others",
            "take all from ABS_MT_…, or none",
        );
    }
    Some(Touching {
        place,
        force,
        full_share: full_share?.value,
        full_n: full_n?.value,
        touch_n: touch_n?.value,
    })
}

/// Says that a device that tells contacts has no area and no force of its own.
fn refuse_reach(root: &Section<'_>, findings: &mut Findings<'_>) {
    for key in ["area", "force"] {
        if let Some(at) = root.place_of(key) {
            let help = "the whole range of its axes is the plate; forces stand in [contact]";
            findings.error(at, format!("[{key}] is for channels"), help);
        }
    }
}

fn read_evdev(table: &Section<'_>, drafted: Option<&Drafted>, findings: &mut Findings<'_>) -> Option<Evdev> {
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
    let wanted = drafted?.channels();
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

fn read_cells(root: &Section<'_>, at: usize, findings: &mut Findings<'_>) -> Option<Vec<Cell>> {
    let tables = root.tables("cell", &CELL_KEYS, CELLS_MAX + 1, findings);
    if !(CELLS_MIN..=CELLS_MAX).contains(&tables.len()) {
        let message = format!("a place takes {CELLS_MIN} to {CELLS_MAX} cells, not {}", tables.len());
        findings.error(at, message, "write one table [[cell]] for each");
        return None;
    }
    let mut read = |(number, table): (usize, &Section<'_>)| {
        for key in ["x_mm", "y_mm"] {
            table.require(key, "say where the cell stands, in mm from the middle", findings);
        }
        let name = table.name("name", findings).map_or_else(|| format!("cell {number}"), str::to_owned);
        let [x_mm, y_mm] = ["x_mm", "y_mm"].map(|key| table.number(key, PLACE_MM, findings));
        let gain = table.number("gain", GAIN, findings);
        if let Some(gain) = gain.filter(|gain| gain.value == 0.0) {
            findings.error(
                gain.at,
                "\"gain\" must not be 0",
                "a cell without gain says nothing: leave it out",
            );
        }
        Some(Cell { name, place_mm: [x_mm?.value, y_mm?.value], gain: gain?.value })
    };
    let cells: Vec<Option<Cell>> = (1..).zip(&tables).map(&mut read).collect();
    let cells: Vec<Cell> = cells.into_iter().collect::<Option<_>>()?;
    if !spans_area(&cells) {
        findings.error(
            at,
            "the cells stand in one line: no place across it can be told",
            "check x_mm and y_mm",
        );
    }
    Some(cells)
}

/// Whether the places are not in one line.
fn spans_area(cells: &[Cell]) -> bool {
    let mean = |axis: usize| cells.iter().map(|cell| cell.place_mm[axis]).sum::<f64>() / cells.len() as f64;
    let middle = [mean(0), mean(1)];
    let sum = |i: usize, j: usize| {
        let product = |cell: &Cell| (cell.place_mm[i] - middle[i]) * (cell.place_mm[j] - middle[j]);
        cells.iter().map(product).sum::<f64>() / cells.len() as f64
    };
    // The smaller eigenvalue of the places' covariance is the mean square across the line.
    let (trace, determinant) = (sum(0, 0) + sum(1, 1), sum(0, 0) * sum(1, 1) - sum(0, 1) * sum(0, 1));
    let smaller = trace / 2.0 - libm::sqrt((trace * trace / 4.0 - determinant).max(0.0));
    smaller >= ACROSS_MIN_MM * ACROSS_MIN_MM
}

fn read_wrench(table: &Section<'_>, findings: &mut Findings<'_>) -> Option<(Wrench, bool)> {
    let signs = match table.place_of("signs") {
        None => Some([1.0; AXES]),
        Some(_) => table.reals::<f64>("signs", AXES, findings).and_then(|signs| {
            let wrong = signs.iter().find(|sign| sign.value.abs() != 1.0);
            if let Some(wrong) = wrong {
                findings.error(
                    wrong.at,
                    "\"signs\" are 1 or -1",
                    "-1 for an axis that is counted the other way",
                );
            }
            let signs: Vec<f64> = signs.iter().map(|sign| sign.value).collect();
            signs.try_into().ok().filter(|_| wrong.is_none())
        }),
    };
    let height_mm = table.number("height_mm", HEIGHT_MM, findings);
    table.require("moment_unit", "write moment_unit = \"Nm\", \"Nmm\" or \"count\"", findings);
    let unit = table.word("moment_unit", &MOMENT_UNITS, findings)?;
    let per_count = per_count(table, "nmm_per_count", matches!(unit.value, MomentUnit::Count), findings);
    let nmm_per_unit = match unit.value {
        MomentUnit::NewtonMillimetres(nmm) => nmm,
        MomentUnit::Count => per_count?,
    };
    let wrench = Wrench { signs: signs?, nmm_per_unit, height_mm: height_mm?.value };
    Some((wrench, matches!(unit.value, MomentUnit::Count)))
}

fn read_reach(root: &Section<'_>, drafted: Option<&Drafted>, findings: &mut Findings<'_>) -> Option<Reach> {
    root.require("area", "write [area] with half_width_mm and half_height_mm", findings);
    root.require("force", "write [force] with unit and full_n", findings);
    let area = root.table("area", "[area]".into(), &AREA_KEYS, findings);
    let half_mm = area.and_then(|area| {
        for key in AREA_KEYS {
            area.require(key, "from the middle to the edge of what is touched, in mm", findings);
        }
        let [width, height] = AREA_KEYS.map(|key| area.number(key, HALF_MM, findings));
        Some([width?.value, height?.value])
    });
    let force = root.table("force", "[force]".into(), &FORCE_KEYS, findings)?;
    force.require("unit", "write unit = \"g\", \"kg\", \"lb\", \"N\" or \"count\"", findings);
    force.require("full_n", "write the force, in N, that is as much as a finger's firm press", findings);
    let full_n = force.number("full_n", FULL_N, findings);
    let noise_n = force.number("noise_n", NOISE_N, findings);
    let is_stood_on = force.place_of("standing_n").is_some();
    let standing_n = force.number("standing_n", STANDING_N, findings);
    let unit = force.word("unit", &FORCE_UNITS, findings)?;
    let is_count = matches!(unit.value, ForceUnit::Count);
    let per_count = per_count(&force, "n_per_count", is_count, findings);
    if (root.place_of("wire").is_some() || root.place_of("evdev").is_some()) && !is_count {
        findings.error(unit.at, "its numbers are counts", "write unit = \"count\", and n_per_count");
    }
    if matches!(drafted, Some(Drafted::Wrench(_, true))) && !is_count {
        findings.error(
            unit.at,
            "moments are counts and forces are not",
            "give both in units, or both in counts",
        );
    }
    let n_per_unit = match unit.value {
        ForceUnit::Newtons(n) => n,
        ForceUnit::Count => per_count?,
    };
    let standing_n = is_stood_on.then_some(standing_n?.value);
    Some(Reach { half_mm: half_mm?, n_per_unit, full_n: full_n?.value, noise_n: noise_n?.value, standing_n })
}

/// What a count is worth, where the unit is counts and only there.
fn per_count(
    table: &Section<'_>,
    key: &'static str,
    is_count: bool,
    findings: &mut Findings<'_>,
) -> Option<f64> {
    match (is_count, table.place_of(key)) {
        (true, _) => {
            table.require(
                key,
                "put a known weight on the pad, and divide its force by what is counted",
                findings,
            );
            let number = table.number(key, PER_COUNT, findings)?;
            if number.value == 0.0 {
                findings.error(number.at, format!("\"{key}\" must not be 0"), "");
            }
            Some(number.value)
        }
        (false, Some(at)) => {
            findings.error(
                at,
                format!("\"{key}\" is for numbers in counts"),
                "take it out, or write \"count\" as the unit",
            );
            None
        }
        (false, None) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::shipped;
    use crate::toml_text::diag::Severity;

    const CELLS: &str = "schema = 1\nname = \"board\"\ntitle = \"A board\"\n[lines]\n[area]\nhalf_width_mm = 60\n\
        half_height_mm = 60\n[force]\nunit = \"N\"\nfull_n = 50.0\n[[cell]]\nx_mm = -60\ny_mm = 60\n[[cell]]\nx_mm = 60\n\
        y_mm = 60\n[[cell]]\nx_mm = 0\ny_mm = -60\n";

    fn messages(text: &str) -> Vec<String> {
        read(text).1.into_iter().map(|found| format!("{}: {}", found.line, found.message)).collect()
    }

    #[test]
    fn what_is_shipped_is_in_order_and_named_like_its_file() {
        for name in shipped::names() {
            let text = shipped::text(name).unwrap();
            let (source, found) = read(text);
            assert_eq!(found, [], "{name}");
            let source = source.unwrap();
            assert_eq!(source.name, name);
            assert!(
                source.decoder().is_some() && is_meant(text) && text.starts_with(shipped::SCHEMA_LINE),
                "{name}"
            );
        }
    }

    #[test]
    fn the_schema_and_the_reader_know_the_same_keys_and_words() {
        let schema: serde_json::Value = serde_json::from_str(shipped::schema()).unwrap();
        let sorted = |mut words: Vec<String>| {
            words.sort();
            words
        };
        let keys = |table: &serde_json::Value| {
            sorted(table["properties"].as_object().unwrap().keys().cloned().collect())
        };
        let read = |words: &[&str]| sorted(words.iter().map(|word| (*word).to_owned()).collect());
        assert_eq!(keys(&schema), read(&ROOT_KEYS));
        let tables: [(&str, &[&str]); 7] = [
            ("lines", &LINES_KEYS),
            ("evdev", &EVDEV_KEYS),
            ("area", &AREA_KEYS),
            ("force", &FORCE_KEYS),
            ("cell", &CELL_KEYS),
            ("wrench", &WRENCH_KEYS),
            ("contact", &CONTACT_KEYS),
        ];
        for (name, known) in tables {
            assert_eq!(keys(&schema["$defs"][name]), read(known), "{name}");
        }
        let listed = |name: &str| {
            let words = schema["$defs"][name]["enum"].as_array().unwrap().iter();
            sorted(words.map(|word| word.as_str().unwrap().to_owned()).collect())
        };
        assert_eq!(listed("axis"), read(&codes::AXES.map(|(name, _)| name)));
        assert_eq!(listed("code"), read(&CODES.map(|(name, _)| name)));
        assert_eq!(listed("reports"), read(&REPORTS.map(|(name, _)| name)));
    }

    #[test]
    fn the_least_description_has_all_else_by_default() {
        let source = read(CELLS).0.unwrap();
        let Origin::Lines(lines) = &source.origin else { panic!("{source:?}") };
        assert_eq!((lines.baud, &lines.columns[..], lines.decimals), (115_200, &[1, 2, 3][..], 2));
        assert_eq!(source.channel_names(), ["cell 1", "cell 2", "cell 3"]);
        assert!(!source.has_shear());
    }

    #[test]
    fn each_mistake_has_its_line_and_all_are_told() {
        for (from, to, line, message) in [
            ("schema = 1", "schema = 2", 1, "\"schema\" is 2; it must be 1"),
            ("\"board\"", "\"My board\"", 2, "\"name\" must be 1 to 32 small letters, digits and -"),
            ("title", "tilte", 3, "unknown key \"tilte\" in the description"),
            ("[lines]", "[lines]\nbaud = 12", 5, "\"baud\" is 12; it must be 300 to 4000000"),
            ("[lines]", "[lines]\ncolumns = [1, 2]", 5, "\"columns\" must be a list of 3 numbers, not of 2"),
            ("[lines]", "[lines]\ncolumns = [1, 2, 2]", 5, "\"columns\" has a number twice"),
            ("[lines]", "[lines]\ncolumns = [0, 2, 3]", 5, "\"columns\" are counted from 1 to 32"),
            ("half_width_mm = 60", "half_width_mm = 0", 6, "\"half_width_mm\" is 0; it must be 5 to 1000"),
            ("unit = \"N\"", "unit = \"count\"", 8, "[force] lacks \"n_per_count\""),
            ("unit = \"N\"", "unit = \"stone\"", 9, "\"unit\" cannot be \"stone\""),
            ("full_n = 50.0", "", 8, "[force] lacks \"full_n\""),
            ("y_mm = -60", "y_mm = 60", 11, "the cells stand in one line: no place across it can be told"),
            ("x_mm = 0", "x = 0", 17, "cell 3 lacks \"x_mm\""),
        ] {
            let text = CELLS.replacen(from, to, 1);
            let found = messages(&text);
            assert!(found.contains(&format!("{line}: {message}")), "{to}: {found:?}");
            assert!(read(&text).0.is_none());
        }
        assert!(messages("").len() >= 5, "{:?}", messages(""));
        let both = format!("{CELLS}[wrench]\nmoment_unit = \"Nm\"\n");
        assert!(messages(&both).iter().any(|found| found.contains("there are \"cell\" and \"wrench\"")));
    }

    /// A text that is cut off anywhere, or in which a part of a line is something else, and what else there may be.
    fn broken(text: &str) -> impl Iterator<Item = String> + '_ {
        const STRANGE: [&str; 14] = [
            "",
            "-1",
            "0",
            "1e999",
            "-nan",
            "inf",
            "\"\"",
            "\"ü\"",
            "[]",
            "[[]]",
            "{}",
            "[nan, 1]",
            "true",
            "1979-05-27",
        ];
        let ends = text.char_indices().map(|(end, _)| text[..end].to_owned());
        let values = text.match_indices(" = ").flat_map(move |(at, between)| {
            let begin = at + between.len();
            let end = text[begin..].find('\n').map_or(text.len(), |end| begin + end);
            STRANGE.map(|strange| [&text[..begin], strange, &text[end..]].concat())
        });
        let lines = (0..text.lines().count()).flat_map(move |number| {
            let without = text.lines().enumerate().filter(move |(line, _)| *line != number);
            let twice = text
                .lines()
                .enumerate()
                .flat_map(move |(line, it)| vec![it; 1 + usize::from(line == number)]);
            [
                without.map(|(_, line)| line).collect::<Vec<_>>().join("\n"),
                twice.collect::<Vec<_>>().join("\n"),
            ]
        });
        ends.chain(values).chain(lines)
    }

    #[test]
    fn no_text_makes_the_reader_panic_and_what_it_refuses_has_a_reason() {
        let mut refused = 0;
        for text in shipped::names().filter_map(shipped::text).chain([CELLS]) {
            for broken in broken(text) {
                let (source, found) = read(&broken);
                assert_eq!(
                    source.is_none(),
                    found.iter().any(|found| found.severity == Severity::Error),
                    "{broken}"
                );
                assert!(source.iter().all(|source| source.decoder().is_some()), "{broken}");
                refused += usize::from(source.is_none());
            }
        }
        assert!(refused > 1_000, "{refused}");
    }

    proptest::proptest! {
        #[test]
        fn no_characters_make_the_reader_panic(text in "\\PC{0,200}", lines in "[a-z_=\\[\\]\"0-9.\\-\n ]{0,300}") {
            for text in [&text, &lines, &format!("{CELLS}{lines}"), &format!("{lines}\n{CELLS}")] {
                let (source, found) = read(text);
                assert_eq!(source.is_none(), found.iter().any(|found| found.severity == Severity::Error), "{text}");
            }
        }
    }

    #[test]
    fn a_weight_that_forces_are_relative_to_is_read_and_bounded() {
        let with = |line: &str| CELLS.replace("full_n = 50.0", &format!("full_n = 50.0\n{line}"));
        let standing_n = |text: &str| read(text).0.and_then(|source| source.decoder()?.standing_n());
        assert_eq!(standing_n(CELLS), None);
        assert_eq!(standing_n(&with("standing_n = 1.5")), Some(1.5));
        assert_eq!(messages(&with("standing_n = 9")), ["11: \"standing_n\" is 9; it must be 0.5 to 4"]);
    }

    #[test]
    fn the_board_is_the_same_for_who_stands_on_it() {
        let [seated, standing] = ["balance-board", "balance-board-standing"]
            .map(|name| read(shipped::text(name).unwrap()).0.unwrap());
        let (Measures::Cells(cells, reach), Measures::Cells(same_cells, same_reach)) =
            (&seated.measures, &standing.measures)
        else {
            panic!("{seated:?} {standing:?}")
        };
        assert_eq!((&seated.origin, cells), (&standing.origin, same_cells));
        assert_eq!(Reach { standing_n: Some(2.0), ..*reach }, *same_reach);
    }

    #[test]
    fn reports_beside_the_driver_are_those_that_are_known_and_of_cells() {
        let text = shipped::text("balance-board").unwrap();
        let reports = |text: &str| match read(text).0.map(|source| source.origin) {
            Some(Origin::Evdev(evdev)) => evdev.reports,
            _ => None,
        };
        let key = "reports = \"balance-board\"\n";
        assert_eq!(reports(text), Some(Reports::BalanceBoard));
        assert_eq!(reports(&text.replace(key, "")), None);
        let wrong = messages(&text.replace(key, "reports = \"skateboard\"\n"));
        assert!(
            matches!(&wrong[..], [one] if one.ends_with("\"reports\" cannot be \"skateboard\"")),
            "{wrong:?}"
        );
        let tablet = shipped::text("tablet").unwrap();
        let wrong = messages(&tablet.replace("grab = true\n", &format!("grab = true\n{key}")));
        assert!(matches!(&wrong[..], [one] if one.ends_with("\"reports\" are for load cells")), "{wrong:?}");
    }

    #[test]
    fn a_contact_is_of_fingers_or_of_a_tool() {
        let text = |x: &str, y: &str, force: &str| {
            format!(
                "schema = 1\nname = \"pad\"\ntitle = \"A pad\"\n[evdev]\nhas = [\"BTN_TOUCH\"]\n[contact]\nx = \"{x}\"\ny = \"{y}\"\n\
                 force = \"{force}\"\n"
            )
        };
        let (fingers, tool) = (
            ["ABS_MT_POSITION_X", "ABS_MT_POSITION_Y", "ABS_MT_PRESSURE"],
            ["ABS_X", "ABS_Y", "ABS_PRESSURE"],
        );
        for mixture in 0..8 {
            let [x, y, force] = [0, 1, 2].map(|k| if mixture >> k & 1 == 1 { fingers[k] } else { tool[k] });
            let found = messages(&text(x, y, force));
            if mixture % 7 == 0 {
                assert_eq!(found, Vec::<String>::new());
            } else {
                assert_eq!(found, ["6: [contact] mixes axes of fingers, ABS_MT_…, with others"]);
            }
        }
    }

    #[test]
    fn forces_and_places_are_mapped_onto_the_plate() {
        let source = read(CELLS).0.unwrap();
        let decoder = source.decoder().unwrap();
        let uv_per_count = decoder.scale().unwrap().uv_per_count;
        // 25 N on each of the upper cells, in hundredths of a newton: 50 N, which is 5 N on the plate, half way up its rim.
        let mut strain = crate::quantity::Strain::default();
        strain.uv[0] = (2_500.0 * uv_per_count) as f32;
        strain.uv[1] = strain.uv[0];
        let contact = decoder.decode(&strain);
        assert!((contact.fz_n - 5.0).abs() < 1e-4 && contact.x_mm.abs() < 1e-4, "{contact:?}");
        assert!((contact.y_mm - 30.0).abs() < 1e-3, "{contact:?}");
    }

    #[test]
    fn a_wrench_tells_the_place_by_its_moments() {
        let text = "schema = 1\nname = \"six\"\ntitle = \"Six axes\"\n[lines]\n[area]\nhalf_width_mm = 30\nhalf_height_mm = 30\n\
            [force]\nunit = \"N\"\nfull_n = 5.0\n[wrench]\nmoment_unit = \"Nm\"\nheight_mm = 8\n";
        let source = read(text).0.unwrap();
        let (decoder, lines) = (source.decoder().unwrap(), 1e2);
        // 2 N into the plate and shear (0.5, −0.25) at (12, −7), 8 mm above the sensor; M = r × F, in N m.
        let (at, force) = ([12.0, -7.0, 8.0], [0.5, -0.25, -2.0]);
        let moment = [
            at[1] * force[2] - at[2] * force[1],
            at[2] * force[0] - at[0] * force[2],
            at[0] * force[1] - at[1] * force[0],
        ];
        let uv_per_count = decoder.scale().unwrap().uv_per_count;
        let mut strain = crate::quantity::Strain::default();
        let axes = force.into_iter().chain(moment.map(|nmm| nmm * 1e-3));
        for (uv, value) in strain.uv.iter_mut().zip(axes) {
            *uv = (value * lines * uv_per_count) as f32;
        }
        let contact = decoder.decode(&strain);
        let found = [contact.x_mm, contact.y_mm, contact.fx_n, contact.fy_n, contact.fz_n];
        for (found, wanted) in found.into_iter().zip([12.0, -7.0, 0.5, -0.25, 2.0]) {
            assert!((found - wanted).abs() < 1e-4, "{contact:?}");
        }
        assert!(source.has_shear());
    }
}
