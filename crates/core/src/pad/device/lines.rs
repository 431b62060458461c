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

/// A line for each key that differs from `other`'s.
pub(super) fn lines_unlike<T>(keys: &[Key<T>], record: &T, other: &T) -> String {
    let differs = |key: &&Key<T>| (key.access.get)(record) != (key.access.get)(other);
    keys.iter().filter(differs).map(|key| line(key, record)).collect()
}

/// The key and its number, or list of numbers, as the shortest decimals that read back equal.
pub(super) fn assignment<T>(key: &Key<T>, record: &T) -> String {
    let mut numbers = (key.access.get)(record);
    if key.takes_one_for_all() && numbers.iter().all(|number| *number == numbers[0]) {
        numbers = &numbers[..1];
    }
    let list = numbers.iter().map(|number| format!("{number:?}")).collect::<Vec<_>>().join(", ");
    if numbers.len() > 1 { format!("{} = [{list}]", key.name) } else { format!("{} = {list}", key.name) }
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
