//! From TOML text to a profile: names, types, ranges, and how the numbers stand to each other.
//!
//! [`check`] reads the whole text, and `section` each of its tables; what these share is in `common`. [`shipped`] has the texts that are
//! inside the program. A [`ReadProfile`] is a profile together with its text, so that it is read once: the text is what captures keep.

pub mod check;
pub(super) mod common;
mod section;
pub mod shear;
pub mod shipped;

use self::check::OutputChoice;
use super::profile::{Keys, Profile};
use crate::pipeline::control::OutputDevice;
use crate::toml_text::diag::Diagnostic;

/// The controls that a binding of a device names, as `BTN_SOUTH` or `KEY_LEFTCTRL+KEY_C`; `None` where it names none of that device.
pub fn binding(device: OutputDevice, text: &str) -> Option<Keys> {
    common::binding::parse_all(device, text).ok()
}

/// A profile that can be used, and the text that says the same.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadProfile {
    text: String,
    output: OutputChoice,
    profile: Profile,
}

impl ReadProfile {
    /// Reads a profile; `None` if there is an error among the findings, see [`check::read`].
    pub fn read(text: &str, output: OutputChoice) -> (Option<Self>, Vec<Diagnostic>) {
        let (profile, diagnostics) = check::read(text, output);
        let read = profile.map(|profile| Self { text: text.to_owned(), output, profile });
        (read, diagnostics)
    }

    /// The TOML text, as it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Which of its two sets of bindings was read.
    pub const fn output(&self) -> OutputChoice {
        self.output
    }

    /// What it says.
    pub const fn profile(&self) -> &Profile {
        &self.profile
    }
}
