//! Comments behind a number that state it: when the number is changed they are marked with the one that they were written for.

/// What a mark begins with; the number and a bracket follow.
const MARK: &str = " (written for ";

/// The text `after` changes of single values, with marks at comments that state what stood there `before`. A mark goes when the number comes back.
pub(super) fn marked(before: &str, after: &str) -> String {
    // Where keys came or went, lines do not stand beside each other.
    if before.lines().count() != after.lines().count() {
        return after.to_owned();
    }
    let lines = before.lines().zip(after.split_inclusive('\n'));
    lines.map(|(old, new)| if old == new.trim_end() { new.to_owned() } else { line(old, new) }).collect()
}

/// One line that was changed; what is no number with a comment stays.
fn line(old: &str, new: &str) -> String {
    let (Some(was), Some(is)) = (NumberLine::read(old), NumberLine::read(new)) else { return new.to_owned() };
    if was.key != is.key || was.comment != is.comment {
        return new.to_owned();
    }
    let Some(comment) = is.marked_comment(was.number, was.written) else { return new.to_owned() };
    let end = new.strip_prefix(new.trim_end_matches(['\r', '\n'])).unwrap_or_default();
    format!("{}#{comment}{end}", is.code)
}

/// A line such as `press_n = 2.0  # a firm press`.
struct NumberLine<'a> {
    /// All before the comment.
    code: &'a str,
    key: &'a str,
    /// The number as it is written.
    written: &'a str,
    number: f64,
    comment: &'a str,
}

impl<'a> NumberLine<'a> {
    fn read(line: &'a str) -> Option<Self> {
        let (code, comment) = line.split_once('#')?;
        let (key, written) = code.split_once('=')?;
        let number = written.trim().parse().ok()?;
        Some(Self { code, key, written: written.trim(), number, comment: comment.trim_end() })
    }

    /// The comment after the number `was` became this one; `None` if it stays as it is.
    fn marked_comment(&self, was: f64, written: &str) -> Option<String> {
        if let Some((text, mark)) = self.comment.rsplit_once(MARK) {
            let meant = mark.strip_suffix(')').and_then(|number| number.parse::<f64>().ok());
            return (meant == Some(self.number)).then(|| text.to_owned());
        }
        let is_part = |letter: char| letter.is_ascii_digit() || letter == '.';
        let words = self.comment.split(|letter| !is_part(letter));
        let mut numbers = words.filter_map(|word| word.trim_end_matches('.').parse::<f64>().ok());
        numbers.any(|number| number == was.abs()).then(|| format!("{}{MARK}{written})", self.comment))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "schema = 1\ncentre_radius_mm = 8.0   # starts 8 mm from the centre\nmin_press_ms = 40 # long enough\n";

    fn with(line: &str) -> String {
        let mut lines: Vec<&str> = TEXT.lines().collect();
        lines[1] = line;
        lines.join("\n") + "\n"
    }

    #[test]
    fn a_comment_that_states_the_number_is_marked_until_it_comes_back() {
        let plain = with("centre_radius_mm = 10.0   # starts 8 mm from the centre");
        let first = marked(TEXT, &plain);
        assert_eq!(first, with("centre_radius_mm = 10.0   # starts 8 mm from the centre (written for 8.0)"));
        let second = first.replace("10.0", "11.5");
        assert_eq!(marked(&first, &second), second, "it was written for that one all the same");
        assert_eq!(
            marked(&second, &second.replace("11.5", "8")),
            with("centre_radius_mm = 8   # starts 8 mm from the centre")
        );
    }

    #[test]
    fn other_comments_and_other_lines_stay() {
        for (from, to) in [
            ("min_press_ms = 40", "min_press_ms = 50"),
            ("# long enough", "# 40 ms are long enough"),
            ("schema = 1\n", ""),
            ("8.0   # starts 8 mm", "9.0   # starts 9 mm"),
        ] {
            let changed = TEXT.replace(from, to);
            assert_eq!(marked(TEXT, &changed), changed, "{to}");
        }
        for end in ["", "\n", "\r\n"] {
            let [old, new] = ["a_n = 2 # 2.", "a_n = 3 # 2."].map(|text| format!("{text}{end}"));
            assert_eq!(marked(&old, &new), format!("a_n = 3 # 2. (written for 2){end}"));
        }
    }
}
