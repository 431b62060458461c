//! What is wrong with a text and where: line, column, one sentence and the way out.

use std::fmt::{self, Write};

use serde::Serialize;

use super::{excerpt, token};

/// Whether what the text describes can still be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// It cannot be used until this is mended.
    Error,
    /// It works, but probably not as meant.
    Warning,
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Error => "error",
            Self::Warning => "warning",
        })
    }
}

/// One finding about a text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Diagnostic {
    /// Whether what the text describes can still be used.
    pub severity: Severity,
    /// One sentence without a full stop: what is wrong.
    pub message: String,
    /// Line of the text, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// What to do about it, where that can be said.
    pub help: Option<String>,
    /// Characters from the column on that it is about, at least 1; they may reach beyond the line.
    #[serde(skip)]
    pub length: usize,
    /// The line as it is written, without its end; empty for what is about the whole text.
    #[serde(skip)]
    pub source: String,
}

impl Diagnostic {
    /// The finding for people, as `FILE:LINE:COLUMN: error: message`, the line of the text with the place underlined,
    /// and a last line `  help: …`; no final newline.
    pub fn render(&self, file: &str) -> String {
        let Self { severity, message, line, column, help, length, source } = self;
        let mut text = format!("{file}:{line}:{column}: {severity}: {message}");
        excerpt::write(&mut text, source, *line, *column, *length);
        if let Some(help) = help {
            // Writing to a string cannot fail.
            let _ = write!(text, "\n  help: {help}");
        }
        text
    }
}

/// After so many findings nobody reads on; the rest is told in one line.
const FINDINGS_MAX: usize = 50;

/// What is wrong with a bare word at the byte offset `at`, and the way out; `None` if the parser's message is of something else. A bare word
/// is the usual slip, and the parser names what it took the word for.
fn bare(text: &str, at: usize, message: &str) -> Option<(String, Option<String>)> {
    let line = text.get(at..).unwrap_or_default().lines().next().unwrap_or_default();
    let value = line.split(['#', ',', '}', ']']).next().unwrap_or_default().trim();
    if ["true", "false"].iter().any(|small| value.eq_ignore_ascii_case(small)) {
        return Some((
            message.to_owned(),
            Some(format!("write it in small letters: {}", value.to_ascii_lowercase())),
        ));
    }
    if !message.contains("boolean") && !message.contains("must be quoted") {
        return None;
    }
    if value.is_empty() {
        return Some(("nothing stands behind the =".into(), Some("write a value there".into())));
    }
    let number = value.trim_end_matches(|c: char| !c.is_ascii_digit());
    Some(if number.parse::<f64>().is_ok() {
        (format!("{value} is no number"), Some(format!("write it without its unit: {number}")))
    } else {
        (
            format!("{value} is neither a number nor text in quotation marks"),
            Some(format!("write text in quotation marks: \"{value}\"")),
        )
    })
}

/// Findings about one text while it is read.
pub(crate) struct Findings<'t> {
    text: &'t str,
    found: Vec<Diagnostic>,
    broken_lines: Vec<usize>,
    /// The severest of the findings that were not kept.
    dropped: Option<Severity>,
}

impl<'t> Findings<'t> {
    pub(crate) const fn new(text: &'t str) -> Self {
        Self { text, found: Vec::new(), broken_lines: Vec::new(), dropped: None }
    }

    /// Notes at the byte offset `at` that the text cannot be parsed there.
    ///
    /// Whatever else is found on that line would be an echo of this, and so may be keys that are missing or
    /// in the wrong table anywhere: both are dropped from here on.
    pub(crate) fn broken(&mut self, at: usize, message: &str) {
        if self.is_full() {
            self.dropped = Some(Severity::Error);
            return;
        }
        self.broken_lines.push(position(self.text, at).0);
        let (message, help) = bare(self.text, at, message).unwrap_or_else(|| {
            let comma = decimal_comma(self.text, at);
            (message.to_owned(), comma.map(|number| format!("write a decimal point: {number}")))
        });
        self.found.push(self.finding(Severity::Error, at, message, help));
    }

    /// Notes an error of the text as a whole, which no line shows; an empty `help` is none.
    pub(crate) fn unreadable(&mut self, message: impl Into<String>, help: impl Into<String>) {
        self.error(0, message, help);
        if let Some(last) = self.found.last_mut() {
            last.source.clear();
        }
    }

    /// Notes an error at the byte offset `at`; an empty `help` is none.
    pub(crate) fn error(&mut self, at: usize, message: impl Into<String>, help: impl Into<String>) {
        self.note(Severity::Error, at, message.into(), help.into());
    }

    /// Notes at the byte offset `at` that a key is missing or stands where it does not belong.
    pub(crate) fn misplaced(&mut self, at: usize, message: impl Into<String>, help: impl Into<String>) {
        if self.broken_lines.is_empty() {
            self.error(at, message, help);
        }
    }

    /// Notes a warning at the byte offset `at`; an empty `help` is none.
    pub(crate) fn warning(&mut self, at: usize, message: impl Into<String>, help: impl Into<String>) {
        self.note(Severity::Warning, at, message.into(), help.into());
    }

    fn note(&mut self, severity: Severity, at: usize, message: String, help: String) {
        if self.is_full() {
            // A broken line may hide it, but then there is an error in any case.
            let is_error = severity == Severity::Error || self.dropped == Some(Severity::Error);
            self.dropped = Some(if is_error { Severity::Error } else { severity });
            return;
        }
        let help = if help.is_empty() { None } else { Some(help) };
        let finding = self.finding(severity, at, message, help);
        if !self.broken_lines.contains(&finding.line) {
            self.found.push(finding);
        }
    }

    fn finding(&self, severity: Severity, at: usize, message: String, help: Option<String>) -> Diagnostic {
        let (line, column) = position(self.text, at);
        let (length, source) = (token::length(self.text, at), line_of(self.text, at).to_owned());
        Diagnostic { severity, message, line, column, help, length, source }
    }

    /// Whether there are so many findings that no other is kept.
    pub(crate) const fn is_full(&self) -> bool {
        self.found.len() >= FINDINGS_MAX
    }

    /// Whether an error was noted.
    pub(crate) fn failed(&self) -> bool {
        let mut severities = self.found.iter().map(|finding| finding.severity).chain(self.dropped);
        severities.any(|severity| severity == Severity::Error)
    }

    /// Everything found, in the order of the text, and a closing line if there is more.
    pub(crate) fn finish(mut self) -> Vec<Diagnostic> {
        self.found.sort_by_key(|finding| (finding.line, finding.column));
        if let Some(severity) = self.dropped {
            let message = format!("and more: only {FINDINGS_MAX} findings are listed");
            let more = self.finding(severity, usize::MAX, message, None);
            self.found.push(Diagnostic { source: String::new(), ..more });
        }
        self.found
    }
}

/// Line and column, both from 1 and the column in characters, of the byte offset `at`; behind the end means
/// the end.
fn position(text: &str, at: usize) -> (usize, usize) {
    let before = text.char_indices().take_while(|(offset, _)| *offset < at).map(|(_, letter)| letter);
    before.fold(
        (1, 1),
        |(line, column), letter| if letter == '\n' { (line + 1, 1) } else { (line, column + 1) },
    )
}

/// The line with the byte offset `at`, without its end; behind the end means the last one.
fn line_of(text: &str, at: usize) -> &str {
    let (before, after) = text.split_at_checked(at).unwrap_or((text, ""));
    let start = before.rfind('\n').map_or(0, |end| end + 1);
    let end = before.len() + after.find('\n').unwrap_or(after.len());
    text.get(start..end).unwrap_or_default().trim_end_matches('\r')
}

/// The number whose decimal comma is at the byte offset `at`, with a point; `None` if there is none.
fn decimal_comma(text: &str, at: usize) -> Option<String> {
    let (before, after) = (text.get(..at)?, text.get(at..)?.strip_prefix(',')?);
    let is_number = |letter: char| letter.is_ascii_digit() || "+-.".contains(letter);
    let whole = before.get(before.trim_end_matches(is_number).len()..)?;
    let digits = after.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(after.len());
    let fraction = after.get(..digits)?;
    (!whole.is_empty() && digits > 0).then(|| format!("{whole}.{fraction}"))
}

/// `text` cut to a length that fits a sentence.
pub(crate) fn shortened(text: &str) -> String {
    const SHOWN: usize = 40;
    let mut letters = text.chars();
    let mut short: String = letters.by_ref().take(SHOWN).collect();
    if letters.next().is_some() {
        short.push('…');
    }
    short
}

/// `text` shortened, in quotation marks, control characters escaped.
pub fn quoted(text: &str) -> String {
    format!("{:?}", shortened(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_count_characters_from_one() {
        let text = "ä = 1\n\nbc";
        assert_eq!(position(text, 0), (1, 1));
        assert_eq!(position(text, 2), (1, 2), "ä is two bytes and one character");
        assert_eq!(position(text, 7), (2, 1));
        assert_eq!(position(text, 9), (3, 2));
        assert_eq!(position(text, 1_000), (3, 3));
        assert_eq!(position("", 3), (1, 1));
    }

    #[test]
    fn a_finding_renders_for_people_and_for_programs() {
        let mut findings = Findings::new("a = 1\nb = 2\n");
        findings.warning(10, "late", "");
        findings.error(4, "early", "write 2");
        assert!(findings.failed());
        let found = findings.finish();
        let lines: Vec<_> = found.iter().map(|finding| finding.render("p.toml")).collect();
        assert_eq!(
            lines,
            [
                "p.toml:1:5: error: early\n  1 | a = 1\n    |     ^\n  help: write 2",
                "p.toml:2:5: warning: late\n  2 | b = 2\n    |     ^"
            ]
        );
        assert_eq!(
            serde_json::to_string(&found).unwrap(),
            r#"[{"severity":"error","message":"early","line":1,"column":5,"help":"write 2"},"#.to_owned()
                + r#"{"severity":"warning","message":"late","line":2,"column":5,"help":null}]"#
        );
    }

    #[test]
    fn lines_are_those_of_the_place() {
        let text = "ä = 1\r\n\nbc";
        for (at, line) in [(0, "ä = 1"), (2, "ä = 1"), (6, "ä = 1"), (8, ""), (9, "bc"), (1_000, "bc")] {
            assert_eq!(line_of(text, at), line, "{at}");
        }
        assert_eq!(line_of("", 3), "");
        let mut findings = Findings::new("a = 1\n");
        findings.unreadable("too long", "");
        assert_eq!(findings.finish()[0].render("p.toml"), "p.toml:1:1: error: too long");
    }

    #[test]
    fn a_line_that_cannot_be_parsed_is_reported_once() {
        let mut findings = Findings::new("a =\nb = 2\n");
        findings.broken(3, "no value");
        findings.error(0, "echo", "");
        findings.misplaced(4, "c is missing", "");
        findings.error(8, "b is too small", "");
        let messages: Vec<_> = findings.finish().into_iter().map(|finding| finding.message).collect();
        assert_eq!(messages, ["no value", "b is too small"]);
    }

    #[test]
    fn the_fifty_first_finding_closes_the_list() {
        let text = "\n".repeat(60);
        let noted = |warnings: usize, errors: usize| {
            let mut findings = Findings::new(&text);
            (0..warnings).for_each(|at| findings.warning(at, "w", ""));
            (warnings..warnings + errors).for_each(|at| findings.error(at, "e", ""));
            let failed = findings.failed();
            let found = findings.finish();
            let last = found.last().unwrap().clone();
            (found.len(), last.message.starts_with("and more"), last.severity, failed)
        };
        assert_eq!(noted(50, 0), (50, false, Severity::Warning, false));
        assert_eq!(noted(51, 0), (51, true, Severity::Warning, false));
        assert_eq!(
            noted(50, 1),
            (51, true, Severity::Error, true),
            "an error that is not listed still counts"
        );
        assert_eq!(noted(51, 1), (51, true, Severity::Error, true));
        assert_eq!(noted(0, 60), (51, true, Severity::Error, true));
    }

    #[test]
    fn quotes_escape_and_cut() {
        assert_eq!(quoted("a\nb"), r#""a\nb""#);
        assert_eq!(quoted(&"x".repeat(1_000)).chars().count(), 43);
    }
}
