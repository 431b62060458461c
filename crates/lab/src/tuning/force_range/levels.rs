//! The normal forces that a profile asks for.

use crate::tuning::knobs::{Key, shortest};
use tactpad_core::pipeline::mapping::profile::{Action, Force, Profile};
use tactpad_core::toml_text::edit::{self, Table};

/// Levels that differ by less, as a ratio, are one force: one press reaches all of them.
pub const ONE_FORCE: f64 = 1.5;

/// A normal force that something begins at, in newtons.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Where it stands.
    pub key: Key,
    /// What it is, written or by default.
    pub force_n: f64,
    /// Other numbers that are written and keep their share of it, each with what it is and the least that it may be.
    pub(super) followers: Vec<DependentNumber>,
    /// The key of the same table that must stay less.
    pub(super) above: Option<&'static str>,
}

/// A number that goes with a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DependentNumber {
    pub(super) key: &'static str,
    pub(super) force_n: f64,
    pub(super) least_n: f64,
}

/// What a release may be, and a hair trigger.
const RELEASE_MIN_N: f64 = 0.0;
const HAIR_MIN_N: f64 = 0.05;

/// The levels of a profile, in the order of its tables: directions, pointer, sticks, triggers, buttons. Forces along the plate are none of
/// them, and neither is `rest_n`, see [`rest_n`].
pub fn all(profile: &Profile, text: &str) -> Vec<Level> {
    let mut found = Found { text, levels: Vec::new() };
    let gate = ["min_force_n", "release_force_n"];
    if let Some(dpad) = &profile.dpad {
        found.level(Table::Named("dpad"), gate, [dpad.min_force_n, dpad.release_force_n]);
    }
    if let Some(pointer) = &profile.pointer {
        found.level(Table::Named("pointer"), gate, [pointer.min_force_n, pointer.release_force_n]);
    }
    for (number, stick) in profile.sticks.iter().enumerate() {
        found.level(Table::Listed("stick", number), gate, [stick.min_force_n, stick.release_force_n]);
    }
    for (number, trigger) in profile.triggers.iter().enumerate() {
        let table = Table::Listed("trigger", number);
        found.add(table, "from_n", trigger.from_n, None);
        found.add(table, "full_n", trigger.full_n, Some("from_n"));
    }
    for (number, button) in profile.buttons.iter().enumerate().filter(|(_, it)| it.force == Force::Fz) {
        let table = Table::Listed("button", number);
        found.level(table, ["press_n", "release_n"], [button.press_n, button.release_n]);
        if let Some(hair_n) = button.hair_n {
            found.follower("hair_n", hair_n, HAIR_MIN_N);
        }
        if let Action::ByForce { hard_press_n, hard_release_n, .. } = button.action {
            found.add(table, "hard_press_n", hard_press_n, Some("press_n"));
            found.follower("hard_release_n", hard_release_n, RELEASE_MIN_N);
        }
    }
    found.levels
}

/// The lowest and the highest of them; `None` where there are none.
pub fn ends_n(levels: &[Level]) -> Option<[f64; 2]> {
    let forces = || levels.iter().map(|level| level.force_n);
    (!levels.is_empty())
        .then(|| [forces().fold(f64::INFINITY, f64::min), forces().fold(f64::NEG_INFINITY, f64::max)])
}

/// Whether one force is enough for a profile with these ends, as a light press reaches them all.
pub fn is_one_force([lowest_n, highest_n]: [f64; 2]) -> bool {
    highest_n < ONE_FORCE * lowest_n
}

/// By how much a touch must exceed the hand that rests, if the profile asks for that.
pub fn rest_n(profile: &Profile) -> Option<f64> {
    profile.access.rest.map(|rest| shortest(rest.n))
}

struct Found<'t> {
    text: &'t str,
    levels: Vec<Level>,
}

impl Found<'_> {
    /// A level and what it is released below.
    fn level(&mut self, table: Table, [key, release]: [&'static str; 2], [force_n, release_n]: [f32; 2]) {
        self.add(table, key, force_n, None);
        self.follower(release, release_n, RELEASE_MIN_N);
    }

    fn add(&mut self, table: Table, key: &'static str, force_n: f32, above: Option<&'static str>) {
        let level = Level { key: (table, key), force_n: shortest(force_n), followers: Vec::new(), above };
        self.levels.push(level);
    }

    /// A number that goes with the last level. What is not written follows by itself.
    fn follower(&mut self, key: &'static str, force_n: f32, least_n: f64) {
        if let Some(level) = self.levels.last_mut()
            && edit::written(self.text, level.key.0, key).is_some()
        {
            level.followers.push(DependentNumber { key, force_n: shortest(force_n), least_n });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pipeline::mapping::read::check::{OutputChoice, read};
    use tactpad_core::pipeline::mapping::read::shipped;

    fn found(text: &str) -> Vec<(&'static str, f64, Vec<&'static str>)> {
        let (profile, findings) = read(text, OutputChoice::AsWritten);
        let profile = profile.unwrap_or_else(|| panic!("{findings:?}"));
        let shown =
            |level: &Level| (level.key.1, level.force_n, level.followers.iter().map(|it| it.key).collect());
        all(&profile, text).iter().map(shown).collect()
    }

    #[test]
    fn all_normal_forces_are_levels_and_no_other_ones() {
        let text = "schema = 1\nname = \"All\"\noutput = \"gamepad\"\naccess = { rest_n = 0.5 }\n[dpad]\n\
            [pointer]\nmin_force_n = 0.4\nrelease_force_n = 0.3\n\
            [[stick]]\nstick = \"left\"\nfrom = \"shear\"\n[[trigger]]\ntrigger = \"left\"\nfull_n = 3\n\
            [[button]]\nforce = \"fx\"\npress_n = 1\nout = { gamepad = \"BTN_TL\", keyboard = \"KEY_A\" }\n\
            [[button]]\nforce = \"fz\"\npress_n = 1.5\nhair_n = 0.3\nhard_press_n = 3\nhard_release_n = 2\n\
            light = { gamepad = \"BTN_TR\", keyboard = \"KEY_S\" }\nhard = { gamepad = \"BTN_EAST\", keyboard = \"KEY_X\" }\n";
        let wanted = [
            ("min_force_n", 0.3, vec![]),
            ("min_force_n", 0.4, vec!["release_force_n"]),
            ("min_force_n", 0.3, vec![]),
            ("from_n", 0.5, vec![]),
            ("full_n", 3.0, vec![]),
            ("press_n", 1.5, vec!["hair_n"]),
            ("hard_press_n", 3.0, vec!["hard_release_n"]),
        ];
        assert_eq!(found(text), wanted);
    }

    #[test]
    fn of_the_shipped_profiles_one_asks_for_one_force() {
        let is_one = |name: &&str| {
            let text = shipped::text(name).unwrap();
            let profile = read(text, OutputChoice::AsWritten).0.unwrap();
            is_one_force(ends_n(&all(&profile, text)).unwrap())
        };
        assert_eq!(shipped::names().filter(is_one).collect::<Vec<_>>(), ["one-button"]);
        assert_eq!(ends_n(&[]), None);
    }
}
