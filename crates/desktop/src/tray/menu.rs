//! The icon's menu.

use tray_icon::menu::{
    CheckMenuItem, IsMenuItem, Menu, MenuId, MenuItem, PredefinedMenuItem, Result, Submenu,
};

/// Prefix of a profile's name in the name of its entry.
const PROFILE: &str = "profile:";

/// A choice of people in the menu.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum MenuChoice {
    /// Go over to this profile.
    Profile(String),
    /// Pause, or go on.
    Pause,
    /// Measure the zero.
    Tare,
    /// Release everything.
    Panic,
    /// Open the page.
    Page,
    /// Open what the page says of this machine.
    Doctor,
    /// End the bridge.
    Quit,
}

/// The entries without a profile: their names, their texts, and what they stand for.
const ENTRIES: [(&str, &str, MenuChoice); 6] = [
    ("pause", "Pause", MenuChoice::Pause),
    ("tare", "Measure the zero", MenuChoice::Tare),
    ("panic", "Release everything", MenuChoice::Panic),
    ("page", "Open dashboard…", MenuChoice::Page),
    ("doctor", "Doctor…", MenuChoice::Doctor),
    ("quit", "Quit", MenuChoice::Quit),
];

/// The text of the entry for [`MenuChoice::Pause`] while the bridge is paused.
const GO_ON: &str = "Go on";

impl MenuChoice {
    /// The choice of the entry with this name.
    pub(super) fn of(entry: &MenuId) -> Option<Self> {
        let name = entry.as_ref();
        if let Some(profile) = name.strip_prefix(PROFILE) {
            return Some(Self::Profile(profile.to_owned()));
        }
        ENTRIES.into_iter().find(|(entry, ..)| *entry == name).map(|(.., choice)| choice)
    }

    /// The text of its entry.
    const fn is_on_page(&self) -> bool {
        matches!(self, Self::Page | Self::Doctor)
    }
}

/// A menu, and those of its entries that change.
pub(super) struct MenuEntries {
    line: MenuItem,
    pause: MenuItem,
    profiles: Vec<(String, CheckMenuItem)>,
    is_paused: bool,
}

impl MenuEntries {
    /// A menu for these profiles. What the page shows can be chosen only where there is one.
    ///
    /// # Errors
    /// An entry cannot be put in.
    pub(super) fn build(names: Vec<String>, has_page: bool) -> Result<(Menu, Self)> {
        let line = MenuItem::new("", false, None);
        let entry = |name: String| {
            let item = CheckMenuItem::with_id(format!("{PROFILE}{name}"), plain(&name), true, false, None);
            (name, item)
        };
        let profiles: Vec<_> = names.into_iter().map(entry).collect();
        let submenu = Submenu::new("Profile", !profiles.is_empty());
        profiles.iter().try_for_each(|(_, item)| submenu.append(item))?;
        let items = ENTRIES.map(|(name, text, choice)| {
            MenuItem::with_id(name, text, has_page || !choice.is_on_page(), None)
        });
        let [pause, tare, panic, page, doctor, quit] = &items;
        let gap = PredefinedMenuItem::separator;
        let (gaps, menu) = ([gap(), gap(), gap()], Menu::new());
        let parts: [&dyn IsMenuItem; 11] =
            [&line, &gaps[0], &submenu, pause, tare, panic, &gaps[1], page, doctor, &gaps[2], quit];
        menu.append_items(&parts)?;
        Ok((menu, Self { line, pause: pause.clone(), profiles, is_paused: false }))
    }

    /// The names of its profiles.
    pub(super) fn profiles(&self) -> impl Iterator<Item = &String> {
        self.profiles.iter().map(|(name, _)| name)
    }

    /// Whether the entry that pauses says that the bridge goes on.
    pub(super) const fn is_paused(&self) -> bool {
        self.is_paused
    }

    /// Shows the state: its line, whether the bridge is paused, and which profile is played. What shows it already stays.
    pub(super) fn show(&mut self, line: &str, is_paused: bool, playing: Option<&str>) {
        let line = plain(line);
        if self.line.text() != line {
            self.line.set_text(line);
        }
        if self.is_paused != is_paused {
            self.is_paused = is_paused;
            self.pause.set_text(if is_paused { GO_ON } else { "Pause" });
        }
        // A click has changed the mark of its entry, whatever came of it.
        for (name, item) in &self.profiles {
            let is_played = playing == Some(name);
            if item.is_checked() != is_played {
                item.set_checked(is_played);
            }
        }
    }
}

/// A text in which `&` stands for itself, and not for a key.
fn plain(text: &str) -> String {
    text.replace('&', "&&")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_entries_stand_for_choices() {
        for (name, _, choice) in ENTRIES {
            assert_eq!(MenuChoice::of(&MenuId::new(name)), Some(choice));
        }
        assert_eq!(
            MenuChoice::of(&MenuId::new("profile:my game")),
            Some(MenuChoice::Profile("my game".into()))
        );
        assert_eq!(MenuChoice::of(&MenuId::new("another's")), None);
    }

    #[test]
    fn the_menu_shows_the_state_and_the_profile_that_is_played() {
        let (_, mut entries) = MenuEntries::build(vec!["a&b".into(), "c".into()], true).unwrap();
        entries.show("A & B: paused", true, Some("a&b"));
        assert_eq!((entries.line.text(), entries.pause.text()), ("A && B: paused".into(), GO_ON.into()));
        let checked = |entries: &MenuEntries| {
            entries.profiles.iter().map(|(_, it)| it.is_checked()).collect::<Vec<_>>()
        };
        assert_eq!(checked(&entries), [true, false]);
        // A click changes a mark, though the bridge may refuse the profile.
        entries.profiles[1].1.set_checked(true);
        entries.show("A & B: playing", false, Some("a&b"));
        assert_eq!((checked(&entries), entries.pause.text()), (vec![true, false], "Pause".into()));
    }
}
