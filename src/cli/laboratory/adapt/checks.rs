//! Where contacts miss a fit by more than its noise says.

use serde::Serialize;

use tactpad::lab::calibration::result::predictive::{Partition, PredictiveCheck};

/// A third of the contacts, held against all of them.
#[derive(Serialize)]
pub(super) struct CheckResult {
    by: &'static str,
    part: &'static str,
    contacts: usize,
    /// Their mean square over that of all.
    ratio: f64,
    p_value: f64,
    /// Whether that is more than chance.
    missed: bool,
}

impl CheckResult {
    pub(super) fn of(check: &PredictiveCheck) -> Self {
        let PredictiveCheck { by, third, contacts, ratio, p_value } = *check;
        let (by, parts) = words(by);
        Self { by, part: parts[third.min(2)], contacts, ratio, p_value, missed: check.is_missed() }
    }

    /// The sentence about a check that is missed.
    pub(super) fn words(&self) -> String {
        format!(
            "{} miss by {:.2} times what all do: the fit lacks something there, and regions that are stated there are too narrow by as \
             much.",
            self.part,
            self.ratio.sqrt()
        )
    }
}

const fn words(by: Partition) -> (&'static str, [&'static str; 3]) {
    match by {
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
