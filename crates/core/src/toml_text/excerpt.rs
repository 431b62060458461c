//! The line of a text that a finding is about, with the place underlined, as a terminal shows it.

use std::fmt::Write;

/// Columns of a line that are shown. With its number the whole is no wider than a narrow terminal.
const SHOWN: usize = 68;

/// Columns shown in front of a place in a line that is cut.
const BEFORE: usize = 24;

/// What a tab is shown as.
const TAB: &str = "    ";

/// Letters that take two columns: Unicode's East Asian Width, its wide and full-width blocks.
const WIDE: [(char, char); 9] = [
    ('\u{1100}', '\u{115f}'),
    ('\u{2e80}', '\u{303e}'),
    ('\u{3041}', '\u{a4cf}'),
    ('\u{ac00}', '\u{d7a3}'),
    ('\u{f900}', '\u{faff}'),
    ('\u{fe30}', '\u{fe6f}'),
    ('\u{ff01}', '\u{ff60}'),
    ('\u{1f300}', '\u{1faff}'),
    ('\u{20000}', '\u{3fffd}'),
];

/// Marks that take no column: they go with the letter before them.
const NARROW: [(char, char); 3] =
    [('\u{300}', '\u{36f}'), ('\u{20d0}', '\u{20ff}'), ('\u{fe00}', '\u{fe0f}')];

/// Letters that turn or hide what stands beside them. They are control characters for the eye.
const HIDING: [(char, char); 4] =
    [('\u{200b}', '\u{200f}'), ('\u{2028}', '\u{202e}'), ('\u{2060}', '\u{206f}'), ('\u{feff}', '\u{feff}')];

/// Writes `  12 | source` and a line below it with `length` carets from `column` on, each on a new line; nothing for a
/// blank line.
pub(super) fn write(to: &mut String, source: &str, line: usize, column: usize, length: usize) {
    let source = source.trim_end();
    if source.is_empty() {
        return;
    }
    let place = column.saturating_sub(1);
    let start = first_shown(source, place, length);
    let (mut shown, mut under) = (String::new(), String::new());
    if start > 0 {
        shown.push('…');
        under.push(' ');
    }
    let (mut columns, mut cut) = (0, false);
    for (number, letter) in source.chars().enumerate().skip(start) {
        columns += width(letter);
        if columns > SHOWN {
            cut = true;
            break;
        }
        show(letter, &mut shown);
        let mark = if number < place { ' ' } else { '^' };
        if number < place + length {
            under.extend([mark].repeat(width(letter)));
        }
    }
    if cut {
        shown.push('…');
    }
    if !under.contains('^') {
        // The place lies behind what is written, or is a letter without a width.
        under.push('^');
    }
    let number = line.to_string();
    let blank = " ".repeat(number.len());
    // Writing to a string cannot fail.
    let _ = write!(to, "\n  {number} | {shown}\n  {blank} | {under}");
}

/// The number of the first letter that is shown, so that the place is among those that are.
fn first_shown(source: &str, place: usize, length: usize) -> usize {
    let widths: Vec<usize> = source.chars().map(width).collect();
    let until = |end: usize| widths.iter().take(end).sum::<usize>();
    if until(widths.len()) <= SHOWN || until(place.saturating_add(length)) <= SHOWN {
        return 0;
    }
    let mut columns = 0;
    let before = widths.iter().take(place).rev();
    let kept = before.take_while(|width| {
        columns += **width;
        columns <= BEFORE
    });
    place.min(widths.len()) - kept.count()
}

/// The columns that a letter takes as [`show`] shows it.
fn width(letter: char) -> usize {
    match letter {
        '\t' => TAB.len(),
        letter if is_in(&NARROW, letter) => 0,
        letter if is_in(&WIDE, letter) => 2,
        _ => 1,
    }
}

fn show(letter: char, to: &mut String) {
    match letter {
        '\t' => to.push_str(TAB),
        letter if letter.is_control() || is_in(&HIDING, letter) => to.push(char::REPLACEMENT_CHARACTER),
        letter => to.push(letter),
    }
}

fn is_in(ranges: &[(char, char)], letter: char) -> bool {
    ranges.iter().any(|(first, last)| (*first..=*last).contains(&letter))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(source: &str, column: usize, length: usize) -> String {
        let mut to = String::new();
        write(&mut to, source, 12, column, length);
        to
    }

    /// The line and the carets below it, without the line's number.
    fn lines(source: &str, column: usize, length: usize) -> [String; 2] {
        let drawn = drawn(source, column, length);
        let lines: Vec<_> = drawn.lines().filter_map(|line| line.get(7..)).map(str::to_owned).collect();
        lines.try_into().unwrap()
    }

    #[test]
    fn the_place_is_underlined() {
        assert_eq!(drawn("a = 12 # x", 5, 2), "\n  12 | a = 12 # x\n     |     ^^");
        assert_eq!(lines("a =   ", 7, 1), ["a =", "   ^"], "behind what is written");
        assert_eq!(drawn("   \r", 1, 1), "");
    }

    #[test]
    fn tabs_wide_letters_and_control_characters_keep_the_place() {
        assert_eq!(lines("\ta = 1", 6, 1), ["    a = 1", "        ^"]);
        assert_eq!(lines("名 = 日本", 5, 2), ["名 = 日本", "     ^^^^"]);
        assert_eq!(lines("e\u{301} = 1", 6, 1), ["e\u{301} = 1", "    ^"]);
        assert_eq!(lines("\u{1b}[2J\u{202e}x", 6, 1), ["\u{fffd}[2J\u{fffd}x", "     ^"]);
        assert_eq!(lines("\u{301}", 1, 1)[1], "^");
    }

    #[test]
    fn a_long_line_is_cut_around_the_place() {
        let long = format!("{}WRONG{}", "x".repeat(1_000), "y".repeat(1_000));
        let [shown, under] = lines(&long, 1_001, 5);
        assert!(shown.starts_with('…') && shown.ends_with("y…"), "{shown}");
        assert_eq!(shown.chars().count(), SHOWN + 2);
        let found = shown.chars().skip(under.find('^').unwrap()).take(5).collect::<String>();
        assert_eq!((found.as_str(), under.matches('^').count()), ("WRONG", 5));
        let [shown, under] = lines(&long, 1, 2_000);
        assert_eq!((shown.chars().count(), under.len()), (SHOWN + 1, SHOWN));
        let [shown, under] = lines(&long, 2_006, 1);
        assert!(shown.starts_with('…') && shown.ends_with("yy") && under.ends_with("  ^"), "{shown}");
        let wide = "日".repeat(100);
        for column in [1, 20, 34, 35, 36, 60, 100, 101] {
            let [shown, under] = lines(&wide, column, 1);
            assert!(shown.chars().count() < 40 && under.contains('^'), "{column}: {shown}");
        }
    }
}
