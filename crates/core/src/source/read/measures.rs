//! What the numbers of a described pad are.

use super::origin::ORIGINS;
use super::units::{MOMENT_UNITS, MomentUnit, per_count};
use crate::source::{AXES, Cell, Touching, Wrench, codes};
use crate::toml_text::diag::Findings;
use crate::toml_text::section::{Bounds, Section};

pub(super) const CONTACT_KEYS: [&str; 6] = ["x", "y", "force", "full_share", "full_n", "touch_n"];
pub(super) const CELL_KEYS: [&str; 4] = ["name", "x_mm", "y_mm", "gain"];
pub(super) const WRENCH_KEYS: [&str; 4] = ["signs", "moment_unit", "nmm_per_count", "height_mm"];

/// What the numbers are, of which a description has one.
const MEASURES: [&str; 3] = ["cell", "wrench", "contact"];

/// The most cells: eight channels fit into a frame.
const CELLS_MAX: usize = firmware_proto::channels::FEW_CHANNELS_MAX;

/// Fewer cells tell no place.
const CELLS_MIN: usize = 3;

const PLACE_MM: Bounds<f64> = Bounds { low: -1_000.0, high: 1_000.0, default: 0.0 };
const GAIN: Bounds<f64> = Bounds { low: -100.0, high: 100.0, default: 1.0 };
const FULL_SHARE: Bounds<f64> = Bounds { low: 0.05, high: 1.0, default: 0.8 };
const TOUCH_N: Bounds<f64> = Bounds { low: 0.1, high: 5.0, default: 2.5 };
const HEIGHT_MM: Bounds<f64> = Bounds { low: -500.0, high: 500.0, default: 0.0 };
pub(super) const FULL_N: Bounds<f64> = Bounds { low: 0.1, high: 5_000.0, default: 5.0 };

/// Cells that are so near to one line tell no place across it, mm.
const ACROSS_MIN_MM: f64 = 1.0;

/// What the numbers are, while units are not known yet.
pub(super) enum Drafted {
    Cells(Vec<Cell>),
    /// With whether its moments are counts.
    Wrench(Wrench, bool),
    Contact(Touching),
}

impl Drafted {
    /// How many channels they take.
    pub(super) const fn channels(&self) -> usize {
        match self {
            Self::Cells(cells) => cells.len(),
            Self::Wrench(..) => AXES,
            Self::Contact(_) => 0,
        }
    }
}

pub(super) fn read_measures(root: &Section<'_>, findings: &mut Findings<'_>) -> Option<Drafted> {
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
