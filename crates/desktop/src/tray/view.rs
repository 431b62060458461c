//! The icon and the menu as they are shown now.

use std::io;
use std::sync::mpsc::Receiver;
use std::sync::{Mutex, PoisonError};

use serde_json::Value;
use tray_icon::menu::MenuId;
use tray_icon::{TrayIcon, TrayIconBuilder};

use crate::tray::browser::{self, Opening};
use crate::tray::host::TrayHost;
use crate::tray::icon;
use crate::tray::icon_state::IconState;
use crate::tray::menu::{MenuChoice, MenuEntries};
use tactpad_bridge::request::{Request, RequestSender};
use tactpad_bridge::snapshot::{Snapshot, Status};
use tactpad_bridge::state::State;

/// Profiles are looked for at each of so many looks: some once a second.
const LOOKS_FOR_PROFILES: u32 = 10;

/// The icon and its menu, and what they show.
pub(super) struct TrayView {
    icon: TrayIcon,
    entries: MenuEntries,
    icon_state: IconState,
    tooltip: String,
    host: Box<dyn TrayHost + Send>,
    sender: RequestSender,
    opening: Option<Opening>,
    answer: Option<Receiver<String>>,
    /// Error of the last choice, for people.
    trouble: Option<String>,
    looks: u32,
}

impl TrayView {
    /// Puts the icon on the desktop.
    ///
    /// # Errors
    /// There is no desktop; the text is for people.
    pub(super) fn begin(
        mut host: Box<dyn TrayHost + Send>,
        sender: RequestSender,
        snapshot: &Mutex<Snapshot>,
    ) -> Result<Self, String> {
        let names = host.profiles();
        let (menu, entries) =
            MenuEntries::build(names, host.page().is_some()).map_err(|it| it.to_string())?;
        let icon_state = IconState::of(&look(snapshot));
        let mut builder =
            TrayIconBuilder::new().with_id("tactpad").with_title("tactpad").with_menu(Box::new(menu));
        if let Some(icon) = icon::draw(icon_state) {
            builder = builder.with_icon(icon);
        }
        let icon = builder.build().map_err(|error| error.to_string())?;
        let (tooltip, opening, answer, trouble) = (String::new(), None, None, None);
        let mut view =
            Self { icon, entries, icon_state, tooltip, host, sender, opening, answer, trouble, looks: 0 };
        view.renew(snapshot);
        Ok(view)
    }

    /// Shows what the bridge is doing now.
    pub(super) fn renew(&mut self, snapshot: &Mutex<Snapshot>) {
        self.hear();
        if self.looks.is_multiple_of(LOOKS_FOR_PROFILES) {
            self.renew_profiles();
            self.host.remember();
        }
        self.looks = self.looks.wrapping_add(1);
        let status = look(snapshot);
        let icon_state = IconState::of(&status);
        if self.icon_state != icon_state {
            self.icon_state = icon_state;
            // Without memory for a picture the old one stays; the words change.
            let _ = icon::draw(icon_state).map(|drawn| self.icon.set_icon(Some(drawn)));
        }
        let tooltip = self
            .trouble
            .clone()
            .unwrap_or_else(|| format!("{}, profile {}", icon_state.words(status.state), status.profile));
        if self.tooltip != tooltip {
            let _ = self.icon.set_tooltip(Some(&tooltip));
            self.tooltip = tooltip;
        }
        // Touches do not change it, so that nothing flickers in a menu that is open.
        let trouble = self.trouble.as_ref().and_then(|it| it.lines().next());
        let line =
            trouble.map_or_else(|| format!("{}: {}", status.profile, status.state.word()), str::to_owned);
        let playing = self.host.playing(&status.profile);
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
        let names = self.host.profiles();
        if names.iter().eq(self.entries.profiles()) {
            return;
        }
        if let Ok((menu, entries)) = MenuEntries::build(names, self.host.page().is_some()) {
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
        let request = match MenuChoice::of(entry) {
            Some(MenuChoice::Profile(name)) => Request::Profile(Some(name)),
            Some(MenuChoice::Pause) if self.entries.is_paused() => Request::Resume,
            Some(MenuChoice::Pause) => Request::Pause,
            Some(MenuChoice::Tare) => Request::Retare,
            Some(MenuChoice::Panic) => Request::ReleaseAll,
            Some(MenuChoice::Quit) => Request::End,
            Some(MenuChoice::Page) => {
                self.open("");
                return Ok(());
            }
            Some(MenuChoice::Doctor) => {
                self.open("#doctor");
                return Ok(());
            }
            None => return Ok(()),
        };
        self.answer = Some(self.sender.send_for_reply(request)?);
        Ok(())
    }

    /// Opens this part of the page.
    fn open(&mut self, part: &str) {
        let Some(page) = self.host.page() else { return };
        match browser::open(&format!("{page}{part}")) {
            Ok(opening) => self.opening = Some(opening),
            Err(error) => self.trouble = Some(error),
        }
    }
}

/// The status of the bridge. The bridge does not wait for this: it skips a snapshot that is being read.
fn look(snapshot: &Mutex<Snapshot>) -> Status {
    snapshot.lock().unwrap_or_else(PoisonError::into_inner).status.clone()
}
