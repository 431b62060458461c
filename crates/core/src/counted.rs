//! Numbers of things in sentences.

use core::fmt::Display;

/// So many things: `1 contact`, `0 contacts`, `2 presses`.
pub fn counted(count: impl Display, thing: &str) -> String {
    let count = count.to_string();
    if count == "1" || thing.ends_with("series") {
        return format!("{count} {thing}");
    }
    let end = if ["s", "ch", "x"].iter().any(|end| thing.ends_with(end)) { "es" } else { "s" };
    format!("{count} {thing}{end}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_one_and_all_others_are_many() {
        for (count, thing, expected) in [
            (0, "row", "0 rows"),
            (1, "row", "1 row"),
            (2, "press", "2 presses"),
            (3, "touch", "3 touches"),
            (2, "time series", "2 time series"),
        ] {
            assert_eq!(counted(count, thing), expected);
        }
    }
}
