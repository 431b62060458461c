//! The host of the page: the interface of the program around the bridge, for profiles, the doctor and reports.

use std::path::PathBuf;
use std::sync::Arc;

use serde::Serialize;

use super::practice::Wish;
use tactpad_core::pipeline::call::Call;
use tactpad_core::pipeline::capture::head::Head;
use tactpad_core::pipeline::mapping::read::check::OutputChoice;
use tactpad_core::source::Source;
use tactpad_core::time::HostInstant;
use tactpad_core::toml_text::diag::Diagnostic;
use tactpad_lab::play::guide::Guide;
use tactpad_lab::play::weights::Placement;

/// The program around the bridge. Its functions may read and write files; they are called on a thread that may wait.
pub trait DashboardHost: Send + Sync {
    /// All profiles that have names.
    fn entries(&self) -> Vec<ProfileEntry>;

    /// The profile that is played: its name, or its file.
    fn playing(&self) -> String;

    /// Which bindings of a profile are played here.
    fn output(&self) -> OutputChoice;

    /// The description of the pad; `None` of a strain pad.
    fn described(&self) -> Option<Arc<Source>> {
        None
    }

    /// Whether the pad measures forces along the plate.
    fn pad_has_shear(&self) -> bool {
        self.described().is_none_or(|pad| pad.has_shear())
    }

    /// A profile by its name. `None` if there is none, or if it is no name: no file outside the folder of profiles is read.
    fn read(&self, name: &str) -> Option<StoredProfile>;

    /// Keeps a profile in the user's own folder.
    ///
    /// # Errors
    /// Nothing was written.
    fn save(&self, name: &str, text: &str, over: &Overwrite) -> Result<SavedProfile, SaveError>;

    /// The saves of a profile of the user's own, the newest first, as `tactpad profile history --json` prints them.
    fn history(&self, name: &str) -> serde_json::Value;

    /// The text of the save that has this `id`.
    fn saved(&self, name: &str, id: u64) -> Option<String>;

    /// Removes a profile of the user's own; its history stays.
    ///
    /// # Errors
    /// It is still there.
    fn delete(&self, name: &str) -> Result<(), SaveError>;

    /// Gives a profile of the user's own another name, and its history with it.
    ///
    /// # Errors
    /// It has the name that it had.
    fn rename(&self, from: &str, to: &str) -> Result<(), SaveError>;

    /// The names of the user's own decoders.
    fn decoders(&self) -> Vec<String>;

    /// A profile as a file for export, with the user's own decoder of this name if one is named; `None` if there is no such profile or decoder.
    fn exported(&self, name: &str, decoder: Option<&str>) -> Option<String>;

    /// Makes the profile of an exported file the user's own under a name that is new; the path of its decoder, if one is in it.
    ///
    /// # Errors
    /// There is no new profile.
    fn import(&self, document: &str, name: &str) -> Result<Option<String>, SaveError>;

    /// The findings about this machine, as `tactpad doctor --json` prints them.
    fn doctor(&self) -> serde_json::Value;

    /// Reports of diagnoses, the newest first.
    fn reports(&self) -> Vec<ReportEntry>;

    /// The page of the report of this number.
    fn report(&self, id: &str) -> Option<PathBuf>;

    /// Has a virtual pad's practice hand do what a guide asks, if one plays.
    fn practise(&self, _wish: Wish) {}

    /// Whether there is an earlier session to go on from, of the calibration that is kept under this name.
    fn has_session(&self, name: &str) -> bool;

    /// Opens what the calibration of this name keeps. What an earlier session heard is told to the guide, unless this one is `fresh`.
    ///
    /// # Errors
    /// It cannot be read or written; the text is for people.
    fn open_session(
        &self,
        name: &str,
        fresh: bool,
        guide: &mut Guide,
        head: &Head,
    ) -> Result<Box<dyn SessionStore>, String>;

    /// Keeps the decoder that the calibration of this name came to. It plays nowhere by that.
    ///
    /// # Errors
    /// Nothing was written; the text is for people.
    fn keep_decoder(&self, name: &str, bytes: &[u8]) -> Result<KeptDecoder, String>;
}

/// The store of a calibration's calls, from which a later session goes on.
pub trait SessionStore: Send {
    /// A moment of the session in the time of what is kept.
    fn at(&self, at: HostInstant) -> HostInstant;

    /// Keeps a call, at that time.
    ///
    /// # Errors
    /// It cannot be written; the text is for people.
    fn write(&mut self, at: HostInstant, call: Call<'_>) -> Result<(), String>;

    /// Sees that everything is there whatever comes.
    ///
    /// # Errors
    /// It cannot be written; the text is for people.
    fn settle(&mut self, placements: &[Placement]) -> Result<(), String>;
}

/// A decoder that is kept.
#[derive(Clone, Debug)]
pub struct KeptDecoder {
    /// Its file, by its whole path.
    pub path: String,
    /// The command that plays with it.
    pub command: String,
}

/// A profile that has a name.
#[derive(Clone, Debug, Serialize)]
pub struct ProfileEntry {
    /// The name.
    pub name: String,
    /// Whether it is the user's own.
    pub own: bool,
    /// Whether there is one of this name inside the program.
    pub shipped: bool,
}

/// A profile as it is kept.
#[derive(Clone, Debug, Serialize)]
pub struct StoredProfile {
    /// Its name, and whose it is.
    #[serde(flatten)]
    pub entry: ProfileEntry,
    /// Its text.
    pub text: String,
    /// Tells this text from others.
    pub version: String,
}

/// The version that a profile may overwrite.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Overwrite {
    /// Whatever is there.
    Anything,
    /// Only this version.
    Version(String),
    /// Nothing: it must be new.
    Nothing,
}

/// A profile was kept.
#[derive(Clone, Debug, Serialize)]
pub struct SavedProfile {
    /// Tells the text from others.
    pub version: String,
    /// The file.
    pub path: String,
}

/// Why a profile was not kept; the texts are for people.
#[derive(Clone, Debug)]
pub enum SaveError {
    /// It cannot have this name.
    Name(String),
    /// It has errors.
    Errors(Vec<Diagnostic>),
    /// Another one is there than was to be written over.
    Changed(String),
    /// It cannot be written.
    Failed(String),
}

/// A report of a diagnosis.
#[derive(Clone, Debug, Serialize)]
pub struct ReportEntry {
    /// By which [`DashboardHost::report`] finds it.
    pub id: String,
    /// The folder's name.
    pub name: String,
    /// Its whole path.
    pub folder: String,
    /// Seconds since 1970 when it was written.
    pub modified_s: u64,
    /// Its verdict.
    pub verdict: String,
    /// The findings, in one line.
    pub summary: String,
}
