//! What changed from one text of a profile to the next, in words.

use std::collections::BTreeSet;

use toml::{Table, Value};

/// More changes than this are counted.
const TOLD_MAX: usize = 6;

/// Units by the ends of keys.
const UNITS: [(&str, &str); 5] =
    [("_n", " N"), ("_mm", " mm"), ("_ms", " ms"), ("_deg", "°"), ("_hz", " Hz")];

/// One phrase for each change; of texts that say the same, that it is so.
pub(super) fn changes(before: &str, after: &str) -> Vec<String> {
    let read = |text: &str| toml::from_str::<Table>(text);
    let (Ok(old), Ok(new)) = (read(before), read(after)) else {
        return vec!["the text, which could not be read".into()];
    };
    let mut told = Vec::new();
    tables("", &old, &new, &mut told);
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

fn tables(place: &str, old: &Table, new: &Table, told: &mut Vec<String>) {
    let keys: BTreeSet<&String> = old.keys().chain(new.keys()).collect();
    for key in keys {
        let place = if place.is_empty() { key.clone() } else { format!("{place} {key}") };
        values(&place, key, old.get(key), new.get(key), told);
    }
}

fn values(place: &str, key: &str, old: Option<&Value>, new: Option<&Value>, told: &mut Vec<String>) {
    match (old, new) {
        (Some(old), Some(new)) if old == new => {}
        (Some(Value::Table(old)), Some(Value::Table(new))) => tables(place, old, new, told),
        (Some(Value::Array(old)), Some(Value::Array(new))) => lists(place, key, old, new, told),
        (None, Some(Value::Array(new))) => lists(place, key, &[], new, told),
        (Some(Value::Array(old)), None) => lists(place, key, old, &[], told),
        (Some(old), Some(new)) => told.push(format!("{place} from {} to {}", said(key, old), said(key, new))),
        (None, Some(new)) => told.push(format!("{place} added{}", of(key, new))),
        (Some(old), None) => told.push(format!("{place} removed{}", of(key, old))),
        (None, None) => {}
    }
}

/// Lists are compared from both ends, so that one that was removed in the middle is one change.
fn lists(place: &str, key: &str, old: &[Value], new: &[Value], told: &mut Vec<String>) {
    let same = |pair: &(&Value, &Value)| pair.0 == pair.1;
    let head = old.iter().zip(new).take_while(same).count();
    let shorter = old.len().min(new.len()) - head;
    let tail = old.iter().rev().zip(new.iter().rev()).take(shorter).take_while(same).count();
    let old = old.get(head..old.len() - tail).unwrap_or_default();
    let new = new.get(head..new.len() - tail).unwrap_or_default();
    for index in 0..old.len().max(new.len()) {
        let place = format!("{place} {}", head + index + 1);
        values(&place, key, old.get(index), new.get(index), told);
    }
}

/// " (2.5 N)"; nothing of what has parts.
fn of(key: &str, value: &Value) -> String {
    if matches!(value, Value::Table(_) | Value::Array(_)) {
        return String::new();
    }
    format!(" ({})", said(key, value))
}

fn said(key: &str, value: &Value) -> String {
    let unit = UNITS.iter().find(|(end, _)| key.ends_with(end)).map_or("", |(_, unit)| unit);
    match value {
        Value::String(text) => format!("“{text}”"),
        Value::Boolean(true) => "yes".into(),
        Value::Boolean(false) => "no".into(),
        Value::Integer(number) => format!("{number}{unit}"),
        Value::Float(number) => format!("{number}{unit}"),
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
            ("press_n = 2.0", "press_n = 2.5", "button 1 press_n from 2 N to 2.5 N"),
            ("min_press_ms = 40\n", "", "min_press_ms removed (40 ms)"),
            ("KEY_Z", "KEY_X", "button 1 out keyboard from “KEY_Z” to “KEY_X”"),
            ("[dpad]", "left_handed = true\n[dpad]", "left_handed added (yes)"),
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
