//! Changes in the pad since its decoder was made, as ordinary play shows them. Another thread compares and sets them here; the bridge
//! only adds them to its status.

use std::sync::{Arc, Mutex, PoisonError};

use firmware_proto::identity::SerialNumber;
use serde::Serialize;
use serde_json::Value;

/// The changes that were found of one pad.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PadChanges {
    /// The pad.
    #[serde(skip)]
    pub pad: SerialNumber,
    /// The file of the decoder that it is held against.
    pub since: String,
    /// Each change, in the form of a diagnosis.
    pub findings: Value,
    /// All of it, for people, on one line.
    pub text: String,
}

/// The slot for the changes that were found; clones share it.
#[derive(Clone, Debug, Default)]
pub struct ChangesSlot(Arc<Mutex<Option<PadChanges>>>);

impl ChangesSlot {
    /// Sets the changes that were found, in place of earlier ones.
    pub fn set(&self, changes: PadChanges) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(changes);
    }

    /// The changes that were found of this pad.
    pub(super) fn of(&self, pad: Option<SerialNumber>) -> Option<PadChanges> {
        let found = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        found.as_ref().filter(|changes| pad == Some(changes.pad)).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_found_of_one_pad_is_not_told_of_another() {
        let [one, other] = ["A-1", "A-2"].map(SerialNumber::from_ascii);
        let slot = ChangesSlot::default();
        assert_eq!(slot.of(one), None);
        let changes = PadChanges {
            pad: one.unwrap(),
            since: "my.decoder".into(),
            findings: Value::Null,
            text: "none".into(),
        };
        slot.clone().set(changes.clone());
        assert_eq!((slot.of(one), slot.of(other), slot.of(None)), (Some(changes), None, None));
    }
}
