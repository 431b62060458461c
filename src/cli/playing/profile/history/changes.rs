//! What changed from one text of a profile to the next, in words.

use std::collections::BTreeSet;

use tactpad::pipeline::control::OutputDevice;
use tactpad::pipeline::mapping::plain::{controls, settings, values};
use tactpad::pipeline::mapping::read;
use toml::{Table, Value};

/// More changes than this are counted.
const TOLD_MAX: usize = 6;

/// One phrase for each change; of texts that say the same, that it is so.
pub(super) fn changes(before: &str, after: &str) -> Vec<String> {
    let read = |text: &str| toml::from_str::<Table>(text);
    let (Ok(old), Ok(new)) = (read(before), read(after)) else {
        return vec!["the text, which could not be read".into()];
    };
    let mut told = Vec::new();
    tables(&Place::default(), &old, &new, &mut told);
    if told.is_empty() {
        told.push("comments or layout alone".into());
    }
    let more = told.len().saturating_sub(TOLD_MAX);
    told.truncate(TOLD_MAX);
    if more > 0 {
        told.push(format!("and {more} more"));
    }
    told
}

/// Where something stands in a profile.
#[derive(Clone, Default)]
struct Place {
    /// Its tables and its key, as settings are named.
    setting: String,
    /// The same for people: `button 1, press force`.
    words: String,
}

impl Place {
    fn key(&self, key: &str) -> Self {
        let (dot, comma) = if self.setting.is_empty() { ("", "") } else { (".", ", ") };
        let setting = format!("{}{dot}{key}", self.setting);
        let words = format!("{}{comma}{}", self.words, settings::word(&setting));
        Self { setting, words }
    }

    fn number(&self, number: usize) -> Self {
        Self { setting: self.setting.clone(), words: format!("{} {number}", self.words) }
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

fn tables(place: &Place, old: &Table, new: &Table, told: &mut Vec<String>) {
    let keys: BTreeSet<&String> = old.keys().chain(new.keys()).collect();
    for key in keys {
        compare(&place.key(key), old.get(key), new.get(key), told);
    }
}

fn compare(place: &Place, old: Option<&Value>, new: Option<&Value>, told: &mut Vec<String>) {
    let words = &place.words;
    match (old, new) {
        (Some(old), Some(new)) if old == new => {}
        (Some(Value::Table(old)), Some(Value::Table(new))) => tables(place, old, new, told),
        (Some(Value::Array(old)), Some(Value::Array(new))) => lists(place, old, new, told),
        (None, Some(Value::Array(new))) => lists(place, &[], new, told),
        (Some(Value::Array(old)), None) => lists(place, old, &[], told),
        (Some(old), Some(new)) => {
            told.push(format!("{words} from {} to {}", said(place, old), said(place, new)));
        }
        (None, Some(new)) => told.push(format!("{words} added{}", of(place, new))),
        (Some(old), None) => told.push(format!("{words} removed{}", of(place, old))),
        (None, None) => {}
    }
}

/// Lists are compared from both ends, so that one that was removed in the middle is one change.
fn lists(place: &Place, old: &[Value], new: &[Value], told: &mut Vec<String>) {
    let same = |pair: &(&Value, &Value)| pair.0 == pair.1;
    let head = old.iter().zip(new).take_while(same).count();
    let shorter = old.len().min(new.len()) - head;
    let tail = old.iter().rev().zip(new.iter().rev()).take(shorter).take_while(same).count();
    let old = old.get(head..old.len() - tail).unwrap_or_default();
    let new = new.get(head..new.len() - tail).unwrap_or_default();
    for index in 0..old.len().max(new.len()) {
        compare(&place.number(head + index + 1), old.get(index), new.get(index), told);
    }
}

/// " (2.5 N)"; nothing of what has parts.
fn of(place: &Place, value: &Value) -> String {
    if matches!(value, Value::Table(_) | Value::Array(_)) {
        return String::new();
    }
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

    #[test]
    fn each_change_is_a_phrase() {
        for (from, to, phrase) in [
            ("press_n = 2.0", "press_n = 2.5", "button 1, press force from 2 N to 2.5 N"),
            ("min_press_ms = 40\n", "", "shortest press removed (40 ms)"),
            ("KEY_Z", "KEY_X", "button 1, press, on the keyboard from Z to X"),
            ("[dpad]", "left_handed = true\n[dpad]", "left-handed added (yes)"),
            ("8way", "4way", "directions, kind of directions from “eight directions” to “four directions”"),
            ("[[button]]\nforce = \"fy\"\npress_n = 1.2\n", "", "button 2 removed"),
            ("[dpad]", "# a word\n[dpad]", "comments or layout alone"),
            ("[dpad]", "[dpad", "the text, which could not be read"),
        ] {
            assert_eq!(changes(TEXT, &TEXT.replacen(from, to, 1)), [phrase], "{from}");
        }
        let added = format!("{TEXT}[[zone]]\nname = \"a\"\n");
        assert_eq!(changes(TEXT, &added), ["zone 1 added"]);
        let many: String = (0..9).map(|index| format!("k{index}_n = 1\n")).collect();
        let told = changes("", &many);
        assert_eq!((told.len(), told.last().map(String::as_str)), (7, Some("and 3 more")));
    }
}
