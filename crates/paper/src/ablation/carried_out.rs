//! A plan that was carried out on the pad.

use super::{Pad, Subject};
use tactpad_core::network::Zero;
use tactpad_core::pad::twin::life::Life;
use tactpad_core::pipeline::contact::Decoder;
use tactpad_core::tables::measured::{Label, Row, Table};
use tactpad_core::tables::plans;
use tactpad_core::tables::recording::Recording;
use tactpad_lab::rig::measurement::{Measurement, carry_on};

/// What was measured, and what was true, row for row.
#[derive(Clone, Debug)]
pub(super) struct ExecutedPlan {
    pub(super) recording: Recording,
    /// As it was measured, for a decoder that takes raw channels.
    raw: Vec<Row>,
    pub(super) truths: Vec<Label>,
}

impl ExecutedPlan {
    /// The paper's plan on the new pad: what decoders are fitted to.
    pub(super) fn calibration(subject: &Subject<'_>) -> Self {
        Self::of(subject, calibrated(subject).0)
    }

    /// Carries out a plan on the pad as it goes on after that.
    pub(super) fn afterwards(subject: &Subject<'_>, plan: &Table, seed: u64) -> Self {
        let Pad { device, field } = subject.actual;
        let (_, life) = calibrated(subject);
        Self::of(subject, carry_on(plan, device, field, life, seed).0)
    }

    /// What was measured by one of our own plans: all of them begin with the untouched pad.
    #[expect(clippy::expect_used, reason = "no plan comes from outside, and tests carry out each of them")]
    fn of(subject: &Subject<'_>, Measurement { table, truth, .. }: Measurement) -> Self {
        let pad = subject.actual;
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

/// The paper's plan, carried out on a new pad, and the pad's life after it.
fn calibrated(subject: &Subject<'_>) -> (Measurement, Life) {
    let Pad { device, field } = subject.actual;
    let plan = plans::paper::plan(&device.contact);
    carry_on(&plan, device, field, Life::new(device, subject.seed), subject.seed)
}
