//! What changed from one text of a profile to the next, in words.

use std::collections::BTreeSet;

use tactpad::pipeline::control::OutputDevice;
use tactpad::pipeline::mapping::plain::{controls, named, settings, values};
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::{self, check};
use toml::{Table, Value};

/// The table of helps for hands, which say by themselves what they do.
const HELPS: &str = "access";
/// More changes than this are counted.
const TOLD_MAX: usize = 6;

/// One phrase for each change; of texts that say the same, that it is so.
pub(super) fn changes(before: &str, after: &str) -> Vec<String> {
    let read = |text: &str| toml::from_str::<Table>(text);
    let (Ok(old), Ok(new)) = (read(before), read(after)) else {
        return vec!["the text, which could not be read".into()];
    };
    let mut told = Vec::new();
    let profile = |text: &str| check::read(text, check::OutputChoice::AsWritten).0;
    let profiles = Versions { old: profile(before), new: profile(after) };
    tables(&Place::default(), &old, &new, &profiles, &mut told);
    if told.is_empty() {
        told.push("only comments".into());
    }
    let more = told.len().saturating_sub(TOLD_MAX);
    told.truncate(TOLD_MAX);
    if more > 0 {
        told.push(format!("and {more} more"));
    }
    told
}

/// Both texts as they are played, where they can be.
struct Versions {
    old: Option<Profile>,
    new: Option<Profile>,
}

/// Where something stands in a profile.
#[derive(Clone, Default)]
struct Place {
    /// Its tables and its key, as settings are named.
    setting: String,
    /// The same for people: `button 1, press force`.
    words: String,
    /// What people call it, before its number: `A: jump`.
    name: Option<String>,
    /// Which table of a list it is, from 0.
    index: usize,
}

impl Place {
    fn key(&self, key: &str) -> Self {
        let (dot, comma) = if self.setting.is_empty() { ("", "") } else { (".", ", ") };
        let setting = format!("{}{dot}{key}", self.setting);
        let word = settings::word(&setting);
        let of = self.name.as_ref().unwrap_or(&self.words);
        let words = if self.setting == HELPS { word.to_owned() } else { format!("{of}{comma}{word}") };
        Self { setting, words, name: None, index: 0 }
    }

    fn number(&self, index: usize) -> Self {
        let words = format!("{} {}", self.words, index + 1);
        Self { setting: self.setting.clone(), words, name: None, index }
    }

    /// A button is named by what it does: `A: jump`.
    fn named(self, profiles: &Versions) -> Self {
        let played =
            [&profiles.old, &profiles.new].into_iter().flatten().filter(|_| self.setting == "button");
        let name =
            played.filter_map(|profile| named::button(profile, self.index)).find(|name| !name.is_empty());
        Self { name, ..self }
    }

    /// Whether it is a help for hands.
    fn is_help(&self) -> bool {
        self.setting.strip_prefix(HELPS).is_some_and(|rest| rest.starts_with('.'))
    }

    /// A whole table that stands here, for people: `button 2, Start: pause`.
    fn table(&self, table: &Table, profile: Option<&Profile>) -> String {
        let button = profile.filter(|_| self.setting == "button");
        let name = button.and_then(|profile| named::button(profile, self.index));
        let name = name.or_else(|| Some(table.get("name")?.as_str()?.to_owned()));
        name.map_or_else(|| self.words.clone(), |name| format!("{}, {name},", self.words))
    }

    /// A text that stands here, for people.
    fn text(&self, text: &str) -> String {
        let devices = [OutputDevice::Gamepad, OutputDevice::Keyboard, OutputDevice::Pointer];
        let device =
            devices.into_iter().find(|it| self.setting.split('.').skip(1).any(|step| step == it.name()));
        let keys = device.and_then(|device| read::binding(device, text));
        keys.map_or_else(
            || format!("“{}”", values::word(&self.setting, text)),
            |keys| controls::all_of(&keys),
        )
    }
}

fn tables(place: &Place, old: &Table, new: &Table, profiles: &Versions, told: &mut Vec<String>) {
    let keys: BTreeSet<&String> = old.keys().chain(new.keys()).collect();
    for key in keys {
        compare(&place.key(key), old.get(key), new.get(key), profiles, told);
    }
}

fn compare(
    place: &Place,
    old: Option<&Value>,
    new: Option<&Value>,
    profiles: &Versions,
    told: &mut Vec<String>,
) {
    let words = &place.words;
    match (old, new) {
        (Some(old), Some(new)) if old == new => {}
        (Some(Value::Table(old)), Some(Value::Table(new))) => tables(place, old, new, profiles, told),
        (Some(Value::Array(old)), Some(Value::Array(new))) => lists(place, old, new, profiles, told),
        (None, Some(Value::Array(new))) => lists(place, &[], new, profiles, told),
        (Some(Value::Array(old)), None) => lists(place, old, &[], profiles, told),
        (None, Some(Value::Table(new))) if place.setting == HELPS => {
            tables(place, &Table::new(), new, profiles, told);
        }
        (Some(Value::Table(old)), None) if place.setting == HELPS => {
            tables(place, old, &Table::new(), profiles, told);
        }
        (None, Some(Value::Table(new))) => {
            told.push(format!("{} added", place.table(new, profiles.new.as_ref())));
        }
        (Some(Value::Table(old)), None) => {
            told.push(format!("{} removed", place.table(old, profiles.old.as_ref())));
        }
        (None, Some(new)) if place.is_help() => told.push(format!("{words} {}", said(place, new))),
        (Some(old), None) if place.is_help() => told.push(format!("{words} {}: no more", said(place, old))),
        (Some(old), Some(new)) => {
            told.push(format!("{words} from {} to {}", said(place, old), said(place, new)));
        }
        (None, Some(new)) => told.push(format!("{words} added{}", of(place, new))),
        (Some(old), None) => told.push(format!("{words} removed{}", of(place, old))),
        (None, None) => {}
    }
}

/// Lists are compared from both ends, so that one that was removed in the middle is one change.
fn lists(place: &Place, old: &[Value], new: &[Value], profiles: &Versions, told: &mut Vec<String>) {
    let same = |pair: &(&Value, &Value)| pair.0 == pair.1;
    let head = old.iter().zip(new).take_while(same).count();
    let shorter = old.len().min(new.len()) - head;
    let tail = old.iter().rev().zip(new.iter().rev()).take(shorter).take_while(same).count();
    let old = old.get(head..old.len() - tail).unwrap_or_default();
    let new = new.get(head..new.len() - tail).unwrap_or_default();
    for index in 0..old.len().max(new.len()) {
        compare(&place.number(head + index).named(profiles), old.get(index), new.get(index), profiles, told);
    }
}

/// " (2.5 N)"
fn of(place: &Place, value: &Value) -> String {
    format!(" ({})", said(place, value))
}

fn said(place: &Place, value: &Value) -> String {
    match value {
        Value::String(text) => place.text(text),
        Value::Boolean(true) => "yes".into(),
        Value::Boolean(false) => "no".into(),
        Value::Integer(number) => settings::amount(&place.setting, *number as f64),
        Value::Float(number) => settings::amount(&place.setting, *number),
        Value::Datetime(date) => date.to_string(),
        Value::Array(all) => format!("{} of them", all.len()),
        Value::Table(_) => "a table".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "min_press_ms = 40\n[dpad]\nmode = \"8way\"\n[[button]]\npress_n = 2.0\nout = { keyboard = \"KEY_Z\" }\n\
                        [[button]]\nforce = \"fy\"\npress_n = 1.2\n[[button]]\npress_n = 3.0\n";

    const BUTTON: &str =
        "[[button]]\nforce = \"fz\"\npress_n = 2\nout = { keyboard = \"KEY_Z\", gamepad = \"BTN_SOUTH\" }\n";

    #[test]
    fn each_change_is_a_phrase() {
        for (from, to, phrase) in [
            ("press_n = 2.0", "press_n = 2.5", "button 1, press force from 2 N to 2.5 N"),
            ("min_press_ms = 40\n", "", "shortest press removed (40 ms)"),
            ("KEY_Z", "KEY_X", "button 1, press, on the keyboard from Z to X"),
            ("[dpad]", "left_handed = true\n[dpad]", "left-handed added (yes)"),
            ("8way", "4way", "directions, kind of directions from “eight directions” to “four directions”"),
            ("[[button]]\nforce = \"fy\"\npress_n = 1.2\n", "", "button 2 removed"),
            ("[dpad]", "# a word\n[dpad]", "only comments"),
            ("[dpad]", "[dpad", "the text, which could not be read"),
        ] {
            assert_eq!(changes(TEXT, &TEXT.replacen(from, to, 1)), [phrase], "{from}");
        }
        let added = format!("{TEXT}[[zone]]\nname = \"a\"\n[access]\nrest_n = 0.5\n");
        assert_eq!(changes(TEXT, &added), ["ignores a resting hand below 0.5 N", "zone 1, a, added"]);
        assert_eq!(
            changes(&added, TEXT),
            ["ignores a resting hand below 0.5 N: no more", "zone 1, a, removed"]
        );
        let played = format!("schema = 1\nname = \"x\"\noutput = \"gamepad\"\n{BUTTON}");
        let start = BUTTON.replace("SOUTH\"", "START\", label = \"pause\"").replace("fz", "fy");
        assert_eq!(changes(&played, &format!("{played}{start}")), ["button 2, Start: pause, added"]);
        let harder = played.replace("press_n = 2", "press_n = 3");
        assert_eq!(changes(&played, &harder), ["A, press force from 2 N to 3 N"]);
        let many: String = (0..9).map(|index| format!("k{index}_n = 1\n")).collect();
        let told = changes("", &many);
        assert_eq!((told.len(), told.last().map(String::as_str)), (7, Some("and 3 more")));
    }
}
