//! What stands on the desktop now.

use std::io;
use std::sync::mpsc::Receiver;
use std::sync::{Mutex, PoisonError};

use serde_json::Value;
use tray_icon::menu::MenuId;
use tray_icon::{TrayIcon, TrayIconBuilder};

use crate::tray::browser::{self, Opening};
use crate::tray::desk::Desk;
use crate::tray::face::Face;
use crate::tray::icon;
use crate::tray::menu::{Choice, Entries};
use tactpad_bridge::request::{Asker, Request};
use tactpad_bridge::snapshot::{Snapshot, Status};
use tactpad_bridge::state::State;

/// Profiles are looked for at each of so many looks: some once a second.
const LOOKS_FOR_PROFILES: u32 = 10;

/// The icon and its menu, and what they show.
pub(super) struct Shown {
    icon: TrayIcon,
    entries: Entries,
    face: Face,
    tooltip: String,
    desk: Box<dyn Desk + Send>,
    asker: Asker,
    opening: Option<Opening>,
    answer: Option<Receiver<String>>,
    /// What went wrong with the last choice, for people.
    trouble: Option<String>,
    looks: u32,
}

impl Shown {
    /// Puts the icon on the desktop.
    ///
    /// # Errors
    /// There is no desktop; the text is for people.
    pub(super) fn begin(
        mut desk: Box<dyn Desk + Send>,
        asker: Asker,
        snapshot: &Mutex<Snapshot>,
    ) -> Result<Self, String> {
        let names = desk.profiles();
        let (menu, entries) = Entries::build(names, desk.page().is_some()).map_err(|it| it.to_string())?;
        let face = Face::of(&look(snapshot));
        let mut builder =
            TrayIconBuilder::new().with_id("tactpad").with_title("tactpad").with_menu(Box::new(menu));
        if let Some(icon) = icon::draw(face) {
            builder = builder.with_icon(icon);
        }
        let icon = builder.build().map_err(|error| error.to_string())?;
        let (tooltip, opening, answer, trouble) = (String::new(), None, None, None);
        let mut shown =
            Self { icon, entries, face, tooltip, desk, asker, opening, answer, trouble, looks: 0 };
        shown.renew(snapshot);
        Ok(shown)
    }

    /// Shows what the bridge is doing now.
    pub(super) fn renew(&mut self, snapshot: &Mutex<Snapshot>) {
        self.hear();
        if self.looks.is_multiple_of(LOOKS_FOR_PROFILES) {
            self.renew_profiles();
            self.desk.remember();
        }
        self.looks = self.looks.wrapping_add(1);
        let status = look(snapshot);
        let face = Face::of(&status);
        if self.face != face {
            self.face = face;
            // Without memory for a picture the old one stays; the words change.
            let _ = icon::draw(face).map(|drawn| self.icon.set_icon(Some(drawn)));
        }
        let tooltip = self
            .trouble
            .clone()
            .unwrap_or_else(|| format!("{}, profile {}", face.words(status.state), status.profile));
        if self.tooltip != tooltip {
            let _ = self.icon.set_tooltip(Some(&tooltip));
            self.tooltip = tooltip;
        }
        // Touches do not change it, so that nothing flickers in a menu that is open.
        let trouble = self.trouble.as_ref().and_then(|it| it.lines().next());
        let line =
            trouble.map_or_else(|| format!("{}: {}", status.profile, status.state.word()), str::to_owned);
        let playing = self.desk.playing(&status.profile);
        self.entries.show(&line, status.state == State::Paused, playing.as_deref());
    }

    /// Hears what came of the last choice, if that is known by now.
    fn hear(&mut self) {
        if let Some(outcome) = self.opening.as_mut().and_then(Opening::outcome) {
            self.opening = None;
            self.trouble = outcome.err();
        }
        if let Some(answer) = self.answer.as_ref().and_then(|answer| answer.try_recv().ok()) {
            self.answer = None;
            let answer: Value = serde_json::from_str(&answer).unwrap_or_default();
            self.trouble = answer.get("error").and_then(Value::as_str).map(str::to_owned);
        }
    }

    /// Makes the menu anew if there are other profiles than in it.
    fn renew_profiles(&mut self) {
        let names = self.desk.profiles();
        if names.iter().eq(self.entries.profiles()) {
            return;
        }
        if let Ok((menu, entries)) = Entries::build(names, self.desk.page().is_some()) {
            self.entries = entries;
            self.icon.set_menu(Some(Box::new(menu)));
        }
    }

    /// Does what was chosen.
    ///
    /// # Errors
    /// The bridge has ended.
    pub(super) fn obey(&mut self, entry: &MenuId) -> io::Result<()> {
        self.trouble = None;
        let request = match Choice::of(entry) {
            Some(Choice::Profile(name)) => Request::Profile(Some(name)),
            Some(Choice::Pause) if self.entries.is_paused() => Request::Resume,
            Some(Choice::Pause) => Request::Pause,
            Some(Choice::Tare) => Request::Retare,
            Some(Choice::Panic) => Request::ReleaseAll,
            Some(Choice::Quit) => Request::End,
            Some(Choice::Page) => {
                self.open("");
                return Ok(());
            }
            Some(Choice::Doctor) => {
                self.open("#doctor");
                return Ok(());
            }
            None => return Ok(()),
        };
        self.answer = Some(self.asker.question(request)?);
        Ok(())
    }

    /// Opens this part of the page.
    fn open(&mut self, part: &str) {
        let Some(page) = self.desk.page() else { return };
        match browser::open(&format!("{page}{part}")) {
            Ok(opening) => self.opening = Some(opening),
            Err(error) => self.trouble = Some(error),
        }
    }
}

/// What the bridge is doing. The bridge does not wait for this: it skips a snapshot that is being read.
fn look(snapshot: &Mutex<Snapshot>) -> Status {
    snapshot.lock().unwrap_or_else(PoisonError::into_inner).status.clone()
}
