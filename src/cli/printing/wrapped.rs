//! Sentences on lines of a terminal.

/// Tables and texts are no wider than this, and neither is help.
pub(crate) const COLUMNS: usize = 80;

/// The words of `text` on lines of at most `columns` characters; a longer word has a line of its own. A command between backquotes is a word.
pub(crate) fn lines(text: &str, columns: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words(text) {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= columns => {
                line.push(' ');
                line.push_str(&word);
            }
            _ => lines.push(word),
        }
    }
    lines
}

fn words(text: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for piece in text.split_whitespace() {
        match words.last_mut() {
            Some(command) if command.matches('`').count() % 2 == 1 => *command += &format!(" {piece}"),
            _ => words.push(piece.to_owned()),
        }
    }
    words
}

/// The same with `before` in front of the first line and as many spaces in front of the others.
pub(crate) fn hanging(before: &str, text: &str) -> String {
    let indent = before.chars().count();
    let lines = lines(text, COLUMNS.saturating_sub(indent));
    format!("{before}{}", lines.join(&format!("\n{}", " ".repeat(indent))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stay_whole_and_lines_short() {
        assert_eq!(lines("one two  three\nfour", 9), ["one two", "three", "four"]);
        assert_eq!(lines("a longer-than-any b", 6), ["a", "longer-than-any", "b"]);
        assert_eq!(lines("type `a b c`, then `d`", 9), ["type", "`a b c`,", "then `d`"]);
        assert!(lines(" ", 9).is_empty());
    }

    #[test]
    fn later_lines_hang_below_the_first() {
        let text = hanging("  1  ", &"µm ".repeat(40));
        assert!(text.lines().all(|line| line.chars().count() <= COLUMNS && line.starts_with("  ")), "{text}");
        assert_eq!(text.lines().nth(1).map(|line| line.starts_with("     µm")), Some(true), "{text}");
    }
}
