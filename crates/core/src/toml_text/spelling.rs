//! "Did you mean": the known word nearest to a misspelt one.

/// A word longer than this is nobody's slip of the finger, and comparing it would only cost time.
const LENGTH_MAX: usize = 48;

/// The candidate with the fewest single-letter changes from `word`, the first of equals; letter case does not
/// count.
///
/// `None` if even the nearest differs in more than a third of `word`'s letters (but one change always
/// passes).
pub fn nearest<'c>(word: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    if word.is_empty() || word.len() > LENGTH_MAX {
        return None;
    }
    let allowed = (word.chars().count() / 3).max(1);
    let scored = candidates.into_iter().map(|candidate| (distance(word, candidate), candidate));
    scored
        .filter(|(changes, _)| *changes <= allowed)
        .min_by_key(|(changes, _)| *changes)
        .map(|(_, best)| best)
}

/// Single-letter changes that make one word of the other: insert, delete, replace, or swap two neighbours.
///
/// Source: F. J. Damerau, "A technique for computer detection and correction of spelling errors" (1964), in
/// the form that changes no letter twice; computed row by row over the letters of `left`.
fn distance(left: &str, right: &str) -> usize {
    let right: Vec<char> = right.chars().flat_map(char::to_lowercase).collect();
    let mut older: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=right.len()).collect();
    let mut letter_above = None;
    for (number, letter) in (1..).zip(left.chars().flat_map(char::to_lowercase)) {
        let mut row = vec![number];
        let mut before = number;
        let mut other_before = None;
        for (column, other) in right.iter().copied().enumerate() {
            let at = |cells: &[usize], column: usize| cells.get(column).copied().unwrap_or(usize::MAX);
            let replaced = at(&above, column).saturating_add(usize::from(other != letter));
            let mut best = replaced.min(before + 1).min(at(&above, column + 1).saturating_add(1));
            if letter_above == Some(other) && other_before == Some(letter) {
                best = best.min(at(&older, column.wrapping_sub(1)).saturating_add(1));
            }
            row.push(best);
            before = best;
            other_before = Some(other);
        }
        older = std::mem::replace(&mut above, row);
        letter_above = Some(letter);
    }
    above.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_by_hand() {
        for (left, right, changes) in [
            ("", "", 0),
            ("", "abc", 3),
            ("abc", "", 3),
            ("kitten", "sitting", 3),
            ("Fz", "fz", 0),
            ("ab", "ba", 1),
            ("ca", "abc", 3),
        ] {
            assert_eq!(distance(left, right), changes, "{left} {right}");
        }
    }

    #[test]
    fn a_slip_finds_its_word_and_a_stranger_finds_none() {
        let known = ["press_n", "release_n", "force"];
        assert_eq!(nearest("pres_n", known), Some("press_n"));
        assert_eq!(nearest("RELAESE_N", known), Some("release_n"));
        assert_eq!(nearest("volume", known), None);
        assert_eq!(nearest("", known), None);
        assert_eq!(nearest(&"press_n".repeat(100), known), None);
    }
}
