//! A check, and how it came out.

use serde::Serialize;

/// How a check came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Finding {
    /// In order.
    Good,
    /// Worth knowing; nothing needs to be done.
    Note,
    /// Stands in the way.
    Bad,
}

/// One check.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub(super) struct Check {
    pub(super) name: &'static str,
    pub(super) finding: Finding,
    pub(super) message: String,
    /// The command that mends it.
    pub(super) mend: Option<String>,
}

impl Check {
    pub(super) fn good(name: &'static str, message: impl Into<String>) -> Self {
        Self { name, finding: Finding::Good, message: message.into(), mend: None }
    }

    pub(super) fn note(name: &'static str, message: impl Into<String>) -> Self {
        Self { name, finding: Finding::Note, message: message.into(), mend: None }
    }

    pub(super) fn bad(name: &'static str, message: impl Into<String>, mend: impl Into<String>) -> Self {
        Self { name, finding: Finding::Bad, message: message.into(), mend: Some(mend.into()) }
    }

    /// The same where it stands in nobody's way, and why.
    pub(super) fn noted(self, why: &str) -> Self {
        Self { finding: Finding::Note, message: format!("{}; {why}", self.message), ..self }
    }
}
