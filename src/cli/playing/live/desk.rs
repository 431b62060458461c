//! The program around the tray: which profiles there are, which one is played, and what is kept of that for the next start.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::last_profile;
use super::wish::{Stamp, Wish};
use crate::cli::playing::profile;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::tray::desk::Desk;

/// What a profile calls itself, as it was read.
struct Title {
    stamp: Option<Stamp>,
    /// `None` where it cannot be used.
    text: Option<String>,
}

/// The program that was started from a command line.
pub(super) struct Around {
    wish: Arc<Mutex<Wish>>,
    page: Option<String>,
    titles: BTreeMap<String, Title>,
    /// The names of `titles`, in the order of `profile list`.
    names: Vec<String>,
    remembered: Option<String>,
}

impl Around {
    /// The program in which people wish this, and which shows the bridge at the address `page`.
    pub(super) fn new(wish: Arc<Mutex<Wish>>, page: Option<String>) -> Self {
        Self { wish, page, titles: BTreeMap::new(), names: Vec::new(), remembered: None }
    }

    fn wish(&self) -> Wish {
        self.wish.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Desk for Around {
    fn profiles(&mut self) -> Vec<String> {
        self.names = profile::known();
        self.titles.retain(|name, _| self.names.contains(name));
        for name in &self.names {
            let stamp = Stamp::of(name);
            if self.titles.get(name).is_none_or(|title| title.stamp != stamp) {
                let read = profile::read_aside(name, OutputChoice::AsWritten).ok();
                let text = read.map(|(read, _)| read.profile().name.clone());
                self.titles.insert(name.clone(), Title { stamp, text });
            }
        }
        self.names.clone()
    }

    fn playing(&mut self, title: &str) -> Option<String> {
        let has_title =
            |name: &String| self.titles.get(name).is_some_and(|known| known.text.as_deref() == Some(title));
        // Several may call themselves the same.
        let wished = Some(self.wish().name).filter(has_title);
        wished.or_else(|| self.names.iter().find(|name| has_title(name)).cloned())
    }

    fn remember(&mut self) {
        let asked = self.wish().as_asked();
        if self.remembered.as_ref() != Some(&asked) {
            // Without a place to keep it in, the next start begins with the usual one.
            let _ = last_profile::keep(&asked);
            self.remembered = Some(asked);
        }
    }

    fn page(&self) -> Option<String> {
        self.page.clone()
    }
}
