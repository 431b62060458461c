//! The causes that a diagnosis of the measured tables names: a number of the fit has a name only where this gives it.

use std::fmt;

use serde::Serialize;

use crate::cli::laboratory::diagnose::document;
use crate::cli::laboratory::diagnose::text::sized;
use crate::cli::printing::wrapped::hanging;
use tactpad::lab::calibration::result::numbers::Number;
use tactpad::lab::diagnosis;
use tactpad::lab::diagnosis::agreement::agreed;
use tactpad::lab::diagnosis::report::{Diagnosis, Finding, Verdict};
use tactpad::lab::tangent::SimulatedPad;
use tactpad::tables::measured::Table;

/// Of more rows causes are looked for by `tactpad diagnose` alone: it would take longer than the fit.
const ROWS_MAX: usize = 10_000;

/// The diagnoses of the tables.
///
/// Each table is diagnosed by itself, as `tactpad diagnose` would do it. A name counts if each table that can be diagnosed gives
/// it ([`agreed`]).
pub(super) struct NamedCauses {
    /// By the tables' names.
    diagnoses: Vec<(String, Diagnosis)>,
    /// Why others have none.
    unfit: Vec<String>,
}

/// A finding, and the table that it is of.
#[derive(Serialize)]
pub(super) struct TableFinding<'d> {
    measured: &'d str,
    #[serde(flatten)]
    finding: document::Finding<'d>,
}

impl NamedCauses {
    /// Without a table.
    pub(super) const fn none() -> Self {
        Self { diagnoses: Vec::new(), unfit: Vec::new() }
    }

    /// Diagnoses the tables.
    pub(super) fn by(tables: &[(String, Table)], pad: &SimulatedPad<'_>) -> Self {
        let mut named = Self::none();
        for (name, table) in tables {
            match of_table(table, pad) {
                Ok(diagnosis) => named.diagnoses.push((name.clone(), diagnosis)),
                Err(why) => named.unfit.push(format!("{name}: {why}")),
            }
        }
        named
    }

    /// The named findings, as they stand in each table.
    fn findings(&self) -> Vec<Vec<&Finding>> {
        agreed(&self.diagnoses.iter().map(|(_, diagnosis)| diagnosis).collect::<Vec<_>>())
    }

    /// Whether a number's cause is named in its place.
    pub(super) fn names(&self, number: &Number) -> bool {
        let is_its = |it: &Finding| Some(it.effect) == number.quantity.effect() && it.target == number.target;
        self.findings().iter().flatten().any(|finding| is_its(finding))
    }

    /// The named findings, as documents write them.
    pub(super) fn documents(&self) -> Vec<TableFinding<'_>> {
        self.findings()
            .into_iter()
            .flat_map(|all| {
                self.diagnoses
                    .iter()
                    .zip(all)
                    .map(|((name, diagnosis), finding)| found_in(name, diagnosis, finding))
            })
            .collect()
    }

    /// Why tables are not diagnosed.
    pub(super) fn unfit(&self) -> &[String] {
        &self.unfit
    }

    /// The names of channels.
    fn channels(&self) -> &[String] {
        self.diagnoses.first().map_or(&[], |(_, diagnosis)| &diagnosis.channels)
    }
}

fn found_in<'d>(measured: &'d str, diagnosis: &'d Diagnosis, finding: &'d Finding) -> TableFinding<'d> {
    TableFinding { measured, finding: document::Finding::of(finding, &diagnosis.channels) }
}

fn of_table(table: &Table, pad: &SimulatedPad<'_>) -> Result<Diagnosis, String> {
    diagnosis::check(table, pad).map_err(|why| why.to_string())?;
    let rows = table.rows.len();
    if rows > ROWS_MAX {
        return Err(format!("causes are looked for in at most {ROWS_MAX} rows, and the table has {rows}"));
    }
    diagnosis::causes(table, pad).map_err(|why| why.to_string())
}

/// Why a table's diagnosis names nothing.
const fn nameless(diagnosis: &Diagnosis) -> &'static str {
    match diagnosis.verdict {
        Verdict::NoDiscrepancy => "the device accounts for these rows",
        Verdict::Unexplained => "the device is wrong here, and no known cause accounts for it",
        Verdict::Explained | Verdict::PartlyExplained => {
            "the device is wrong here, and these rows do not tell which cause it is; tactpad diagnose lists them"
        }
    }
}

impl fmt::Display for NamedCauses {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let several = self.diagnoses.len() > 1;
        let findings = self.findings();
        if !findings.is_empty() {
            writeln!(f, "Named by a diagnosis of these rows, with 95 % intervals:")?;
        }
        for all in &findings {
            for ((name, _), finding) in self.diagnoses.iter().zip(all) {
                let place = if several { format!(" ({name})") } else { String::new() };
                writeln!(f, "{}", hanging("  ", &format!("{}{place}", sized(finding, self.channels()))))?;
            }
        }
        if findings.is_empty() && several {
            writeln!(f, "{}", hanging("", "No cause is named: none is named alike in each of the tables."))?;
        }
        if let (true, [(_, diagnosis)]) = (findings.is_empty(), self.diagnoses.as_slice()) {
            writeln!(f, "{}", hanging("", &format!("No cause is named: {}.", nameless(diagnosis))))?;
        }
        for why in &self.unfit {
            writeln!(f, "{}", hanging("", &format!("Nothing is named by {why}.")))?;
        }
        Ok(())
    }
}
