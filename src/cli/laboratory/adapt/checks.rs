//! Where contacts miss a fit by more than its noise says.

use serde::Serialize;

use tactpad::lab::calibration::result::predictive::{Partition, Predicted, PredictiveCheck};

/// Contacts that were held out, a third of them or all.
#[derive(Serialize)]
pub(super) struct CheckResult {
    of: &'static str,
    by: &'static str,
    part: &'static str,
    contacts: usize,
    /// Their mean square over the stated one.
    ratio: f64,
    p_value: f64,
    /// Whether that is more than chance.
    missed: bool,
}

impl CheckResult {
    pub(super) fn of(check: &PredictiveCheck) -> Self {
        let PredictiveCheck { of, by, third, contacts, ratio, p_value } = *check;
        let (by, parts) = words(by);
        let of = match of {
            Predicted::Place => "place",
            Predicted::Force => "force",
        };
        Self { of, by, part: parts[third.min(2)], contacts, ratio, p_value, missed: check.is_missed() }
    }

    /// The sentence about a check that is missed.
    pub(super) fn words(&self) -> String {
        format!(
            "{}, each held out, miss their {} by {:.2} times what the fit states: it lacks something there.",
            self.part,
            self.of,
            self.ratio.sqrt()
        )
    }
}

const fn words(by: Partition) -> (&'static str, [&'static str; 3]) {
    match by {
        Partition::Whole => ("whole", ["Contacts"; 3]),
        Partition::Radius => {
            ("radius", ["Contacts in the middle", "Contacts half way to the rim", "Contacts near the rim"])
        }
        Partition::Force => {
            ("force", ["The lightest contacts", "Contacts of middling force", "The strongest contacts"])
        }
        Partition::Time => {
            ("time", ["The first contacts", "Contacts midway through the table", "The last contacts"])
        }
    }
}
