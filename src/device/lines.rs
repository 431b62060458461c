//! How a device file writes numbers and texts.

use super::schema::Key;

/// A line for each key.
pub(super) fn lines<T>(keys: &[Key<T>], record: &T) -> String {
    keys.iter().map(|key| line(key, record)).collect()
}

/// The key with its number and, for people, its meaning.
pub(super) fn line<T>(key: &Key<T>, record: &T) -> String {
    format!("{} # {}\n", assignment(key, record), key.meaning)
}

/// The key and its number, or list of numbers, as the shortest decimals that read back equal.
pub(super) fn assignment<T>(key: &Key<T>, record: &T) -> String {
    let numbers: Vec<_> = (key.access.get)(record).iter().map(|number| format!("{number:?}")).collect();
    let list = numbers.join(", ");
    if key.elements.len() > 1 { format!("{} = [{list}]", key.name) } else { format!("{} = {list}", key.name) }
}

/// The text in quotation marks, so that TOML reads it back.
pub(super) fn quoted(text: &str) -> String {
    let escaped = |letter: char| match letter {
        '"' | '\\' => format!("\\{letter}"),
        _ if letter.is_control() => format!("\\u{:04X}", u32::from(letter)),
        _ => letter.to_string(),
    };
    format!("\"{}\"", text.chars().map(escaped).collect::<String>())
}
