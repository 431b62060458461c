//! The report of `tactpad ablation`.

use serde::Serialize;

use super::timing;
use tactpad::lab::ablation::entries::{AblationEntry, ENTRIES};
use tactpad::lab::ablation::trials::Trials;
use tactpad::lab::ablation::unseen::{Least, Unseen, UnseenContacts};
use tactpad::lab::evaluation::Errors;

/// Everything that the verb finds out.
#[derive(Serialize)]
pub(super) struct AblationReport {
    /// Whose figures these are.
    pub(super) statement: String,
    /// Seed of the training data.
    pub(super) seed: u64,
    pub(super) rows: Vec<DecoderRow>,
    /// Files that were written.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) files: Vec<String>,
}

/// A decoder and its errors.
#[derive(Serialize)]
pub(super) struct DecoderRow {
    #[serde(flatten)]
    pub(super) entry: AblationEntry,
    /// Median time of one decode, one processor; null where this program has no clock.
    pub(super) decode_us: Option<f64>,
    pub(super) unseen: Vec<DecoderErrors>,
}

/// Its errors on one table.
#[derive(Clone, Copy, Serialize)]
pub(super) struct DecoderErrors {
    pub(super) plan: &'static str,
    pub(super) seed: u64,
    pub(super) contacts: usize,
    /// Against the truth.
    pub(super) truth: Errors,
    /// Against what the rig wrote.
    pub(super) labels: Errors,
    /// Share of the truths in the decoder's 95 % regions; null for a decoder without.
    pub(super) coverage95: Option<f64>,
    /// The least that the twin's noise allows.
    pub(super) bound: Least,
}

/// A row for each decoder. Decodes are timed here.
pub(super) fn rows(trials: &Trials) -> Vec<DecoderRow> {
    let row = |(index, entry): (usize, &AblationEntry)| DecoderRow {
        entry: *entry,
        decode_us: timing::median_us(&trials.decoders[index], &trials.unseen),
        unseen: trials
            .unseen
            .iter()
            .zip(&trials.judged)
            .map(|(it, judged)| DecoderErrors::of(it, &judged[index]))
            .collect(),
    };
    ENTRIES.iter().enumerate().map(row).collect()
}

impl DecoderErrors {
    fn of(unseen: &Unseen, judged: &UnseenContacts) -> Self {
        Self {
            plan: unseen.plan,
            seed: unseen.seed,
            contacts: unseen.truths().len(),
            truth: judged.by_truth,
            labels: judged.by_labels,
            coverage95: judged.coverage95,
            bound: unseen.least(unseen.truths()),
        }
    }
}
