//! Contacts that no decoder has seen, and how well each decodes them.

use serde::Serialize;

use super::Subject;
use super::carried_out::ExecutedPlan;
use tactpad_core::pipeline::contact::Decoder;
use tactpad_core::quantity::{Contact, Strain};
use tactpad_core::tables::measured::{Label, Row, Table};
use tactpad_core::tables::plans::{paper, recommended};
use tactpad_lab::evaluation::{self, Errors, PerAxis};
use tactpad_lab::rig::bound::{Bound, ContactReading};

/// Static contacts of the pad with their truths.
#[derive(Clone, Debug)]
pub struct Unseen {
    /// The plan's name, as `twin` takes it.
    pub plan: &'static str,
    /// The seed that drew them.
    pub seed: u64,
    carried_out: ExecutedPlan,
    /// Places of the contacts among its rows.
    contacts: Vec<usize>,
    /// Theirs.
    truths: Vec<Label>,
    bound: Bound,
}

/// The smallest mean errors that the twin's noise allows: Cramér and Rao's bound.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Least {
    /// Mean of |Δx| and |Δy|.
    pub position_mae_mm: f64,
    /// Mean of |ΔFx|, |ΔFy| and |ΔFz|.
    pub force_mae_n: f64,
    /// Each axis on its own.
    pub per_axis: PerAxis,
}

/// A decoder's contacts of an unseen table.
#[derive(Clone, Debug)]
pub struct UnseenContacts {
    /// The contacts that it found, in the order of [`Unseen::truths`].
    pub found: Vec<Contact>,
    /// Its errors.
    pub by_truth: Errors,
    /// Its errors, as one would measure them.
    pub by_labels: Errors,
    /// Share of the truths in its 95 % regions; `None` for a decoder that states none.
    pub coverage95: Option<f64>,
}

/// The paper's contacts, measured anew, and those of the recommended plan: other places, loads between the paper's, held for
/// longer, half of them come to from above.
pub fn unseen(subject: &Subject<'_>) -> [Unseen; 2] {
    let patch = &subject.actual.device.contact;
    let seeds = [2, 1].map(|later| subject.seed.wrapping_add(later));
    [
        Unseen::of(subject, "paper", &paper::plan(patch), seeds[0]),
        Unseen::of(subject, "recommended", &recommended::plan(patch, seeds[1]), seeds[1]),
    ]
}

impl Unseen {
    fn of(subject: &Subject<'_>, plan: &'static str, contacts: &Table, seed: u64) -> Self {
        let carried_out = ExecutedPlan::afterwards(subject, contacts, seed);
        let contacts = carried_out.recording.contacts();
        let truths = contacts.iter().map(|at| carried_out.truths[*at]).collect();
        let bound = Bound::new(subject.actual.device, subject.actual.field, seed);
        Self { plan, seed, carried_out, contacts, truths, bound }
    }

    /// The true contacts.
    pub fn truths(&self) -> &[Label] {
        &self.truths
    }

    /// Cramér-Rao bound of the errors on some of the true contacts.
    pub fn least(&self, truths: &[Label]) -> Least {
        let [x_mm, y_mm, fx_n, fy_n, fz_n] = self.bound.expected(truths, ContactReading::Mean);
        Least {
            position_mae_mm: (x_mm + y_mm) / 2.0,
            force_mae_n: (fx_n + fy_n + fz_n) / 3.0,
            per_axis: PerAxis { x_mm, y_mm, fx_n, fy_n, fz_n },
        }
    }

    /// The channels of the contacts, as this decoder takes them.
    pub fn strains(&self, decoder: &Decoder) -> Vec<Strain> {
        self.rows(decoder).iter().map(evaluation::strain).collect()
    }

    /// Decodes all of them.
    pub fn judged(&self, decoder: &Decoder) -> UnseenContacts {
        let rows = self.rows(decoder);
        let found = evaluation::decoded(decoder, &rows);
        let labels: Vec<Label> = rows.iter().map(|row| row.label).collect();
        UnseenContacts {
            by_truth: evaluation::errors(&found, &self.truths),
            by_labels: evaluation::errors(&found, &labels),
            coverage95: evaluation::coverage95(decoder, &rows, &self.truths),
            found,
        }
    }

    fn rows(&self, decoder: &Decoder) -> Vec<Row> {
        let taken = self.carried_out.taken(decoder);
        self.contacts.iter().map(|at| taken[*at]).collect()
    }
}
