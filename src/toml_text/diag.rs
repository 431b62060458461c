//! What is wrong with a text and where: line, column, one sentence and the way out.

use std::fmt::{self, Write};

use serde::Serialize;

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
}

impl Diagnostic {
    /// The finding for people, as `FILE:LINE:COLUMN: error: message` and a second line `  help: …`; no final
    /// newline.
    pub fn render(&self, file: &str) -> String {
        let Self { severity, message, line, column, help } = self;
        let mut text = format!("{file}:{line}:{column}: {severity}: {message}");
        if let Some(help) = help {
            // Writing to a string cannot fail.
            let _ = write!(text, "\n  help: {help}");
        }
        text
    }
}

/// After so many findings nobody reads on; the rest is told in one line.
const FINDINGS_MAX: usize = 50;

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
        let (line, column) = position(self.text, at);
        self.broken_lines.push(line);
        // A bare word is the usual slip, and the parser names what it took the word for.
        let is_word = message.contains("boolean") || message.contains("must be quoted");
        let help = if is_word {
            Some("text stands in quotation marks".to_owned())
        } else {
            decimal_comma(self.text, at).map(|number| format!("write a decimal point: {number}"))
        };
        self.found.push(Diagnostic {
            severity: Severity::Error,
            message: message.to_owned(),
            line,
            column,
            help,
        });
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
        let (line, column) = position(self.text, at);
        if !self.broken_lines.contains(&line) {
            let help = if help.is_empty() { None } else { Some(help) };
            self.found.push(Diagnostic { severity, message, line, column, help });
        }
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
            let (line, column) = position(self.text, usize::MAX);
            let message = format!("and more: only {FINDINGS_MAX} findings are listed");
            self.found.push(Diagnostic { severity, message, line, column, help: None });
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
pub(crate) fn quoted(text: &str) -> String {
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
        assert_eq!(lines, ["p.toml:1:5: error: early\n  help: write 2", "p.toml:2:5: warning: late"]);
        assert_eq!(
            serde_json::to_string(&found).unwrap(),
            r#"[{"severity":"error","message":"early","line":1,"column":5,"help":"write 2"},"#.to_owned()
                + r#"{"severity":"warning","message":"late","line":2,"column":5,"help":null}]"#
        );
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
