//! The profiles to choose from: games, those that are installed first, and what is no game.

use std::env;
use std::path::Path;

use crate::cli::playing::profile;
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::check::OutputChoice;

/// Shipped profiles of no game: for a mouse, a switch, and pads that are no disc.
const NO_GAMES: [&str; 6] = ["pointer", "one-button", "tablet", "touchpad", "board-seated", "board-standing"];

/// Debian's folder of games, which root's PATH lacks.
const GAMES_FOLDER: &str = "/usr/games";

/// A profile to choose.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Choice {
    pub(super) name: String,
    /// The name that people read.
    title: String,
    pub(super) kind: Kind,
}

/// What a profile is for; in the order of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// A game whose program is here.
    Installed,
    /// A game.
    Game,
    /// Something else.
    Other,
}

impl Kind {
    /// The heading of those of this kind.
    pub(super) const fn heading(self) -> &'static str {
        match self {
            Self::Installed => "Games that are installed here:",
            Self::Game => "Games, and what is played like them:",
            Self::Other => "No games, but a mouse, one switch, other pads:",
        }
    }
}

impl Choice {
    /// The name, and the title where that is another word.
    pub(super) fn words(&self) -> String {
        format!("{} ({})", self.name, self.title)
    }
}

/// All profiles that are known, as they are to be listed.
pub(super) fn choices() -> Vec<Choice> {
    let mut choices: Vec<_> = profile::known().into_iter().map(choice).collect();
    choices.sort_by_key(|choice| choice.kind);
    choices
}

fn choice(name: String) -> Choice {
    let read = profile::read_aside(&name, OutputChoice::AsWritten).ok();
    let profile = read.as_ref().map(|(read, _)| read.profile());
    let kind = match profile {
        _ if NO_GAMES.contains(&&*name) => Kind::Other,
        Some(profile) if is_installed(profile, is_command) => Kind::Installed,
        _ => Kind::Game,
    };
    let title = profile.map_or_else(|| "has errors".to_owned(), |profile| profile.name.clone());
    Choice { name, title, kind }
}

/// Whether a program that the profile is for is here; most have the same word for their windows and their executable.
fn is_installed(profile: &Profile, is_command: impl Fn(&str) -> bool) -> bool {
    profile
        .programs
        .iter()
        .any(|program| program.executable.as_deref().or(program.class.as_deref()).is_some_and(&is_command))
}

fn is_command(name: &str) -> bool {
    let path = env::var_os("PATH").unwrap_or_default();
    let folders = env::split_paths(&path).chain([GAMES_FOLDER.into()]);
    folders.map(|folder| folder.join(Path::new(name))).any(|file| file.is_file())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn games_are_told_from_what_is_none_and_those_that_are_here_stand_first() {
        let choices = choices();
        assert!(choices.is_sorted_by_key(|choice| choice.kind));
        let others = choices.iter().filter(|choice| choice.kind == Kind::Other);
        assert_eq!(others.count(), NO_GAMES.len(), "each of them is a profile");
    }

    #[test]
    fn a_game_is_installed_where_its_program_is() {
        let installed = |name: &str, command: &str| {
            let (read, _) = profile::read_aside(name, OutputChoice::AsWritten).ok().unwrap();
            is_installed(read.profile(), |asked| asked == command)
        };
        for (name, command) in [("supertux", "supertux2"), ("btanks", "btanks"), ("vitetris", "vitetris")] {
            assert!(installed(name, command) && !installed(name, "another"), "{name}");
        }
        assert!(!installed("super-mario", "super-mario"), "it is for no program");
    }
}
