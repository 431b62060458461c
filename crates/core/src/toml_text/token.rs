//! How far what stands at a place of a text reaches: what a finding underlines.

/// The characters from the byte offset `at` to the end of what begins there, within its line; at least 1.
///
/// That is a text in quotation marks, a list, an inline table or a table's header up to its last bracket, a number or
/// date, a key or bare word; of anything else, one character.
pub(super) fn length(text: &str, at: usize) -> usize {
    let rest = text.get(at..).unwrap_or_default();
    let line = rest.lines().next().unwrap_or_default();
    let end = match line.chars().next() {
        Some(quote @ ('"' | '\'')) => quoted(line, quote),
        Some('[' | '{') => bracketed(line),
        Some(first) if first.is_ascii_digit() || first == '+' || first == '-' => {
            word(line, |letter| is_of_key(letter) || ".+:".contains(letter))
        }
        _ => word(line, is_of_key),
    };
    line.get(..end).unwrap_or(line).chars().count().max(1)
}

/// Letters beyond those of TOML's bare keys count, too: they are there by mistake.
fn is_of_key(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_' || letter == '-'
}

/// Where the letters end that `is_in` takes.
fn word(line: &str, is_in: impl Fn(char) -> bool) -> usize {
    line.find(|letter| !is_in(letter)).unwrap_or(line.len())
}

/// The byte behind the closing quotation marks, or behind the line.
fn quoted(line: &str, quote: char) -> usize {
    let thrice = [quote; 3].iter().collect::<String>();
    if let Some(inside) = line.strip_prefix(thrice.as_str()) {
        return inside.find(thrice.as_str()).map_or(line.len(), |end| end + 2 * thrice.len());
    }
    let mut escaped = false;
    for (offset, letter) in line.char_indices().skip(1) {
        if letter == quote && !escaped {
            return offset + 1;
        }
        // Single quotation marks know no escapes.
        escaped = quote == '"' && letter == '\\' && !escaped;
    }
    line.len()
}

/// The byte behind the bracket that closes the first one, or behind the line without its comment.
fn bracketed(line: &str) -> usize {
    let (mut depth, mut at) = (0_usize, 0);
    while let Some(rest) = line.get(at..)
        && let Some(letter) = rest.chars().next()
    {
        match letter {
            '[' | '{' => depth += 1,
            ']' | '}' if depth <= 1 => return at + 1,
            ']' | '}' => depth -= 1,
            '#' => return line.get(..at).unwrap_or_default().trim_end().len(),
            '"' | '\'' => {
                at += quoted(rest, letter);
                continue;
            }
            _ => {}
        }
        at += letter.len_utf8();
    }
    line.trim_end().len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_at_a_place_reaches_to_its_end() {
        for (text, wanted) in [
            ("\"5way\" # no", "\"5way\""),
            (r#""a\"b" c"#, r#""a\"b""#),
            (r"'a\' b", r"'a\'"),
            ("\"open", "\"open"),
            ("\"\"\"a\" b\"\"\" c", "\"\"\"a\" b\"\"\""),
            ("\"\"\"a\nb\"\"\"", "\"\"\"a"),
            ("-1.5e3 # no", "-1.5e3"),
            ("1979-05-27T07:32:00 x", "1979-05-27T07:32:00"),
            ("4way\n", "4way"),
            ("pres_n = 2", "pres_n"),
            ("dpad.mode = 2", "dpad"),
            ("größe = 2", "größe"),
            ("[dpad] # a table", "[dpad]"),
            ("[[button]]\nforce", "[[button]]"),
            ("[1, [2, \"]\"], 3] x", "[1, [2, \"]\"], 3]"),
            ("{ gamepad = \"a}\" } x", "{ gamepad = \"a}\" }"),
            ("[1, # one\n2]", "[1,"),
            ("[1,\r\n2]", "[1,"),
            (", 3", ","),
            ("= 3", "="),
            ("# comment", "#"),
        ] {
            assert_eq!(length(text, 0), wanted.chars().count(), "{text}");
            let later = format!("ä = {text}");
            assert_eq!(length(&later, "ä = ".len()), wanted.chars().count(), "{text}");
        }
    }

    #[test]
    fn any_place_has_a_character() {
        for (text, at) in [("", 0), ("a", 1), ("a", 9), ("ä", 1), ("a\n\nb", 1), ("a\n\nb", 2), (" ", 0)] {
            assert_eq!(length(text, at), 1, "{text:?} {at}");
        }
        let deep = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
        assert_eq!(length(&deep, 0), 200_000);
    }
}
