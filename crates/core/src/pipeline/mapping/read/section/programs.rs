//! A profile's `[[program]]` tables.

use crate::pipeline::mapping::profile::Program;
use crate::toml_text::diag::Findings;
use crate::toml_text::section::Section;

/// The most programs that a profile can name.
pub(crate) const PROGRAMS_MAX: usize = 16;

pub(crate) const PROGRAM_KEYS: [&str; 2] = ["class", "executable"];

/// The longest name of a class or an executable; a path is the longest of these.
const CHARS_MAX: usize = 256;

/// Reads all `[[program]]`s.
pub(crate) fn read(tables: &[Section<'_>], findings: &mut Findings<'_>) -> Vec<Program> {
    if let Some(extra) = tables.get(PROGRAMS_MAX) {
        findings.error(
            extra.at,
            format!("a profile names at most {PROGRAMS_MAX} programs"),
            "remove this one",
        );
    }
    tables.iter().map(|table| read_one(table, findings)).collect()
}

fn read_one(table: &Section<'_>, findings: &mut Findings<'_>) -> Program {
    if table.is_empty() {
        findings.misplaced(
            table.at,
            format!("{} names no program", table.title),
            "write class = \"…\", as `xprop WM_CLASS` tells it of the window that you click, or executable = \"…\"",
        );
    }
    let [class, executable] = PROGRAM_KEYS.map(|key| read_word(table, key, findings));
    Program { class, executable }
}

fn read_word(table: &Section<'_>, key: &str, findings: &mut Findings<'_>) -> Option<String> {
    let word = table.text(key, findings)?;
    let text = word.value.trim();
    if text.is_empty() || text.chars().count() > CHARS_MAX || text.chars().any(char::is_control) {
        findings.error(word.at, format!("\"{key}\" must be one line of 1 to {CHARS_MAX} characters"), "");
        return None;
    }
    Some(text.to_owned())
}
