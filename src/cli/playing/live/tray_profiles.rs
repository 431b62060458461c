//! The profiles for the tray's menu: which ones exist, which one is in play, and the choice that is saved for the next start.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::last_choice;
use super::profile_selection::{FileStamp, ProfileSelection};
use crate::cli::playing::profile;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::tray::host::TrayHost;

/// The title of a profile, as its file gives it.
struct ProfileTitle {
    stamp: Option<FileStamp>,
    /// `None` where it cannot be used.
    text: Option<String>,
}

/// The host of the tray: it lists the profiles and saves the last choice.
pub(super) struct TrayProfiles {
    selection: Arc<Mutex<ProfileSelection>>,
    page: Option<String>,
    titles: BTreeMap<String, ProfileTitle>,
    /// The names of `titles`, in the order of `profile list`.
    names: Vec<String>,
    remembered: Option<String>,
}

impl TrayProfiles {
    /// The profiles of a program with this selection; `page` is the address of the bridge's page.
    pub(super) fn new(selection: Arc<Mutex<ProfileSelection>>, page: Option<String>) -> Self {
        Self { selection, page, titles: BTreeMap::new(), names: Vec::new(), remembered: None }
    }

    fn selection(&self) -> ProfileSelection {
        self.selection.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl TrayHost for TrayProfiles {
    fn profiles(&mut self) -> Vec<String> {
        self.names = profile::known();
        self.titles.retain(|name, _| self.names.contains(name));
        for name in &self.names {
            let stamp = FileStamp::of(name);
            if self.titles.get(name).is_none_or(|title| title.stamp != stamp) {
                let read = profile::read_aside(name, OutputChoice::AsWritten).ok();
                let text = read.map(|(read, _)| read.profile().name.clone());
                self.titles.insert(name.clone(), ProfileTitle { stamp, text });
            }
        }
        self.names.clone()
    }

    fn playing(&mut self, title: &str) -> Option<String> {
        let has_title =
            |name: &String| self.titles.get(name).is_some_and(|known| known.text.as_deref() == Some(title));
        // Several may call themselves the same.
        let selected = Some(self.selection().name).filter(has_title);
        selected.or_else(|| self.names.iter().find(|name| has_title(name)).cloned())
    }

    fn remember(&mut self) {
        let argument = self.selection().as_argument();
        if self.remembered.as_ref() != Some(&argument) {
            // Without a place to keep it in, the next start begins with the usual one.
            let _ = last_choice::keep_profile(&argument);
            self.remembered = Some(argument);
        }
    }

    fn page(&self) -> Option<String> {
        self.page.clone()
    }
}
