//! When a figure in a page is not what the program makes any more.

/// Numbers that differ by less are the same on another processor, which rounds elsewhere.
const SAME_SHARE: f64 = 0.02;

/// In units of the last printed digit.
const SAME_DIGITS: f64 = 1.5;

/// In a drawing, in its own units: less than can be seen.
const SAME_DRAWN: f64 = 0.5;

/// A column under this heading is this machine's time, which differs from run to run.
const TIME: &str = "µs";

/// The first word that is different, if any is.
pub(super) fn differs(before: &str, now: &str) -> Option<String> {
    let timed = now.lines().any(|line| line.ends_with(TIME));
    let mut lines = (before.lines(), now.lines());
    loop {
        match (lines.0.next(), lines.1.next()) {
            (None, None) => return None,
            (Some(before), Some(now)) => {
                let [before_words, now_words] = [before, now].map(|line| words(line, timed));
                let same = before_words.len() == now_words.len()
                    && before_words.iter().zip(&now_words).all(|(before, now)| same(before, now, last_digit));
                if !same {
                    return Some(format!("\"{before}\" is \"{now}\" now"));
                }
            }
            (before, now) => return Some(format!("{before:?} is {now:?} now")),
        }
    }
}

/// Whether a drawing looks different.
pub(super) fn drawing_differs(before: &str, now: &str) -> bool {
    let separate = |text: &str| -> Vec<String> {
        let split = |c: char| c.is_whitespace() || "\"'<>=,;()".contains(c) || c.is_ascii_alphabetic();
        text.split(split).filter(|word| !word.is_empty()).map(str::to_owned).collect()
    };
    let (before, now) = (separate(before), separate(now));
    before.len() != now.len()
        || !before.iter().zip(&now).all(|(before, now)| same(before, now, |_| SAME_DRAWN))
}

/// The words of a line; the last of a line in a table with times is one.
fn words(line: &str, timed: bool) -> Vec<&str> {
    let mut words: Vec<&str> = line.split_whitespace().collect();
    if timed && words.len() > 5 {
        words.pop();
    }
    words
}

fn same(before: &str, now: &str, margin: impl Fn(&str) -> f64) -> bool {
    let number = |word: &str| word.trim_end_matches([',', '%', ')', ';']).replace(',', "").parse::<f64>();
    match (number(before), number(now)) {
        (Ok(before), Ok(after)) => (before - after).abs() <= margin(now).max(SAME_SHARE * after.abs()),
        _ => before == now,
    }
}

/// What the last digit of a printed number allows.
fn last_digit(word: &str) -> f64 {
    let digits =
        word.split_once('.').map_or(0, |(_, part)| part.chars().filter(char::is_ascii_digit).count());
    SAME_DIGITS * 0.1_f64.powi(i32::try_from(digits).unwrap_or(0))
}

#[test]
fn a_number_that_changed_is_stale_and_one_that_rounds_elsewhere_is_not() {
    let table = "as built   20.00   0.197 mm   2,454";
    assert_eq!(differs(table, "as built   20.00   0.198 mm   2,455"), None);
    for other in
        ["as built   20.00   0.204 mm   2,454", "as drawn   20.00   0.197 mm   2,454", "as built", ""]
    {
        assert!(differs(table, other).is_some(), "{other}");
    }
}

#[test]
fn times_are_not_compared() {
    let table = |us: f64| format!("decoder  mm  N  in 95 %  µs\nnetwork 648  0.5 0.04 97.1  {us:.1}");
    assert_eq!(differs(&table(1.2), &table(3.7)), None);
}

#[test]
fn a_drawing_may_move_by_what_cannot_be_seen() {
    let drawing = |x: f64| format!("<path d=\"M10.0,{x} L20.0,30.5\"/>");
    assert!(!drawing_differs(&drawing(12.0), &drawing(12.2)));
    assert!(drawing_differs(&drawing(12.0), &drawing(14.0)));
    assert!(drawing_differs("", &drawing(12.0)));
}
