//! "Did you mean": the known word nearest to a misspelt one.

/// A word longer than this is nobody's slip of the finger, and comparing it would only cost time.
const LENGTH_MAX: usize = 48;

/// The candidate with the fewest single-letter changes from `word`, the first of equals; letter case does not count.
///
/// `None` if even the nearest differs in more than a third of `word`'s letters (but one change always passes).
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

/// Letters to insert, delete or replace to make one word of the other.
///
/// Source: V. I. Levenshtein, "Binary codes capable of correcting deletions, insertions, and reversals" (1966);
/// computed row by row over the letters of `left`.
fn distance(left: &str, right: &str) -> usize {
    let right: Vec<char> = right.chars().flat_map(char::to_lowercase).collect();
    let mut row: Vec<usize> = (0..=right.len()).collect();
    for (above_first, letter) in left.chars().flat_map(char::to_lowercase).enumerate() {
        let mut diagonal = above_first;
        let mut before = above_first + 1;
        for (other, cell) in right.iter().zip(row.iter_mut().skip(1)) {
            let replaced = diagonal + usize::from(*other != letter);
            diagonal = *cell;
            before = replaced.min(before + 1).min(*cell + 1);
            *cell = before;
        }
        if let Some(first) = row.first_mut() {
            *first = above_first + 1;
        }
    }
    row.last().copied().unwrap_or(0)
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
            ("ab", "ba", 2),
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
