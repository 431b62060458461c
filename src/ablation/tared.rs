//! A plan that was carried out on the pad.

use super::Subject;
use crate::contact::Decoder;
use crate::evaluation;
use crate::measured::{Label, Row, Table, zero};
use crate::quantity::Contact;
use crate::twin::measurement::{Measurement, carry_out};

/// What was measured, relative to the untouched pad, and what was true, row for row.
#[derive(Clone, Debug)]
pub struct Tared {
    rows: Vec<Row>,
    truths: Vec<Label>,
    /// Indices of the rows that a decoder is fitted to or tried on.
    contacts: Vec<usize>,
}

impl Tared {
    /// Carries out a plan. One that never reads the untouched pad gives no rows.
    pub fn of(subject: &Subject<'_>, plan: &Table, seed: u64) -> Self {
        let pad = subject.actual;
        let Measurement { mut table, truth } = carry_out(plan, pad.device, pad.field, seed);
        // Lines tell which rows the contacts are.
        table.rows.iter_mut().zip(1..).for_each(|(row, line)| row.line = line);
        let tared = zero::tared(&table).unwrap_or_default();
        let contacts = zero::contacts(&tared).iter().map(|row| row.line - 1).collect();
        Self { rows: tared.rows, truths: truth, contacts }
    }

    /// All rows, with those of the untouched pad.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// What was true of each row.
    pub fn truths(&self) -> &[Label] {
        &self.truths
    }

    /// Of values for each row, those of the contacts.
    pub fn of_contacts<T: Copy>(&self, values: &[T]) -> Vec<T> {
        self.contacts.iter().filter_map(|index| values.get(*index).copied()).collect()
    }

    /// What a decoder makes of each row.
    pub fn decoded(&self, decoder: &Decoder) -> Vec<Contact> {
        evaluation::decoded(decoder, &self.rows)
    }
}
