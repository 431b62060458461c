//! The measured tables that a decoder is fitted to.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::PathBuf;

use super::method::Method;
use crate::cli::failure::Failure;
use crate::cli::files::labels::LabelOptions;
use crate::cli::files::tables;
use tactpad::lab::calibration::screening::Fault;
use tactpad::lab::contacts::Contacts;
use tactpad::lab::tangent::SimulatedPad;
use tactpad::pad::device::Device;
use tactpad::tables::measured::{Table, zero};
use tactpad::tables::recording::Recording;

/// So many of the contacts, or all of them, drawn by a seed.
#[derive(Clone, Copy)]
pub(super) struct RowDraw {
    pub(super) rows: Option<usize>,
    pub(super) seed: u64,
}

/// The contacts of the tables, and what people call these.
pub(super) struct Measured {
    pub(super) contacts: Contacts,
    pub(super) names: String,
    /// The tables with all their rows, by their names.
    whole: Vec<(String, Table)>,
}

impl Measured {
    /// Reads the tables of this pad; see [`Contacts::of`] for the others.
    pub(super) fn read(
        paths: &[PathBuf],
        meant: &LabelOptions,
        device: &Device,
        draw: RowDraw,
        method: Method,
    ) -> Result<Self, Failure> {
        let each: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
        let names = each.join(", ");
        let tables =
            paths.iter().map(|path| meant.read(path, device)).collect::<Result<Vec<_>, Failure>>()?;
        let kept = tables.clone();
        let full_scale_n = device.contact.full_scale_n;
        let recordings = tables.into_iter().map(|table| Recording::tared_or_raw(table, full_scale_n));
        let contacts = Contacts::of(recordings.collect(), draw.rows, draw.seed);
        let contacts = contacts.map_err(|error| Failure::Unusable(format!("{names}: {error}")))?;
        tables::within_memory(&names, contacts.count(), method.row_bytes(), |most| {
            format!("take some of them with --rows {most}")
        })?;
        Ok(Self { contacts, names, whole: each.into_iter().zip(kept).collect() })
    }

    /// Refuses tables whose labels are meant otherwise than somebody said.
    pub(super) fn ask(&self, meant: &LabelOptions, pad: &SimulatedPad<'_>) -> Result<(), Failure> {
        self.whole.iter().try_for_each(|(name, table)| meant.ask(name, table, pad))
    }

    /// The rows by which causes may be looked for, by the tables' names.
    pub(super) fn tables(&self, rows: Option<usize>) -> Cow<'_, [(String, Table)]> {
        if rows.is_some() {
            Cow::Owned(drawn(self.whole.clone(), &self.contacts))
        } else {
            Cow::Borrowed(&self.whole)
        }
    }

    /// A decoder can be fitted to them, but a part of the pad is at fault.
    pub(super) fn warning(&self, fault: Fault) -> String {
        format!("{}: {fault}; mend it and measure again", self.names)
    }

    /// Nothing can be fitted to them.
    pub(super) fn refused(&self, why: impl std::fmt::Display) -> Failure {
        Failure::Unusable(format!("{}: {why}", self.names))
    }
}

/// The tables with the contacts that were drawn, and the readings of the untouched pad. Time series go: with rows left out they
/// are none.
fn drawn(tables: Vec<(String, Table)>, contacts: &Contacts) -> Vec<(String, Table)> {
    let drawn: BTreeSet<usize> = contacts.places().iter().copied().collect();
    let mut first = 0;
    let of_table = |(name, mut table): (String, Table)| {
        let pressed: BTreeSet<usize> = zero::contacts(&table).into_iter().collect();
        let rows = std::mem::take(&mut table.rows).into_iter().enumerate();
        let before = first;
        first += rows.len();
        let is_kept = |at: usize| drawn.contains(&(before + at)) || !pressed.contains(&at);
        table.rows =
            rows.filter(|(at, row)| row.trial.is_none() && is_kept(*at)).map(|(_, row)| row).collect();
        (name, table)
    };
    tables.into_iter().map(of_table).collect()
}
