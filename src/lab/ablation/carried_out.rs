//! A plan that was carried out on the pad.

use super::Subject;
use crate::lab::rig::measurement::{Measurement, carry_out};
use crate::network::Zero;
use crate::pipeline::contact::Decoder;
use crate::tables::measured::{Label, Row, Table};
use crate::tables::recording::Recording;

/// What was measured, and what was true, row for row.
#[derive(Clone, Debug)]
pub(super) struct CarriedOut {
    pub(super) recording: Recording,
    /// As it was measured, for a decoder that takes raw channels.
    raw: Vec<Row>,
    pub(super) truths: Vec<Label>,
}

impl CarriedOut {
    /// Carries out one of our own plans: all of them begin with the untouched pad.
    #[expect(clippy::expect_used, reason = "no plan comes from outside, and tests carry out each of them")]
    pub(super) fn of(subject: &Subject<'_>, plan: &Table, seed: u64) -> Self {
        let pad = subject.actual;
        let Measurement { table, truth, .. } = carry_out(plan, pad.device, pad.field, seed);
        let raw = table.rows.clone();
        let recording = Recording::of(table, pad.device.contact.full_scale_n);
        Self { recording: recording.expect("a plan begins with the untouched pad"), raw, truths: truth }
    }

    /// Some of the rows as they were measured.
    pub(super) fn raw_at(&self, places: &[usize]) -> Vec<Row> {
        places.iter().map(|at| self.raw[*at]).collect()
    }

    /// All rows as the decoder takes them.
    pub(super) fn taken(&self, decoder: &Decoder) -> Vec<Row> {
        if decoder.zero() == Zero::Raw { self.raw.clone() } else { self.recording.taken(decoder).rows }
    }
}
